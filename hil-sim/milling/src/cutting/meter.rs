//! The chip-load meter: measures the quantity of every governed move from the machine's actual positions.
//!
//! [`MeasuredMove`] says what is measured on a move: the chip of a cup mill at its contact, the feed per tooth of an end
//! mill at its contour, or the thickest chip. The meter works in the plane of the arc, G17 or another (on a line: in the
//! plane perpendicular to the tool's axis); on a helix it measures across that axis.
//!
//! A sample is steady if the machine ran within 0.5 % of the commanded feed during the whole cut of its tooth, within
//! one block. Figures of the law's error use steady samples with an admissible contact; all others are counted by
//! cause. Largest chips use all samples with a contact. A tooth that is still in the cut when its block ends
//! counts with the mean feed that it had. The spindle's speed at a tooth's beginning sets the tooth's time.

use std::collections::VecDeque;

use arcfeed_model::job::ToolSetup;
use arcfeed_model::report::{ChipFigures, ExcludedSamples};
use arcfeed_model::telemetry::Sample;
use arcfeed_nc::segment::Segment;
use arcfeed_units::{Micros, RevPerMin, S_PER_MIN, US_PER_S};
use nalgebra::Vector2;

use super::measured_move::{GoverningRule, MeasuredMove};

/// Largest relative deviation of the actual speed from the commanded feed at which a sample counts as steady.
pub const STEADY_RATIO: f64 = 5e-3;

/// Measured chip loads of one move under a cut rule, as statistics over its samples.
#[derive(Clone, Debug, PartialEq)]
pub struct MoveChips {
    /// Number of the move's first block: count of executed blocks up to and including it.
    pub block: u32,
    /// `N` number of the block; `None` without one.
    pub sequence: Option<i64>,
    /// Index of the cut rule in the job's list.
    pub rule: usize,
    /// Measured quantity divided by the target, steady samples only.
    pub contact: ChipFigures,
    /// Measured quantity divided by the target, all samples with a contact.
    pub any_contact: ChipFigures,
    /// Thickest chip of a ring's outer and inner circle anywhere inside the half plane of its rule, divided by the target; steady
    /// samples only.
    pub thickest: [ChipFigures; 2],
    /// Numbers of samples that `contact` does not include, by cause.
    pub left_out: ExcludedSamples,
}

/// Measured chip load of one tooth, over one tooth period (60 s divided by spindle speed and number of teeth).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredChip {
    /// Measured quantity divided by the target.
    pub chip_ratio: f64,
    /// Whether the machine ran at the commanded feed during the whole cut of the tooth.
    pub is_steady: bool,
}

/// Chip meter: measures the chip load of every move under a cut rule from the positions that the machine reports.
#[derive(Debug)]
pub struct ChipMeter {
    /// Teeth of the tool in the spindle.
    teeth: u16,
    /// Time of one tooth, in microseconds.
    tooth_us: f64,
    history: VecDeque<Measured>,
    /// Last sample that was not steady.
    unsteady: Option<Micros>,
    block: Option<u32>,
    cut: Option<MeasuredMove>,
    moves: Vec<MoveChips>,
    last_ratio: Option<f64>,
    /// Tooth that the last report completed.
    latest: Option<MeasuredChip>,
}

#[derive(Clone, Copy, Debug)]
struct Measured {
    at: Micros,
    position_mm: Vector2<f64>,
    /// Time of the tooth that begins here.
    tooth_us: f64,
}

impl ChipMeter {
    /// Chip meter for a tool and the spindle speed of its setup.
    pub fn new(setup: &ToolSetup) -> Self {
        let teeth = setup.tool.active_teeth();
        ChipMeter {
            teeth,
            tooth_us: tooth_us(teeth, setup.spindle),
            history: VecDeque::new(),
            unsteady: None,
            block: None,
            cut: None,
            moves: Vec::new(),
            last_ratio: None,
            latest: None,
        }
    }

    /// Sets the speed of the spindle from here on.
    pub fn set_spindle(&mut self, spindle: RevPerMin) {
        self.tooth_us = tooth_us(self.teeth, spindle);
    }

    /// Measured chip loads of all moves under a cut rule so far, in the order of execution.
    pub fn moves(&self) -> &[MoveChips] {
        &self.moves
    }

    /// Measured quantity divided by the target, of the last tooth measured on the present move, steady or not; `None` before the first.
    pub fn last_ratio(&self) -> Option<f64> {
        self.last_ratio
    }

    /// Measured chip load of the tooth that the last report completed; the last such tooth if there were several. `None` if
    /// the report completed no tooth, or that tooth had no contact.
    pub fn latest(&self) -> Option<MeasuredChip> {
        self.latest
    }

    /// Target of the present move, mm per tooth; `None` if nothing is measured on it.
    pub fn target_mm_per_tooth(&self) -> Option<f64> {
        self.cut.as_ref().map(MeasuredMove::target_mm_per_tooth)
    }

    /// Whether `block` is the block begun last and a cut rule applies to it.
    pub fn is_on(&self, block: u32) -> bool {
        self.block == Some(block)
    }

    /// Begins a block with a new move; `governing` is the cut rule that applies to it, if any.
    pub fn begin(&mut self, block: u32, segment: &Segment, governing: Option<&GoverningRule<'_>>) {
        self.begin_block(block, segment, governing);
        let Some(governing) = governing else { return };
        self.moves.push(MoveChips {
            block,
            sequence: segment.sequence,
            rule: governing.index,
            contact: ChipFigures::default(),
            any_contact: ChipFigures::default(),
            thickest: [ChipFigures::default(); 2],
            left_out: ExcludedSamples::default(),
        });
    }

    /// Begins a block that is a further piece of the move before. If engaged arcs describe its stock, they count from the beginning
    /// of the whole move; therefore such a piece is not measured.
    pub fn continue_move(&mut self, block: u32, segment: &Segment, governing: Option<&GoverningRule<'_>>) {
        self.begin_block(block, segment, governing);
        self.cut = self.cut.take().filter(|cut| !cut.counts_from_start());
    }

    fn begin_block(&mut self, block: u32, segment: &Segment, governing: Option<&GoverningRule<'_>>) {
        self.end_block();
        let Some(governing) = governing else { return };
        self.block = Some(block);
        self.teeth = governing.setup.tool.active_teeth();
        self.cut = MeasuredMove::new(segment, governing);
    }

    /// Processes a report that must not be measured, because the axes are not on the move yet or the spindle stands still: counts it, and
    /// the unfinished teeth before it, among the samples left out.
    pub fn leave_out(&mut self, sample: &Sample) {
        self.latest = None;
        if !self.is_on(sample.block) {
            self.end_block();
        }
        if let (Some(_), Some(chips)) = (&self.cut, self.moves.last_mut()) {
            chips.left_out.not_steady += 1 + self.history.len() as u64;
        }
        self.history.clear();
    }

    /// Processes one report of the machine, and measures the teeth that it completes.
    pub fn add_sample(&mut self, sample: &Sample) {
        self.latest = None;
        if !self.tooth_us.is_finite() {
            return self.leave_out(sample);
        }
        if !self.is_on(sample.block) {
            self.end_block();
        }
        let Some(cut) = &self.cut else { return };
        let at = sample.at;
        let position_mm = cut.in_plane(&sample.position);
        // The first sample of a block has no speed yet.
        let is_steady = self.history.back().is_some_and(|last| {
            let speed = (position_mm - last.position_mm).norm() / at.since(last.at).to_s() * S_PER_MIN;
            let commanded = f64::from(sample.commanded.0);
            libm::fabs(speed - commanded) <= STEADY_RATIO * commanded
        });
        if !is_steady {
            self.unsteady = Some(at);
        }
        self.history.push_back(Measured { at, position_mm, tooth_us: self.tooth_us });
        while let Some(first) = self.history.front().copied() {
            if (at.since(first.at).0 as f64) < first.tooth_us {
                break;
            }
            self.measure(first);
            self.history.pop_front();
        }
    }

    /// Measures the tooth that began at the oldest sample.
    fn measure(&mut self, first: Measured) {
        let Some(end_mm) = self.position_after_tooth(first) else { return };
        let (Some(cut), Some(chips)) = (&self.cut, self.moves.last_mut()) else { return };
        let delta_mm = end_mm - first.position_mm;
        let contact = cut.ratio(&first.position_mm, &delta_mm);
        if let Some(ratio) = contact {
            chips.any_contact.add(ratio);
            self.last_ratio = Some(ratio);
        }
        // The speed at the oldest sample itself is that of the step before the tooth.
        let is_steady = self.unsteady.is_none_or(|at| at <= first.at);
        self.latest = contact.map(|chip_ratio| MeasuredChip { chip_ratio, is_steady });
        if !is_steady {
            chips.left_out.not_steady += 1;
            return;
        }
        match contact {
            Some(ratio) => chips.contact.add(ratio),
            None => chips.left_out.no_contact += 1,
        }
        let thickest = cut.thickest_of_ring(&first.position_mm, &delta_mm);
        for (ratio, figures) in thickest.into_iter().zip(&mut chips.thickest) {
            if let Some(ratio) = ratio {
                figures.add(ratio);
            }
        }
    }

    /// The position one tooth after `first`, between two samples. Only differences of time become floats, so that a run
    /// gives the same figures whenever it starts.
    fn position_after_tooth(&self, first: Measured) -> Option<Vector2<f64>> {
        let since_us = |measured: &Measured| measured.at.since(first.at).0 as f64;
        let after = self.history.partition_point(|measured| since_us(measured) < first.tooth_us);
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
                if let Some(ratio) = cut.ratio(&first.position_mm, &delta_mm) {
                    chips.any_contact.add(ratio);
                }
            }
        }
        self.block = None;
        self.last_ratio = None;
        self.history.clear();
    }
}

/// Time of one tooth, microseconds; infinite at rest.
fn tooth_us(teeth: u16, spindle: RevPerMin) -> f64 {
    S_PER_MIN * US_PER_S as f64 / (f64::from(spindle.0) * f64::from(teeth))
}
