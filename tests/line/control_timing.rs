//! Timing of the control: a documented program over a line at 9600 baud, millisecond by millisecond, compared with a
//! reviewed trace (`tests/cases/control-timing`, whose README has the arithmetic) and with that arithmetic.

use std::collections::VecDeque;

use arcfeed_control::line::LineSettings;
use arcfeed_control::{Control, ControlSettings, Switches};
use arcfeed_model::machine::ArcClamp;
use arcfeed_tests::root;
use arcfeed_units::{LengthUnit, Micros, Mm, MmPerMin};

const CASE: &str = "tests/cases/control-timing";
const STEP: Micros = Micros::from_ms(1);
const DC1: u8 = 0x11;
const DC3: u8 = 0x13;
/// When the operator presses feed hold, and cycle start again, after N30 has begun.
const HOLD_AFTER_MS: u64 = 180;
const RESTART_AFTER_MS: u64 = 400;
/// 11 bits at 9600 baud.
const CHAR_MS: f64 = 11.0 / 9.6;

/// A 16i with a small buffer, an arc clamp of 1500 mm/min at 1.25 mm, and the optional-stop and block-delete switches on.
fn settings() -> ControlSettings {
    let settings = ControlSettings::fanuc_16i(LengthUnit::Mm);
    ControlSettings {
        line: LineSettings { buffer: 64, xoff_below: 16, xon_above: 48, ..settings.line },
        look_ahead: 4,
        arc_clamp: Some(ArcClamp { feed: MmPerMin(3_000.0), radius: Mm(5.0), floor: MmPerMin(100.0) }),
        operator_restart: Some(Micros::from_ms(200)),
        switches: Switches { optional_stop: true, block_delete: 1, ..Switches::default() },
        ..settings
    }
}

/// A sender that keeps one character on the line and stops at DC3.
struct Sender {
    left: VecDeque<u8>,
    may_send: bool,
}

impl Sender {
    fn step(&mut self, control: &mut Control) -> Option<&'static str> {
        let mut said = None;
        while let Some(byte) = control.port().poll_transmit() {
            self.may_send = byte == DC1;
            said = Some(if byte == DC1 { "DC1" } else { "DC3" });
            assert!(matches!(byte, DC1 | DC3));
        }
        while self.may_send && control.port().on_wire() < 2 {
            let Some(byte) = self.left.pop_front() else { break };
            control.port().on_bytes(&[byte]);
        }
        said
    }
}

/// Time, what happened, and what there was to see.
struct Event {
    at_ms: u64,
    what: String,
    bytes: u64,
    buffered: usize,
    queued: usize,
    speed_mm_per_s: f64,
    x_mm: f64,
}

/// Runs the program; answers what happened.
fn run() -> Vec<Event> {
    let program = std::fs::read(root().join(CASE).join("program.nc")).expect("the case has a program");
    let mut sender = Sender { left: program.into(), may_send: false };
    let mut control = Control::on_line(settings());
    let mut events: Vec<Event> = Vec::new();
    let (mut executed, mut was_resting, mut was_stopped, mut began_ms) = (0, true, false, None);
    for ms in 1..20_000 {
        control.step(Micros::from_ms(ms), STEP, 100);
        let mut happened: Vec<String> = sender.step(&mut control).map(str::to_owned).into_iter().collect();
        for block in &control.executed()[executed..] {
            let text = String::from_utf8_lossy(block).into_owned();
            began_ms = began_ms.or((text.starts_with("N30")).then_some(ms));
            happened.push(text);
        }
        executed = control.executed().len();
        if began_ms == Some(ms - HOLD_AFTER_MS.min(ms)) {
            control.hold();
            happened.push("feed hold".into());
        }
        if began_ms == Some(ms - RESTART_AFTER_MS.min(ms)) {
            control.cycle_start();
            happened.push("cycle start".into());
        }
        if control.is_at_rest() && !was_resting {
            happened.push("at rest".into());
        }
        if control.is_stopped() != was_stopped {
            happened.push(if was_stopped { "goes on" } else { "waits" }.into());
        }
        (was_resting, was_stopped) = (control.is_at_rest(), control.is_stopped());
        if !happened.is_empty() {
            events.push(Event {
                at_ms: ms,
                what: happened.join(", "),
                bytes: control.line_counters().bytes,
                buffered: control.port().buffered(),
                queued: control.queued(),
                speed_mm_per_s: control.speed_mm_per_s(),
                x_mm: control.position().linear[0].to_mm(),
            });
        }
        if control.is_over() && control.is_at_rest() {
            assert_eq!(control.alarm(), None);
            return events;
        }
    }
    panic!("the program does not end");
}

fn render(events: &[Event]) -> String {
    let mut text = String::from("    ms  received  buffer  ahead    mm/s       X mm  what\n");
    for event in events {
        let Event { at_ms, what, bytes, buffered, queued, speed_mm_per_s, x_mm } = event;
        text += &format!("{at_ms:6}  {bytes:8}  {buffered:6}  {queued:5}  {speed_mm_per_s:6.2}  {x_mm:9.4}  {what}\n");
    }
    text
}

fn at_ms(events: &[Event], what: &str) -> u64 {
    event(events, what).at_ms
}

fn event<'e>(events: &'e [Event], what: &str) -> &'e Event {
    events.iter().find(|event| event.what.contains(what)).unwrap_or_else(|| panic!("no {what}"))
}

#[test]
fn timing_of_events_equals_the_reviewed_file() {
    let golden = root().join(CASE).join("expected.txt");
    let text = render(&run());
    println!("{text}");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&golden, &text).expect("the golden can be written");
    }
    let expected = std::fs::read_to_string(&golden).expect("the case has an expected.txt");
    assert_eq!(text, expected, "UPDATE_GOLDEN=1 rewrites {}", golden.display());
    assert!(expected.lines().count() <= 40);
}

/// The step in which something happens that takes `span_ms` from the end of step `from_ms`.
fn step_after(from_ms: u64, span_ms: f64) -> u64 {
    from_ms + libm::ceil(span_ms - 1e-6) as u64
}

#[test]
fn blocks_begin_when_their_last_bit_is_there() {
    let events = run();
    // Characters up to the end of each block, the label's two among them. The line is free from the first step.
    for (what, characters) in [("O0004", 25.0), ("N10 ", 41.0), ("N20 ", 54.0), ("N30 ", 72.0)] {
        assert_eq!(at_ms(&events, what), step_after(0, characters * CHAR_MS), "{what}");
    }
}

#[test]
fn dc3_and_dc1_come_at_their_levels() {
    let events = run();
    let levels: Vec<(u64, bool)> = events
        .iter()
        .filter(|event| event.what.contains("DC") && event.at_ms > 1 && !event.what.contains("M30"))
        .map(|event| (64 - event.buffered as u64, event.what.contains("DC3")))
        .collect();
    assert_eq!(levels.iter().map(|(_, is_dc3)| *is_dc3).collect::<Vec<_>>(), [true, false, true, false]);
    // One character is as large as a step: the first level below 16 is 15, the first above 48 is what a block leaves.
    assert!(levels.iter().all(|&(free, is_dc3)| if is_dc3 { free == 15 } else { free > 48 }), "{levels:?}");
}

#[test]
fn feed_hold_takes_v_over_a_and_the_rest_of_the_block_is_a_triangle() {
    let events = run();
    let (hold, rest) = (event(&events, "feed hold"), event(&events, "at rest"));
    let (speed, acceleration) = (hold.speed_mm_per_s, 500.0);
    assert_eq!(rest.at_ms, step_after(hold.at_ms, speed / acceleration * 1e3));
    assert!((rest.x_mm - hold.x_mm - speed * speed / (2.0 * acceleration)).abs() < 1e-6);
    let left_mm = 20.0 - rest.x_mm;
    let span_ms = 2.0 * libm::sqrt(left_mm / acceleration) * 1e3;
    assert_eq!(at_ms(&events, "N40"), step_after(at_ms(&events, "cycle start"), span_ms));
}

#[test]
fn dwell_line_and_clamped_circle_take_their_computed_times() {
    let events = run();
    let from = |what: &str| at_ms(&events, what) - 1;
    assert_eq!(at_ms(&events, "N50") - at_ms(&events, "N40"), 100);
    // L / v + v / a at 50 mm/s; the circle of 1.25 mm at half of 50 mm/s, for sqrt(1.25 / 5) = 1/2.
    assert_eq!(at_ms(&events, "N60"), step_after(from("N50"), 1e3 * (10.0 / 50.0 + 50.0 / 500.0)));
    let circle_mm = 2.0 * core::f64::consts::PI * 1.25;
    assert_eq!(at_ms(&events, "N110"), step_after(from("N100"), 1e3 * (circle_mm / 25.0 + 25.0 / 500.0)));
    for (stop, next) in [("N60", "N70"), ("N80", "goes on")] {
        let after = events.iter().find(|event| event.at_ms > at_ms(&events, stop) && event.what.contains(next));
        assert_eq!(after.map(|event| event.at_ms - at_ms(&events, stop)), Some(200), "{stop}");
    }
}
