//! The calls as C makes them: the same results as the Rust controller to the bit, and an error for each misuse.

use super::*;
use crate::random::Random;
use crate::values::{
    ARCFEED_NO_LINE, ARCFEED_NO_RULE, ARCFEED_PATH_CCW_XY, ARCFEED_PATH_CW_XY, ARCFEED_PATH_LINE, ARCFEED_SIGNAL_ARM,
    ARCFEED_SIGNAL_DISARM, ARCFEED_SIGNAL_FEED_HOLD, ARCFEED_STATE_ARMED, ARCFEED_STATE_FALLBACK,
    ARCFEED_STATE_RUNNING,
};
use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::controller::Measurement;
use arcfeed_firmware::output::telemetry::reason::Cause;
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::Supervisor;
use arcfeed_firmware::supervisor::input::Input;
use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_firmware::supervisor::signals::Signals;
use arcfeed_link::message::codes::RefusalCode;
use arcfeed_link::message::page::{self, TappedLine};
use arcfeed_link::message::prepared::{PreparedHeader, seal, write_entry};
use arcfeed_link::message::staging::empty_job;
use arcfeed_link::message::{moves as encoding, parameters};
use arcfeed_model::cut::{ContourSide, CutRule, Moves, Work};
use arcfeed_model::job::{FeedPolicy, Job, LawKind, ToolSetup, Tools};
use arcfeed_model::knots::Knot;
use arcfeed_model::tool::{EndMill, Tool};
use arcfeed_nc::modal::{Feed, Plane, Pose, Turn};
use arcfeed_nc::segment::{Arc, Path, Segment};
use arcfeed_units::{Mm, MmPerTooth, Nm, RevPerMin, Span};

/// Room of the tests.
const MOVES: usize = 40;
const SPINDLE: RevPerMin = RevPerMin(4_000.0);
const RULES: [(Turn, ContourSide); 2] = [(Turn::Cw, ContourSide::Outside), (Turn::Ccw, ContourSide::Inside)];

/// Aligned memory of a controller.
struct Place(Vec<u64>);

impl Place {
    fn of_moves(moves: usize) -> Self {
        Place(vec![0x5A5A_5A5A_5A5A_5A5A; (ARCFEED_CONTROLLER_SIZE + moves * ARCFEED_MOVE_SIZE) / 8])
    }

    fn create(&mut self) -> *mut ArcfeedController {
        let mut controller = ptr::null_mut();
        let size = self.0.len() * 8;
        // SAFETY: the memory is the test's own.
        let status = unsafe { arcfeed_create(self.0.as_mut_ptr().cast(), size, &raw mut controller) };
        assert_eq!(status, ArcfeedStatus::Ok);
        controller
    }
}

fn job() -> Job {
    let law = LawKind::Contour { inside_only: false, floor_ratio: 0.1 };
    let mill = Tool::EndMill(EndMill { radius: Nm(5_000_000), teeth: 4 });
    let mut job = Job {
        tools: Tools::one(ToolSetup::new(mill, SPINDLE, law, MmPerTooth(0.05))),
        policy: FeedPolicy::OverrideOnly,
        ..empty_job()
    };
    for (turn, side) in RULES {
        let work = Work::Mill { side, radial_depth: Nm(500_000) };
        let (moves, feed_per_tooth, table, sequence, level) = (Moves::Arcs(turn), None, None, None, None);
        job.rules.push(CutRule { tool: 0, moves, work, feed_per_tooth, table, sequence, level }).unwrap();
    }
    job
}

/// A move with the index of its rule: a half circle about the origin or a line across it.
fn random_move(random: &mut Random, from: [i64; 2], feed: i64) -> (Segment, Option<u8>) {
    let end = from.map(|at| -at);
    let pose = |[x, y]: [i64; 2]| Pose { linear: [Nm(x), Nm(y), Nm(0)], ..Pose::default() };
    let rule = random.below(3) as usize;
    let path = RULES.get(rule).map_or(Path::Line, |(turn, _)| {
        Path::Arc(Arc { plane: Plane::Xy, turn: *turn, center: [Nm(0); 2], from: from.map(Nm), to: end.map(Nm) })
    });
    let segment = Segment { sequence: None, start: pose(from), end: pose(end), feed: Feed::PerMinute(Nm(feed)), path };
    (segment, u8::try_from(rule).ok().filter(|rule| *rule < 2))
}

fn c_move(segment: &Segment, rule: Option<u8>) -> ArcfeedMove {
    let Feed::PerMinute(Nm(feed_nm_per_min)) = segment.feed else { panic!("a feed per minute") };
    ArcfeedMove {
        start_nm: segment.start.linear.map(|Nm(nm)| nm),
        end_nm: segment.end.linear.map(|Nm(nm)| nm),
        feed_nm_per_min,
        path: match rule {
            Some(0) => ARCFEED_PATH_CW_XY,
            Some(_) => ARCFEED_PATH_CCW_XY,
            None => ARCFEED_PATH_LINE,
        },
        rule: rule.unwrap_or(ARCFEED_NO_RULE),
        end_percent: 100,
        ..ArcfeedMove::default()
    }
}

/// Position at this part of a move.
fn position(segment: &Segment, part: f64) -> Pose {
    let [x, y, _] = segment.start.linear.map(|Nm(nm)| nm as f64);
    let [x, y] = match &segment.path {
        Path::Arc(arc) => {
            let (sin, cos) = libm::sincos(f64::from(arc.turn.sign()) * core::f64::consts::PI * part);
            [x * cos - y * sin, x * sin + y * cos]
        }
        _ => [x, y].map(|at| at * (1.0 - 2.0 * part)),
    };
    Pose { linear: [Nm(x as i64), Nm(y as i64), Nm(0)], ..Pose::default() }
}

fn load_page(controller: *mut ArcfeedController, job: &Job) {
    let page = page::write(job, TappedLine::default()).unwrap();
    // SAFETY: page and length belong together.
    assert_eq!(unsafe { arcfeed_load_page(controller, page.as_ptr(), page.len()) }, ArcfeedStatus::Ok);
}

fn tick(controller: *mut ArcfeedController, input: &ArcfeedInput) -> (ArcfeedOutput, ArcfeedStatus) {
    let mut output = ArcfeedOutput::default();
    // SAFETY: references of Rust.
    let status = unsafe { arcfeed_tick(controller, input, &raw mut output) };
    (output, status)
}

/// An input without a move, and the same as the Rust controller gets it.
fn inputs(signals: u32, at: Option<(i32, Pose)>, operator_percent: u8) -> (ArcfeedInput, Input) {
    let (line, pose) = at.unwrap_or((ARCFEED_NO_LINE, Pose::default()));
    let measured = Measurement { position: Some(pose), spindle: SPINDLE, dt: Span::from_ms(1) };
    let rust = Input { signals: Signals::of_machine(signals).unwrap(), operator_percent, ..Input::of(measured) };
    let c = ArcfeedInput {
        position_nm: pose.linear.map(|Nm(nm)| nm),
        position_microdeg: pose.rotary.map(|at| at.0),
        dt_us: 1_000,
        signals,
        line,
        spindle_rev_per_min: SPINDLE.0,
        operator_percent,
        ..ArcfeedInput::default()
    };
    (c, rust)
}

#[test]
fn random_programs_have_the_overrides_of_the_rust_controller_to_the_bit() {
    let (mut ticks, mut running, mut percents) = (0, 0, std::collections::BTreeSet::new());
    for seed in 0..60 {
        let (random, job) = (&mut Random(seed), job());
        let mut place = Place::of_moves(MOVES);
        let controller = place.create();
        load_page(controller, &job);
        let supervisor = Supervisor::new(&job, Settings::default()).unwrap();
        let mut memory = Memory::with_override(FeedOverride::PROGRAMMED);
        let mut from = [0, 1].map(|_| 4_000_000 + random.below(30_000_000) as i64);
        let mut line = 0;
        let mut program = Vec::new();
        for _ in 0..MOVES {
            let feed = 200_000_000 + random.below(900_000_000) as i64;
            let (segment, rule) = random_move(random, from, feed);
            line += 1 + random.below(3) as u32;
            // SAFETY: a reference of Rust.
            let status = unsafe { arcfeed_add_move(controller, line, &c_move(&segment, rule)) };
            assert_eq!(status, ArcfeedStatus::Ok);
            let active = ActiveSegment::new(&segment, rule.map(|rule| &job.rules[usize::from(rule)]), &job);
            program.push((line, segment, active));
            from = from.map(|at: i64| -at);
        }
        // SAFETY: a controller.
        assert_eq!(unsafe { arcfeed_moves(controller) }, MOVES);
        let mut step = |at: Option<(u32, Pose, &ActiveSegment)>, signals: u32, percent: u8| {
            let (c, rust) = inputs(signals, at.map(|(line, pose, _)| (line as i32, pose)), percent);
            let expected = supervisor.tick(&mut memory, at.map(|(line, _, active)| (line, active)), &rust);
            let (output, status) = tick(controller, &c);
            let found = (output.override_percent, output.state, output.reason);
            let wanted = expected.feed_override.percent;
            assert_eq!(status, ArcfeedStatus::Ok);
            assert_eq!(found, (wanted, memory_state(&memory), Cause::from(expected.reason) as u8), "seed {seed}");
            (ticks, running) = (ticks + 1, running + u32::from(output.state == ARCFEED_STATE_RUNNING));
            percents.insert(output.override_percent);
        };
        step(None, 0, 100);
        step(None, ARCFEED_SIGNAL_ARM, 100);
        for (line, segment, active) in &program {
            let steps = 20 + random.below(300);
            for at in 0..=steps {
                let signals = if random.below(50) == 0 { ARCFEED_SIGNAL_FEED_HOLD } else { 0 };
                let signals = signals | if random.below(2_000) == 0 { ARCFEED_SIGNAL_DISARM } else { 0 };
                let signals = signals | if random.below(500) == 0 { ARCFEED_SIGNAL_ARM } else { 0 };
                let percent = 92 + random.below(9) as u8;
                step(Some((*line, position(segment, at as f64 / steps as f64), active)), signals, percent);
            }
        }
    }
    println!("{ticks} ticks, {running} under a law, {} values of the override", percents.len());
    assert!(running > 100_000 && percents.len() > 60);
}

fn memory_state(memory: &Memory) -> u8 {
    arcfeed_board_app::application::report::state_code(&memory.state()) as u8
}

/// A prepared program of one half circle at line 5.
fn prepared() -> Vec<u8> {
    let (segment, rule) = random_move(&mut Random(1), [-20_000_000, 0], 800_000_000);
    prepared_with(&[], &segment, rule)
}

/// A prepared program of one move at line 5, with feeds before it.
fn prepared_with(feeds: &[Knot], segment: &Segment, rule: Option<u8>) -> Vec<u8> {
    let (job, mut entries) = (job(), Vec::new());
    let emit = &mut |bytes: &[u8]| entries.extend_from_slice(bytes);
    parameters::messages(&job, 1, &mut |message| write_entry(0, &message, emit)).unwrap();
    feeds.iter().for_each(|knot| write_entry(5, &encoding::encode_feed(knot).unwrap().into(), emit));
    write_entry(5, &encoding::encode(segment, 0, rule).unwrap().into(), emit);
    let header = PreparedHeader { moves: 1, entries_len: entries.len() as u32, ..PreparedHeader::default() };
    let mut bytes = [&header.encode()[..], &entries].concat();
    bytes.extend(seal(&bytes));
    bytes
}

fn load(controller: *mut ArcfeedController, bytes: &[u8]) -> ArcfeedStatus {
    // SAFETY: a controller, bytes and their length.
    unsafe {
        assert_eq!(arcfeed_begin_program(controller), ArcfeedStatus::Ok);
        let load_part = |part: &[u8]| arcfeed_load_program(controller, part.as_ptr(), part.len());
        bytes.chunks(4).fold(ArcfeedStatus::Incomplete, |_, part| load_part(part))
    }
}

#[test]
fn a_program_is_in_force_when_its_last_byte_is_right_and_never_before() {
    let (bytes, mut place) = (prepared(), Place::of_moves(1));
    let controller = place.create();
    // SAFETY: a controller.
    let moves = || unsafe { arcfeed_moves(controller) };
    let arm = || tick(controller, &inputs(ARCFEED_SIGNAL_ARM, None, 100).0).0;
    for length in 0..bytes.len() {
        assert_eq!((load(controller, &bytes[..length]), moves()), (ArcfeedStatus::Incomplete, 0));
    }
    assert_eq!((arm().state, arm().refusal), (0, RefusalCode::NoParameters as u8));
    assert_eq!((load(controller, &bytes), moves()), (ArcfeedStatus::Ok, 1));
    for at in 0..bytes.len() {
        let mut altered = bytes.clone();
        altered[at] ^= 1 << (at % 8);
        assert!(load(controller, &altered) != ArcfeedStatus::Ok && moves() == 0, "byte {at}");
    }
    let more = [&bytes[..], &[0]].concat();
    assert_eq!((load(controller, &more), moves()), (ArcfeedStatus::Form, 0));
    let mut small = Place::of_moves(0);
    assert_eq!(load(small.create(), &bytes), ArcfeedStatus::Full);
}

/// A controller with the prepared program, armed.
fn armed(place: &mut Place) -> *mut ArcfeedController {
    armed_with(place, &prepared())
}

fn armed_with(place: &mut Place, prepared: &[u8]) -> *mut ArcfeedController {
    let controller = place.create();
    assert_eq!(load(controller, prepared), ArcfeedStatus::Ok);
    tick(controller, &inputs(0, None, 100).0);
    let (output, _) = tick(controller, &inputs(ARCFEED_SIGNAL_ARM, None, 100).0);
    assert_eq!((output.state, output.override_percent), (ARCFEED_STATE_ARMED, 100));
    controller
}

#[test]
fn only_the_prepared_line_from_its_start_is_governed() {
    let at = |x_mm: f64, y_mm: f64| Pose { linear: [x_mm, y_mm, 0.0].map(Nm::from_mm), ..Pose::default() };
    for (line, pose, is_governed) in [
        (5, at(-20.0, 0.0), true),
        (5, at(-19.6, 0.4), true),
        (4, at(-20.0, 0.0), false),
        (6, at(-20.0, 0.0), false),
        (5, at(-19.4, 0.0), false),
        (5, at(0.0, 20.0), false),
        (5, Pose { rotary: [arcfeed_units::MicroDeg(100_001); 3], ..at(-20.0, 0.0) }, false),
    ] {
        let mut place = Place::of_moves(1);
        let controller = armed(&mut place);
        let (output, _) = tick(controller, &inputs(0, Some((line, pose)), 100).0);
        let expected = if is_governed { ARCFEED_STATE_RUNNING } else { ARCFEED_STATE_ARMED };
        assert_eq!((output.state, output.is_followed), (expected, u8::from(is_governed)), "{line} {pose:?}");
        // A move that did not begin at its start is not governed later either.
        let (output, _) = tick(controller, &inputs(0, Some((line, at(-20.0, 0.0))), 100).0);
        assert_eq!(output.is_followed, u8::from(is_governed));
    }
}

#[test]
fn feeds_before_a_move_without_a_rule_are_its_law() {
    let at = |x_mm: f64| Pose { linear: [x_mm, 0.0, 0.0].map(Nm::from_mm), ..Pose::default() };
    let feed = Feed::PerMinute(Nm(800_000_000));
    let line = Segment { sequence: None, start: at(0.0), end: at(40.0), feed, path: Path::Line };
    // 150 % in the middle: 0.075 mm by 4 teeth at 4 000 rev/min is 1 200 mm/min.
    let knots = [(0.0, 0.05), (5.0, 0.075), (30.0, 0.075), (35.0, 0.05)];
    let knots = knots.map(|(travelled, feed)| (Mm(travelled), MmPerTooth(feed)));
    for (feeds, most) in [(&knots[..], 150), (&[], 100)] {
        let mut place = Place::of_moves(1);
        let controller = armed_with(&mut place, &prepared_with(feeds, &line, None));
        let percent =
            |ms: u32| tick(controller, &inputs(0, Some((5, at(f64::from(ms) / 200.0))), 100).0).0.override_percent;
        let percents: Vec<u8> = (0..=8_000).map(percent).collect();
        assert_eq!((percents[0], percents.iter().max(), percents[8_000]), (100, Some(&most), 100));
    }
    let mut place = Place::of_moves(1);
    assert_eq!(load(place.create(), &prepared_with(&knots, &line, Some(0))), ArcfeedStatus::Value, "with a rule");
}

#[test]
fn a_program_cannot_be_exchanged_while_a_law_has_the_override() {
    let mut place = Place::of_moves(1);
    let controller = armed(&mut place);
    let page = page::write(&job(), TappedLine::default()).unwrap();
    // SAFETY: a controller, a page and its length.
    unsafe {
        assert_eq!(arcfeed_begin_program(controller), ArcfeedStatus::Busy);
        assert_eq!(arcfeed_load_page(controller, page.as_ptr(), page.len()), ArcfeedStatus::Busy);
        tick(controller, &inputs(ARCFEED_SIGNAL_DISARM, None, 100).0);
        assert_eq!(arcfeed_begin_program(controller), ArcfeedStatus::Ok);
    }
}

#[test]
fn invalid_inputs_of_a_tick_have_no_effect_and_in_a_row_are_a_loss() {
    let mut place = Place::of_moves(1);
    let controller = armed(&mut place);
    let (good, _) = inputs(0, None, 100);
    let nowhere = arcfeed_nm(f64::NAN);
    for bad in [
        ArcfeedInput { position_nm: [nowhere, 0, 0], ..good },
        ArcfeedInput { position_nm: [0, arcfeed_nm(f64::NEG_INFINITY), 0], ..good },
        ArcfeedInput { position_microdeg: [0, 0, arcfeed_microdeg(1e300)], ..good },
        ArcfeedInput { spindle_rev_per_min: f32::NAN, ..good },
        ArcfeedInput { spindle_rev_per_min: -1.0, ..good },
        ArcfeedInput { signals: 0x8000_0000, ..good },
    ] {
        let (output, status) = tick(controller, &bad);
        assert_eq!((status, output.override_percent, output.state), (ArcfeedStatus::Input, 100, ARCFEED_STATE_ARMED));
        assert_eq!(tick(controller, &good).1, ArcfeedStatus::Ok);
    }
    let lost = ArcfeedInput { position_nm: [nowhere; 3], ..good };
    let states: Vec<u8> = (0..5).map(|_| tick(controller, &lost).0.state).collect();
    assert_eq!(states, [ARCFEED_STATE_ARMED, 1, 1, 1, ARCFEED_STATE_FALLBACK]);
}

#[test]
fn every_misuse_has_an_error() {
    let mut place = Place::of_moves(1);
    let (memory, size) = (place.0.as_mut_ptr(), place.0.len() * 8);
    let mut controller = ptr::null_mut();
    let (added, input) = (ArcfeedMove { path: 1, end_percent: 100, ..ArcfeedMove::default() }, inputs(0, None, 100).0);
    let mut output = ArcfeedOutput::default();
    // SAFETY: all pointers are null, misaligned or lead to memory of their size.
    unsafe {
        let out = &raw mut controller;
        assert_eq!(arcfeed_create(ptr::null_mut(), size, out), ArcfeedStatus::Null);
        assert_eq!(arcfeed_create(memory.cast(), size, ptr::null_mut()), ArcfeedStatus::Null);
        assert_eq!(arcfeed_create(memory.cast::<u8>().add(4).cast(), size - 4, out), ArcfeedStatus::Alignment);
        assert_eq!(arcfeed_create(memory.cast(), ARCFEED_CONTROLLER_SIZE - 1, out), ArcfeedStatus::Size);
        assert!(controller.is_null());
        let raw = memory.cast::<ArcfeedController>();
        assert_eq!(arcfeed_tick(raw, &input, &raw mut output), ArcfeedStatus::NoController);
        assert_eq!(output, no_controller());
        assert_eq!(arcfeed_create(memory.cast(), size, out), ArcfeedStatus::Ok);
        assert_eq!(arcfeed_create(memory.cast(), size, out), ArcfeedStatus::Exists);
        let mut copy = place.0.clone();
        assert_eq!(arcfeed_begin_program(copy.as_mut_ptr().cast()), ArcfeedStatus::NoController);
        for (wrong, status) in [
            (ptr::null_mut(), ArcfeedStatus::Null),
            (controller.byte_add(1), ArcfeedStatus::Alignment),
            (copy.as_mut_ptr().cast(), ArcfeedStatus::NoController),
        ] {
            let mut feed = ArcfeedAdaptiveOutput::default();
            assert_eq!(arcfeed_discard(wrong), status);
            assert_eq!(arcfeed_load_page(wrong, [0_u8; 8].as_ptr(), 8), status);
            assert_eq!(arcfeed_load_program(wrong, [0_u8; 8].as_ptr(), 8), status);
            assert_eq!(arcfeed_begin_program(wrong), status);
            assert_eq!(arcfeed_add_move(wrong, 1, &added), status);
            assert_eq!(arcfeed_moves(wrong), 0);
            assert_eq!(arcfeed_tick(wrong, &input, &raw mut output), status);
            assert_eq!(arcfeed_adaptive_feed(wrong, &ArcfeedAdaptiveInput::default(), &raw mut feed), status);
            assert_eq!((output.override_percent, feed.adaptive_feed_ratio, feed.feed_inhibit), (0, 0.0, 1));
        }
        assert_eq!(arcfeed_load_page(controller, ptr::null(), 8), ArcfeedStatus::Null);
        assert_eq!(arcfeed_load_page(controller, [0_u8; 8].as_ptr(), usize::MAX), ArcfeedStatus::Size);
        assert_eq!(arcfeed_load_program(controller, [0_u8; 8].as_ptr(), 8), ArcfeedStatus::Order);
        assert_eq!(arcfeed_add_move(controller, 1, ptr::null()), ArcfeedStatus::Null);
        assert_eq!(arcfeed_add_move(controller, 1, &added), ArcfeedStatus::NoParameters);
        assert_eq!(arcfeed_tick(controller, ptr::null(), &raw mut output), ArcfeedStatus::Null);
        assert_eq!(output.override_percent, 0);
        assert_eq!(arcfeed_tick(controller, &input, ptr::null_mut()), ArcfeedStatus::Null);
        assert_eq!(arcfeed_tick(controller, &input, (&raw mut output).byte_add(1)), ArcfeedStatus::Alignment);
        assert_eq!(arcfeed_discard(controller), ArcfeedStatus::Ok);
        assert_eq!(arcfeed_discard(controller), ArcfeedStatus::NoController);
    }
}

#[test]
fn an_invalid_move_is_refused_and_nothing_changes() {
    let mut place = Place::of_moves(2);
    let controller = place.create();
    load_page(controller, &job());
    let good = ArcfeedMove {
        end_nm: [1_000_000, 0, 0],
        feed_nm_per_min: 1_000_000,
        path: ARCFEED_PATH_LINE,
        rule: ARCFEED_NO_RULE,
        end_percent: 100,
        ..ArcfeedMove::default()
    };
    // SAFETY: a controller and references of Rust.
    let add = |line, added: &ArcfeedMove| unsafe { arcfeed_add_move(controller, line, added) };
    for bad in [
        ArcfeedMove { path: 8, ..good },
        ArcfeedMove { path: 255, ..good },
        ArcfeedMove { rule: 2, ..good },
        ArcfeedMove { spindle_rev_per_min: f32::NAN, ..good },
        ArcfeedMove { spindle_rev_per_min: f32::INFINITY, ..good },
        ArcfeedMove { spindle_rev_per_min: -1.0, ..good },
        ArcfeedMove { end_nm: [i64::MIN, 0, 0], ..good },
        ArcfeedMove { start_microdeg: [i64::MAX; 3], ..good },
        ArcfeedMove { path: ARCFEED_PATH_CW_XY, center_nm: [5, 0], ..good },
        ArcfeedMove { path: ARCFEED_PATH_CW_XY, center_nm: [i64::MAX; 2], ..good },
    ] {
        assert_eq!(add(1, &bad), ArcfeedStatus::Value, "{bad:?}");
    }
    assert_eq!(add(0, &good), ArcfeedStatus::Order);
    assert_eq!(add(3, &good), ArcfeedStatus::Ok);
    assert_eq!(add(3, &good), ArcfeedStatus::Order);
    assert_eq!(add(4, &good), ArcfeedStatus::Ok);
    assert_eq!(add(5, &good), ArcfeedStatus::Full);
    // SAFETY: a controller.
    assert_eq!(unsafe { arcfeed_moves(controller) }, 2);
}

#[test]
fn the_sizes_in_the_header_leave_little_over() {
    println!("controller {SLOTS_OFFSET} bytes, move {} bytes", size_of::<Slot>());
    assert!(SLOTS_OFFSET * 5 > ARCFEED_CONTROLLER_SIZE * 4 && size_of::<Slot>() * 5 > ARCFEED_MOVE_SIZE * 4);
}
