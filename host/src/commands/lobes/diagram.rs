//! Stability diagram: the largest stable depth of cut over a range of spindle speeds, from the edges and modes of a job.
//!
//! ```text
//! h = f (cos phi1 - cos phi2) / (phi2 - phi1)     (1)
//! ```
//!
//! h is the mean chip of a tooth between its angles of entry and exit, at the job's feed per tooth f: at this thickness the
//! forces of a chip are replaced by their slope, which is all that the linear theory knows of them.

use std::path::Path;
use std::thread::{available_parallelism, scope};

use arcfeed_milling::stability::{ChatterKind, DepthLimit, LinearMilling};
use arcfeed_modal::dynamics::modal::Mode;
use arcfeed_model::tool::Tool;

use super::super::outcome::Failure;
use super::super::simulate::edges;
use crate::job::cutting::Mode as ModeFigures;
use crate::job::{Cutting, JobFile};
use crate::place::place;

/// Best speeds that are named.
const BEST_MAX: usize = 3;

/// Cut for which a stability diagram is computed.
#[derive(Clone, Copy, Debug)]
pub struct Cut {
    /// Radial depth of cut, mm; `None` for a slot (full width).
    pub radial_depth_mm: Option<f64>,
    /// Conventional (up) milling; otherwise climb milling.
    pub is_up: bool,
    /// Direction of the feed in the XY plane, from +X towards +Y, degrees.
    pub feed_direction_deg: f64,
}

/// Limit of the stable depth at one spindle speed.
#[derive(Clone, Copy, Debug)]
pub struct LimitPoint {
    /// Spindle speed, rev/min.
    pub rev_per_min: f64,
    /// Smallest unstable axial depth; `None` if every depth up to the height of the edges is stable.
    pub limit: Option<DepthLimit>,
}

/// Stability diagram of a job's tool, with the depth and speed of the job.
#[derive(Clone, Debug)]
pub struct Diagram {
    /// Model of the milling process and the vibration modes.
    pub milling: LinearMilling,
    /// Radial depth of cut, mm.
    pub radial_depth_mm: f64,
    /// Height of the tool's edges, mm: no larger depth is examined.
    pub depth_max_mm: f64,
    /// Limits at evenly spaced speeds.
    pub points: Vec<LimitPoint>,
    /// Difference of neighbouring speeds, rev/min.
    pub step_rev_per_min: f64,
    /// Spindle speed of the job, rev/min.
    pub job_rev_per_min: f64,
    /// Axial depth of cut of the job, mm.
    pub cut_depth_mm: f64,
    /// Limit at the job's speed.
    pub job_point: LimitPoint,
}

impl LimitPoint {
    /// Name of this kind of chatter in reports.
    pub const fn chatter(kind: ChatterKind) -> &'static str {
        match kind {
            ChatterKind::Hopf => "hopf",
            ChatterKind::Flip => "flip",
        }
    }

    fn depth_mm(&self) -> f64 {
        self.limit.map_or(f64::INFINITY, |limit| limit.depth_mm)
    }
}

impl Diagram {
    /// Computes the diagram of a job for `count` speeds in `range`, rev/min.
    ///
    /// # Errors
    /// The job has no end mill with equal teeth, no edges or no modes, or the radial depth exceeds the tool's diameter.
    pub fn new(path: &Path, file: &JobFile, cut: &Cut, range: [f64; 2], count: usize) -> Result<Self, Failure> {
        let (milling, radial_depth_mm) = linear_milling(path, file, cut)?;
        let cutting = file.cutting.as_ref();
        let depth_max_mm = file.workpiece.as_ref().map_or(0.0, |workpiece| workpiece.body.height_mm);
        let job_rev_per_min = f64::from(file.job.tools.first().spindle.0);
        let [from, to] = range;
        let step_rev_per_min = (to - from) / (count - 1) as f64;
        let mut speeds: Vec<f64> = (0..count).map(|index| from + step_rev_per_min * index as f64).collect();
        speeds.push(job_rev_per_min);
        let mut points = limits(&milling, &speeds, depth_max_mm);
        let job_point = points.pop().unwrap_or(LimitPoint { rev_per_min: job_rev_per_min, limit: None });
        let cut_depth_mm = cutting.map_or(0.0, |cutting| cutting.axial_depth_mm);
        Ok(Diagram {
            milling,
            radial_depth_mm,
            depth_max_mm,
            points,
            step_rev_per_min,
            job_rev_per_min,
            cut_depth_mm,
            job_point,
        })
    }

    /// Whether the job's depth is stable at its speed.
    pub fn job_is_stable(&self) -> bool {
        self.cut_depth_mm < self.job_point.depth_mm()
    }

    /// Speeds at which the stable depth has a local maximum, the largest depth first. In a range in which every depth is stable, the
    /// middle of the range.
    pub fn best(&self) -> impl Iterator<Item = &LimitPoint> {
        let mut peaks: Vec<&LimitPoint> = Vec::new();
        for run in self.points.chunk_by(|a, b| a.depth_mm() == b.depth_mm()) {
            let depth_mm = run[0].depth_mm();
            let begin = self.points.partition_point(|point| point.rev_per_min < run[0].rev_per_min);
            let before = begin.checked_sub(1).and_then(|index| self.points.get(index));
            let neighbours = [before, self.points.get(begin + run.len())];
            if neighbours.into_iter().flatten().all(|point| point.depth_mm() < depth_mm) {
                peaks.push(&run[run.len() / 2]);
            }
        }
        peaks.sort_by(|a, b| b.depth_mm().total_cmp(&a.depth_mm()));
        peaks.into_iter().take(BEST_MAX)
    }
}

/// Milling of the job, and its radial depth.
fn linear_milling(path: &Path, file: &JobFile, cut: &Cut) -> Result<(LinearMilling, f64), Failure> {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let refused = |offset: usize, message: &str| {
        let [line, column] = place(&text, offset);
        Failure::Input(format!("{}:{line}:{column}: {message}", path.display()))
    };
    let Some(cutting) = &file.cutting else {
        return Err(refused(0, "the job has no [cutting]: lobes needs its coefficients and modes (docs/job.md)"));
    };
    let setup = file.job.tools.first();
    let Tool::EndMill(mill) = &setup.tool else {
        return Err(refused(cutting.offset, "lobes is for end mills; the tool of this job is a cup mill"));
    };
    let diameter_mm = 2.0 * mill.radius.to_mm();
    let radial_depth_mm = cut.radial_depth_mm.unwrap_or(diameter_mm);
    if radial_depth_mm > diameter_mm {
        return Err(Failure::Usage(format!(
            "--radial-depth: {radial_depth_mm} mm is more than the tool's diameter, {diameter_mm} mm"
        )));
    }
    check(cutting, file).map_err(|message| refused(cutting.offset, message))?;
    let engaged_rad = LinearMilling::engaged_rad(radial_depth_mm / diameter_mm, cut.is_up);
    let [entry_rad, exit_rad] = engaged_rad;
    let mean = (libm::cos(entry_rad) - libm::cos(exit_rad)) / (exit_rad - entry_rad);
    let chip_mm = f64::from(setup.feed_per_tooth.0) * mean; // (1)
    let wrong =
        |(offset, message): (Option<usize>, String)| refused(offset.unwrap_or(cutting.offset), message.as_str());
    let specific_mpa = edges::slopes_mpa(&cutting.coefficients, chip_mm).map_err(wrong)?;
    // From the program's frame to that of the theory: x along the feed.
    let (sin, cos) = libm::sincos(cut.feed_direction_deg.to_radians());
    let into_feed = |figures: &ModeFigures| {
        let [x, y, z] = figures.direction;
        edges::mode(&ModeFigures { direction: [cos * x + sin * y, cos * y - sin * x, z], ..*figures })
    };
    let modes = cutting.modes.iter().map(into_feed).collect::<Result<Vec<Mode>, _>>().map_err(wrong)?;
    Ok((LinearMilling { modes, teeth: usize::from(mill.teeth), specific_mpa, engaged_rad }, radial_depth_mm))
}

/// Refuses what the theory does not know.
fn check(cutting: &Cutting, file: &JobFile) -> Result<(), &'static str> {
    let is_even = cutting.pitch_rad.windows(2).all(|pair| (pair[0] - pair[1]).abs() < 1e-9);
    if !is_even {
        return Err("lobes is for teeth at equal distances: this [cutting] has an uneven `pitch`");
    }
    if file.workpiece.as_ref().is_some_and(|workpiece| workpiece.flexible.is_some()) {
        return Err(
            "lobes has no modes that differ from place to place: the job has [workpiece.flexible]; simulate the cut",
        );
    }
    // A direction along Z alone does not see the forces of the theory.
    let sees_forces = |mode: &ModeFigures| libm::hypot(mode.direction[0], mode.direction[1]) > 0.0;
    match cutting.modes.iter().any(|mode| sees_forces(mode) && mode.damping_ratio > 0.0) {
        true if cutting.modes.iter().all(|mode| mode.damping_ratio > 0.0) => Ok(()),
        _ => Err("lobes needs `modes` with damping in [cutting], at least one of them not along Z"),
    }
}

/// Limits at these speeds, on all cores.
fn limits(milling: &LinearMilling, speeds: &[f64], depth_max_mm: f64) -> Vec<LimitPoint> {
    let threads = available_parallelism().map_or(1, usize::from);
    let point = |speed: &f64| LimitPoint { rev_per_min: *speed, limit: milling.limit(*speed, depth_max_mm) };
    scope(|scope| {
        let parts = speeds.chunks(speeds.len().div_ceil(threads).max(1));
        let tasks: Vec<_> = parts.map(|part| scope.spawn(|| part.iter().map(point).collect::<Vec<_>>())).collect();
        tasks.into_iter().flat_map(|task| task.join().unwrap_or_default()).collect()
    })
}
