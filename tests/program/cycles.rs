//! Canned cycles and ways of writing numbers against closed forms: depths and feeds written out by hand or computed from
//! the drawing, never from the reader.

use arcfeed_nc::alarm::{Alarm, Cause};
use arcfeed_nc::block::Reading;
use arcfeed_nc::modal::{MotionKind, Pose};
use arcfeed_nc::reader::Reader;
use arcfeed_nc::series::SeriesAction;
use arcfeed_nc::settings::{Decimals, Preset, Scope, Settings, Tables};
use arcfeed_units::{LengthUnit, Micros, Nm};

/// Rounding of two points, nm.
pub const ROUNDING_NM: f64 = 2.0;

pub fn reader(change: impl Fn(&mut Settings, &mut Tables)) -> Reader {
    let mut settings = Settings::preset(Preset::Fanuc16i, LengthUnit::Mm, Reading::Strict);
    settings.scope = Scope::Everything;
    let mut tables = Tables::default();
    change(&mut settings, &mut tables);
    Reader::with(settings, tables)
}

/// Motions of a program, written as `r x y z`, `f x y z`, `a x y z` (arc), `d seconds`, `s` for the spindle.
pub fn run(reader: &mut Reader, program: &str) -> Vec<String> {
    let show = |pose: &Pose| pose.linear.map(|axis| axis.to_mm().to_string()).join(" ");
    let mut done = Vec::new();
    for line in program.lines() {
        let understood = reader.read(line.as_bytes()).unwrap_or_else(|fault| panic!("{line}: {fault:?}"));
        let single = understood.step.motion.map(SeriesAction::Move);
        let dwell = understood.step.dwell.map(SeriesAction::Dwell);
        for act in
            single.into_iter().chain(dwell).chain(understood.step.series.iter().flat_map(|series| series.actions()))
        {
            done.push(match act {
                SeriesAction::Move(motion) => {
                    let kind = match motion.kind {
                        MotionKind::Rapid => 'r',
                        MotionKind::Line => 'f',
                        MotionKind::Arc(_) => 'a',
                    };
                    format!("{kind} {}", show(&motion.end))
                }
                SeriesAction::Dwell(span) => format!("d {}", span.to_s()),
                SeriesAction::Spindle(_) => "s".to_owned(),
            });
        }
    }
    done
}

#[track_caller]
pub fn assert_does(program: &str, wanted: &[&str]) {
    assert_eq!(run(&mut reader(|_, _| ()), program), wanted, "{program}");
}

pub const START: &str = "G0X0Y0Z50.\nF100.\n";

fn assert_drills(cycle: &str, wanted: &[&str]) {
    let wanted: Vec<&str> = ["r 0 0 50"].iter().chain(wanted).copied().collect();
    assert_does(&format!("{START}{cycle}"), &wanted);
}

#[test]
fn a_cycle_repeats_up_to_9999_times() {
    let mut reader = reader(|_, _| ());
    assert!(reader.read(b"G91G81X1.Z-1.R-1.F9.K9999").is_ok());
    let fault = reader.read(b"X1.K10000").expect_err("five digits");
    assert_eq!((fault.cause, fault.column), (Cause::Alarm(Alarm::TooManyDigits), 4));
}

#[test]
fn a_drilled_hole_ends_at_the_initial_level_or_at_r() {
    assert_drills("G98G81X10.Y5.R2.Z-8.", &["r 10 5 50", "r 10 5 2", "f 10 5 -8", "r 10 5 50"]);
    assert_drills(
        "G99G81X10.Y5.R2.Z-8.\nX20.",
        &["r 10 5 50", "r 10 5 2", "f 10 5 -8", "r 10 5 2", "r 20 5 2", "f 20 5 -8", "r 20 5 2"],
    );
    // Back to the level from before the first of them, not before this one.
    assert_drills(
        "G99G81X10.R2.Z-8.\nG98X20.",
        &["r 10 0 50", "r 10 0 2", "f 10 0 -8", "r 10 0 2", "r 20 0 2", "f 20 0 -8", "r 20 0 50"],
    );
}

#[test]
fn dwells_spindle_and_slow_retreats_stand_where_the_manual_draws_them() {
    assert_drills("G82X1.R2.Z-3.P500", &["r 1 0 50", "r 1 0 2", "f 1 0 -3", "d 0.5", "r 1 0 50"]);
    assert_drills(
        "G84X1.R2.Z-3.P500",
        &["r 1 0 50", "r 1 0 2", "f 1 0 -3", "d 0.5", "s", "f 1 0 2", "d 0.5", "s", "r 1 0 50"],
    );
    assert_drills("G85X1.R2.Z-3.", &["r 1 0 50", "r 1 0 2", "f 1 0 -3", "f 1 0 2", "r 1 0 50"]);
    assert_drills("G86X1.R2.Z-3.", &["r 1 0 50", "r 1 0 2", "f 1 0 -3", "s", "r 1 0 50", "s"]);
    assert_drills("G89X1.R2.Z-3.P250", &["r 1 0 50", "r 1 0 2", "f 1 0 -3", "d 0.25", "f 1 0 2", "r 1 0 50"]);
    assert_drills(
        "G76X1.R2.Z-3.Q0.5",
        &["r 1 0 50", "r 1 0 2", "f 1 0 -3", "s", "r 1.5 0 -3", "r 1.5 0 50", "r 1 0 50", "s"],
    );
    assert_drills(
        "G87X1.R-9.Z-3.Q0.5",
        &[
            "r 1 0 50",
            "s",
            "r 1.5 0 50",
            "r 1.5 0 -9",
            "r 1 0 -9",
            "s",
            "f 1 0 -3",
            "s",
            "r 1.5 0 -3",
            "r 1.5 0 50",
            "r 1 0 50",
            "s",
        ],
    );
}

#[test]
fn pecks_go_back_by_their_parameter_and_the_last_cut_is_what_is_left() {
    // Depth 10 below R in cuts of 4: 4, 4 and 2.
    assert_drills(
        "G83R2.Z-8.Q4.",
        &["r 0 0 2", "f 0 0 -2", "r 0 0 2", "r 0 0 -1", "f 0 0 -6", "r 0 0 2", "r 0 0 -5", "f 0 0 -8", "r 0 0 50"],
    );
    assert_drills(
        "G73R2.Z-8.Q4.",
        &["r 0 0 2", "f 0 0 -2", "r 0 0 -1", "f 0 0 -6", "r 0 0 -5", "f 0 0 -8", "r 0 0 50"],
    );
}

#[test]
fn every_depth_is_reached_in_as_many_cuts_as_division_says() {
    for depth_um in [1, 999, 1_000, 1_001, 7_777, 40_000] {
        let cuts = run(&mut reader(|_, _| ()), &format!("{START}G83R0.Z-{:.3}Q1.", f64::from(depth_um) / 1000.0));
        let feeds = cuts.iter().filter(|act| act.starts_with('f')).count();
        assert_eq!(feeds, (depth_um as usize).div_ceil(1_000), "{depth_um}");
    }
}

#[test]
fn incremental_holes_step_and_k_repeats_them() {
    assert_does(
        "G91G0Z50.\nF100.\nG99G81X10.R-48.Z-10.K3\nG80X1.",
        &[
            "r 0 0 50",
            "r 10 0 50",
            "r 10 0 2",
            "f 10 0 -8",
            "r 10 0 2",
            "r 20 0 2",
            "f 20 0 -8",
            "r 20 0 2",
            "r 30 0 2",
            "f 30 0 -8",
            "r 30 0 2",
            "r 31 0 2",
        ],
    );
    // K0 only stores; a block without axis words drills nothing; a G code of the moves ends the cycle.
    assert_drills("G81R2.Z-8.K0\nM8\nX10.\nG1X11.", &["r 10 0 50", "r 10 0 2", "f 10 0 -8", "r 10 0 50", "f 11 0 50"]);
}

#[test]
fn in_other_planes_the_normal_is_drilled() {
    assert_does("G18G0X1.Y50.Z2.\nG81R3.Y-4.F100.", &["r 1 50 2", "r 1 3 2", "f 1 -4 2", "r 1 50 2"]);
    assert_does("G19G0X50.\nG81R3.X-4.Y7.F100.", &["r 50 0 0", "r 50 7 0", "r 3 7 0", "f -4 7 0", "r 50 7 0"]);
}

/// Points that a program drills, mm.
pub fn holes(program: &str) -> Vec<[f64; 2]> {
    let acts = run(&mut reader(|_, _| ()), program);
    let point = |act: &String| {
        let numbers: Vec<f64> = act.split(' ').skip(1).map(|number| number.parse().expect("a number")).collect();
        [numbers[0], numbers[1]]
    };
    acts.iter().filter(|act| act.starts_with('f')).map(point).collect()
}

#[test]
fn both_conventions_of_numbers_without_a_point() {
    let least = "G21G0X1500Y-25Z+007\nG4P250\nG4X1.5";
    assert_eq!(run(&mut reader(|_, _| ()), least), ["r 1.5 -0.025 0.007", "d 0.25", "d 1.5"]);
    let mut calculator = reader(|settings, _| settings.decimals = Decimals::Calculator);
    assert_eq!(run(&mut calculator, least), ["r 1500 -25 7", "d 0.25", "d 1.5"]);
    assert_eq!(run(&mut reader(|_, _| ()), "G20G0X10000Y.5"), ["r 25.4 12.7 0"]);
}

#[test]
fn a_block_delete_switch_skips_what_stands_behind_its_slash() {
    let program = "/G0X1.\n/2G0X2.\nN5G0X3./Y3.";
    assert_eq!(run(&mut reader(|_, _| ()), program), ["r 1 0 0", "r 2 0 0", "r 3 3 0"]);
    let mut first = reader(|settings, _| settings.delete_switches = 1 << 1);
    assert_eq!(run(&mut first, program), ["r 2 0 0", "r 3 0 0"]);
    let mut second = reader(|settings, _| settings.delete_switches = 1 << 2);
    assert_eq!(run(&mut second, program), ["r 1 0 0", "r 3 3 0"]);
}

#[test]
fn a_feed_per_revolution_counts_with_the_spindle() {
    let mut reader = reader(|_, _| ());
    let feed = |reader: &mut Reader, line: &str| reader.read(line.as_bytes()).expect(line).segment.expect(line).feed;
    use arcfeed_nc::modal::Feed;
    assert_eq!(feed(&mut reader, "G95G1X1.S2000F0.15"), Feed::PerMinute(Nm::from_mm(300.0)));
    assert_eq!(feed(&mut reader, "X2.S1000"), Feed::PerMinute(Nm::from_mm(150.0)));
    assert_eq!(feed(&mut reader, "G94X3."), Feed::Missing);
    assert_eq!(reader.read(b"G4P1").expect("a dwell").step.dwell, Some(Micros::from_ms(1)));
}

#[test]
fn who_makes_plain_moves_only_refuses_the_rest_by_name_and_loses_nothing() {
    for (program, named) in [
        ("G81X1.Z-1.R1.F100.", "G81"),
        ("G28X0", "G28"),
        ("G53X5.", "G53"),
        ("G92X5.\nX6.", "a move under G92"),
        ("G52X5.\nX6.", "a move under G52"),
        ("G68X0Y0R30.\nX6.Y0", "a move under G68"),
        ("G41D1\nX6.", "a move under G41"),
        ("G43.4H1\nX6.", "a move under G43.4"),
        ("G95S100F1.\nG1X6.", "a move under G95"),
    ] {
        let mut plain = Reader::new(LengthUnit::Mm, Reading::Lenient);
        let faults: Vec<_> = program.lines().filter_map(|line| plain.read(line.as_bytes()).err()).collect();
        assert_eq!(faults.len(), 1, "{program}: {faults:?}");
        assert!(faults[0].cause.to_string().starts_with(&format!("{named} is not")), "{}", faults[0].cause);
    }
}
