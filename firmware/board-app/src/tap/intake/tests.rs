use super::*;

fn texts<const N: usize>(intake: &mut Intake<N>) -> std::vec::Vec<String> {
    let mut line = Vec::new();
    let mut found = std::vec::Vec::new();
    while let Some(fits) = intake.next_block(&mut line) {
        assert!(fits);
        found.push(String::from_utf8(line.to_vec()).unwrap());
    }
    found
}

/// Pushes a text; returns the number of programs that start in it.
fn hear<const N: usize>(intake: &mut Intake<N>, code: TapeCode, text: &str) -> usize {
    text.bytes().filter(|byte| intake.push(code.encode(*byte).unwrap())).count()
}

fn blocks_of(set: Option<TapeCode>, code: TapeCode, text: &str) -> std::vec::Vec<String> {
    let mut intake = Intake::<1_000>::new(set);
    hear(&mut intake, code, text);
    texts(&mut intake)
}

const DAMAGE: &str = "\u{2}";
const GAP: &str = "\u{3}";

#[test]
fn a_program_is_the_same_in_each_code_without_comments_and_blanks() {
    let text = "%\nO1 (A (50% B)\nN10 G1\tX-1.5 (C)F100\n\n(D)\n/2M8\nM30\n%\n";
    for (set, code) in [(None, TapeCode::Iso), (None, TapeCode::Eia), (Some(TapeCode::Ascii), TapeCode::Ascii)] {
        assert_eq!(blocks_of(set, code, text), ["O1", "N10G1X-1.5F100", "/2M8", "M30"], "{code:?}");
    }
}

#[test]
fn carriage_returns_leaders_deletes_and_flow_control_mean_nothing() {
    let text = "\0\0\r%\r\n\x11\0G1\x7fX1.\x13\n\r\rY2.\r\n";
    assert_eq!(blocks_of(None, TapeCode::Iso, text), ["G1X1.", "Y2."]);
}

#[test]
fn without_a_mark_in_the_label_no_program_begins() {
    assert!(blocks_of(None, TapeCode::Iso, "G0X1.\nG1X2.\n(50%\n").is_empty());
    assert_eq!(blocks_of(None, TapeCode::Iso, "X1.\n%\nG1X2.\n"), ["G1X2."]);
    // A further mark before the first block is part of the label.
    assert_eq!(blocks_of(None, TapeCode::Iso, "%LEADER\n%\nG1X2.\n"), ["G1X2."]);
}

#[test]
fn behind_the_end_the_next_program_needs_its_label_and_may_be_in_the_other_code() {
    for end in ["M30", "M2", "N9M02", "G0X1.M30(END)", "M8M30"] {
        let mut intake = Intake::<1_000>::new(None);
        assert_eq!(hear(&mut intake, TapeCode::Iso, &format!("%\nG0X1.\n{end}\n\r\n%\n")), 1);
        assert_eq!(texts(&mut intake).len(), 2, "{end}");
        assert_eq!(hear(&mut intake, TapeCode::Iso, "G1\nG2\n"), 0, "its own mark is no label");
        assert!(texts(&mut intake).is_empty(), "{end}");
        assert_eq!(hear(&mut intake, TapeCode::Eia, "%\nG1X3.\n"), 1);
        assert_eq!(texts(&mut intake), ["G1X3."], "{end}");
    }
    assert_eq!(blocks_of(None, TapeCode::Iso, "%\nM3\nM20\nM300\nX1.\n").len(), 4);
}

#[test]
fn a_mark_behind_a_program_is_a_label_once_the_control_has_asked() {
    let mut intake = Intake::<1_000>::new(None);
    assert_eq!(hear(&mut intake, TapeCode::Iso, "%\nG0X1.\nM30\n"), 1);
    intake.separate();
    assert_eq!(hear(&mut intake, TapeCode::Iso, "%\nG1X3.\n"), 1);
    assert_eq!(texts(&mut intake), ["G1X3."]);
}

#[test]
fn a_label_in_the_middle_of_a_program_forgets_what_was_before() {
    let mut intake = Intake::<1_000>::new(None);
    assert_eq!(hear(&mut intake, TapeCode::Iso, "%\nG0X1.\nG1X2.\nX3"), 1);
    // The block that was cut off and the label behind it are one line for who listens.
    assert_eq!(hear(&mut intake, TapeCode::Iso, "\n%\nG0Y1.\n"), 1);
    assert_eq!(texts(&mut intake), ["G0Y1."]);
}

#[test]
fn percent_sign_after_a_truncated_block_is_a_label_and_in_a_comment_only_after_a_reset() {
    for (cut_off, is_reset, programs) in
        [("G1X2.", false, 1), ("G1X2.", true, 1), ("(ROUGHI", false, 0), ("(ROUGHI", true, 1), ("(NOTE)", false, 1)]
    {
        let mut intake = Intake::<1_000>::new(None);
        assert_eq!(hear(&mut intake, TapeCode::Iso, &format!("%\nG0X1.\n{cut_off}")), 1);
        if is_reset {
            intake.expect_label();
        }
        assert_eq!(hear(&mut intake, TapeCode::Iso, "%\nG0Y1.\nY2.\n"), programs, "{cut_off} {is_reset}");
        if programs > 0 {
            assert_eq!(texts(&mut intake), ["G0Y1.", "Y2."], "{cut_off}");
        }
    }
}

#[test]
fn a_wrong_hole_marks_its_block_and_no_other() {
    for code in [TapeCode::Iso, TapeCode::Eia] {
        let sound: std::vec::Vec<u8> =
            b"%\nG1X1.\nY25.\nZ3.\n".iter().map(|byte| code.encode(*byte).unwrap()).collect();
        for at in 8..12 {
            for hole in 0..8 {
                let mut intake = Intake::<1_000>::new(Some(code));
                for (index, frame) in sound.iter().enumerate() {
                    intake.push(if index == at { frame ^ 1 << hole } else { *frame });
                }
                assert_eq!(texts(&mut intake), ["G1X1.", DAMAGE, "Z3."], "{code:?} {at} {hole}");
            }
        }
    }
}

#[test]
fn a_character_lost_in_the_receiver_marks_the_block_it_is_in() {
    let mut intake = Intake::<1_000>::new(None);
    hear(&mut intake, TapeCode::Iso, "%\nG1X1.\nY2");
    intake.mark_damaged();
    hear(&mut intake, TapeCode::Iso, ".\nZ3.\n");
    assert_eq!(texts(&mut intake), ["G1X1.", DAMAGE, "Z3."]);
}

#[test]
fn overflow_of_the_buffer_is_reported_once_and_ends_the_program() {
    for room_taken in 1..40 {
        let mut intake = Intake::<40>::new(None);
        let filler = "X".repeat(room_taken);
        hear(&mut intake, TapeCode::Iso, &format!("%\nG1X1.\n{filler}\n"));
        for _ in 0..20 {
            hear(&mut intake, TapeCode::Iso, "Y1.\n");
        }
        let found = texts(&mut intake);
        assert_eq!(found.last().map(String::as_str), Some(GAP), "{found:?}");
        assert_eq!(found.iter().filter(|text| *text == GAP).count(), 1);
        hear(&mut intake, TapeCode::Iso, "Y2.\nY3.\n");
        assert!(texts(&mut intake).is_empty());
        assert_eq!(hear(&mut intake, TapeCode::Iso, "%\nG0Z1.\n"), 1);
        assert_eq!(texts(&mut intake), ["G0Z1."]);
    }
}

#[test]
fn a_block_longer_than_a_line_is_said_not_to_fit() {
    let mut intake = Intake::<1_000>::new(None);
    hear(&mut intake, TapeCode::Iso, &format!("%\n{}\nG1\n", "X1".repeat(LINE_MAX)));
    let mut line = Vec::new();
    assert_eq!(intake.next_block(&mut line), Some(false));
    assert_eq!((intake.next_block(&mut line), line.as_slice()), (Some(true), b"G1".as_slice()));
}
