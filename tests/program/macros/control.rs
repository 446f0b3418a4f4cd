//! Macro statements in the control: over its DNC line with subprograms in memory, and what they switch there.

use std::collections::BTreeMap;

use arcfeed_control::search::Search;
use arcfeed_control::settings::Switches;
use arcfeed_control::{Control, ControlSettings};
use arcfeed_nc::modal::Pose;
use arcfeed_units::{LengthUnit, Micros};

const STEP: Micros = Micros::from_ms(1);

/// A control and its clock.
struct Bench {
    control: Control,
    now: Micros,
    said: Vec<u8>,
}

impl Bench {
    fn of(control: Control) -> Self {
        Bench { control, now: Micros(0), said: Vec::new() }
    }

    fn on_line(program: &str, library: &[(u32, &str)]) -> Self {
        let library: BTreeMap<u32, Vec<u8>> =
            library.iter().map(|(number, text)| (*number, text.as_bytes().into())).collect();
        let control = Control::on_line(ControlSettings::fanuc_16i(LengthUnit::Mm)).with_library(Box::new(library));
        let mut bench = Bench::of(control);
        bench.control.port().on_bytes(program.as_bytes());
        bench
    }

    fn from_memory(program: &str, switches: Switches) -> Self {
        let settings =
            ControlSettings { switches, operator_restart: None, ..ControlSettings::fanuc_16i(LengthUnit::Mm) };
        Bench::of(Control::from_memory(settings, program.as_bytes()))
    }

    fn step(&mut self) {
        self.now = self.now.after(STEP);
        self.control.step(self.now, STEP, 50);
        self.said.extend(std::iter::from_fn(|| self.control.port().poll_transmit()));
    }

    /// Until something holds; answers whether it ever does.
    fn until(&mut self, holds: impl Fn(&Control) -> bool) -> bool {
        for _ in 0..100_000 {
            if holds(&self.control) {
                return true;
            }
            self.step();
        }
        false
    }

    fn end(&mut self) -> [f64; 3] {
        assert!(self.until(|control| control.is_over() && control.is_at_rest() && !control.is_punching()));
        self.step();
        self.control.position().linear.map(|axis| axis.to_mm())
    }

    fn executed(&self) -> Vec<&str> {
        self.control.executed().iter().map(|text| std::str::from_utf8(text).expect("ASCII")).collect()
    }
}

#[test]
fn over_the_line_statements_calls_and_plain_blocks_go_together() {
    let program = "%\n#100=3.\n#101=#100*2\nG0X#100\nIF[#101GT5]THEN#102=7.\nY#102\nM98P9001L2\nG65P9002A#102\nG66P9002A1.\nX0\nG67\nX1.\nM30\n%";
    let library =
        [(9001, "O9001\nG91Z1.\nG90\nM99\n"), (9002, "O9002\nWHILE[#1GT0]DO1\nG91Z-#1\nG90\n#1=0\nEND1\nM99\n")];
    let mut bench = Bench::on_line(program, &library);
    assert_eq!(bench.end(), [1.0, 7.0, 2.0 - 7.0 - 1.0]);
    assert_eq!(bench.control.alarm(), None);
    let wanted = [
        "#100=3.",
        "#101=#100*2",
        "G0X3.",
        "IF[#101GT5]THEN#102=7.",
        "Y7.",
        "M98P9001L2",
        "O9001",
        "G91Z1.",
        "G90",
        "O9001",
        "G91Z1.",
        "G90",
        "G65P9002A#102",
        "O9002",
        "G91Z-7.",
        "G90",
        "G66P9002A1.",
        "X0",
        "O9002",
        "G91Z-1.",
        "G90",
        "G67",
        "X1.",
        "M30",
    ];
    assert_eq!(bench.executed(), wanted);
}

#[test]
fn over_the_line_nothing_jumps_whatever_its_condition() {
    for text in ["GOTO1", "IF[1EQ2]GOTO1", "IF[1EQ1]THENGOTO1", "IF[1EQ2]THENGOTO1", "WHILE[1EQ2]DO1", "DO1", "N5 END1"]
    {
        let mut bench = Bench::on_line(&format!("%\nG0X1.\n{text}\nM30\n%"), &[]);
        assert_eq!(bench.end(), [1.0, 0.0, 0.0]);
        let alarm = bench.control.alarm().unwrap_or_else(|| panic!("{text}"));
        assert_eq!(alarm.line, 3, "{text}");
        assert!(alarm.fault.cause.to_string().starts_with("PS0123"), "{text}: {}", alarm.fault.cause);
    }
}

#[test]
fn a_program_that_is_not_in_memory_is_alarm_78_at_its_call() {
    let mut bench = Bench::on_line("%\nG0X1.\nM98P9003\nM30\n%", &[]);
    bench.end();
    let alarm = bench.control.alarm().expect("O9003 is not there");
    assert_eq!((alarm.line, alarm.fault.column), (3, 4));
    assert!(alarm.fault.cause.to_string().starts_with("PS0078"), "{}", alarm.fault.cause);
}

#[test]
fn printed_text_is_sent_between_dc2_and_dc4_before_the_line_ends() {
    let program = "%\nPOPEN\n#1=-12.5\nDPRNT[X#1[42]*A]\nG0X1.\nDPRNT[B]\nPCLOS\nM30\n%";
    let mut bench = Bench::on_line(program, &[]);
    bench.end();
    assert_eq!(bench.control.output(), b"\x12X-  12.50 A\nB\n\x14");
    // DC1 before it and DC3 behind the program are those of the reader.
    let text: Vec<u8> = bench.said.iter().copied().filter(|byte| !matches!(byte, 0x11 | 0x13)).collect();
    assert_eq!(text, b"\x12X-  12.50 A\nB\n\x14");
}

#[test]
fn a_reset_keeps_commons_from_500_and_offsets_and_the_library() {
    let mut bench =
        Bench::on_line("%\n#100=1.\n#500=2.\n#5221=10.\n#1=5.\nG10L12P1R3.\nM30\n%", &[(9001, "O9001\nY1.\nM99\n")]);
    bench.end();
    bench.control.reset();
    assert!(bench.until(Control::is_ready));
    bench.control.cycle_start();
    bench.step();
    bench.control.port().on_bytes(b"%\nG0X#500\nZ#100\nZ#1\nM98P9001\nZ#13001\nM30\n%");
    // G54 lies at X10: X2 of the program is X12 of the machine.
    assert_eq!(bench.end(), [12.0, 1.0, 3.0]);
    assert_eq!(bench.control.alarm(), None);
}

#[test]
fn a_restart_over_the_line_works_the_statements_before_it_out() {
    let mut bench = Bench::on_line("%\n#3004=2\nG1X1.F60\nN20X2.\nM30\n%", &[]);
    bench.control.search(Search::Restart(20));
    bench.end();
    assert_eq!(bench.control.override_percent(), 100);
    let mut bench = Bench::on_line("%\n#100=4.\nPOPEN\nDPRNT[A]\nPCLOS\nG1F1000X#100\nN20Y#100\nM30\n%", &[]);
    bench.control.search(Search::Restart(20));
    assert_eq!(bench.end(), [4.0, 4.0, 0.0]);
    assert_eq!(bench.control.output(), b"");
    let mut bench = Bench::on_line("%\n#100=4.\nG1F1000X#100\nN20G0Y#100\nX1.\nM30\n%", &[]);
    bench.control.search(Search::Sequence(20));
    assert_eq!(bench.end(), [1.0, 0.0, 0.0], "without #100 there is no Y");
}

#[test]
fn with_3003_single_block_stops_where_it_counts_again() {
    let program = "#3003=1\nG0X1.\nX2.\n#3003=0\nX3.\nX4.\nM30\n";
    let single = Switches { single_block: true, ..Switches::default() };
    let mut bench = Bench::from_memory(program, single);
    assert!(bench.until(|control| control.is_stopped() || control.is_over()));
    assert_eq!((bench.control.is_stopped(), bench.executed()), (true, vec!["G0X1.", "X2.", "X3."]));
}

#[test]
fn with_3004_feed_hold_waits_until_it_counts_again() {
    let program = "#3004=1\nG1X10.F3000\nX20.\n#3004=0\nX30.\nM30\n";
    let mut bench = Bench::from_memory(program, Switches::default());
    assert!(bench.until(|control| control.position() != Pose::ORIGIN));
    bench.control.hold();
    assert!(bench.until(Control::is_at_rest));
    let x = bench.control.position().linear[0].to_mm();
    assert!((20.0..30.0).contains(&x), "{x}");
}

#[test]
fn with_3004_the_override_is_100_percent_and_afterwards_that_of_the_input() {
    let program = "#3004=2\nG1X20.F1200\n#3004=0\nX40.\nM30\n";
    let mut bench = Bench::from_memory(program, Switches::default());
    let fastest = |bench: &mut Bench, x: f64| {
        let mut fastest = 0.0_f64;
        while bench.control.position().linear[0].to_mm() < x {
            bench.step();
            fastest = fastest.max(bench.control.speed_mm_per_s());
        }
        (fastest, bench.control.override_percent())
    };
    let (first, percent) = fastest(&mut bench, 15.0);
    assert!((first - 20.0).abs() < 1e-9 && percent == 100, "{first} mm/s at {percent} %");
    fastest(&mut bench, 25.0);
    let (second, percent) = fastest(&mut bench, 35.0);
    assert!((second - 10.0).abs() < 1e-9 && percent == 50, "{second} mm/s at {percent} %");
}

#[test]
fn offsets_are_the_same_tables_for_g10_and_variables() {
    let program = "#5221=5.\nG10L2P1Y6.\nG10L10P3R7.\n#10003=0.5\n#500=#5222\n#501=#2203+#11003+#2003\nG0X1.Y1.\nG43H3Z0\nG10L20P2X9.\n#502=#7021\n\
                   #2500=1.\n#503=#5201\nM30\n";
    let mut bench = Bench::from_memory(program, Switches::default());
    assert_eq!(bench.end(), [6.0, 7.0, 7.5]);
    let mut bench =
        Bench::from_memory(&program.replace("M30", "G53X#500Y#501Z#502\nM0\nG53X#503\nM30"), Switches::default());
    assert!(bench.until(Control::is_stopped));
    assert_eq!(bench.control.position().linear.map(|axis| axis.to_mm()), [6.0, 14.5, 9.0]);
    bench.control.cycle_start();
    assert_eq!(bench.end()[0], 1.0);
}
