//! Either side begins anew at random points of the example, under the emulated chip: the chip by a loss of power, the host killed.
//! The other side notices, the override goes where docs/board-safety.md says, and nothing but a person arms again.

use arcfeed::board::words;
use arcfeed_control::Control;
use arcfeed_firmware::supervisor::signals::{Request, Signals};
use arcfeed_hil_sim::override_source::board::Board;
use arcfeed_hil_sim::simulated_machine::STEP;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_link::link::{LinkState, Loss};
use arcfeed_link::message::codes::{AlarmCode, ModeCode, StateCode};
use arcfeed_nc::segment::Segment;
use arcfeed_tests::emulation::cable::{Cable, FROM_BOARD, TO_BOARD};
use arcfeed_tests::emulation::host::{Host, SET};
use arcfeed_tests::emulation::qemu::{Clock, Emulator};
use arcfeed_tests::noticed::{Noticed, assert_explained};
use arcfeed_tests::of_full_set;
use arcfeed_units::Micros;

use crate::runs::Example;

/// Points of each kind: some seconds, and with `ARCFEED_SOAK_SECONDS` all.
const SHORT: usize = 3;
const FULL: usize = 100;
/// Points of one run of the program, from a random move on.
const IN_A_ROW: usize = 10;
/// Longest time that the machine runs armed before the restart, and the time after it without a person, ms.
const BEFORE: usize = 3_000;
const AFTER: usize = 200;
/// With room for fewer moves than this left the board has enough to go on with.
const ENOUGH: u16 = 24;
/// The link's time-out, and the slowest hello.
const LOST: usize = 250;
const NOTICED: usize = LOST + 25;
/// A person who does not get it armed in this time gives up.
const TIMEOUT: usize = 10_000;
/// For how long a button is held.
const HELD: usize = 20;
/// The cable: latency below this, and so many of a thousand periods with a byte corrupted, or none.
const LATENCY_MS: usize = 20;
const CORRUPTED_PER_MILLE: u64 = 50;

/// The machine at work, with a chip for its override and a host at the end of a bad cable.
struct UnderWay {
    example: Example,
    moves: Vec<Segment>,
    random: Random,
    simulation: Simulation<Board<Emulator, Cable<Host>>>,
    /// Moves that the control has begun, and the one in work.
    begun: usize,
    active: Option<(u32, Segment)>,
    /// Starts so far.
    hosts: u32,
    boards: u32,
    /// Whether a person has armed since the last restart.
    is_armed: bool,
}

/// Result of a restart.
#[derive(Clone, Copy, Debug)]
struct Outcome {
    noticed: Noticed,
    /// Override before, at the first period that knows, and [`AFTER`] later, %.
    percent: [u8; 3],
}

struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % end
    }
}

impl UnderWay {
    /// A machine on a random move, feed hold pressed, board and host just switched on.
    fn new(seed: u64) -> Self {
        let (example, mut random) = (Example::load(), Random(seed));
        let moves = example.segments();
        let (mut control, mut begun, mut active) = (example.control(), 0, None);
        let first = random.below(moves.len() - 4);
        for period in 1.. {
            control.step(Micros(STEP.0 * period), STEP, 100);
            begun += begins(&mut active, &control);
            if begun > first {
                break;
            }
        }
        control.hold();
        let cable = cable(&mut random, Host::begun_anew(&example.file.job, 1));
        let board = Board::new(Emulator::start("feedboard", Clock::Lockstep), cable, ModeCode::Lockstep);
        let simulation = Simulation::new(control, &example.file.job, board);
        UnderWay { example, moves, random, simulation, begun, active, hosts: 1, boards: 1, is_armed: false }
    }

    /// One period; the override.
    fn step(&mut self) -> u8 {
        self.simulation.step();
        assert_eq!(self.simulation.source().failure(), None);
        self.begun += begins(&mut self.active, self.simulation.control());
        assert!(self.is_armed || !self.is_engaged(), "armed without a person");
        let percent = self.simulation.override_output().percent;
        assert!(percent <= 200, "beyond the limits");
        percent
    }

    fn until(&mut self, most: usize, what: &str, holds: impl Fn(&Self) -> bool) -> usize {
        for periods in 0..=most {
            if holds(self) {
                return periods;
            }
            self.step();
        }
        panic!("{what}: not within {most} ms: {:?}, {:?}", self.state(), self.host().report);
    }

    fn host(&self) -> &Host {
        &self.simulation.source().attached().far
    }

    fn state(&self) -> Option<StateCode> {
        self.simulation.source().state()
    }

    fn is_engaged(&self) -> bool {
        self.state().is_some_and(words::is_engaged)
    }

    /// A person looks: feed hold; the host continues with the next move; ARM; cycle start. Then the machine goes on for a
    /// while.
    fn take_up(&mut self) {
        self.simulation.control_mut().hold();
        self.until(TIMEOUT, "the axes to rest", |way| way.simulation.control().is_at_rest());
        let next = self.moves.get(self.begun..).unwrap_or_default();
        self.simulation.source_mut().attached_mut().far.give(&self.example.file.job, next);
        self.until(TIMEOUT, "the moves", |way| {
            let report = way.host().report.filter(|report| report.set == SET);
            report.is_some_and(|report| report.room < ENOUGH || way.host().is_through())
        });
        self.arm();
        self.simulation.control_mut().cycle_start();
        for _ in 0..self.random.below(BEFORE) {
            self.step();
        }
        assert!(self.is_engaged(), "{:?}", self.state());
    }

    /// Presses the button until it is armed: what was lost has to be fresh for a time first.
    fn arm(&mut self) {
        self.is_armed = true;
        for at in 0..TIMEOUT {
            let is_pressed = (at / HELD).is_multiple_of(2);
            let panel = if is_pressed { Signals::of_request(Request::Arm) } else { Signals::NONE };
            self.simulation.source_mut().set_panel(panel);
            self.step();
            if self.is_engaged() {
                return self.simulation.source_mut().set_panel(Signals::NONE);
            }
        }
        panic!("not armed: {:?}", self.state());
    }

    /// Whether the program is almost finished.
    fn is_ending(&self) -> bool {
        self.begun + 2 > self.moves.len()
    }

    /// Another host in place of the one that was there, and another cable: it knows the job and not where the program is.
    fn replace_host(&mut self) {
        self.hosts += 1;
        let host = Host::begun_anew(&self.example.file.job, self.hosts);
        *self.simulation.source_mut().attached_mut() = cable(&mut self.random, host);
    }

    /// The chip without power, and with it again; no time passes for the machine.
    fn power_cycle(&mut self) {
        self.boards += 1;
        self.simulation.source_mut().restart(Emulator::power_cycle);
    }

    fn cable(&self) -> &Cable<Host> {
        self.simulation.source().attached()
    }

    /// Bytes corrupted on one way of those sent since then that have arrived; `None` if the cable corrupts none.
    fn corrupted(&self, way: usize, since: Micros) -> Option<usize> {
        let (cable, now) = (self.cable(), self.simulation.now());
        let counts = |sent: &&Micros| **sent > since && sent.after(cable.latency()) <= now;
        (!cable.is_clean()).then(|| cable.corrupted[way].iter().filter(counts).count())
    }

    fn latency(&self) -> usize {
        (self.cable().latency().0 / STEP.0) as usize
    }

    /// Periods without a person; the override at their end.
    fn watch(&mut self, mut each: impl FnMut(&Self, u8)) -> u8 {
        for _ in 0..AFTER {
            let percent = self.step();
            each(self, percent);
        }
        self.simulation.override_output().percent
    }
}

/// Number of moves that the control has begun in the last period, as [`Simulation`] counts them.
fn begins(active: &mut Option<(u32, Segment)>, control: &Control) -> usize {
    let before = std::mem::replace(active, control.active().map(|(count, segment)| (count, *segment)));
    usize::from(active.is_some() && *active != before)
}

fn cable(random: &mut Random, host: Host) -> Cable<Host> {
    let latency = Micros::from_ms(random.below(LATENCY_MS) as u64);
    let corrupted = random.below(2) as u64 * CORRUPTED_PER_MILLE;
    Cable::new(host, latency, corrupted, random.below(usize::MAX) as u64)
}

/// The host is killed, and started again by somebody who goes away.
fn host_restarts(way: &mut UnderWay) -> Outcome {
    let (before, since) = (way.simulation.override_output().percent, way.simulation.now());
    way.replace_host();
    let after = way.until(NOTICED, "the host's restart", |way| !way.is_engaged());
    way.is_armed = false;
    // The board can receive in the same period what the host sends at its beginning.
    let noticed = Noticed { after, way: 1 + way.latency(), corrupted: way.corrupted(TO_BOARD, since) };
    let at = way.simulation.override_output().percent;
    assert!(at <= 100, "{before} to {at} %");
    let mut last = at;
    let later = way.watch(|way, percent| {
        assert_eq!(way.state(), Some(StateCode::Fallback));
        assert!(percent <= last.max(100), "{last} to {percent} %");
        last = percent;
    });
    assert!(later == 100 || before < 100, "{before} % before, {later} % after");
    let report = way.host().report.expect("the new host is welcome");
    assert_eq!((report.state, report.alarm), (StateCode::Fallback, AlarmCode::Latched));
    Outcome { noticed, percent: [before, at, later] }
}

/// The chip loses its power, and has it again.
fn board_restarts(way: &mut UnderWay) -> Outcome {
    let (before, since) = (way.simulation.override_output().percent, way.simulation.now());
    way.is_armed = false;
    way.power_cycle();
    let at = way.step();
    assert_eq!((at, way.state()), (0, Some(StateCode::Idle)), "power-on");
    let after = 1 + way.until(NOTICED, "the board's restart", |way| way.host().link().state() != LinkState::Up);
    // The host receives in the next period at the earliest what the board sends at the end of a period.
    let noticed = Noticed { after, way: 1 + way.latency().max(1), corrupted: way.corrupted(FROM_BOARD, since) };
    let reason = way.host().link().state();
    assert_eq!(
        (reason, words::link(reason).as_str()),
        (LinkState::Lost(Loss::PeerRestarted), "the board has restarted")
    );
    let (sent, mut last) = (way.host().bytes()[0], way.simulation.override_output().percent);
    let later = way.watch(|way, percent| {
        assert_eq!(way.state(), Some(StateCode::Idle));
        assert!(percent <= 100 && percent <= last + 1, "{last} to {percent} %");
        last = percent;
    });
    assert_eq!(way.host().bytes()[0], sent, "a host that lost its board sends nothing more");
    way.replace_host();
    Outcome { noticed, percent: [before, at, later] }
}

/// Restarts, one after the other, in as many programs as it takes; what they came to.
fn restarts(who: &str, seed: u64, restart: fn(&mut UnderWay) -> Outcome) {
    let points = of_full_set(FULL, SHORT);
    let (mut outcomes, mut programs) = (Vec::new(), 0);
    while outcomes.len() < points {
        let mut way = UnderWay::new(seed + programs);
        programs += 1;
        way.take_up();
        let until = points.min(outcomes.len() + IN_A_ROW);
        while outcomes.len() < until && !way.is_ending() {
            outcomes.push(restart(&mut way));
            println!("{} moves begun, {:?}", way.begun, outcomes[outcomes.len() - 1]);
            way.take_up();
            let starts = way.host().link().peer_session().expect("the link is up") >> 16;
            assert_eq!(starts, way.boards, "starts as the board counts them");
        }
    }
    let column = |at: usize| outcomes.iter().map(move |outcome| outcome.percent[at]);
    let [before, at, later] =
        [0, 1, 2].map(|when| [column(when).min(), column(when).max()].map(Option::unwrap_or_default));
    println!("{points} points in {programs} programs");
    assert_explained(who, &outcomes.iter().map(|outcome| outcome.noticed).collect::<Vec<_>>());
    println!("override, least and largest, %: {before:?} before, {at:?} when noticed, {later:?} {AFTER} ms later");
}

#[test]
fn a_host_that_begins_anew_is_noticed_by_the_chip_which_a_person_has_to_arm_again() {
    restarts("host", 1, host_restarts);
}

#[test]
fn a_chip_that_begins_anew_is_noticed_by_the_host_and_boots_disarmed() {
    restarts("chip", 1_001, board_restarts);
}
