//! Times from a fault to its safe output, measured on a board in process and compared with `docs/board-safety.md`.

use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::controller;
use arcfeed_firmware::supervisor::Supervisor;
use arcfeed_firmware::supervisor::input::Input;
use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::report::Alarm;
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_firmware::supervisor::signals::{BoardFault, Signals};
use arcfeed_firmware::supervisor::state::State;
use arcfeed_link::message::codes::RequestCode;
use arcfeed_link::message::table;
use arcfeed_model::cut::{CutRule, Moves, RotationCircle, Work};
use arcfeed_model::job::{FeedPolicy, Job, LawKind, OverrideLimits, ToolSetup, Tools};
use arcfeed_model::stock::{Stock, StockLine};
use arcfeed_model::tool::{CupMill, Edge, Tool};
use arcfeed_nc::modal::{Feed, Plane, Pose, Turn};
use arcfeed_nc::segment::{Arc, Path, Segment};
use arcfeed_units::{LengthUnit, MmPerTooth, Nm, RevPerMin, Span};

use crate::application::document::rows;
use crate::application::world::{Board, Channel, Host, World, standing};

const RADIUS: Nm = Nm(100_000_000);
/// The highest override there is.
const WORST_PERCENT: u8 = 200;
/// From 0 % to 100 %, armed, to 200 %, and settled.
const SETTLE: usize = 5_000;

/// Stands at the beginning of an arc on which the law wants more than 200 % of the feed that was sent, and a little less further on.
fn job() -> Job {
    let rule = CutRule {
        tool: 0,
        moves: Moves::Rotations(RotationCircle::Exterior, Turn::Cw),
        work: Work::Ring(
            Edge::Outer,
            Stock::half_plane(StockLine { normal: [0.0, 1.0], offset_mm: 50.0, rise_ratio: 0.0 }),
        ),
        feed_per_tooth: None,
        table: None,
        sequence: None,
        level: None,
    };
    Job {
        unit: LengthUnit::Mm,
        tools: Tools::one(ToolSetup::new(
            Tool::CupMill(CupMill { outer_radius: RADIUS, inner_radius: Nm(90_000_000), active_teeth: 10 }),
            RevPerMin(1_000.0),
            LawKind::Circumference,
            MmPerTooth(0.1),
        )),
        ceiling: Default::default(),
        policy: FeedPolicy::OverrideOnly,
        limits: OverrideLimits::default(),
        machine: Default::default(),
        rules: [rule].into_iter().collect(),
        knots: Default::default(),
    }
}

fn start() -> Pose {
    Pose { linear: [Nm(0), RADIUS, Nm(0)], ..Pose::default() }
}

fn quarter(feed: Nm) -> Segment {
    let end = Pose { linear: [RADIUS, Nm(0), Nm(0)], ..Pose::default() };
    let ends = [[Nm(0), RADIUS], [RADIUS, Nm(0)]];
    let [from, to] = ends;
    let arc = Arc { plane: Plane::Xy, turn: Turn::Cw, center: [Nm(0), Nm(0)], from, to };
    Segment { sequence: None, start: start(), end, feed: Feed::PerMinute(feed), path: Path::Arc(arc) }
}

/// The feed of which the law wants 220 %.
fn feed(job: &Job) -> Nm {
    let supervisor = Supervisor::new(job, Settings::default()).expect("the bounds are sound");
    let probe = ActiveSegment::new(&quarter(Nm(1_000_000_000)), job.rules.first(), job);
    let measured =
        controller::Measurement { position: Some(start()), spindle: job.tools.first().spindle, dt: Span::from_ms(1) };
    let output = supervisor.tick(&mut Memory::armed(), Some((0, &probe)), &Input::of(measured));
    let path = output.ipt_center.expect("the probe meets the stock");
    let wanted =
        f64::from(path.0) * f64::from(job.tools.first().tool.active_teeth()) * f64::from(job.tools.first().spindle.0);
    Nm::from_mm(wanted / 2.2)
}

/// Running, as fast as the law wants it.
pub fn settled() -> World {
    let job = job();
    let mut world = World::new(&job, &[(quarter(feed(&job)), Some(0))], [1, 2].map(|seed| Channel::new(0, 0, seed)));
    world.sensors = standing(start(), job.tools.first().spindle);
    world.arm();
    world.run(SETTLE);
    world
}

/// Running at 200 %, the host heard just now.
fn running() -> World {
    let mut world = settled();
    let output = world.output.expect("a tick");
    assert_eq!((output.feed_override.percent, output.state), (WORST_PERCENT, State::Running));
    // The worst moment: the next word would have come first after the longest silence.
    world.until("a word of the host", |world| world.board.host_link.link().age(world.now) == Span(0));
    world
}

/// Name, fault, and test of the safe state.
type Fault = (&'static str, fn(&mut World), fn(&World) -> bool);

fn percent(world: &World) -> u8 {
    world.output.expect("a tick").feed_override.percent
}

fn is_stopped(world: &World) -> bool {
    percent(world) == 0
}

fn is_plain(world: &World) -> bool {
    percent(world) <= 100
}

fn is_alarmed(world: &World) -> bool {
    world.output.expect("a tick").alarm == Alarm::Latched
}

fn engagement(world: &mut World) {
    world.sensors.signals = Signals::of_fault(BoardFault::Watchdog);
}

fn fail(world: &mut World) {
    world.sensors.signals = Signals::of_fault(BoardFault::Hardware);
}

/// A set of which one message is missing.
fn tear_parameters(world: &mut World) {
    if world.host.refusals.is_empty() && world.host.link.unacknowledged() == 0 {
        world.host.say(table::Begin { set: 2 });
        world.host.say(table::Commit { set: 2, messages: 4, checksum: 0xDEAD_BEEF });
    }
}

fn blind(world: &mut World) {
    world.sensors.freshness.age = world.sensors.freshness.age.longer_by(Span::from_ms(1));
}

fn pull_plug(world: &mut World) {
    world.down.is_open = false;
}

fn restart_host(world: &mut World) {
    if world.host.link.session() == 1 {
        world.host = Host::new(2, &job(), &[]);
    }
}

fn say_goodbye(world: &mut World) {
    world.host.link.close();
}

/// Noise on the host's line, enough for twenty frames that are none.
fn make_noise(world: &mut World) {
    world.down.is_open = false;
    let now = world.now;
    world.board.host_link.on_link_bytes(now, &[0x02, 0x11, 0x00].repeat(20));
}

fn restart_board(world: &mut World) {
    if world.board.task.memory().state() != State::Idle {
        world.board = Board::boot(2, None);
    }
}

fn stop_main_loop(world: &mut World) {
    world.is_main_loop_running = false;
}

fn ask_to_disarm(world: &mut World) {
    world.host.ask(RequestCode::Disarm);
}

fn clear(world: &mut World) {
    world.host.say(table::Clear {});
}

fn compensate(world: &mut World) {
    world.sensors.signals = Signals::CUTTER_COMPENSATION;
}

fn tap(world: &mut World) {
    world.sensors.signals = Signals::TAPPING;
}

fn lower_dial(world: &mut World) {
    world.sensors.operator_percent = 80;
}

fn stop_spindle(world: &mut World) {
    world.sensors.spindle = RevPerMin(f32::NAN);
}

const FAULTS: [Fault; 21] = [
    ("watchdog: 0 %", engagement, is_stopped),
    ("board fault: 0 %", fail, is_stopped),
    ("corrupt parameters: 0 %", tear_parameters, is_stopped),
    ("board restarts: 0 %", restart_board, is_stopped),
    ("position silent: alarm", blind, is_alarmed),
    ("position silent: 100 %", blind, is_plain),
    ("host silent: alarm", pull_plug, is_alarmed),
    ("host silent: 100 %", pull_plug, is_plain),
    ("noise on the link: alarm", make_noise, is_alarmed),
    ("noise on the link: 100 %", make_noise, is_plain),
    ("host restarts: alarm", restart_host, is_alarmed),
    ("host restarts: 100 %", restart_host, is_plain),
    ("host says goodbye: 100 %", say_goodbye, is_plain),
    ("main loop stops, no watchdog: alarm", stop_main_loop, is_alarmed),
    ("main loop stops, no watchdog: 100 %", stop_main_loop, is_plain),
    ("segments cleared: 100 %", clear, is_plain),
    ("host asks to disarm: 100 %", ask_to_disarm, is_plain),
    ("G41/G42 or #3004: 100 %", compensate, is_plain),
    ("tapping, threading, G63, rapid: 100 %", tap, is_plain),
    ("dial down to 80: 80 %", lower_dial, |world| percent(world) <= 80),
    ("spindle speed not a number: 100 %", stop_spindle, is_plain),
];

/// Ticks from the fault to its safe output; the tick that could first see it is 1.
fn ticks((what, strike, is_safe): &Fault) -> u32 {
    let mut world = running();
    for tick in 1..3_000 {
        strike(&mut world);
        world.step();
        if is_safe(&world) {
            return tick;
        }
    }
    panic!("{what}: never safe")
}

#[test]
fn the_document_quotes_the_times_that_are_measured() {
    let measured: Vec<String> = FAULTS.iter().map(|fault| format!("{} | {}", fault.0, ticks(fault))).collect();
    measured.iter().for_each(|row| println!("| {row} |"));
    let quoted: Vec<String> = rows("board-safety.md", "Times").into_iter().map(|row| row[..2].join(" | ")).collect();
    assert_eq!(quoted, measured);
}

#[test]
fn a_fault_stays_until_a_person_resets_and_then_nothing_is_armed() {
    use arcfeed_firmware::supervisor::signals::Request;
    for strike in [engagement as fn(&mut World), fail, tear_parameters] {
        let mut world = running();
        world.host.refusals.clear();
        strike(&mut world);
        world.run(3);
        world.sensors.signals = Signals::NONE;
        world.host.ask(RequestCode::Arm);
        assert!((0..2_000).all(|_| world.step().feed_override.percent == 0), "0 % until then");
        world.sensors.signals = Signals::of_request(Request::Reset);
        world.step();
        world.sensors.signals = Signals::NONE;
        assert!((0..3_000).all(|_| world.step().state == State::Idle));
    }
}

#[test]
fn last_value_is_kept_for_exactly_its_time_to_live_after_the_last_frame() {
    let mut world = running();
    pull_plug(&mut world);
    let kept = (1..2_000).take_while(|_| world.step().feed_override.percent == WORST_PERCENT).count();
    println!("the last value stayed for {kept} ticks");
    // Tick 300 is the first behind it.
    assert_eq!(kept, 299);
}
