//! State of the control before a block, and the blocks that bring a control into that state, for a restart in the
//! middle of a program.
//!
//! Our own interpreter finds the state by reading up to the block. The blocks go first to a clearance plane, then over
//! the block's start, wait there at M0, and only then go down at a feed. The same interpreter reads them back, from
//! power-on: unless they end in exactly the required state, there is no restart at this block.

use std::fmt::Write;

use arcfeed_nc::block::Reading;
use arcfeed_nc::modal::{Cycle, FeedMode, Modal, MotionKind, Plane, Pose, Turn};
use arcfeed_nc::reader::Reader;
use arcfeed_nc::settings::{ArcCenters, Scope, Settings, Tables};
use arcfeed_units::{LengthUnit, MICRODEG_PER_DEG, MicroDeg, Micros, Nm};

use super::functions::Functions;
use super::transmission::Transmission;

/// Fastest feed on the way down, nm/min, and the feed if the program has given none.
const DOWN_MAX: Nm = Nm(500_000_000);
const DOWN_DEFAULT: Nm = Nm(100_000_000);

/// State of a control after power-on, before it has read anything.
#[derive(Clone, Debug)]
pub struct PowerOn {
    /// Settings of the control (dialect, units, options).
    pub settings: Settings,
    /// Offsets stored in the control: work offsets, tool lengths and radii.
    pub tables: Tables,
}

impl PowerOn {
    /// Interpreter for this control in that state, with all functions of the dialect.
    pub fn reader(&self) -> Reader {
        let settings = Settings { scope: Scope::Everything, reading: Reading::Lenient, ..self.settings };
        Reader::with(settings, self.tables)
    }
}

/// State of the control before a block, as the interpreter finds it: all that a restart must restore.
#[derive(Clone, Debug, PartialEq)]
pub struct StateBefore {
    /// The control's modal state: modes, position, feed, coordinate systems.
    pub modal: Modal,
    /// Spindle, coolant and tool functions that the M, S and T words have left on.
    pub functions: Functions,
    /// Highest Z to which a rapid has led before the block, in the program's coordinates that are in force there;
    /// `None` if there was no rapid since those coordinates were set.
    pub clearance: Option<Nm>,
    /// Rotary axes that the program has named.
    rotary: [bool; 3],
    /// Last feed per minute.
    feed: Option<Nm>,
}

impl StateBefore {
    /// State before the line with this index in the transmission, found by reading all lines before it.
    ///
    /// # Errors
    /// A line before it cannot be read or ends the program, or a state is in force that blocks cannot restore (such as
    /// G41, G16, scaling, G92); with the reason.
    pub fn line(sent: &Transmission, index: usize, control: &PowerOn) -> Result<Self, String> {
        let mut reader = control.reader();
        let mut before = StateBefore {
            modal: *reader.modal(),
            functions: Functions::default(),
            clearance: None,
            rotary: [false; 3],
            feed: None,
        };
        for line in 1..index.min(sent.lines().len()) {
            before.take(&mut reader, sent, line)?;
        }
        before.modal = *reader.modal();
        before.refuse(reader.tables() != &control.tables, control.settings.arc_centers)?;
        Ok(before)
    }

    fn take(&mut self, reader: &mut Reader, sent: &Transmission, line: usize) -> Result<(), String> {
        if sent.is_of_report(line) {
            return Ok(());
        }
        let text = sent.line_text(line).unwrap_or_default();
        let text = text.strip_suffix(b"\n").unwrap_or(text);
        let source = sent.lines()[line].source;
        let shift = reader.modal().frame.shift();
        let understood =
            reader.read(text).map_err(|fault| format!("line {source} cannot be read any more: {}", fault.cause))?;
        if understood.step.stop.is_some_and(|stop| stop == arcfeed_nc::modal::ProgramStop::End) {
            return Err(format!("line {source} ends the program"));
        }
        let block = &understood.parsed.block;
        self.functions.take(block);
        for (named, letter) in self.rotary.iter_mut().zip(b'A'..) {
            *named |= block.word(letter).is_some();
        }
        let modal = reader.modal();
        if modal.frame.shift() != shift {
            self.clearance = None;
        }
        let is_rapid = understood.step.motion.is_some_and(|motion| motion.kind == MotionKind::Rapid);
        if is_rapid {
            let [_, _, z] = modal.program.linear;
            self.clearance = Some(self.clearance.map_or(z, |highest| highest.max(z)));
        }
        if modal.feed_mode == FeedMode::PerMinute {
            self.feed = modal.feed.or(self.feed);
        }
        Ok(())
    }

    /// Rejects a state that blocks cannot bring about.
    fn refuse(&self, has_data: bool, arc_centers: ArcCenters) -> Result<(), String> {
        let modal = &self.modal;
        let found = [
            (modal.compensation.is_some(), "G41 or G42 is in force: the tool meets the contour only where it began"),
            (modal.polar.is_some(), "G16 is in force"),
            (modal.frame.scaling().is_some(), "scaling or mirror image is in force"),
            (modal.unmodelled != 0, "a tilted plane is in force"),
            (modal.follows_tool_center, "G43.4 is in force"),
            (modal.preset != Pose::ORIGIN, "G92 has set coordinates: what they refer to is gone"),
            (modal.rotation_pending, "G68 or G69 stands before it and no move since has named both axes"),
            (modal.arc_centers != arc_centers, "G90.1 or G91.1 has changed what I, J, K refer to"),
            (has_data, "G10 has written offsets: whether the control still has them is not known"),
        ];
        match found.into_iter().find(|(holds, _)| *holds) {
            Some((_, why)) => Err(format!("{why}; take the program up at a line before that")),
            None => Ok(()),
        }
    }

    /// Text of the blocks that bring a control from power-on to this state, before line `source` of the file.
    /// `clearance` is the Z of the clearance plane in the program's coordinates; `None`: the highest Z of a rapid so
    /// far.
    ///
    /// # Errors
    /// No blocks lead to this state; with the reason.
    pub fn blocks(&self, source: usize, clearance: Option<Nm>, control: &PowerOn) -> Result<String, String> {
        let start = self.start();
        let [_, _, z] = start.linear;
        let clearance = clearance.or(self.clearance).ok_or(
            "the program has not gone to a clearance plane by rapid; give one in its coordinates with --clearance Z",
        )?;
        if clearance < z {
            let height = self.length(clearance);
            return Err(format!(
                "Z{height} is below the block's start, Z{}: no clearance; see --clearance",
                self.length(z)
            ));
        }
        let text = self.write(source, clearance, &start);
        let read = read_back(&text, control)?;
        match difference(&self.modal, &read) {
            None => Ok(text),
            Some(group) => {
                Err(format!("no blocks lead to this state ({group} would differ); take the program up at another line"))
            }
        }
    }

    /// Required position of the tool; under a cycle that at its initial level.
    fn start(&self) -> Pose {
        let mut start = self.modal.program;
        if let Some(cycle) = self.modal.cycle {
            let (.., normal) = self.modal.plane.axes();
            start.linear[normal] = Nm(cycle.initial.0 - self.modal.frame.shift().linear[normal].0);
        }
        start
    }

    fn write(&self, source: usize, clearance: Nm, start: &Pose) -> String {
        let modal = &self.modal;
        let mut text = format!("%\n(RESUME AT LINE {source})\nG90G94G17G40G49G69G80\n");
        text += if modal.unit == LengthUnit::Inch { "G20\n" } else { "G21\n" };
        match modal.system {
            system @ 0..=5 => line(&mut text, &format!("G{}", 54 + system)),
            system => line(&mut text, &format!("G54.1P{}", system - 5)),
        }
        if modal.local != Pose::ORIGIN {
            line(&mut text, &format!("G52{}", self.words(&modal.local, [true; 3])));
        }
        for words in self.functions.words(modal.spindle) {
            line(&mut text, &words);
        }
        let length = match (modal.length_sign, modal.length_offset) {
            (0, 0) => String::new(),
            (0, offset) => format!("H{offset}"),
            (sign, offset) => format!("G{}H{offset}", if sign > 0 { 43 } else { 44 }),
        };
        let radius = if modal.radius_offset == 0 { String::new() } else { format!("D{}", modal.radius_offset) };
        line(&mut text, &format!("G0{length}{radius}Z{}", self.length(clearance)));
        let rotary = self.rotary_words(start);
        if !rotary.is_empty() {
            line(&mut text, &rotary);
        }
        if let Some(rotation) = modal.frame.rotation() {
            let (g, [first, second]) = plane(rotation.plane);
            let [x, y] = rotation.center.map(|center| self.length(center));
            line(&mut text, &format!("{g}G68{first}{x}{second}{y}R{}", degrees(rotation.angle)));
        }
        let [x, y, z] = start.linear.map(|axis| self.length(axis));
        line(&mut text, &format!("G17X{x}Y{y}"));
        line(&mut text, "M0");
        match (modal.feed_mode, modal.feed) {
            // Nothing has been cut yet: the program itself went there by rapid.
            (FeedMode::PerMinute, None) => line(&mut text, &format!("Z{z}")),
            _ => {
                let down = self.feed.unwrap_or(DOWN_DEFAULT).min(DOWN_MAX);
                line(&mut text, &format!("G1Z{z}F{}", self.length(down)));
            }
        }
        self.write_modes(&mut text);
        text
    }

    fn write_modes(&self, text: &mut String) {
        let modal = &self.modal;
        line(text, plane(modal.plane).0);
        let mode = match modal.feed_mode {
            FeedMode::PerMinute => "G94",
            FeedMode::InverseTime => "G93",
            FeedMode::PerRevolution => "G95",
        };
        line(text, &modal.feed.map_or(mode.into(), |feed| format!("{mode}F{}", self.length(feed))));
        let levels = if modal.returns_to_r { "G99" } else { "G98" };
        line(text, levels);
        let motion = match modal.motion {
            MotionKind::Rapid => "G0",
            MotionKind::Line => "G1",
            MotionKind::Arc(Turn::Cw) => "G2",
            MotionKind::Arc(Turn::Ccw) => "G3",
        };
        line(text, motion);
        if let Some(Cycle { code, r, bottom, q, dwell, .. }) = modal.cycle {
            let mut block = format!("G{code}");
            for (letter, value) in [('Z', bottom), ('R', r), ('Q', Some(q).filter(|q| q.0 != 0))] {
                if let Some(value) = value {
                    let _never_fails = write!(block, "{letter}{}", self.length(value));
                }
            }
            if dwell > Micros(0) {
                let _never_fails = write!(block, "P{}", dwell.0 / 1_000);
            }
            line(text, &format!("{block}K0"));
        }
        if !modal.absolute {
            line(text, "G91");
        }
    }

    /// Length in the program's unit, with a point.
    fn length(&self, length: Nm) -> String {
        decimal(length.0, self.modal.unit.nm(), if self.modal.unit == LengthUnit::Inch { 5 } else { 6 })
    }

    fn words(&self, pose: &Pose, named: [bool; 3]) -> String {
        let linear = "XYZ".chars().zip(pose.linear).zip(named).filter(|(_, named)| *named);
        linear.map(|((letter, axis), _)| format!("{letter}{}", self.length(axis))).collect::<String>()
            + &self.rotary_words(pose)
    }

    fn rotary_words(&self, pose: &Pose) -> String {
        let rotary = "ABC".chars().zip(pose.rotary).zip(self.rotary).filter(|(_, named)| *named);
        rotary.map(|((letter, axis), _)| format!("{letter}{}", degrees(axis))).collect()
    }
}

fn line(text: &mut String, words: &str) {
    text.push_str(words);
    text.push('\n');
}

fn plane(plane: Plane) -> (&'static str, [char; 2]) {
    match plane {
        Plane::Xy => ("G17", ['X', 'Y']),
        Plane::Zx => ("G18", ['Z', 'X']),
        Plane::Yz => ("G19", ['Y', 'Z']),
    }
}

fn degrees(angle: MicroDeg) -> String {
    decimal(angle.0, MICRODEG_PER_DEG, 6)
}

/// Fraction with at most `decimals` decimals, and always a point.
fn decimal(value: i64, per_one: i64, decimals: u32) -> String {
    let scale = 10_i128.pow(decimals);
    let scaled = i128::from(value) * scale * 2;
    let rounded = (scaled.abs() + i128::from(per_one)) / (2 * i128::from(per_one));
    let digits = format!("{:0width$}", rounded % scale, width = decimals as usize);
    let sign = if value < 0 && rounded > 0 { "-" } else { "" };
    format!("{sign}{}.{}", rounded / scale, digits.trim_end_matches('0'))
}

/// State after these blocks.
fn read_back(text: &str, control: &PowerOn) -> Result<Modal, String> {
    let mut reader = control.reader();
    for block in text.lines().skip(1) {
        reader.read(block.as_bytes()).map_err(|fault| format!("our own block {block} is refused: {}", fault.cause))?;
    }
    Ok(*reader.modal())
}

/// First group in which two states differ. Under G99 a cycle continues from its initial level, which is above R.
fn difference(wanted: &Modal, found: &Modal) -> Option<&'static str> {
    let mut place = wanted.program;
    if wanted.cycle.is_some() && wanted.returns_to_r {
        let (.., normal) = wanted.plane.axes();
        place.linear[normal] = found.program.linear[normal];
    }
    let groups = [
        (wanted.unit == found.unit, "units"),
        (wanted.plane == found.plane, "plane"),
        (wanted.absolute == found.absolute, "G90 or G91"),
        (wanted.motion == found.motion, "motion"),
        (wanted.feed_mode == found.feed_mode, "feed mode"),
        (wanted.feed == found.feed, "feed"),
        (wanted.spindle == found.spindle, "spindle speed"),
        (wanted.system == found.system && wanted.local == found.local, "work coordinates"),
        (wanted.frame == found.frame, "rotation"),
        (wanted.length_sign == found.length_sign && wanted.length_offset == found.length_offset, "tool length"),
        (wanted.radius_offset == found.radius_offset, "cutter compensation number"),
        (wanted.cycle == found.cycle && wanted.returns_to_r == found.returns_to_r, "canned cycle"),
        (place == found.program, "position"),
    ];
    groups.into_iter().find(|(is_same, _)| !is_same).map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transmission::Wire;
    use arcfeed_nc::settings::Preset;

    fn control() -> PowerOn {
        let settings = Settings::preset(Preset::Fanuc16i, LengthUnit::Mm, Reading::Lenient);
        PowerOn { settings, tables: Tables::default() }
    }

    fn before(program: &str, index: usize) -> Result<StateBefore, String> {
        let wire = Wire { encode: Some, filters: false, tv_check: false };
        let text = format!("%\n{program}\nM30\n%\n");
        let sent = Transmission::new(text.as_bytes(), |_| 1, &wire).unwrap();
        StateBefore::line(&sent, index, &control())
    }

    const RICH: &str = "G20G90\nT3M6\nS4000M3\nM8\nG55\nG43H2D3Z1.\nG0X1.Y2.B30.\nG68X1.Y1.R30.\nX2.Y2.\nG1Z-.1F20.\n\
                        G18\nG95F.01\nG91X.5\nG17G90G94F9.\nG69\nX3.Y3.\nG0Z1.\nG99G83Z-1.R.1Q.05F7.\nX4.\nG80\n\
                        G93\nG1X5.F30.\nG94G54G49G52X1.Y0Z0\nG2X6.I1.F8.\nG91G0Y1.\nX1.";

    #[test]
    fn restart_at_every_line_of_a_rich_program_works_or_gives_a_reason() {
        let (mut restored, mut refused) = (0, Vec::new());
        for index in 2..=RICH.lines().count() + 1 {
            // The self-check in `blocks` compares every group.
            match before(RICH, index).and_then(|before| before.blocks(index, Some(Nm(60_000_000)), &control())) {
                Ok(_) => restored += 1,
                Err(why) => refused.push((index, why)),
            }
        }
        assert!(refused.iter().all(|(_, why)| why.contains("G68") || why.contains("clearance")), "{refused:#?}");
        assert_eq!((restored, refused.len()), (24, 2), "{refused:#?}");
    }

    #[test]
    fn the_way_down_is_the_last_move_and_at_a_feed() {
        let before = before("G21G0X10.Y5.\nZ5.\nS500M3\nG1Z-2.F2000.\nX20.", 6).unwrap();
        let blocks = before.blocks(6, None, &control()).unwrap();
        let lines: Vec<&str> = blocks.lines().collect();
        assert_eq!(
            lines,
            [
                "%",
                "(RESUME AT LINE 6)",
                "G90G94G17G40G49G69G80",
                "G21",
                "G54",
                "S500M3",
                "G0Z5.",
                "G17X20.Y5.",
                "M0",
                "G1Z-2.F500.",
                "G17",
                "G94F2000.",
                "G98",
                "G1"
            ]
        );
    }

    #[test]
    fn what_cannot_be_restored_is_refused_by_name() {
        for (program, why) in [
            ("G21G0X1.\nG41X2.D1\nX3.", "G41"),
            ("G0X1.\nG92X0", "G92"),
            ("G10L2P1X5.\nG0X1.", "G10"),
            ("G16\nG0X1.", "G16"),
        ] {
            let index = program.lines().count() + 1;
            let refusal = before(program, index).unwrap_err();
            assert!(refusal.contains(why), "{refusal}");
        }
        let low = before("G21G0Z-5.\nG1X1.F1.", 3).unwrap().blocks(3, Some(Nm::from_mm(-6.0)), &control());
        assert!(low.unwrap_err().contains("--clearance"));
    }

    #[test]
    fn numbers_are_written_with_a_point_and_no_more_digits_than_they_need() {
        assert_eq!(decimal(-25_400_000, 25_400_000, 5), "-1.");
        assert_eq!(decimal(2_540, 25_400_000, 5), "0.0001");
        assert_eq!(decimal(-1, 25_400_000, 5), "0.");
    }
}
