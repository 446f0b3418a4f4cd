//! Blade, tool, pass, and the results for one pair of damping ratios.

use std::collections::BTreeMap;
use std::error::Error;

use arcfeed_blades::beam::{Beam, BeamModes, BeamSection};
use arcfeed_blades::blade::Blade;
use arcfeed_blades::finishing::marks::{SurfaceMark, deviation_mm, marks};
use arcfeed_blades::finishing::pass::{FinishingPass, PassResolution, PassResult};
use arcfeed_blades::finishing::side::Side;
use arcfeed_fe::body::Body;
use arcfeed_fe::field::Field;
use arcfeed_fe::material::{ElasticMaterial, TITANIUM_6AL_4V};
use arcfeed_milling::cutting::edges::EndMill;
use arcfeed_milling::cutting::material::MATERIALS;
use arcfeed_modal::dynamics::chatter::metric_mm;
use arcfeed_modal::flexible::{Modal, Workpiece};

/// Blade whose first ten modes are near those of the paper, which does not state its dimensions.
pub const BLADE: Blade = Blade {
    span_mm: 84.2,
    chord_mm: [84.2, 67.36],
    thickness_mm: [8.42, 3.368],
    edge_ratio: 0.3,
    camber_rad: [0.4, 0.3],
    stagger_rad: [0.0; 2],
    lean_rad: 0.0,
};
/// Number of modes of the blade, as in the paper.
pub const MODES: usize = 10;
/// Cemented carbide; assumed, a common grade.
const CARBIDE: ElasticMaterial = ElasticMaterial { young_mpa: 580e3, poisson_ratio: 0.22, density_kg_per_m3: 14400.0 };
const DIAMETER_MM: f64 = 8.0;
/// Length out of the holder, without the flutes: gives the paper's 1960 Hz.
const SHANK_MM: f64 = 51.46;
const FLUTES_MM: f64 = 12.0;
/// Height of the pass, as a fraction of the span.
const HEIGHT_RATIO: f64 = 0.5;
/// Radial and axial force over tangential force: assumed.
const FORCE_RATIOS: [f64; 2] = [0.4, 0.2];
const SPINDLE_REV_PER_S: f64 = 45.0;
pub const FEED_MM_PER_TOOTH: f64 = 0.1;
/// Windows of the chord in which stability is evaluated.
pub const WINDOWS: usize = 20;
/// Largest M of a stable window.
const STABLE_MM: f64 = 0.05 * FEED_MM_PER_TOOTH;

/// Any error.
pub type Failure = Box<dyn Error + Send + Sync>;

/// Damping of workpiece and tool; a rigid one has none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damping {
    pub workpiece: Option<f64>,
    pub tool: Option<f64>,
}

/// Data common to all passes over a workpiece.
pub struct Bench<B> {
    pub pass: FinishingPass,
    pub body: B,
    pub tool: BeamModes,
    rigid: PassResult,
}

/// Result of one pass.
pub struct Outcome {
    /// Metric M in each window of the chord.
    pub metrics_mm: Vec<f64>,
    /// Largest displacement in each window.
    pub swings_mm: Vec<f64>,
    /// Root mean square deviation of the surface in each window.
    pub deviations_mm: Vec<f64>,
    pub marks: Vec<SurfaceMark>,
    /// Number of steps in which force and displacement did not converge.
    pub open: usize,
    pub force_n: f64,
}

/// Field of a blade alone, clamped at its foot.
pub fn blade_alone(blade: &Blade, edge_mm: f64) -> Result<Field, Failure> {
    let body = Body::new(blade.mesh([12, 1, 16], 0.4)?, &TITANIUM_6AL_4V);
    let modes = body.modes(&Blade::foot(body.mesh()), MODES)?;
    Ok(Field::new(body.mesh().clone(), &modes, edge_mm))
}

/// Point at which forces act on the tool: the ball's centre.
pub fn tool_point_mm() -> [f64; 3] {
    [0.0, 0.0, DIAMETER_MM / 2.0]
}

impl<B: Modal> Bench<B> {
    /// Bench for a body that has the shape of this blade in the cut region.
    pub fn new(body: B, blade: Blade, stepover_mm: f64, resolution: PassResolution) -> Result<Self, Failure> {
        let section = |length_mm, diameter_mm| BeamSection { length_mm, diameter_mm, material: CARBIDE };
        let sections = vec![section(SHANK_MM, DIAMETER_MM), section(FLUTES_MM, 0.8 * DIAMETER_MM)];
        let tool = Beam { sections, tip_mass_kg: 0.0, elements: 10 }.modes(1)?;
        let pass = FinishingPass {
            side: Side::new(blade, HEIGHT_RATIO),
            mill: EndMill {
                diameter_mm: DIAMETER_MM,
                corner_mm: DIAMETER_MM / 2.0,
                teeth: 4,
                helix_rad: 30.0_f64.to_radians(),
                height_mm: DIAMETER_MM / 2.0 + stepover_mm + resolution.rise_mm,
            },
            allowance_mm: 0.2,
            stepover_mm,
            feed_mm_per_tooth: FEED_MM_PER_TOOTH,
            tooth_hz: 4.0 * SPINDLE_REV_PER_S,
            cutting: MATERIALS[0].tangential.with_ratios(FORCE_RATIOS[0], FORCE_RATIOS[1]),
            resolution,
        };
        let rigid = pass.run::<B>(Vec::new(), None)?;
        Ok(Bench { pass, body, tool, rigid })
    }

    /// Runs one pass with this damping.
    pub fn run(&self, damping: Damping) -> Result<Outcome, Failure> {
        let (mut modes, mut seen) = (Vec::new(), None);
        if let Some(ratio) = damping.workpiece {
            let mut workpiece = Workpiece::new(&self.body);
            modes = workpiece.modes(self.pass.side.place_mm(0.0), ratio)?;
            seen = Some(workpiece);
        }
        if let Some(ratio) = damping.tool {
            modes.extend(self.tool.modes_at(tool_point_mm(), ratio)?);
        }
        let machined = self.pass.run(modes, seen)?;
        eprintln!("{damping:?}");
        Ok(self.judged(&machined))
    }

    fn judged(&self, machined: &PassResult) -> Outcome {
        let length_mm = self.pass.side.length_mm();
        let window = |along_mm: f64| libm::floor((along_mm / length_mm + 0.5) * WINDOWS as f64) as i64;
        let marks = marks(&self.pass.side, &self.rigid, machined);
        let (mut metrics_mm, mut swings_mm, mut deviations_mm) = (Vec::new(), Vec::new(), Vec::new());
        for at in 0..WINDOWS as i64 {
            let teeth: Vec<_> = machined.teeth.iter().filter(|tooth| window(tooth.along_mm) == at).collect();
            let samples: Vec<_> = teeth.iter().map(|tooth| tooth.displacement_mm).collect();
            metrics_mm.push(metric_mm(&samples, 1));
            swings_mm.push(teeth.iter().map(|tooth| tooth.swing_mm).fold(0.0, f64::max));
            deviations_mm.push(deviation_mm(marks.iter().filter(|mark| window(mark.along_mm) == at)));
        }
        let force_n = machined.teeth.iter().map(|tooth| tooth.force_n).fold(0.0, f64::max);
        Outcome { metrics_mm, swings_mm, deviations_mm, marks, open: machined.open, force_n }
    }
}

impl Outcome {
    /// Whether the pass was stable: M is at most a twentieth of the feed per tooth in every window of the chord.
    pub fn is_stable(&self) -> bool {
        self.metrics_mm.iter().all(|metric_mm| *metric_mm <= STABLE_MM)
    }

    /// Deviation of the whole surface, without 0.3 mm at the edges.
    pub fn deviation_mm(&self) -> f64 {
        deviation_mm(self.marks.iter())
    }

    /// Deviation of the surface from its own mean in each window and layer: marks without the bending common to all
    /// teeth.
    pub fn scatter_mm(&self) -> f64 {
        let ends = self.marks.iter().map(|mark| mark.along_mm);
        let (first, last) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), mm| (a.min(mm), b.max(mm)));
        let cell =
            |mark: &SurfaceMark| (mark.layer, (((mark.along_mm - first) / (last - first)) * WINDOWS as f64) as usize);
        let mut cells: BTreeMap<(usize, usize), [f64; 3]> = BTreeMap::new();
        for mark in &self.marks {
            let sums = cells.entry(cell(mark)).or_default();
            let of_mark = [1.0, mark.deviation_mm, mark.deviation_mm * mark.deviation_mm];
            sums.iter_mut().zip(of_mark).for_each(|(sum, of_mark)| *sum += of_mark);
        }
        let squares: f64 = cells.values().map(|[count, sum, square]| square - sum * sum / count).sum();
        libm::sqrt(squares / self.marks.len().max(1) as f64)
    }

    /// Largest depth of the tool below the nominal surface.
    pub fn gouge_mm(&self) -> f64 {
        self.marks.iter().map(|mark| -mark.deviation_mm).fold(0.0, f64::max)
    }
}
