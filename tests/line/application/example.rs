//! The example job over the link: the same overrides as with a controller that is notified of each block.

use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::controller;
use arcfeed_firmware::queue::Follower;
use arcfeed_firmware::supervisor::Supervisor;
use arcfeed_firmware::supervisor::input::Input;
use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_firmware::supervisor::state::State;
use arcfeed_nc::segment::Segment;
use arcfeed_units::Span;

use crate::application::world::{Channel, World, standing};
use arcfeed_tests::recording::{Recording, ibr_slot};

/// The run's moves with their rules.
pub fn moves(run: &Recording) -> Vec<(Segment, Option<usize>)> {
    run.segments.iter().map(|segment| (*segment, run.rule(segment))).collect()
}

/// Overrides of the board application over a line with this latency and loss.
fn over_the_link(run: &Recording, latency_ms: u64, lost_per_mille: u64) -> (Vec<u8>, World) {
    let channels = [1, 2].map(|seed| Channel::new(latency_ms, lost_per_mille, seed));
    let mut world = World::new(&run.job, &moves(run), channels);
    world.arm();
    let mut trace = Vec::new();
    for (position, ..) in &run.ticks {
        world.sensors = standing(*position, run.job.tools.first().spindle);
        trace.push(world.step().feed_override.percent);
    }
    (trace, world)
}

/// Overrides of the same supervisor and the same follower, with all segments at hand and no link at all.
fn without_a_link(run: &Recording) -> Vec<u8> {
    let supervisor = Supervisor::new(&run.job, Settings::default()).expect("the limits are sound");
    let prepare = |segment| ActiveSegment::new(segment, run.rule(segment).map(|rule| &run.job.rules[rule]), &run.job);
    let mut ahead = run.segments.iter().map(prepare).peekable();
    let (mut memory, mut follower) = (Memory::armed(), Follower::default());
    let mut trace = Vec::new();
    for (position, ..) in &run.ticks {
        let measured = controller::Measurement {
            position: Some(*position),
            spindle: run.job.tools.first().spindle,
            dt: Span::from_ms(1),
        };
        let output = supervisor.tick(&mut memory, follower.in_work(ahead.peek()), &Input::of(measured));
        trace.push(output.feed_override.percent);
        if ahead.peek().is_some_and(|front| follower.follow(supervisor.controller(), front, &measured)) {
            ahead.next();
        }
    }
    trace
}

/// FNV-1a, to compare with traces printed elsewhere.
fn hash(trace: &[u8]) -> u32 {
    trace.iter().fold(0x811C_9DC5, |hash: u32, percent| (hash ^ u32::from(*percent)).wrapping_mul(0x0100_0193))
}

/// Ticks that differ, the largest difference, and how far the furthest of them lies behind the beginning of a move or before it.
fn compare(run: &Recording, found: &[u8]) -> (usize, u8, usize) {
    let begins: Vec<usize> = (1..run.ticks.len()).filter(|at| run.ticks[*at].2 != run.ticks[at - 1].2).collect();
    let differ: Vec<usize> = (0..found.len()).filter(|at| found[*at] != run.ticks[*at].1).collect();
    let largest = differ.iter().map(|at| found[*at].abs_diff(run.ticks[*at].1)).max().unwrap_or(0);
    let away = |at: &usize| begins.iter().map(|begin| begin.abs_diff(*at)).min().unwrap_or(usize::MAX);
    (differ.len(), largest, differ.iter().map(away).max().unwrap_or(0))
}

#[test]
fn over_the_link_the_overrides_are_those_of_segments_given_directly() {
    let run = ibr_slot();
    let (found, world) = over_the_link(run, 0, 0);
    let direct = without_a_link(run);
    println!("{} ticks, {} moves, trace {:08x}", found.len(), run.segments.len(), hash(&found));
    assert_eq!(found.iter().max(), Some(&direct.iter().copied().max().expect("a trace")));
    let differ: Vec<usize> = (0..found.len()).filter(|at| found[*at] != direct[*at]).collect();
    assert!(differ.is_empty(), "differ at {differ:?}");
    assert_eq!(world.board.task.executed() as usize, run.segments.len());
    assert_eq!(world.output.expect("a tick").state, State::Armed);
}

#[test]
fn where_the_position_finds_the_blocks_the_overrides_differ_by_little_and_only_at_their_ends() {
    let run = ibr_slot();
    let found = without_a_link(run);
    let (ticks, largest, away) = compare(run, &found);
    println!(
        "{ticks} of {} ticks differ, by {largest} % at most, up to {away} ticks from a block's beginning",
        found.len()
    );
    assert!(ticks * 1_000 < found.len(), "{ticks} of {}", found.len());
    assert!(found.iter().zip(&run.ticks).all(|(found, (_, expected, _))| *found <= expected + 1));
}

#[test]
fn a_slow_line_that_loses_every_twentieth_frame_changes_no_override() {
    let run = ibr_slot();
    let (ideal, _) = over_the_link(run, 0, 0);
    let (found, world) = over_the_link(run, 20, 50);
    let corrupted = world.board.host_link.link().counters().crc_errors;
    let again = world.host.link.counters().retransmissions;
    println!("{corrupted} frames corrupted, {again} sent again");
    assert!(corrupted > 30 && again > 0, "the line was sound");
    assert_eq!(world.host.refusals, []);
    assert!(found == ideal, "{:?}", found.iter().zip(&ideal).position(|(a, b)| a != b));
}
