//! Preparation of a transmission from a job: everything is checked before the line is opened.

use std::collections::HashMap;

use arcfeed_control::code::{TapeCode, with_even_parity};
use arcfeed_hil_sim::planned_conditions::PlannedConditions;
use arcfeed_nc::modal::{Feed, PER_MIN_SCALE, Pose};
use arcfeed_nc::segment::Segment;
use arcfeed_units::{Micros, S_PER_MIN};

use super::super::executed_blocks::check_expanded;
use super::super::job_input::{JobInput, adapted};
use super::super::line_args::LineArgs;
use super::super::outcome::Failure;
use super::super::simulate::control::{control_settings, tape_code};
use super::super::simulate::{foreseen, foreseen_before};
use crate::board::plan::MoveBounds;
use crate::checksum::fingerprint;
use crate::console::note;
use crate::dnc::journal::Start;
use crate::dnc::pace::Pace;
use crate::dnc::reports::Reports;
use crate::dnc::restored_state::PowerOn;
use crate::dnc::sender::LineUse;
use crate::dnc::starvation::{BlockLoad, Wait, predict};
use crate::dnc::transmission::{Transmission, TransmissionFault, Wire};
use crate::job::JobFile;
use crate::plural::counted;
use crate::port::reaction::reaction;
use crate::port::url::PortUrl;
use crate::program::Program;

/// Shortest wait that is reported, s.
const WAIT_MIN_S: f64 = 0.001;

/// Program that is checked and ready to be sent.
pub struct PreparedProgram {
    /// Job file.
    pub file: JobFile,
    /// Program of the job, before adaptation.
    pub program: Program,
    /// Transmission of the whole adapted program.
    pub whole: Transmission,
    /// Rules by which text becomes the characters on the line.
    pub wire: Wire,
    /// First record of the journal, with the fingerprints of the whole program.
    pub start: Start,
    /// Position reports of the control that are expected for the whole program.
    pub reports: Reports,
    /// Conditions of moves that the simulated machine cannot know, from the plan.
    pub foreseen: Vec<PlannedConditions>,
    /// The same for a run of the original program.
    pub foreseen_before: Vec<PlannedConditions>,
    /// Limits of moves that their NC text does not show, for a board; by line of the program's file.
    pub bounds: HashMap<usize, MoveBounds>,
    /// Notes for the operator before anything is sent.
    pub notes: Vec<String>,
}

/// Move of a line of the transmission.
pub struct LineMove {
    /// The move in path coordinates (docs/dialect.md), without the tool length.
    pub segment: Segment,
    /// Origin of the program's coordinates.
    pub origin: Pose,
    /// G43.4: the coordinates are those of the tip on the part.
    pub follows_tip: bool,
}

impl PreparedProgram {
    /// Reads and checks job and program.
    ///
    /// # Errors
    /// Every error of the program, and every character that the control would not receive correctly, one per line.
    pub fn load(input: &JobInput, line: &LineArgs, filters: bool) -> Result<Self, Failure> {
        let (mut file, program) = input.load()?;
        line.apply(&mut file)?;
        check_expanded(&program.path, program.places.as_deref())?;
        if let Some(places) = &program.places {
            note(format_args!(
                "{}: a control on a line cannot jump or loop: sent are the {} lines of `arcfeed adapt --expand`, and line \
                 numbers are theirs",
                program.path.display(),
                places.len()
            ));
        }
        let adapted = adapted(&program, &file);
        let wire = Wire { encode: encode(&file), filters, tv_check: file.dnc.tv_check };
        let line = |offset: usize| adapted.line_ends.partition_point(|end| *end <= offset) + 1;
        let path = program.path.display();
        let refused = |refusals: Vec<TransmissionFault>| {
            let lines: Vec<String> = refusals.iter().map(|refusal| format!("{path}:{refusal}")).collect();
            Failure::Input(lines.join("\n"))
        };
        let mut whole = Transmission::new(&adapted.text, line, &wire).map_err(&refused)?;
        whole.changes().in_words().iter().for_each(|change| note(format_args!("{path}: note: {change}")));
        let mut reports = Reports::default();
        if let Some(every) = file.dnc.report_every {
            let control = PowerOn { settings: file.nc, tables: file.tables };
            (whole, reports) = Reports::insert_into(&whole, every, &control, &wire).map_err(refused)?;
        }
        // Comments, and settings for the simulation or the line only, may change between two transmissions.
        let JobFile { job, control, nc, tables, dnc, map, rule_scopes, plunge, spindle, .. } = &file;
        let said = format!("{:?}", (job, control, nc, tables, dnc, map, rule_scopes, plunge, spindle));
        let start = Start {
            program: fingerprint(program.bytes()),
            job: fingerprint(said.as_bytes()),
            sent: fingerprint(whole.frames()),
            bytes: whole.frames().len(),
            ..Start::default()
        };
        let [foreseen, foreseen_before] = [foreseen, foreseen_before].map(|moves| moves(&program, &adapted, &file));
        let bounds = MoveBounds::of(&adapted);
        Ok(PreparedProgram {
            file,
            program,
            whole,
            wire,
            start,
            reports,
            foreseen,
            foreseen_before,
            bounds,
            notes: Vec::new(),
        })
    }

    /// Settings of the line for this port, as the sender needs them.
    pub fn line_use(&self, port: &PortUrl) -> LineUse {
        let (serial, dnc) = (&self.file.serial, &self.file.dnc);
        let reaction = dnc.reaction.unwrap_or_else(|| reaction(port));
        let pace = Pace::new(serial.bits_per_char(), serial.baudrate, serial.xonxoff.then_some(reaction));
        let timeout = |time: Micros| (time > Micros(0)).then_some(time);
        LineUse {
            pace,
            xonxoff: serial.xonxoff,
            eight_bits: serial.is_bare(),
            start_timeout: timeout(dnc.start_timeout),
            xoff_timeout: timeout(dnc.xoff_timeout),
        }
    }

    /// State of the control after power-on, before the program.
    pub fn power_on(&self) -> PowerOn {
        PowerOn { settings: self.file.nc, tables: self.file.tables }
    }

    /// Notes on a line that cannot be used at its full rate, or is too slow for the program.
    pub fn line_notes(&self, line: &LineUse) -> Vec<String> {
        let mut notes = Vec::new();
        let share = line.pace.share();
        if share < 1.0 {
            notes.push(format!(
                "note: at {} baud a control's ten characters after XOFF last {:.1} ms, and this port may react later: only \
                 {:.0} % of the line are used. Use RTS/CTS or a lower rate, set the adapter's latency timer to 1 ms, or set \
                 its reaction in seconds ([dnc] reaction) if it is faster",
                self.file.serial.baudrate,
                10.0 * 1e3 / self.chars_per_s(),
                share * 100.0
            ));
        }
        let waits: Vec<Wait> = self.waits(share).into_iter().filter(|wait| wait.time_s >= WAIT_MIN_S).collect();
        if let Some(longest) = waits.iter().max_by(|a, b| a.time_s.total_cmp(&b.time_s)) {
            let [first, last] = longest.blocks.map(|index| self.whole.lines()[index].source);
            let total: f64 = waits.iter().map(|wait| wait.time_s).sum();
            let lines = if first == last { format!("line {first}") } else { format!("lines {first} to {last}") };
            notes.push(format!(
                "note: the line is slower than the program: the control will wait {}, {total:.2} s in all, longest before {lines} \
                 ({:.2} s); the tool then stands in the cut",
                counted(waits.len(), "time"),
                longest.time_s
            ));
        }
        notes
    }

    /// Predicted waits of the control for characters, if the fraction `share` of the line's rate can be used.
    pub fn waits(&self, share: f64) -> Vec<Wait> {
        let buffer = control_settings(&self.file).line.buffer;
        predict(&self.loads(&self.whole), self.chars_per_s() * share, buffer)
    }

    /// Length and execution time of each line, at the programmed feed.
    pub fn loads(&self, sending: &Transmission) -> Vec<BlockLoad> {
        self.moves(sending).map(|(load, _)| load).collect()
    }

    /// Execution time of each line at the programmed feed, and its move.
    pub fn moves(&self, sending: &Transmission) -> impl Iterator<Item = (BlockLoad, Option<LineMove>)> {
        let control = control_settings(&self.file);
        let (rapid_mm_per_s, acceleration) = (control.dynamics.rapid_mm_per_s, control.dynamics.acceleration_mm_per_s2);
        let mut reader = self.power_on().reader();
        (0..sending.lines().len()).map(move |index| {
            let text = sending.line_text(index).unwrap_or_default();
            let read = if index == 0 || sending.is_of_report(index) {
                None
            } else {
                reader.read(text.strip_suffix(b"\n").unwrap_or(text)).ok()
            };
            let dwell = read.as_ref().and_then(|read| read.step.dwell).map_or(0.0, Micros::to_s);
            let Some(segment) = read.and_then(|read| read.segment) else {
                return (BlockLoad::of_time(text.len(), dwell), None);
            };
            let speed_mm_per_s = match segment.feed {
                Feed::PerMinute(feed) => feed.to_mm() / S_PER_MIN * segment.length_mm() / segment.feed_length_mm(),
                Feed::InverseTime(times) => segment.length_mm() * times as f64 / PER_MIN_SCALE as f64 / S_PER_MIN,
                Feed::Missing => rapid_mm_per_s,
            };
            let load = if segment.length_mm() > 0.0 && speed_mm_per_s > 0.0 {
                BlockLoad::of_move(text.len(), segment.length_mm(), speed_mm_per_s, acceleration)
            } else {
                BlockLoad::of_time(text.len(), dwell)
            };
            let modal = reader.modal();
            let origin = modal.work_origin();
            (load, Some(LineMove { segment, origin, follows_tip: modal.follows_tool_center }))
        })
    }

    /// Characters per second on the line.
    pub fn chars_per_s(&self) -> f64 {
        f64::from(self.file.serial.baudrate) / f64::from(self.file.serial.bits_per_char())
    }
}

/// Encoding of a character for the job's line: the sender makes the code if the line has no parity bit of its own.
fn encode(file: &JobFile) -> fn(u8) -> Option<u8> {
    let seven_bits = |byte: u8| byte.is_ascii().then_some(byte);
    match file.dnc.code.map(tape_code) {
        Some(TapeCode::Iso) => |byte| byte.is_ascii().then(|| with_even_parity(byte)),
        Some(TapeCode::Eia) => |byte| if byte.is_ascii_lowercase() { None } else { TapeCode::Eia.encode(byte) },
        Some(TapeCode::Ascii) | None => seven_bits,
    }
}
