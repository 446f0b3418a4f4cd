use super::*;
use arcfeed_model::cut::{ContourSide, CutRule, Moves, RULES_MAX, Work};
use arcfeed_model::job::{LawKind, OverrideLimits, ToolSetup, Tools};
use arcfeed_model::knots::Knots;
use arcfeed_model::machine::MachineLimits;
use arcfeed_model::tool::{EndMill, Tool};
use arcfeed_nc::modal::Turn;
use arcfeed_nc::tape_code::TapeCode;
use arcfeed_units::{LengthUnit, MmPerTooth, Nm, RevPerMin};

type Small = Tap<400>;

fn job() -> Job {
    let rule = CutRule {
        tool: 0,
        moves: Moves::Arcs(Turn::Ccw),
        work: Work::Mill { side: ContourSide::Inside, radial_depth: Nm(1_000_000) },
        feed_per_tooth: None,
        table: None,
        sequence: None,
        level: None,
    };
    Job {
        unit: LengthUnit::Mm,
        tools: Tools::one(ToolSetup::new(
            Tool::EndMill(EndMill { radius: Nm(2_000_000), teeth: 2 }),
            RevPerMin(1_000.0),
            LawKind::Contour { inside_only: false, floor_ratio: 0.1 },
            MmPerTooth(0.05),
        )),
        ceiling: Default::default(),
        policy: FeedPolicy::OverrideOnly,
        limits: OverrideLimits::default(),
        machine: MachineLimits::default(),
        rules: heapless::Vec::<CutRule, RULES_MAX>::from_iter([rule]),
        knots: Knots::new(),
    }
}

fn pose(x: i64, y: i64, z: i64) -> Pose {
    Pose { linear: [x, y, z].map(|mm| Nm(mm * 1_000_000)), ..Pose::ORIGIN }
}

/// A tap that has seen the axes at rest at the origin.
fn tap() -> Small {
    let mut tap = Small::new(TapSettings { code: Some(TapeCode::Ascii), ..TapSettings::new(LengthUnit::Mm) }).unwrap();
    stand(&mut tap, pose(0, 0, 0));
    tap
}

fn stand(tap: &mut Small, at: Pose) {
    for _ in 0..20 {
        tap.follow(None, 0, &at);
    }
}

fn hear(tap: &mut Small, text: &str) {
    for byte in text.bytes() {
        assert_eq!(tap.from_sender(Micros(0), byte), byte);
    }
}

/// Counts of the segments that are handed out now.
fn handed(tap: &mut Small) -> std::vec::Vec<u32> {
    let job = job();
    std::iter::from_fn(|| tap.next(&job)).map(|handed| handed.count).collect()
}

#[test]
fn each_character_is_passed_on_as_it_is() {
    let mut tap = tap();
    for byte in (0..=u8::MAX).chain((0..=u8::MAX).rev()) {
        assert_eq!((tap.from_sender(Micros(0), byte), tap.from_control(Micros(0), byte)), (byte, byte));
    }
    assert_eq!((tap.counters().from_sender, tap.counters().from_control), (512, 512));
}

#[test]
fn moves_are_handed_out_in_order_and_the_rules_are_found() {
    let mut tap = tap();
    hear(&mut tap, "%\nS1000M3\nG0X1.\nG1X2.F100.\nG3X4.I1.\nM30\n%\n");
    assert_eq!(handed(&mut tap), [0, 1, 2]);
    assert_eq!((tap.counters().segments, tap.counters().governed), (3, 1));
    assert_eq!(tap.state(), TapState::Listening);
}

#[test]
fn another_tool_a_stopped_spindle_and_a_helix_are_handed_out_without_a_rule() {
    for program in ["G3X2.I1.", "S1000M3\nT2M6\nS900M3\nG3X2.I1.", "S1000M3\nM5\nG3X2.I1.", "S1000M3\nG3X2.Z1.I1."] {
        let mut tap = tap();
        hear(&mut tap, &format!("%\nF100.\n{program}\nM30\n%\n"));
        assert_eq!((handed(&mut tap).len(), tap.counters().governed), (1, 0), "{program}");
    }
}

#[test]
fn no_more_are_handed_out_than_can_be_watched() {
    let mut tap = tap();
    hear(&mut tap, "%\n");
    for x in 1..=20 {
        hear(&mut tap, &format!("G1X{x}.F1.\n"));
    }
    assert_eq!(handed(&mut tap).len(), AHEAD_MAX);
    tap.follow(Some(3), 3, &pose(3, 0, 0));
    assert_eq!(handed(&mut tap), [16, 17, 18]);
}

#[test]
fn axes_that_leave_the_path_end_it_until_the_next_program() {
    let mut tap = tap();
    hear(&mut tap, "%\nG1X10.F100.\nX20.\n");
    assert_eq!(handed(&mut tap).len(), 2);
    tap.follow(Some(0), 0, &pose(5, 0, 0));
    for _ in 0..4 {
        tap.follow(Some(0), 0, &pose(5, 1, 0));
    }
    assert_eq!(tap.state(), TapState::InStep);
    tap.follow(Some(0), 0, &pose(5, 1, 0));
    assert_eq!(
        (tap.state(), tap.must_clear(), tap.must_clear()),
        (TapState::Lost(TapLossReason::OffPath), true, false)
    );
    assert!(handed(&mut tap).is_empty());
    hear(&mut tap, "X30.\n");
    assert!(handed(&mut tap).is_empty());
    assert_eq!(tap.counters().passed_over, 1);
    stand(&mut tap, pose(0, 0, 0));
    hear(&mut tap, "%\nG1X1.F1.\n");
    assert_eq!((handed(&mut tap), tap.state()), (vec![2], TapState::InStep));
    assert_eq!(tap.counters().restarts, 0);
}

#[test]
fn a_place_off_the_path_now_and_then_is_noise() {
    let mut tap = tap();
    hear(&mut tap, "%\nG1X10.F100.\n");
    handed(&mut tap);
    for _ in 0..100 {
        tap.follow(Some(0), 0, &pose(5, 3, 0));
        tap.follow(Some(0), 0, &pose(5, 0, 0));
    }
    assert_eq!(tap.state(), TapState::InStep);
}

#[test]
fn what_stands_before_a_damaged_block_is_still_done() {
    let mut tap = tap();
    hear(&mut tap, "%\nG1X10.F100.\n");
    tap.on_line_error();
    hear(&mut tap, "X20.\nX30.\n");
    assert_eq!(handed(&mut tap), [0]);
    assert_eq!(tap.state(), TapState::Lost(TapLossReason::Damaged));
}

#[test]
fn each_way_of_getting_lost_is_named() {
    let long = format!("{}\n", "X1.".repeat(100));
    let many = "Y1.\n".repeat(200);
    for (text, wanted) in [
        (long.as_str(), TapLossReason::LongBlock),
        (many.as_str(), TapLossReason::TooFarAhead),
        ("#3004=2\n", TapLossReason::OutOfSight),
    ] {
        let mut tap = tap();
        hear(&mut tap, &format!("%\nG1F1.\n{text}"));
        for count in 0..400 {
            handed(&mut tap);
            tap.follow(Some(count), count, &pose(0, 1, 0));
        }
        assert_eq!(tap.state(), TapState::Lost(wanted));
    }
    let mut tap = tap();
    hear(&mut tap, "%\nM98P1\n");
    handed(&mut tap);
    assert!(matches!(tap.state(), TapState::Lost(TapLossReason::NotUnderstood(_))));
}

#[test]
fn behind_a_hole_it_goes_on_when_the_tool_is_out_of_it() {
    let mut tap = tap();
    hear(&mut tap, "%\nG0Z10.\nG81X5.Z-3.R2.F100.\nG80\nG1X9.F1.\n");
    assert_eq!((handed(&mut tap), tap.state()), (vec![0], TapState::Passing));
    // The rapid before it has to be done first: its end is also where the hole's way begins.
    for position in [pose(0, 0, 5), pose(5, 0, -3), pose(5, 0, 10)] {
        tap.follow(Some(0), 0, &position);
        assert!(handed(&mut tap).is_empty());
    }
    for position in [pose(0, 0, 10), pose(5, 0, 10), pose(5, 0, -3)] {
        tap.follow(Some(1), 1, &position);
        assert!(handed(&mut tap).is_empty());
    }
    tap.follow(Some(1), 1, &pose(5, 0, 10));
    assert_eq!((handed(&mut tap), tap.state()), (vec![1], TapState::InStep));
}

#[test]
fn a_program_that_begins_while_another_is_on_clears_the_queue() {
    let mut tap = tap();
    hear(&mut tap, "%\nG1X10.F100.\nX20.\nM30\n%\n");
    assert_eq!(handed(&mut tap), [0, 1]);
    hear(&mut tap, "%\n");
    assert!(handed(&mut tap).is_empty(), "a mark alone is no program");
    hear(&mut tap, "G1X10.F100.\n");
    assert_eq!((tap.must_clear(), handed(&mut tap)), (true, vec![2]));
    assert_eq!((tap.counters().programs, tap.counters().restarts), (2, 1));
}

#[test]
fn silence_or_dc1_tells_the_next_label_from_the_mark_behind_a_program() {
    for (dc1, begins_at, programs) in [(false, 1, 1), (false, 3_000, 2), (true, 1, 2)] {
        let mut tap = tap();
        hear(&mut tap, "%\nG1X10.F100.\nM30\n");
        if dc1 {
            tap.from_control(Micros(0), DC1);
        }
        for byte in "%\nG1X10.F100.\n".bytes() {
            tap.from_sender(Micros::from_ms(begins_at), byte);
        }
        assert_eq!(tap.counters().programs, programs, "{dc1} {begins_at}");
    }
}

#[test]
fn a_program_that_begins_on_the_move_is_followed_from_the_first_place_it_gives() {
    let mut tap = tap();
    tap.follow(Some(0), 0, &pose(1, 1, 1));
    hear(&mut tap, "%\nG1X10.F100.\nY10.\nZ10.\nX20.\n");
    assert!(handed(&mut tap).is_empty());
    assert_eq!(tap.state(), TapState::Passing);
    tap.follow(Some(0), 0, &pose(1, 1, 1));
    tap.follow(Some(0), 0, &pose(5, 5, 5));
    tap.follow(Some(0), 0, &pose(10, 10, 10));
    assert_eq!((handed(&mut tap), tap.state()), (vec![0], TapState::InStep));
}

#[test]
fn settings_that_make_no_sense_are_refused() {
    let settings = TapSettings::new(LengthUnit::Mm);
    for (settings, error) in [
        (TapSettings { off_path: Nm(0), ..settings }, TapSettingsError::OffPath(Nm(0))),
        (TapSettings { off_path_count: 0, ..settings }, TapSettingsError::OffPathCount(0)),
        (TapSettings { off_path_count: 255, ..settings }, TapSettingsError::OffPathCount(255)),
    ] {
        assert_eq!(Small::new(settings).err(), Some(error));
    }
}

#[test]
fn without_an_override_no_rule_counts() {
    let mut tap = tap();
    hear(&mut tap, "%\nG3X4.I2.F100.\n");
    let job = Job { policy: FeedPolicy::RewriteOnly(arcfeed_model::job::PieceSettings::default()), ..job() };
    assert!(tap.next(&job).is_some());
    assert_eq!(tap.counters().governed, 0);
}

#[test]
fn with_nothing_in_work_those_executed_since_are_done() {
    let mut tap = tap();
    tap.follow(None, 7, &pose(0, 0, 0));
    hear(&mut tap, "%\nG1X1.F1.\nX2.\nG81X5.Z-3.R2.F100.\nG1X9.\n");
    assert_eq!(handed(&mut tap), [0, 1]);
    // The tick has not seen them yet.
    tap.follow(None, 7, &pose(0, 0, 0));
    tap.follow(Some(0), 7, &pose(0, 0, 0));
    for position in [pose(5, 0, -3), pose(5, 0, 0)] {
        tap.follow(Some(1), 8, &position);
    }
    assert_eq!(tap.state(), TapState::Passing);
    for position in [pose(2, 0, 0), pose(5, 0, -3), pose(5, 0, 0)] {
        tap.follow(None, 9, &position);
    }
    assert_eq!(tap.state(), TapState::InStep);
}
