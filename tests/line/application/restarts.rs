//! Either side begins anew at random points of the example: the other notices, nothing of before is believed, and only a person
//! arms again.

use arcfeed_board_app::application::host_link::HostLink;
use arcfeed_firmware::supervisor::report::Alarm;
use arcfeed_firmware::supervisor::signals::BoardFault;
use arcfeed_firmware::supervisor::state::State;
use arcfeed_link::link::{LinkState, Loss};
use arcfeed_link::message::codes::RequestCode;
use arcfeed_nc::segment::Segment;
use arcfeed_tests::noticed::{Noticed, assert_explained};
use arcfeed_units::{Micros, Span};

use crate::application::example::moves;
use crate::application::world::{Board, Channel, Host, TICK, World, standing};
use arcfeed_tests::recording::{Recording, ibr_slot};

/// Number of restarts of each kind.
const POINTS: u64 = 100;
/// Corrupted frames per thousand: a normal bad line, and an almost useless one.
const CORRUPTED_PER_MILLE: u64 = 50;
const BAD_PER_MILLE: u64 = 300;
/// Longest time of the machine before the restart, and time after it, ticks.
const BEFORE: usize = 3_000;
const AFTER: usize = 1_500;
/// The link's time-out, ticks.
const LOST: usize = 250;

/// A machine under way: the moves from one on, and where it is at each tick from its beginning on.
struct UnderWay {
    run: &'static Recording,
    all: Vec<(Segment, Option<usize>)>,
    first: usize,
    tick: usize,
    world: World,
}

struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % end
    }
}

impl UnderWay {
    /// Armed at the beginning of a random move, then moving for a while.
    fn new(seed: u64) -> Self {
        let mut random = Random(seed);
        let run = ibr_slot();
        let all = moves(run);
        let first = random.below(all.len() - 4);
        let tick = run.ticks.iter().position(|(_, _, begun)| *begun == first + 1).expect("it began");
        let (latency, lost) = (random.below(20) as u64, random.below(2) as u64 * CORRUPTED_PER_MILLE);
        let channels = [seed, seed + 1].map(|seed| Channel::new(latency, lost, seed));
        let mut world = World::new(&run.job, &all[first..], channels);
        world.sensors = standing(run.ticks[tick].0, run.job.tools.first().spindle);
        world.arm();
        let mut way = UnderWay { run, all, first, tick, world };
        for _ in 0..random.below(BEFORE) {
            way.step();
        }
        way
    }

    fn step(&mut self) -> u8 {
        let at = self.run.ticks.get(self.tick).unwrap_or_else(|| self.run.ticks.last().expect("a run"));
        self.world.sensors = standing(at.0, self.run.job.tools.first().spindle);
        self.tick += 1;
        let output = self.world.step();
        assert!(output.feed_override.percent <= 200, "beyond the limits");
        output.feed_override.percent
    }

    /// Ticks until something holds.
    fn until(&mut self, most: usize, holds: impl Fn(&World) -> bool) -> usize {
        for ticks in 0..=most {
            if holds(&self.world) {
                return ticks;
            }
            self.step();
        }
        panic!("not within {most} ticks: {:?}", self.world.output);
    }

    /// From now on the line corrupts so many of a thousand frames either way; how many before.
    fn corrupt(&mut self, per_mille: u64) -> u64 {
        let World { up, down, .. } = &mut self.world;
        up.lost_per_mille = per_mille;
        std::mem::replace(&mut down.lost_per_mille, per_mille)
    }

    /// Frames that a channel corrupted of those sent since then that have come through; `None` if it corrupts none.
    fn corrupted(&self, channel: &Channel, since: Micros) -> Option<usize> {
        let counts = |sent: &&Micros| **sent > since && sent.after(channel.latency) <= self.world.now;
        (channel.lost_per_mille > 0).then(|| channel.corrupted.iter().filter(counts).count())
    }

    fn state(&self) -> State {
        self.world.output.expect("a tick").state
    }
}

/// When the board noticed that its host is another one, on a line with the given faults until then; the rest is asserted.
fn host_restarts(seed: u64, per_mille: Option<u64>) -> Noticed {
    let mut way = UnderWay::new(seed);
    let was_engaged = way.state().is_engaged();
    assert!(was_engaged, "{:?}", way.state());
    let before = way.world.output.expect("a tick").feed_override.percent;
    let (rest, since) = (way.all[way.first..].to_vec(), way.world.now);
    way.world.host = Host::new(1_000 + seed as u32, &way.run.job, &rest);
    let usual = per_mille.map(|per_mille| way.corrupt(per_mille));
    let after = way.until(LOST + 60, |world| !world.output.expect("a tick").state.is_engaged());
    // The board can receive in the same tick what the host sends.
    let down = &way.world.down;
    let noticed = Noticed { after, way: 1 + ticks(down.latency), corrupted: way.corrupted(down, since) };
    usual.map(|usual| way.corrupt(usual));
    let output = way.world.output.expect("a tick");
    assert!(matches!(output.state, State::Fallback { .. }), "{:?}", output.state);
    assert_eq!(output.alarm, Alarm::Latched);
    let executed = way.world.board.task.executed();
    let mut last = output.feed_override.percent;
    assert!(last <= before.max(100), "a loss raises nothing at once");
    // The new host sends its set and its segments, and arms nothing.
    for _ in 0..AFTER {
        let percent = way.step();
        assert!(!way.state().is_engaged(), "armed without a person");
        assert!(percent <= last.max(100), "{last} to {percent} %");
        last = percent;
    }
    assert_eq!(last, 100);
    assert!(way.world.host.is_accepted, "the new host is welcome");
    // The first segment is the old one or a later one: the position may already have passed some.
    assert!(way.world.board.task.executed().wrapping_sub(executed) < 40);
    // A person presses until it is armed: a line that loses frames may not have been fresh for long enough.
    for _ in 0..20 {
        way.world.host.ask(RequestCode::Arm);
        for _ in 0..300 {
            way.step();
        }
    }
    assert!(way.state().is_engaged(), "{:?}", way.state());
    noticed
}

/// When the host noticed that its board is another one, on a line with the given faults until then; the rest is asserted.
fn board_restarts(seed: u64, per_mille: Option<u64>) -> Noticed {
    let mut way = UnderWay::new(seed);
    let (is_bitten, since) = (seed.is_multiple_of(3), way.world.now);
    way.world.board = Board::boot(2 + seed as u32, is_bitten.then_some(BoardFault::Watchdog));
    let usual = per_mille.map(|per_mille| way.corrupt(per_mille));
    let first = way.step();
    assert_eq!(first, 0, "power-on is 0 %");
    let after = 1 + way.until(LOST + 60, |world| world.host.loss().is_some());
    assert_eq!(way.world.host.loss(), Some(Loss::PeerRestarted));
    // The host receives in the next tick at the earliest what the board sends.
    let up = &way.world.up;
    let noticed = Noticed { after, way: 1 + ticks(up.latency).max(1), corrupted: way.corrupted(up, since) };
    usual.map(|usual| way.corrupt(usual));
    let sent = way.world.host.link.counters().frames_out;
    let mut last = way.world.output.expect("a tick").feed_override.percent;
    for _ in 0..AFTER {
        let percent = way.step();
        assert!(percent <= 100 && percent <= last + 1, "{last} to {percent} %");
        assert!(!way.state().is_engaged());
        last = percent;
    }
    assert_eq!(way.world.host.link.counters().frames_out, sent, "a host that lost its board sends nothing more");
    match way.state() {
        State::Faulted { fault } => assert!(is_bitten && fault == BoardFault::Watchdog && last == 0),
        State::Idle => assert!(!is_bitten && last >= 70),
        other => panic!("{other:?}"),
    }
    assert_eq!(way.world.board.task.executed(), 0);
    noticed
}

fn ticks(time: Micros) -> usize {
    (time.0 / TICK.0) as usize
}

fn points(restart: fn(u64, Option<u64>) -> Noticed, per_mille: Option<u64>) -> Vec<Noticed> {
    (0..POINTS).map(|seed| restart(seed, per_mille)).collect()
}

#[test]
fn a_host_that_begins_anew_at_any_point_is_noticed_and_arms_nothing() {
    assert_explained("host", &points(host_restarts, None));
}

#[test]
fn a_board_that_begins_anew_at_any_point_is_noticed_and_boots_disarmed() {
    assert_explained("board", &points(board_restarts, None));
}

#[test]
fn each_corrupted_hello_costs_one_more_hello() {
    assert_explained("host, bad line", &points(host_restarts, Some(BAD_PER_MILLE)));
    assert_explained("board, bad line", &points(board_restarts, Some(BAD_PER_MILLE)));
}

#[test]
fn a_set_or_a_segment_of_the_session_before_is_not_believed() {
    let mut way = UnderWay::new(5);
    let rest: Vec<_> = way.all[way.first..].to_vec();
    let mut dead = core::mem::replace(&mut way.world.host, Host::new(77, &way.run.job, &rest));
    way.until(400, |world| world.host.is_accepted);
    let executed = way.world.board.host_link.handler().report().expect("a report").executed;
    // The old host wakes up and goes on as if nothing had happened, on a line that both can write to.
    let mut frame = [0; arcfeed_link::frame::ENCODED_MAX];
    dead.ask(RequestCode::Arm);
    let before = way.world.board.host_link.link().counters().stale_sessions;
    for _ in 0..40 {
        way.step();
        let now = way.world.now;
        let length = dead.link.poll_transmit(now, &mut frame);
        let host_link: &mut HostLink<'static> = &mut way.world.board.host_link;
        host_link.on_link_bytes(now, &frame[..length]);
    }
    let counters = way.world.board.host_link.link().counters();
    assert!(counters.stale_sessions + counters.crc_errors > before, "it was not even heard");
    assert!(!way.state().is_engaged());
    assert_eq!(way.world.board.host_link.link().state(), LinkState::Up);
    assert!(way.world.board.host_link.handler().report().expect("a report").executed - executed < 40);
}

#[test]
fn after_a_time_without_positions_no_segment_counts_as_begun_before_the_machine_begins_it() {
    let mut waiting = 0;
    for seed in 0..30 {
        let mut way = UnderWay::new(1_000 + seed);
        for dark_ms in 1..60 + (seed as u32 * 37) % 700 {
            way.world.sensors.freshness.age = Span::from_ms(dark_ms);
            way.tick += 1;
            way.world.step();
        }
        assert!(matches!(way.state(), State::Fallback { .. }));
        for _ in 0..2_500 {
            let percent = way.step();
            assert!(!way.state().is_engaged() && percent <= 200);
        }
        assert_eq!(way.world.output.expect("a tick").feed_override.percent, 100);
        way.world.host.ask(RequestCode::Arm);
        let mut behind = 0;
        for _ in 0..6_000 {
            way.step();
            let begun = way.run.ticks.get(way.tick - 1).map_or(way.run.segments.len(), |(.., begun)| *begun);
            let executed = way.first + way.world.board.task.executed() as usize;
            // The end of a move is seen a tick or two before the control begins the next.
            assert!(executed <= begun, "{executed} done, {begun} begun");
            behind = begun - executed;
        }
        waiting += u32::from(behind > 1);
    }
    println!("{waiting} of 30 wait for an end that went by unseen");
    assert!(waiting < 10);
}
