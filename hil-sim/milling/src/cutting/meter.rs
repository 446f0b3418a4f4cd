//! The chip-load meter: measures the chip of every tooth from the machine's actual positions.
//!
//! The meter works in the plane of the arc, G17 or another, with the tool's axis along the plane's normal; on a helix
//! it measures the chip across that axis.
//!
//! A sample is steady if the machine ran within 0.5 % of the commanded feed during the whole cut of its tooth, within
//! one block. Figures of the law's error use steady samples with an admissible contact; all others are counted by
//! cause. The thickest chip uses all samples with a contact. A tooth that is still in the cut when its block ends
//! counts with the mean feed that it had. The spindle's speed at a tooth's beginning sets the tooth's time.

use std::collections::VecDeque;

use arcfeed_model::cut::{CutRule, Work};
use arcfeed_model::report::{ChipFigures, ExcludedSamples};
use arcfeed_model::stock::StockLine;
use arcfeed_model::telemetry::Sample;
use arcfeed_model::tool::{Edge, Tool};
use arcfeed_nc::modal::Pose;
use arcfeed_nc::segment::Segment;
use arcfeed_units::{Micros, Nm, RevPerMin, S_PER_MIN, US_PER_S};
use nalgebra::Vector2;

use super::chip::Circle;

/// Largest deviation from the commanded feed that counts as steady.
pub const STEADY_RATIO: f64 = 5e-3;

/// Tool data for the meter; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeterSettings {
    /// True tool. The meter measures chips of a ring only.
    pub tool: Tool,
    /// Spindle speed.
    pub spindle: RevPerMin,
    /// Target chip on the circumference if a rule gives none of its own, mm.
    pub target_mm_per_tooth: f64,
}

/// Chips of one move under a cut rule.
#[derive(Clone, Debug, PartialEq)]
pub struct MoveChips {
    /// `N` of the block.
    pub sequence: Option<i64>,
    /// Index of the job's cut rule for the move.
    pub rule: usize,
    /// Chip at the contact relative to the target, steady samples only; empty if the tool is no ring or the stock no
    /// single line.
    pub contact: ChipFigures,
    /// Chip at the contact relative to the target, all samples.
    pub any_contact: ChipFigures,
    /// Thickest chip relative to the target, anywhere inside the rule's half plane: outer and inner circle.
    pub thickest: [ChipFigures; 2],
    /// Samples that are not among the steady ones.
    pub left_out: ExcludedSamples,
}

/// The meter's state.
#[derive(Debug)]
pub struct ChipMeter {
    settings: MeterSettings,
    /// Time of one tooth, in microseconds.
    tooth_us: f64,
    history: VecDeque<Measured>,
    block: Option<u32>,
    cut: Option<RingCut>,
    moves: Vec<MoveChips>,
    last_ratio: Option<f64>,
}

#[derive(Clone, Copy, Debug)]
struct Measured {
    at: Micros,
    position_mm: Vector2<f64>,
    steady: bool,
    /// Time of the tooth that begins here.
    tooth_us: f64,
}

/// An arc of a ring up to a stock line.
#[derive(Clone, Copy, Debug)]
struct RingCut {
    axes: (usize, usize),
    rotation_center_mm: Vector2<f64>,
    /// The circle that cuts.
    cutting: Circle,
    /// The outer and the inner circle.
    circles: [Circle; 2],
    line: StockLine,
    target_mm_per_tooth: f64,
}

impl ChipMeter {
    /// A meter for a tool at a speed.
    pub fn new(settings: MeterSettings) -> Self {
        ChipMeter {
            settings,
            tooth_us: settings.tooth_us(settings.spindle),
            history: VecDeque::new(),
            block: None,
            cut: None,
            moves: Vec::new(),
            last_ratio: None,
        }
    }

    /// Sets the tool in the spindle from here on; the target applies if a rule gives none of its own, mm.
    pub fn set_tool(&mut self, tool: Tool, target_mm_per_tooth: f64) {
        self.settings = MeterSettings { tool, target_mm_per_tooth, ..self.settings };
    }

    /// Sets the speed of the spindle from here on.
    pub fn set_spindle(&mut self, spindle: RevPerMin) {
        self.tooth_us = self.settings.tooth_us(spindle);
    }

    /// Measured chips, move by move.
    pub fn moves(&self) -> &[MoveChips] {
        &self.moves
    }

    /// Chip of the last tooth measured on the move in execution, relative to the target.
    pub fn last_ratio(&self) -> Option<f64> {
        self.last_ratio
    }

    /// Whether a cut rule applies to this block, the last one begun.
    pub fn is_on(&self, block: u32) -> bool {
        self.block == Some(block)
    }

    /// Begins a block; `found` is the cut rule that applies to it, with its index among the rules.
    pub fn begin(&mut self, block: u32, segment: &Segment, found: Option<(usize, &CutRule)>) {
        self.continue_move(block, segment, found);
        let Some((index, _)) = found else { return };
        self.moves.push(MoveChips {
            sequence: segment.sequence,
            rule: index,
            contact: ChipFigures::default(),
            any_contact: ChipFigures::default(),
            thickest: [ChipFigures::default(); 2],
            left_out: ExcludedSamples::default(),
        });
    }

    /// Begins a block that continues the move before, as a further piece of it.
    pub fn continue_move(&mut self, block: u32, segment: &Segment, found: Option<(usize, &CutRule)>) {
        self.end_block();
        let Some((_, rule)) = found else { return };
        self.block = Some(block);
        self.cut = RingCut::new(segment, rule, &self.settings);
    }

    /// Counts a report as left out: the axes are not on the move yet, or the spindle stands still.
    pub fn leave_out(&mut self, sample: &Sample) {
        if !self.is_on(sample.block) {
            self.end_block();
        }
        if let (Some(_), Some(chips)) = (self.cut, self.moves.last_mut()) {
            chips.left_out.not_steady += 1 + self.history.len() as u64;
        }
        self.history.clear();
    }

    /// Processes the machine's report.
    pub fn add_sample(&mut self, sample: &Sample) {
        if !self.tooth_us.is_finite() {
            return self.leave_out(sample);
        }
        if !self.is_on(sample.block) {
            self.end_block();
        }
        let Some(cut) = self.cut else { return };
        let at = sample.at;
        let position_mm = cut.in_plane(&sample.position);
        // The first sample of a block has no speed yet.
        let steady = self.history.back().is_some_and(|last| {
            let speed = (position_mm - last.position_mm).norm() / at.since(last.at).to_s() * S_PER_MIN;
            let commanded = f64::from(sample.commanded.0);
            libm::fabs(speed - commanded) <= STEADY_RATIO * commanded
        });
        self.history.push_back(Measured { at, position_mm, steady, tooth_us: self.tooth_us });
        while let Some(first) = self.history.front().copied() {
            if (at.since(first.at).0 as f64) < first.tooth_us {
                break;
            }
            self.measure(&cut, first);
            self.history.pop_front();
        }
    }

    /// Measures the tooth that began at the oldest sample.
    fn measure(&mut self, cut: &RingCut, first: Measured) {
        let Some(end_mm) = self.position_after_tooth(first) else { return };
        let Some(chips) = self.moves.last_mut() else { return };
        let delta_mm = end_mm - first.position_mm;
        let contact = cut.contact_ratio(&first.position_mm, &delta_mm);
        if let Some(ratio) = contact {
            chips.any_contact.add(ratio);
        }
        // The speed at the oldest sample itself is that of the step before the tooth.
        if !self.history.iter().skip(1).all(|measured| measured.steady) {
            chips.left_out.not_steady += 1;
            return;
        }
        match contact {
            Some(ratio) => {
                chips.contact.add(ratio);
                self.last_ratio = Some(ratio);
            }
            None => chips.left_out.no_contact += 1,
        }
        for (circle, figures) in cut.circles.iter().zip(&mut chips.thickest) {
            if let Some(chip_mm) = circle.thickest_chip_mm(&first.position_mm, &delta_mm, &cut.line) {
                figures.add(chip_mm / cut.target_mm_per_tooth);
            }
        }
    }

    /// The position one tooth after `first`, between two samples. Only differences of time become floats, so that a run
    /// gives the same figures whenever it starts.
    fn position_after_tooth(&self, first: Measured) -> Option<Vector2<f64>> {
        let since_us = |measured: &Measured| measured.at.since(first.at).0 as f64;
        let after = self.history.iter().position(|measured| since_us(measured) >= first.tooth_us)?;
        let (a, b) = (self.history.get(after.checked_sub(1)?)?, self.history.get(after)?);
        let ratio = (first.tooth_us - since_us(a)) / (since_us(b) - since_us(a));
        Some(a.position_mm + (b.position_mm - a.position_mm) * ratio)
    }

    /// The teeth still in the cut at the end of a block.
    fn end_block(&mut self) {
        if let (Some(cut), Some(chips), Some(last)) = (self.cut.take(), self.moves.last_mut(), self.history.back()) {
            chips.left_out.block_end += self.history.len() as u64;
            for first in self.history.iter().filter(|first| first.at != last.at) {
                let teeth = last.at.since(first.at).0 as f64 / first.tooth_us;
                let delta_mm = (last.position_mm - first.position_mm) / teeth;
                if let Some(ratio) = cut.contact_ratio(&first.position_mm, &delta_mm) {
                    chips.any_contact.add(ratio);
                }
            }
        }
        self.block = None;
        self.last_ratio = None;
        self.history.clear();
    }
}

impl MeterSettings {
    /// Time of one tooth, microseconds; infinite at rest.
    fn tooth_us(&self, spindle: RevPerMin) -> f64 {
        let teeth_per_min = f64::from(spindle.0) * f64::from(self.tool.active_teeth());
        S_PER_MIN * US_PER_S as f64 / teeth_per_min
    }
}

impl RingCut {
    fn new(segment: &Segment, rule: &CutRule, settings: &MeterSettings) -> Option<Self> {
        let (Tool::CupMill(mill), Work::Ring(edge, stock)) = (&settings.tool, &rule.work) else { return None };
        let arc = segment.arc()?;
        let (first, second, _) = arc.plane.axes();
        let circle =
            |edge: Edge| Circle { radius_mm: mill.radius(edge).to_mm(), advance_ratio: f64::from(edge.advance()) };
        Some(RingCut {
            axes: (first, second),
            rotation_center_mm: Vector2::from(arc.center.map(Nm::to_mm)),
            cutting: circle(*edge),
            circles: [circle(Edge::Outer), circle(Edge::Inner)],
            line: stock.line()?.at_height(segment.height().to_mm()),
            target_mm_per_tooth: rule.feed_per_tooth.map_or(settings.target_mm_per_tooth, |feed| f64::from(feed.0)),
        })
    }

    /// Chip at the contact of a tooth that moves by `delta_mm`, relative to the target.
    fn contact_ratio(&self, position_mm: &Vector2<f64>, delta_mm: &Vector2<f64>) -> Option<f64> {
        let chip_mm = self.cutting.contact_chip_mm(position_mm, &self.rotation_center_mm, delta_mm, &self.line);
        Some(chip_mm? / self.target_mm_per_tooth)
    }

    fn in_plane(&self, position: &Pose) -> Vector2<f64> {
        let (first, second) = self.axes;
        Vector2::new(position.linear[first].to_mm(), position.linear[second].to_mm())
    }
}
