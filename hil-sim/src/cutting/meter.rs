//! The chip-load meter: chips of every tooth, from the machine's actual positions.
//!
//! A sample counts if the machine ran within 0.5 % of the commanded feed through the whole of its tooth's cut, within
//! one block, and the cutting circle had an admissible contact. All others are counted by cause.

use std::collections::VecDeque;

use arcfeed_shared::cut::CutRule;
use arcfeed_shared::nc::modal::Pose;
use arcfeed_shared::report::{ChipFigures, LeftOut};
use arcfeed_shared::segment::{Arc, Segment};
use arcfeed_shared::telemetry::Sample;
use arcfeed_shared::tool::{CupMill, Edge};
use arcfeed_shared::units::{Micros, Nm, RevPerMin, S_PER_MIN, US_PER_S};
use nalgebra::Vector2;

use super::chip::Circle;

/// Largest deviation from the commanded feed that counts as steady.
pub const STEADY_RATIO: f64 = 5e-3;

/// What the meter needs to know about the tool; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeterSettings {
    /// The true tool.
    pub tool: CupMill,
    /// Spindle speed.
    pub spindle: RevPerMin,
    /// Target chip on the circumference, mm.
    pub target_mm_per_tooth: f64,
}

/// Chips of one arc.
#[derive(Clone, Debug, PartialEq)]
pub struct ArcChips {
    /// `N` of its block.
    pub sequence: Option<i64>,
    /// Which of the job's cut rules speaks of it.
    pub rule: usize,
    /// Chip at the contact relative to the target.
    pub contact: ChipFigures,
    /// Thickest chip relative to the target, anywhere inside the rule's half plane: outer and inner circle.
    pub thickest: [ChipFigures; 2],
    /// Samples that do not count.
    pub left_out: LeftOut,
}

/// The meter's state.
#[derive(Debug)]
pub struct ChipMeter {
    settings: MeterSettings,
    /// Time of one tooth, in microseconds.
    tooth_us: f64,
    history: VecDeque<Measured>,
    cut: Option<Cut>,
    arcs: Vec<ArcChips>,
}

#[derive(Clone, Copy, Debug)]
struct Measured {
    at: Micros,
    position_mm: Vector2<f64>,
    steady: bool,
}

#[derive(Clone, Copy, Debug)]
struct Cut {
    block: u32,
    axes: (usize, usize),
    rotation_center_mm: Vector2<f64>,
    rule: CutRule,
}

impl ChipMeter {
    /// A meter for a tool at a speed.
    pub fn new(settings: MeterSettings) -> Self {
        let teeth_per_min = f64::from(settings.spindle.0) * f64::from(settings.tool.active_teeth);
        ChipMeter {
            settings,
            tooth_us: S_PER_MIN * US_PER_S as f64 / teeth_per_min,
            history: VecDeque::new(),
            cut: None,
            arcs: Vec::new(),
        }
    }

    /// What was measured, arc by arc.
    pub fn arcs(&self) -> &[ArcChips] {
        &self.arcs
    }

    /// Whether it is on an arc of this block.
    pub fn is_on(&self, block: u32) -> bool {
        self.cut.is_some_and(|cut| cut.block == block)
    }

    /// A block begins; `rule` with its index if a cut rule speaks of it.
    pub fn begin(&mut self, block: u32, segment: &Segment, rule: Option<(usize, &CutRule)>) {
        self.end_block();
        if let (Some(arc), Some((index, rule))) = (segment.arc(), rule) {
            self.cut = Some(Cut::new(block, arc, rule));
            self.arcs.push(ArcChips {
                sequence: segment.sequence,
                rule: index,
                contact: ChipFigures::default(),
                thickest: [ChipFigures::default(); 2],
                left_out: LeftOut::default(),
            });
        }
    }

    /// Takes the machine's report.
    pub fn take(&mut self, sample: &Sample) {
        let Some(cut) = self.cut.filter(|cut| cut.block == sample.block) else {
            self.end_block();
            return;
        };
        let at = sample.at;
        let position_mm = cut.in_plane(&sample.position);
        // The first sample of a block has no speed yet.
        let steady = self.history.back().is_some_and(|last| {
            let speed = (position_mm - last.position_mm).norm() / at.since(last.at).to_s() * S_PER_MIN;
            let commanded = f64::from(sample.commanded.0);
            libm::fabs(speed - commanded) <= STEADY_RATIO * commanded
        });
        self.history.push_back(Measured { at, position_mm, steady });
        while let Some(first) = self.history.front().copied() {
            if (at.since(first.at).0 as f64) < self.tooth_us {
                break;
            }
            self.measure(&cut, first);
            self.history.pop_front();
        }
    }

    /// Measures the tooth that began at the oldest sample.
    fn measure(&mut self, cut: &Cut, first: Measured) {
        let Some(end_mm) = self.position_after_tooth(first.at) else { return };
        let Some(arc) = self.arcs.last_mut() else { return };
        // The speed at the oldest sample itself is that of the step before the tooth.
        if !self.history.iter().skip(1).all(|measured| measured.steady) {
            arc.left_out.not_steady += 1;
            return;
        }
        let delta_mm = end_mm - first.position_mm;
        let circle = |edge: Edge| Circle {
            radius_mm: self.settings.tool.radius(edge).to_mm(),
            advance_ratio: f64::from(edge.advance()),
        };
        let stock = &cut.rule.stock;
        let target = self.settings.target_mm_per_tooth;
        let contact =
            circle(cut.rule.edge).contact_chip_mm(&first.position_mm, &cut.rotation_center_mm, &delta_mm, stock);
        match contact {
            Some(chip_mm) => arc.contact.add(chip_mm / target),
            None => arc.left_out.no_contact += 1,
        }
        for (edge, figures) in [Edge::Outer, Edge::Inner].into_iter().zip(&mut arc.thickest) {
            if let Some(chip_mm) = circle(edge).thickest_chip_mm(&first.position_mm, &delta_mm, stock) {
                figures.add(chip_mm / target);
            }
        }
    }

    /// The position one tooth after `start`, between two samples. Only differences of time become floats, so that a run
    /// gives the same figures whenever it starts.
    fn position_after_tooth(&self, start: Micros) -> Option<Vector2<f64>> {
        let since_us = |measured: &Measured| measured.at.since(start).0 as f64;
        let after = self.history.iter().position(|measured| since_us(measured) >= self.tooth_us)?;
        let (a, b) = (self.history.get(after.checked_sub(1)?)?, self.history.get(after)?);
        let ratio = (self.tooth_us - since_us(a)) / (since_us(b) - since_us(a));
        Some(a.position_mm + (b.position_mm - a.position_mm) * ratio)
    }

    /// The teeth still in the cut at the end of a block do not count.
    fn end_block(&mut self) {
        if let (Some(_), Some(arc)) = (self.cut.take(), self.arcs.last_mut()) {
            arc.left_out.block_end += self.history.len() as u64;
        }
        self.history.clear();
    }
}

impl Cut {
    fn new(block: u32, arc: &Arc, rule: &CutRule) -> Self {
        let (first, second, _) = arc.plane.axes();
        Cut { block, axes: (first, second), rotation_center_mm: Vector2::from(arc.center.map(Nm::to_mm)), rule: *rule }
    }

    fn in_plane(&self, position: &Pose) -> Vector2<f64> {
        let (first, second) = self.axes;
        Vector2::new(position.linear[first].to_mm(), position.linear[second].to_mm())
    }
}
