//! Never above the target: random jobs and programs through the host and the simulated machine, millisecond by millisecond.
//!
//! The truth (`truth.rs`) is worked out of the generator's own moves and of geometry; it asks neither the law nor the parser.

mod found;
mod jobs;
mod programs;
mod runs;
mod tools;
mod truth;

use arcfeed_tests::of_full_set;
use fastrand::Rng;

use crate::feed_bounds::jobs::{LAWS, RandomJob};
use crate::feed_bounds::programs::RandomProgram;
use crate::feed_bounds::runs::{Figures, run};

/// Runs a set of programs of each law, and asserts that none is cut too fast. Every `two_tools`th job has two tools.
fn all_laws(name: &str, seed: u64, two_tools: Option<u64>, random_program: fn(&mut Rng, &RandomJob) -> RandomProgram) {
    let (mut total, programs) = (Figures::default(), of_full_set(400, 100));
    for law in LAWS {
        let (mut figures, mut refused) = (Figures::default(), 0);
        for program in 0.. {
            if figures.programs == programs {
                break;
            }
            let mut random = Rng::with_seed(seed + 1_000 * program);
            let job = RandomJob::sample(&mut random, law);
            let has_two = two_tools.is_some_and(|every| program % every == 0);
            let job = if has_two { job.with_second_tool(&mut random) } else { job };
            let random_program = random_program(&mut random, &job);
            let ran = run(name, &job, &random_program).unwrap_or_else(|excess| {
                panic!("{law}, program {program}: {excess}\n{}\n{}", job.toml(), random_program.text());
            });
            refused += u64::from(ran.is_none());
            figures.add(&ran.unwrap_or_default());
        }
        println!("{law}: {figures}; {refused} programs more stop the control in one state of its switch");
        assert!(u64::from(programs) > 4 * refused, "{law}: {refused} programs refused");
        assert!(figures.governed_ms > 5_000, "{law}: hardly anything was governed: {figures}");
        total.add(&figures);
    }
    println!("all: {total}");
}

#[test]
fn no_chip_is_thicker_than_its_target_and_no_feed_above_its_bounds() {
    all_laws("feed-bounds", 1, Some(3), RandomProgram::of_everything);
}

#[test]
fn no_chip_is_thicker_than_its_target_where_one_block_meets_another() {
    all_laws("feed-bounds-transitions", 2, None, RandomProgram::of_transitions);
}
