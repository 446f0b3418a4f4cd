//! `arcfeed simulate`: the program before and after, on the machine in software, as fast as it goes, and what it takes from
//! the job's workpiece.

mod body;

mod edges;

mod marked;

pub(super) mod setup;

pub(super) mod watch;

pub(super) mod told;

mod loaded;

mod drawn;

use std::path::{Path, PathBuf};
use std::time::Instant;

use arcfeed_hil_sim::control::code::Code;
use arcfeed_hil_sim::control::interpolator::AxisLimited;
use arcfeed_hil_sim::control::line::{LineSettings, SenderParity};
use arcfeed_hil_sim::control::tape::TapeSettings;
use arcfeed_hil_sim::control::{ControlSettings, Preset, Switches};
use arcfeed_hil_sim::cutting::meter::MoveChips;
use arcfeed_hil_sim::decider::Decider;
use arcfeed_hil_sim::drives::limits::{AXES, AxisLimits, DriveLimits};
use arcfeed_hil_sim::drives::servo::{AxisServo, Servo};
use arcfeed_hil_sim::drives::spindle::SpindleDrive;
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::rig::{Foreseen, MoveOverride, Rig};
use arcfeed_shared::cut::Moves;
use arcfeed_shared::job::Job;
use arcfeed_shared::kinematics::machine::Letter;
use arcfeed_shared::machine::FeedLimit;
use arcfeed_shared::report::{ChipFigures, LeftOut};
use arcfeed_shared::units::{LengthUnit, MmPerTooth, S_PER_MIN};

use super::adapt::{direction_word, rotation_word, side_word};
use super::mapped::{adapted, load};
use super::outcome::{Failure, say};
use crate::adapt::limit::is_tip_line;
use crate::adapt::{Adapted, PlannedBlock};
use crate::job::{ControlKind, JobFile, Parity, SerialSettings, TapeCode};
use crate::machine_file::MachineFile;
use crate::machine_file::drives::{Drive, Drives, Loops, SpindleRamps};
use crate::program::Program;
use crate::report::figures::{
    AlarmFigures, AxisLimitFigures, IptFigures, MovementFigures, OverrideFigures, RestartFigures, RunReport,
};
use crate::report::printed;
use crate::report::summary::Summary;
use drawn::{Shown, SurfaceFormat};
use setup::Setup;
use watch::Watch;

/// Run a job on the simulated machine, before and after, as fast as it goes
#[derive(Debug, clap::Args)]
pub struct Simulate {
    /// The job file
    job: PathBuf,
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    json: bool,
    /// Write the report with its plots and maps here, as one HTML file (docs/simulate.md)
    #[arg(long, value_name = "OUT.html")]
    report: Option<PathBuf>,
    /// Write the surface that is left of the job's workpiece here, in millimetres: .stl or .ply, binary
    #[arg(long, value_name = "OUT.stl|OUT.ply")]
    surface: Option<PathBuf>,
}

impl Simulate {
    /// Runs the command.
    ///
    /// # Errors
    /// The job or the program is at fault, or the simulated control raised an alarm.
    pub fn run(&self) -> Result<(), Failure> {
        let (file, program) = load(&self.job)?;
        let setup = Setup::of(&self.job, &file)?;
        let surface = self.surface(setup.as_ref())?;
        let target = setup.as_ref().map_or(Ok(None), Setup::target)?;
        let mut watches = [(); 2].map(|()| Watch::on(setup.as_ref()));
        let started = Instant::now();
        let adapted = adapted(&program, &file);
        let mut rig = in_memory(&file, &adapted.text, ControllerFault::None)?;
        rig.foresee(foreseen(&program, &adapted));
        let rig = watches[0].run(rig)?;
        let mut report = measure(&rig, &file.job);
        report.real_time_factor = Some(rig.now().to_s() / started.elapsed().as_secs_f64());
        let before = watches[1].run(in_memory(&file, &program.bytes(), ControllerFault::LawOff)?)?;
        compare(&mut report, measure(&before, &file.job));
        let unit = file.job.unit;
        let title = format!("{}: simulated", file.program.display());
        let (mut deviation, mut marks) = (None, Vec::new());
        if let (Some(setup), [Some(after), Some(before)]) = (&setup, watches.each_ref().map(|watch| &watch.cutter)) {
            let mut material = told::figures(unit, setup, after, before);
            material.warnings(unit).iter().for_each(|warning| eprintln!("warning: {warning}"));
            deviation = target.and_then(|target| told::deviation(unit, after.stock(), &target));
            material.deviation = deviation.as_ref().map(|(_, figures)| *figures);
            report.material = Some(material);
            if let [Some(after), Some(before)] = watches.each_ref().map(|watch| watch.loads.as_ref()) {
                let mut loads = loaded::figures(unit, after, before);
                if let Some(truth) = &setup.truth {
                    marks = truth.marks(after);
                    loads.marks = marked::figures(unit, after, &marks);
                    loads.baseline_marks = marked::figures(unit, before, &truth.marks(before));
                }
                loads.warnings().iter().for_each(|warning| eprintln!("warning: {warning}"));
                report.loads = Some(loads);
            }
            if let Some((path, format)) = surface {
                format.write(after.stock(), path)?;
            }
        }
        if let Some(path) = &self.report {
            let runs = [(&watches[0], rig.now()), (&watches[1], before.now())];
            Shown { title: &title, report: &report, job: &file.job, runs, deviation, marks }.write(path)?;
        }
        finish(&report, self.json, title)
    }

    /// Where the surface goes, and how; asked before anything runs.
    fn surface(&self, setup: Option<&Setup<'_>>) -> Result<Option<(&Path, SurfaceFormat)>, Failure> {
        let Some(path) = self.surface.as_deref() else { return Ok(None) };
        let format = SurfaceFormat::of(path)?;
        match setup {
            Some(_) => Ok(Some((path, format))),
            None => Err(Failure::Usage(format!("--surface: {} has no [workpiece] to be cut", self.job.display()))),
        }
    }
}

/// Prints a report and says how the run ended.
///
/// # Errors
/// The control raised an alarm.
pub fn finish(report: &RunReport, json: bool, title: String) -> Result<(), Failure> {
    if json {
        say(format_args!("{}", serde_json::json!(report)));
    } else {
        say(format_args!("{}", Summary { title, report }.to_string().trim_end()));
    }
    match report.alarms.first() {
        None => Ok(()),
        Some(alarm) => Err(Failure::Machine(format!("the control stopped at {alarm}"))),
    }
}

/// The settings of the job's control on the job's line.
pub fn control_settings(file: &JobFile) -> ControlSettings {
    let preset = match file.control {
        ControlKind::Fanuc16i => Preset::Fanuc16i,
        ControlKind::Fanuc0i => Preset::Fanuc0i,
        ControlKind::Fanuc31i => Preset::Fanuc31i,
    };
    let settings = preset.settings(file.job.unit);
    // Bit n of the reader's is bit n - 1 of the panel's.
    let switches = Switches { block_delete: file.nc.delete_switches >> 1, ..settings.switches };
    let (sender, code) = framing(&file.serial);
    let code = file.dnc.code.map_or(code, |code| Some(tape_code(code)));
    let line = LineSettings {
        baudrate: file.serial.baudrate,
        bits_per_char: file.serial.bits_per_char(),
        sender,
        tape: TapeSettings { code, tv_check: file.dnc.tv_check, ..settings.line.tape },
        ..settings.line
    };
    let (nc, tables, arc_clamp) = (file.nc, file.tables, file.job.machine.arc_clamp);
    let drives = file.machine.as_ref().and_then(drive_limits);
    let servo = file.machine.as_ref().and_then(|machine| machine.servo).map(|loops| {
        let Loops { gain_per_s, feed_forward_ratio, in_position_mm } = loops;
        Servo { axes: [AxisServo { gain_per_s, feed_forward_ratio, in_position_mm }; AXES] }
    });
    let spindle = file.machine.as_ref().and_then(|machine| machine.spindle).map(spindle_drive);
    ControlSettings { nc, tables, line, arc_clamp, switches, drives, servo, spindle, ..settings }
}

/// A spindle of which only the ramps are told: nothing loads it here, so it does not droop.
fn spindle_drive(ramps: SpindleRamps) -> SpindleDrive {
    let SpindleRamps { run_up_rev_per_min_s, run_down_rev_per_min_s, arrival_ratio, waits } = ramps;
    SpindleDrive {
        run_up_rev_per_min_s,
        run_down_rev_per_min_s,
        droop_ratio: 0.0,
        droop_s: 0.0,
        arrival_ratio,
        waits_for_arrival: waits,
    }
}

/// What the drives of a machine can do, axis by axis. A rotary axis that it does not have is as its first.
fn drive_limits(file: &MachineFile) -> Option<DriveLimits> {
    let Drives { linear, rotary, tolerance } = file.drives?;
    let limits = |drive: &Drive| AxisLimits {
        speed_mm_per_s: drive.speed_mm_per_s,
        acceleration_mm_per_s2: drive.acceleration_mm_per_s2,
        jerk_mm_per_s3: drive.jerk_mm_per_s3,
    };
    let of = |letter: Letter| usize::from(file.machine.rotary()[1].letter == letter);
    let [a, b, c] = Letter::ALL.map(|letter| limits(&rotary[of(letter)]));
    let [x, y, z] = linear.each_ref().map(limits);
    Some(DriveLimits {
        axes: [x, y, z, a, b, c],
        tolerance_mm: tolerance.linear_mm,
        tolerance_deg: tolerance.rotary_deg,
    })
}

/// The code that the sender makes itself.
pub fn tape_code(code: TapeCode) -> Code {
    match code {
        TapeCode::Iso => Code::Iso,
        TapeCode::Eia => Code::Eia,
        TapeCode::Ascii => Code::Ascii,
    }
}

/// What the job's line makes of a byte, and the code a control is set to on such a line: with seven bits and a parity bit
/// ISO or EIA, otherwise ASCII.
fn framing(serial: &SerialSettings) -> (SenderParity, Option<Code>) {
    match (serial.bytesize, serial.parity) {
        (7, Parity::Even) => (SenderParity::Even, None),
        (7, Parity::Odd) => (SenderParity::Odd, None),
        _ => (SenderParity::None, Some(Code::Ascii)),
    }
}

/// Runs a program from the control's memory to its end.
///
/// # Errors
/// The run never ends.
pub fn run_in_memory(file: &JobFile, program: &[u8], fault: ControllerFault) -> Result<Rig, Failure> {
    Watch::default().run(in_memory(file, program, fault)?)
}

fn in_memory(file: &JobFile, program: &[u8], fault: ControllerFault) -> Result<Rig, Failure> {
    in_memory_of(control_settings(file), file, program, fault)
}

/// A program in the memory of a control with these settings, not begun.
///
/// # Errors
/// The job's limits of the override are none.
pub(super) fn in_memory_of(
    settings: ControlSettings,
    file: &JobFile,
    program: &[u8],
    fault: ControllerFault,
) -> Result<Rig, Failure> {
    // A last line without its end would never be a block.
    let program = [program, b"\n"].concat();
    Rig::from_memory(settings, &program, &file.job, fault)
        .map_err(|error| Failure::Input(format!("override limits: {error:?}")))
}

/// What the plan knows of moves that the machine in software does not look at by itself: those under G43.4, and those whose
/// engagement is told.
pub fn foreseen(program: &Program, adapted: &Adapted) -> Vec<Foreseen> {
    let is_of_tip = |block: &PlannedBlock| program.lines.get(block.line - 1).is_some_and(is_tip_line);
    let moves = adapted.blocks.iter().filter(|block| block.along.is_some() || is_of_tip(block));
    let known = moves.map(|block| Foreseen {
        segment: block.segment,
        rule: block.rule.filter(|_| block.under.is_none()),
        along: block.along.clone(),
        limit: block.limit.map(FeedLimit::from),
    });
    known.collect()
}

/// Runs the program as it was, without arcfeed, and adds its figures.
///
/// # Errors
/// The run never ends.
pub fn add_baseline(report: &mut RunReport, file: &JobFile, program: &Program) -> Result<(), Failure> {
    let rig = run_in_memory(file, &program.bytes(), ControllerFault::LawOff)?;
    compare(report, measure(&rig, &file.job));
    Ok(())
}

/// Adds the figures of the program as it was.
fn compare(report: &mut RunReport, baseline: RunReport) {
    // A program that its control does not finish has no time to compare with.
    report.baseline_cycle_time_s = baseline.cycle_time_s.filter(|_| baseline.alarms.is_empty());
    report.baseline_ipt_circumference = baseline.ipt_circumference;
    for (movement, before) in report.movements.iter_mut().zip(baseline.movements) {
        movement.baseline_ipt = before.ipt;
    }
}

/// The figures of what the rig executed so far.
pub fn measure<D: Decider>(rig: &Rig<D>, job: &Job) -> RunReport {
    let moves: Vec<(&MoveChips, &MoveOverride)> = rig.meter().moves().iter().zip(rig.overrides()).collect();
    let movements = (0..job.rules.len()).map(|rule| movement(job, rule, &moves)).collect();
    let alarm = rig.control().alarm().map(|alarm| AlarmFigures::new(alarm.line, alarm.fault.column, alarm.fault.cause));
    RunReport {
        unit: job.unit.label(),
        blocks_executed: Some(rig.control().executed().len()),
        alarms: alarm.into_iter().collect(),
        printed: printed::lines(rig.control().output()),
        messages: rig.control().messages().map(String::from).collect(),
        cycle_time_s: Some(rig.cycle_time().to_s()),
        ipt_circumference: ipt(job.unit, job.feed_per_tooth, moves.iter().map(|(chips, _)| *chips)),
        r#override: overrides(moves.iter().map(|(_, figures)| *figures)),
        movements,
        axis_limited: rig.control().limited().iter().map(|limited| axis_limit(job.unit, limited)).collect(),
        restart: rig.control().restart_list().map(|list| RestartFigures {
            t: list.t,
            s: list.s,
            m: list.m.iter().copied().collect(),
            feed: list.feed().map(|feed| feed.0 as f64 / job.unit.nm() as f64),
            g: list.codes(),
        }),
        ..RunReport::default()
    }
}

fn axis_limit(unit: LengthUnit, limited: &AxisLimited) -> AxisLimitFigures {
    let AxisLimited { count, sequence, axis, is_rotary, wanted_mm_per_s, allowed_mm_per_s } = *limited;
    let (of_mm, unit) = match unit {
        _ if is_rotary => (1.0, "deg/min"),
        LengthUnit::Inch => (unit.mm(), "in/min"),
        LengthUnit::Mm => (1.0, "mm/min"),
    };
    let per_min = |speed: f64| speed * S_PER_MIN / of_mm;
    AxisLimitFigures {
        block: count,
        n: sequence,
        axis: ["X", "Y", "Z", "A", "B", "C"][axis],
        asked: per_min(wanted_mm_per_s),
        allowed: per_min(allowed_mm_per_s),
        unit,
    }
}

fn movement(job: &Job, rule: usize, moves: &[(&MoveChips, &MoveOverride)]) -> MovementFigures {
    let of_rule = || moves.iter().filter(move |(chips, _)| chips.rule == rule);
    let thickest = |circle: usize| {
        let ratios = of_rule().filter(|(chips, _)| chips.thickest[circle].samples > 0);
        ratios.map(|(chips, _)| chips.thickest[circle].max_ratio).reduce(f64::max)
    };
    let cut = &job.rules[rule];
    MovementFigures {
        rule: rule + 1,
        rotation: rotation_word(cut.moves),
        direction: match cut.moves {
            Moves::Rotations(_, turn) | Moves::Arcs(turn) => Some(direction_word(turn)),
            Moves::Lines => None,
        },
        side: side_word(&cut.work),
        arcs: of_rule().count(),
        ipt: ipt(job.unit, job.feed_per_tooth_of(cut), of_rule().map(|(chips, _)| *chips)),
        baseline_ipt: None,
        thickest_ratio: [thickest(0), thickest(1)],
        r#override: overrides(of_rule().map(|(_, figures)| *figures)),
        changes_per_arc: of_rule().map(|(_, figures)| figures.changes).collect(),
    }
}

fn ipt<'a>(unit: LengthUnit, target: MmPerTooth, moves: impl Iterator<Item = &'a MoveChips>) -> Option<IptFigures> {
    let (mut figures, mut left_out) = (ChipFigures::default(), LeftOut::default());
    for chips in moves {
        figures.merge(&chips.contact);
        left_out.merge(&chips.left_out);
    }
    IptFigures::new(&figures, &left_out, f64::from(target.0), unit)
}

fn overrides<'a>(arcs: impl Iterator<Item = &'a MoveOverride>) -> Option<OverrideFigures> {
    let figures = arcs.map(|arc| OverrideFigures { min: arc.min_percent, max: arc.max_percent, changes: arc.changes });
    figures.reduce(OverrideFigures::join)
}
