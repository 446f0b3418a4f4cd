//! `arcfeed lobes`: limit depth of stable milling against spindle speed, for the tool and the modes of a job.

mod diagram;

use std::path::PathBuf;
use std::str::FromStr;

use arcfeed_model::tool::Tool;
use arcfeed_units::{LengthUnit, S_PER_MIN};
use serde::Serialize;

use super::outcome::{Failure, json_text, refuse_inputs, say, write_whole};
use crate::console::note;
use crate::init::answers::{Length, Milling};
use crate::job::JobFile;
use crate::report::page::plot::{Lane, Series, svg};
use diagram::{Cut, Diagram, LimitPoint};

/// Most vibrations of the fastest mode from tooth to tooth at the lowest speed of a machine's range. Below, lobes are narrower than
/// speeds are chosen, and the computation grows with their number.
const WAVES_MAX: f64 = 60.0;
/// Rows of the printed table.
const ROWS_MAX: usize = 25;

/// Limit depth of stable milling against spindle speed, and the best speeds
///
/// Linear theory for straight teeth at equal distances, with the modes and coefficients of `[cutting]` in the job
/// (docs/forces.md#stability-lobes).
#[derive(Debug, clap::Args)]
pub struct Lobes {
    /// The job file, with an end mill, [cutting] and its modes
    #[arg(value_name = "JOB.toml")]
    job: PathBuf,
    /// Range of spindle speeds, rev/min; without it the machine's, from 60 vibrations of the fastest mode a tooth
    #[arg(long, value_name = "FROM,TO")]
    speeds: Option<SpeedRange>,
    /// Number of speeds in the range
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(2..=10_000))]
    points: u32,
    /// Radial depth of cut, in the job's unit, or 3mm, 0.1in; without it the tool's diameter, a slot
    #[arg(long, value_name = "LENGTH")]
    radial_depth: Option<Length>,
    /// Side of the material, for a depth below the diameter
    #[arg(long, value_enum, default_value_t)]
    milling: Milling,
    /// Direction of the feed, degrees from +X of the program towards +Y
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, allow_negative_numbers = true)]
    feed_direction: f64,
    /// Write the plot here, as SVG
    #[arg(long, value_name = "OUT.svg")]
    svg: Option<PathBuf>,
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    json: bool,
}

/// Range of speeds, rev/min.
#[derive(Clone, Copy, Debug)]
struct SpeedRange([f64; 2]);

impl FromStr for SpeedRange {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let ends = text.split_once(',').map(|(from, to)| [from, to].map(|end| end.trim().parse().unwrap_or(f64::NAN)));
        let range = ends.filter(|[from, to]| *from >= 1.0 && from < to && *to <= 1e6);
        range.map(SpeedRange).ok_or("write FROM,TO in rev/min, 1 to 1000000, for example 4000,20000")
    }
}

/// The diagram as JSON; lengths in the job's unit.
#[derive(Serialize)]
struct LobeFigures {
    unit: &'static str,
    teeth: usize,
    radial_depth: f64,
    milling: &'static str,
    feed_direction_deg: f64,
    specific_force_n_per_mm2: [f64; 2],
    depth_max: f64,
    job: JobFigures,
    best: Vec<PointFigures>,
    points: Vec<PointFigures>,
}

/// The job's own speed and depth.
#[derive(Serialize)]
struct JobFigures {
    rev_per_min: f64,
    depth: f64,
    depth_limit: Option<f64>,
    chatter: Option<&'static str>,
    is_stable: bool,
}

/// Limit at a speed.
#[derive(Serialize)]
struct PointFigures {
    rev_per_min: f64,
    depth_limit: Option<f64>,
    chatter: Option<&'static str>,
}

/// Speed at which the fastest mode of a job vibrates [`WAVES_MAX`] times from tooth to tooth.
fn slowest_rev_per_min(file: &JobFile) -> f64 {
    let modes = file.cutting.iter().flat_map(|cutting| &cutting.modes);
    let fastest_hz = modes.map(|mode| mode.frequency_hz).fold(0.0, f64::max);
    match &file.job.tools.first().tool {
        Tool::EndMill(mill) => fastest_hz * S_PER_MIN / (WAVES_MAX * f64::from(mill.teeth)),
        Tool::CupMill(_) => 0.0,
    }
}

impl Lobes {
    /// Runs the command.
    ///
    /// # Errors
    /// The job has no such tool, edges or modes, a range is missing, or the plot cannot be written.
    pub fn run(&self) -> Result<(), Failure> {
        let file = JobFile::load(&self.job)?;
        refuse_inputs(&[self.svg.as_deref()], &file.inputs(&self.job))?;
        let unit = file.job.unit;
        let cut = Cut {
            radial_depth_mm: self.radial_depth.as_ref().map(|length| length.to_mm(unit)),
            is_up: self.milling == Milling::Conventional,
            feed_direction_deg: self.feed_direction,
        };
        let diagram = Diagram::new(&self.job, &file, &cut, self.range(&file)?, self.points as usize)?;
        if let Some(path) = &self.svg {
            write_whole(path, plot(&diagram, unit).as_bytes())?;
        }
        if self.json {
            say(format_args!("{}", json_text(&self.figures(&diagram, unit))));
        } else {
            self.print(&diagram, unit);
        }
        Ok(())
    }

    /// Range of speeds: the option's, inside the machine's.
    fn range(&self, file: &JobFile) -> Result<[f64; 2], Failure> {
        let of_machine = file.machine.as_ref().and_then(|machine| machine.spindle_range_rev_per_min);
        match (self.speeds, of_machine) {
            (None, None) => Err(Failure::Usage(
                "--speeds FROM,TO is missing: the job's machine has no spindle_range (docs/kinematics.md)".into(),
            )),
            (None, Some([low, high])) => match slowest_rev_per_min(file) {
                slowest if low < slowest && slowest < high => {
                    note(format_args!(
                        "note: speeds below {slowest:.0} rev/min are left out, where the fastest mode vibrates more than {WAVES_MAX} times from \
                         tooth to tooth; give them with --speeds"
                    ));
                    Ok([slowest, high])
                }
                _ => Ok([low, high]),
            },
            (Some(SpeedRange([from, to])), Some([least, most])) if from < least || to > most => Err(Failure::Usage(
                format!("--speeds {from},{to}: the machine's spindle turns at {least} to {most} rev/min"),
            )),
            (Some(SpeedRange(range)), _) => Ok(range),
        }
    }

    fn figures(&self, diagram: &Diagram, unit: LengthUnit) -> LobeFigures {
        let Diagram { cut_depth_mm, job_rev_per_min, job_point, .. } = diagram;
        let job = point_figures(job_point, unit);
        LobeFigures {
            unit: unit.label(),
            teeth: diagram.milling.teeth,
            radial_depth: diagram.radial_depth_mm / unit.mm(),
            milling: self.side(),
            feed_direction_deg: self.feed_direction,
            specific_force_n_per_mm2: diagram.milling.specific_mpa,
            depth_max: diagram.depth_max_mm / unit.mm(),
            job: JobFigures {
                rev_per_min: *job_rev_per_min,
                depth: cut_depth_mm / unit.mm(),
                depth_limit: job.depth_limit,
                chatter: job.chatter,
                is_stable: diagram.job_is_stable(),
            },
            best: diagram.best().map(|point| point_figures(point, unit)).collect(),
            points: diagram.points.iter().map(|point| point_figures(point, unit)).collect(),
        }
    }

    fn side(&self) -> &'static str {
        if self.milling == Milling::Climb { "climb" } else { "conventional" }
    }

    fn print(&self, diagram: &Diagram, unit: LengthUnit) {
        let label = unit.label();
        let depth = |point: &LimitPoint| match point.limit {
            Some(limit) => format!("{:>12.4}  {}", limit.depth_mm / unit.mm(), LimitPoint::chatter(limit.kind)),
            None => format!("{:>12}  none up to {:.4}", "-", diagram.depth_max_mm / unit.mm()),
        };
        let [along, across] = diagram.milling.specific_mpa;
        say(format_args!(
            "{} teeth, radial depth {:.4} {label} ({}), feed at {} degrees from +X; {along:.1} and {across:.1} N/mm2",
            diagram.milling.teeth,
            diagram.radial_depth_mm / unit.mm(),
            self.side(),
            self.feed_direction
        ));
        say(format_args!("    rev/min    limit, {label}  chatter beyond it"));
        let every = diagram.points.len().div_ceil(ROWS_MAX);
        for point in diagram.points.iter().step_by(every) {
            say(format_args!("{:>11.0}{}", point.rev_per_min, depth(point)));
        }
        say(format_args!("best speeds, of {}:", diagram.points.len()));
        diagram.best().for_each(|point| say(format_args!("{:>11.0}{}", point.rev_per_min, depth(point))));
        let state = if diagram.job_is_stable() { "stable" } else { "not stable" };
        say(format_args!(
            "the job, {:.0} rev/min, {:.4} {label} deep: {state}; limit{}",
            diagram.job_rev_per_min,
            diagram.cut_depth_mm / unit.mm(),
            depth(&diagram.job_point)
        ));
    }
}

fn point_figures(point: &LimitPoint, unit: LengthUnit) -> PointFigures {
    PointFigures {
        rev_per_min: point.rev_per_min,
        depth_limit: point.limit.map(|limit| limit.depth_mm / unit.mm()),
        chatter: point.limit.map(|limit| LimitPoint::chatter(limit.kind)),
    }
}

/// Plot of the limits; where nothing limits the depth, that of the tool.
fn plot(diagram: &Diagram, unit: LengthUnit) -> String {
    let half = diagram.step_rev_per_min / 2.0;
    let step = |point: &LimitPoint| {
        let depth_mm = point.limit.map_or(diagram.depth_max_mm, |limit| limit.depth_mm);
        ([point.rev_per_min - half, point.rev_per_min + half], depth_mm / unit.mm())
    };
    let lane = Lane {
        title: format!("limit of the axial depth, {}; dashed: the job's depth", unit.label()),
        series: vec![Series { name: "limit", color: "#36c", steps: diagram.points.iter().map(step).collect() }],
        mark: Some(diagram.cut_depth_mm / unit.mm()),
        has_gaps: true,
    };
    svg(&[lane], "rev/min")
}
