//! The planner works on all cores; its results do not depend on how many there are.

use arcfeed_plan::cup_mill::plan::ValuedPlan;
use arcfeed_plan::optimisation::Problem;
use arcfeed_plan::proof::verdict::{ProofCase, ProofResolution, prove};
use arcfeed_tests::of_full_set;

use crate::proof_cases::published_tool;
use crate::proof_published::{ROUGHING, ranked};
use crate::published_rotor::blisk;

#[test]
fn plan_volumes_and_proof_are_the_same_to_the_bit_on_any_number_of_threads() {
    let (blisk, tool) = (blisk(), published_tool());
    let slot = blisk.slot();
    let proven = |found: &ValuedPlan| {
        let (path, allowance_mm) = (&found.plan.path, ROUGHING.allowance_mm);
        let case = ProofCase {
            blisk: &blisk,
            tool: &tool,
            path,
            to_slot: found.plan.turn,
            allowance_mm,
            fixture: &[],
            earlier: &[],
        };
        let proof = prove(&case, &ProofResolution { cell_mm: 1.0, ..ProofResolution::default() }).unwrap();
        // Printed numbers are read back to the bit.
        format!("{found:?} {proof:?}")
    };
    let of_computer = proven(&ranked()[0]);
    let mut of_threads = of_full_set(&[1, 5][..], &[5]).iter().map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(*threads).build().unwrap();
        let best = || Problem::new(&blisk, &slot, &tool, &ROUGHING).and_then(|problem| problem.best(|_| true)).unwrap();
        pool.install(|| proven(&best()))
    });
    assert!(of_computer.len() > 1000 && of_threads.all(|found| found == of_computer));
}
