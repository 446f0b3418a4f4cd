//! The planning of cup-mill paths: the proof that nothing is touched.

mod proof_cases;

mod proof_exact;

mod proof_dense;

mod proof_volumes;
