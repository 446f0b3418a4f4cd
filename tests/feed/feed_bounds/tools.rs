//! Jobs with several tools, against jobs for each of them alone.

use std::collections::HashMap;

use arcfeed::adapt::{Adapted, Known, PlanReason, PlannedBlock, adapt_with};
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_tests::{Scratch, of_full_set};
use fastrand::Rng;

use crate::feed_bounds::jobs::{LAWS, RandomJob, TOOL_NUMBERS};
use crate::feed_bounds::programs::RandomProgram;

fn adapted(scratch: &Scratch, name: &str, job: &str, program: &str) -> Adapted {
    let file = JobFile::load(scratch.write(name, job).as_ref()).unwrap_or_else(|error| panic!("{error:?}\n{job}"));
    let program = Program::parse_with(&file.program, program.as_bytes(), file.nc, file.tables);
    adapt_with(&program, &file.job, Known::of(&file))
}

/// Result of a law for a move: its range of feeds, the sent feed, the spindle speed.
fn governed(block: &PlannedBlock) -> Option<(String, Option<i64>, Option<f32>)> {
    let feeds = block.demand.as_ref().map(|demand| format!("{demand:?}"))?;
    Some((feeds, block.sent.map(|feed| feed.0), block.spindle.map(|speed| speed.0)))
}

#[test]
fn each_block_of_a_program_is_governed_as_by_a_job_for_its_tool_alone() {
    let scratch = Scratch::new("feed-bounds-tools");
    let (mut counts, programs) = ([0; 3], of_full_set(1_000, 300));
    for program in 0..programs {
        let mut random = Rng::with_seed(9_000 + program);
        let job = RandomJob::sample(&mut random, LAWS[program as usize % LAWS.len()]).with_second_tool(&mut random);
        let random_program = RandomProgram::of_everything(&mut random, &job);
        let text = random_program.text();
        let both = adapted(&scratch, "job.toml", &job.toml(), &text);
        let alone = [0, 1].map(|place| adapted(&scratch, "alone.toml", &job.toml_of_one(place), &text));
        let by_line = |adapted: &Adapted| -> HashMap<usize, PlannedBlock> {
            adapted.blocks.iter().map(|block| (block.line, block.clone())).collect()
        };
        let alone = alone.each_ref().map(by_line);
        for block in &both.blocks {
            let of_move = |n: i64| random_program.moves.get(n as usize - 1).copied().flatten();
            let Some(of) = block.segment.sequence.and_then(of_move) else { continue };
            let expected = of.tool.and_then(|place| alone[place].get(&block.line));
            // The law of the next block also decides whether an F would leak into it.
            let is_kept = |block: &PlannedBlock| matches!(block.reason, PlanReason::BlockDelete | PlanReason::FeedLeak);
            if is_kept(block) || expected.is_some_and(is_kept) {
                continue;
            }
            counts[of.tool.unwrap_or(2)] += usize::from(governed(block).is_some());
            let expected = expected.and_then(governed);
            assert_eq!(governed(block), expected, "program {program}, line {}\n{}\n{text}", block.line, job.toml());
        }
    }
    let [first, second, other] = counts;
    println!("{programs} programs: {first} moves governed by T{}, {second} by T{}", TOOL_NUMBERS[0], TOOL_NUMBERS[1]);
    let plenty = programs as usize * 3 / 10;
    assert!(first > plenty && second > plenty && other == 0, "{counts:?}");
}
