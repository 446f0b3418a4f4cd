//! The planner works on all cores; its results do not depend on how many there are.

use arcfeed_plan::optimisation::Problem;
use arcfeed_plan::proof::verdict::{ProofCase, ProofResolution, prove};

use crate::proof_cases::published_tool;
use crate::proof_published::ROUGHING;
use crate::published_rotor::blisk;

#[test]
fn plan_volumes_and_proof_are_the_same_to_the_bit_on_one_two_and_five_threads() {
    let (blisk, tool) = (blisk(), published_tool());
    let slot = blisk.slot();
    let of_threads = [1, 2, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let found =
                Problem::new(&blisk, &slot, &tool, &ROUGHING).and_then(|problem| problem.best(|_| true)).unwrap();
            let (path, allowance_mm) = (&found.plan.path, ROUGHING.allowance_mm);
            let case =
                ProofCase { blisk: &blisk, tool: &tool, path, to_slot: found.plan.turn, allowance_mm, fixture: &[] };
            let proof = prove(&case, &ProofResolution { cell_mm: 1.0, ..ProofResolution::default() }).unwrap();
            // Printed numbers are read back to the bit.
            format!("{found:?} {proof:?}")
        })
    });
    assert!(of_threads[0].len() > 1000 && of_threads.iter().all(|found| *found == of_threads[0]));
}
