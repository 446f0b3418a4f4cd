use arcfeed_nc::block::Reading;
use arcfeed_nc::settings::{Preset, Settings, Tables};

use super::*;

const WIRE: Wire = Wire { encode: Some, filters: false, tv_check: false };

fn with_reports(text: &str, every: usize) -> (Transmission, Reports) {
    let source = |at: usize| 1 + text.as_bytes()[..at].iter().filter(|byte| **byte == b'\n').count();
    let sent = Transmission::new(text.as_bytes(), source, &WIRE).unwrap();
    let settings = Settings::preset(Preset::Fanuc16i, LengthUnit::Mm, Reading::Lenient);
    Reports::insert_into(&sent, every, &PowerOn { settings, tables: Tables::default() }, &WIRE).unwrap()
}

fn two() -> (Transmission, Reports) {
    with_reports("%\nO1\nG21G90G0X12.5Z5.\nG1Z-1.F1000.\nG91Y-2.5\nM30\n%\n", 2)
}

#[test]
fn reports_stand_behind_every_so_many_blocks_and_before_the_end() {
    let (sent, reports) = two();
    let text = String::from_utf8(sent.text().to_vec()).unwrap();
    let report = |line| format!("POPEN\nDPRNT[ARCFEED*L{line}X#5001[53]Y#5002[53]Z#5003[53]F#4109[53]]\nPCLOS\n");
    let wanted = format!("%\nO1\nG21G90G0X12.5Z5.\n{}G1Z-1.F1000.\nG91Y-2.5\n{}M30\n%\n", report(3), report(5));
    assert_eq!((text, reports.counts()), (wanted, (2, 0)));
    let sources: Vec<usize> = sent.lines().iter().map(|line| line.source).collect();
    assert_eq!(sources, [1, 2, 3, 3, 3, 3, 4, 5, 5, 5, 5, 6, 7]);
    let (inches, _) = with_reports("%\nG20G1X1.F10.\nM2\n", 1);
    assert!(String::from_utf8_lossy(inches.text()).contains("L2X#5001[44]Y#5002[44]Z#5003[44]F#4109[53]]"));
}

#[test]
fn what_the_program_says_is_confirmed_however_the_control_pads_it() {
    let (sent, mut reports) = two();
    assert_eq!((reports.awaited(), reports.taken_up(&sent, 1)), (Some(3), None));
    assert_eq!(reports.read_printed(b"\x12ARCFEED L3X   12.500Y    0.000Z    5.000F    0.000\n\x14"), []);
    // O1, the move, POPEN and DPRNT are read; whether the last two have been started is unknown.
    assert_eq!((reports.read_up_to(), reports.taken_up(&sent, 2)), (Some(3), Some(2)));
    assert_eq!(reports.read_printed(b"ARCFEED L5X12.5Y-2.5Z-1.F10"), []);
    assert_eq!(reports.read_printed(b"00.\r\n"), []);
    assert_eq!((reports.counts(), reports.awaited()), ((2, 2), None));
}

#[test]
fn another_place_or_feed_is_another_program() {
    for corrupted in [
        "ARCFEED L3X12.6Y0Z5.F0",
        "ARCFEED L3X12.5Y-.01Z5.F0",
        "ARCFEED L3X12.5Y0Z5.002F0",
        "ARCFEED L3X12.5Y0Z5.F1",
        "ARCFEED L4X12.5Y0Z5.F0",
    ] {
        let remarks = two().1.read_printed(format!("{corrupted}\n").as_bytes());
        assert!(matches!(remarks.as_slice(), [ReportFinding::Differs(_)]), "{corrupted}: {remarks:?}");
    }
}

#[test]
fn a_report_that_is_missing_or_corrupted_is_reported_and_other_text_is_kept() {
    let (_, mut reports) = two();
    let remarks = reports.read_printed(b"PART 7\nARCFEED L3X12.5Y0Z5,F0\n");
    assert!(matches!(remarks.as_slice(), [ReportFinding::Doubtful(_)]), "{remarks:?}");
    let remarks = reports.read_printed(b"ARCFEED L5X12.5Y-2.5Z-1.F1000.\nEN");
    assert!(
        matches!(remarks.as_slice(), [ReportFinding::Doubtful(what)] if what.contains("no report of line 3")),
        "{remarks:?}"
    );
    assert_eq!(reports.printed(), b"PART 7\nEN");
    assert_eq!(Reports::default().read_printed(b"ARCFEED L3\n"), [], "no report was requested");
}

#[test]
fn there_is_none_where_the_control_stands_elsewhere_than_the_program_says() {
    for (text, wanted) in [
        ("%\nG41D1G1X1.F9.\nX2.\nG40X3.\nM30\n%\n", vec![4]),
        ("%\nG81X1.Z-1.R1.F9.\nX2.\nG80\nM30\n%\n", vec![4]),
        ("%\nG68X0Y0R30.\nG0X1.Y1.\nG69\nG0X0Y0\nM30\n%\n", vec![4, 5]),
    ] {
        let lines: Vec<usize> = with_reports(text, 1).1.expected.iter().map(|expected| expected.line).collect();
        assert_eq!(lines, wanted, "{text}");
    }
}

#[test]
fn a_restart_expects_the_rest() {
    let (sent, reports) = two();
    // From G1Z-1. on, which is now the line with index 6, behind two lines of ours.
    let mut rest = reports.resumed(6, 2);
    assert_eq!((rest.counts(), rest.awaited()), ((1, 0), Some(5)));
    let resumed = sent.resumed("%\nG90\n", 6, &WIRE).unwrap();
    assert_eq!(rest.read_printed(b"ARCFEED L5X12.5Y-2.5Z-1.F1000.\n"), []);
    assert_eq!(resumed.line_text(rest.last.unwrap().1).map(|line| &line[..10]), Some(b"DPRNT[ARCF".as_slice()));
}
