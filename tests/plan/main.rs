//! The planning of cup-mill paths: the rotor's geometry, and the proof that nothing is touched.

mod published_rotor;

mod generator;

mod files;

mod slots;

mod meshes;

mod proof_cases;

mod proof_exact;

mod proof_dense;

mod proof_volumes;

mod proof_published;

mod parts;

mod flaws;
