//! Seeded schedules of faults on the line, under a machine that works: whatever is lost, the override stays within its limits, rises no
//! faster than it may, falls back in time, and no segment is lost, taken twice or taken out of order.
//!
//! 60 of them in `cargo xtask test`, 1000 in `cargo xtask soak`.

use arcfeed_firmware::supervisor::state::State;
use arcfeed_tests::of_full_set;
use arcfeed_units::{Micros, Span};

use crate::application::example::moves;
use crate::application::world::{Channel, World, standing};
use arcfeed_tests::recording::{Recording, ibr_slot};

const SHORT: u64 = 60;
const FULL: u64 = 1_000;
/// Running time of the machine, ticks.
const LENGTH: usize = 4_000;
/// The last value stays so long after the last word of the host, and a tick.
const KEEP: Span = Span::from_ms(301);

/// Disturbances of the line.
struct Schedule {
    latency_ms: u64,
    lost_per_mille: u64,
    /// From tick, for so many ticks, which way.
    outages: Vec<(usize, usize, [bool; 2])>,
    first: usize,
}

/// Results of a schedule.
#[derive(Default)]
struct Outcome {
    losses: u32,
    executed: u32,
    stalest_ms: u32,
}

impl Schedule {
    fn new(seed: u64, run: &Recording) -> Self {
        let mut random = fastrand::Rng::with_seed(seed);
        let outage = |random: &mut fastrand::Rng| {
            let ways = [[true, false], [false, true], [true, true]];
            (random.usize(..LENGTH), random.usize(1..600), ways[random.usize(..3)])
        };
        Schedule {
            latency_ms: random.u64(..60),
            lost_per_mille: [0, 10, 50, 150][random.usize(..4)],
            outages: (0..random.usize(..4)).map(|_| outage(&mut random)).collect(),
            first: random.usize(..run.segments.len() - 4),
        }
    }
}

fn run_through(seed: u64, run: &'static Recording) -> Outcome {
    let schedule = Schedule::new(seed, run);
    let Schedule { latency_ms, lost_per_mille, first, .. } = schedule;
    let channels = [seed, !seed].map(|seed| Channel::new(latency_ms, 0, seed));
    let mut world = World::new(&run.job, &moves(run)[first..], channels);
    let start = run.ticks.iter().position(|(.., begun)| *begun == first + 1).expect("it began");
    world.sensors = standing(run.ticks[start].0, run.job.tools.first().spindle);
    world.arm();
    [world.down.lost_per_mille, world.up.lost_per_mille] = [lost_per_mille; 2];
    let (mut outcome, mut in_work, mut before) = (Outcome::default(), 0, world.output.expect("a tick"));
    for tick in 0..LENGTH {
        let cut = |way: usize| {
            schedule.outages.iter().any(|(from, long, ways)| (*from..from + long).contains(&tick) && ways[way])
        };
        [world.down.is_open, world.up.is_open] = [!cut(0), !cut(1)];
        let (position, _, begun) = run.ticks.get(start + tick).copied().unwrap_or(run.ticks[run.ticks.len() - 1]);
        world.sensors = standing(position, run.job.tools.first().spindle);
        let output = world.step();
        let context = || format!("seed {seed}, tick {tick}: {before:?}, {output:?}");
        let (percent, last) = (output.feed_override.percent, before.feed_override.percent);
        assert!(percent <= 200, "{}", context());
        // 50 %/s; a block's beginning may bring the same feed by another override, while the laws have it.
        assert!(percent <= last + 1 || output.state == State::Running, "{}", context());
        outcome.losses += u32::from(before.state.is_engaged() && !output.state.is_engaged());
        let age = world.board.host_link.link().age(world.now);
        if output.state.is_engaged() {
            assert!(age <= Span::from_ms(251), "{}", context());
            outcome.stalest_ms = outcome.stalest_ms.max((Micros(u64::from(age.0)).to_s() * 1e3) as u32);
        } else if age > KEEP && last != 100 {
            assert!(percent.abs_diff(100) <= last.abs_diff(100), "{}", context());
        }
        let report = world.board.host_link.handler().report().expect("a report");
        if let Some(count) = report.in_work {
            assert!(count >= in_work && count <= in_work + 1, "{count} behind {in_work}, {}", context());
            in_work = count;
        }
        let executed = world.board.task.executed();
        assert!(first + executed as usize <= begun, "{executed} done, {begun} begun, {}", context());
        outcome.executed = executed;
        before = output;
    }
    assert_eq!(world.host.refusals, [], "seed {seed}");
    // No person has armed it again.
    assert!(outcome.losses == 0 || !before.state.is_engaged(), "seed {seed}");
    outcome
}

#[test]
fn whatever_the_line_loses_the_override_stays_within_its_bounds_and_falls_back_in_time() {
    let schedules = of_full_set(FULL, SHORT);
    let (mut losses, mut executed, mut stalest_ms) = (0, 0, 0);
    for seed in 0..schedules {
        let outcome = run_through(seed, ibr_slot());
        (losses, executed) = (losses + outcome.losses, executed + outcome.executed);
        stalest_ms = stalest_ms.max(outcome.stalest_ms);
    }
    println!(
        "{schedules} schedules: {losses} losses, {executed} segments, the oldest word under the laws {stalest_ms} ms"
    );
    assert!(losses > schedules as u32 / 10 && executed > schedules as u32);
}
