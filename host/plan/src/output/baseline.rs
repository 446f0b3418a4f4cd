//! Time of a slot on the planned path, and by the usual method: flank milling with a ball-end mill.
//!
//! The planned path's time is its length over the feed, movement by movement, at the feeds of the program. The baseline
//! is figure 6.8 of the source, whose text has the conditions only (3.5 in/min, 1000 rev/min, three teeth; no times):
//! passes along the slot, side by side, level by level,
//!
//! ```text
//! levels = ceil(depth / axial_depth)                                         (1)
//! passes = 1 + ceil(max(width - diameter, 0) / stepover), on each level      (2)
//! time   = sum(passes (length + diameter)) / feed                            (3)
//! ```
//!
//! Assumed: (2) both walls stay as a ball of the given diameter leaves them, and a ball cannot pass a slot narrower
//! than its diameter; (3) every pass runs in by half a diameter and out by as much, and the return paths between the
//! passes are at rapid and take no time. Both favour the baseline.

use thiserror::Error;

use crate::geometry::blisk::{Blisk, Slot};
use crate::geometry::face::Face;
use crate::path::{Purpose, SlotPath};
use crate::vector::Point;

/// Places along a slot's side on which its widths are measured, and depths.
const WIDTH_PLACES: u32 = 40;
const WIDTH_DEPTHS: u32 = 8;

/// Conditions of the usual method, flank milling with a ball-end mill, with which the planned path is compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlankMilling {
    /// Diameter of the ball.
    pub diameter_mm: f64,
    /// Feed along the passes.
    pub feed_mm_per_min: f64,
    /// Largest axial depth of cut, from level to level.
    pub axial_depth_mm: f64,
    /// Largest distance between neighbouring passes.
    pub stepover_mm: f64,
}

/// Size of a slot, as seen along the tool.
#[derive(Clone, Debug, PartialEq)]
pub struct SlotSize {
    /// Depth from the blank's rim to the hub with its allowance.
    pub depth_mm: f64,
    /// Length of the slot, from face to face.
    pub length_mm: f64,
    /// Widths between both blades with their allowances, at evenly spaced depths from the rim to the hub; each the narrowest there.
    pub widths_mm: Vec<f64>,
}

/// Numbers of levels and passes that the usual method needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Passes {
    /// Number of levels (1).
    pub levels: usize,
    /// Number of passes on all levels together (2).
    pub passes: usize,
}

/// Time to mill one slot, and the removal rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlotTime {
    /// Cutting time.
    pub cutting_min: f64,
    /// Removal rate: removed volume divided by the cutting time, mm3/min.
    pub rate_mm3_per_min: f64,
}

/// Time of the planned path in one slot.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedTime {
    /// Length, feed and time for each purpose of the path's steps.
    pub parts: Vec<PartTime>,
    /// Total time.
    pub slot: SlotTime,
}

/// All steps of the path that have one purpose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartTime {
    /// Purpose of these steps.
    pub purpose: Purpose,
    /// Length of the centre's path, mm.
    pub length_mm: f64,
    /// Feed, mm/min.
    pub feed_mm_per_min: f64,
    /// Time: length divided by feed, min.
    pub time_min: f64,
}

/// Reason why the usual method cannot be computed for a slot.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum BaselineError {
    /// The mill is wider than the slot.
    #[error(
        "a ball of {diameter_mm:.2} mm does not pass the slot, {width_mm:.2} mm wide at {depth_mm:.1} mm: give [baseline] a smaller diameter"
    )]
    Narrow {
        /// Diameter of the mill.
        diameter_mm: f64,
        /// Smallest width of the slot.
        width_mm: f64,
        /// Depth below the rim at which it is narrowest.
        depth_mm: f64,
    },
    /// A number is not finite or not positive.
    #[error(
        "diameter, feed, axial depth and stepover of the baseline, and the slot's depth and length, must be positive numbers"
    )]
    NotPositive,
}

impl FlankMilling {
    /// Numbers of levels and passes for a slot.
    ///
    /// # Errors
    /// The mill is wider than the slot, or a number is not finite or not positive.
    pub fn passes(&self, slot: &SlotSize) -> Result<Passes, BaselineError> {
        let numbers = [self.diameter_mm, self.feed_mm_per_min, self.axial_depth_mm, self.stepover_mm];
        let is_positive = |number: f64| number > 0.0 && number.is_finite();
        if !numbers.into_iter().chain([slot.depth_mm, slot.length_mm]).all(is_positive) || slot.widths_mm.is_empty() {
            return Err(BaselineError::NotPositive);
        }
        let narrowest = slot.widths_mm.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
        if let Some((at, width_mm)) = narrowest.filter(|(_, width_mm)| **width_mm < self.diameter_mm) {
            let depth_mm = slot.depth_mm * at as f64 / (slot.widths_mm.len() - 1).max(1) as f64;
            return Err(BaselineError::Narrow { diameter_mm: self.diameter_mm, width_mm: *width_mm, depth_mm });
        }
        let levels = whole(slot.depth_mm / self.axial_depth_mm); // (1)
        let passes = |level: usize| {
            // Each level clears down to its lower end; the wider end of it decides.
            let [top_mm, bottom_mm] = [level, level + 1].map(|end| slot.width_mm(end as f64 / levels as f64));
            1 + whole((top_mm.max(bottom_mm) - self.diameter_mm) / self.stepover_mm) // (2)
        };
        Ok(Passes { levels, passes: (0..levels).map(passes).sum() })
    }

    /// Time to mill a slot from which `volume_mm3` is to be removed.
    ///
    /// # Errors
    /// See [`FlankMilling::passes`].
    pub fn time(&self, slot: &SlotSize, volume_mm3: f64) -> Result<SlotTime, BaselineError> {
        let Passes { passes, .. } = self.passes(slot)?;
        let cutting_min = passes as f64 * (slot.length_mm + self.diameter_mm) / self.feed_mm_per_min; // (3)
        Ok(SlotTime { cutting_min, rate_mm3_per_min: volume_mm3 / cutting_min })
    }
}

impl SlotSize {
    /// Size of the slot inside its allowances, from the nearest points of both sides at each height.
    pub fn of(slot: &Slot, blisk: &Blisk, allowance_mm: f64) -> Self {
        let places = |face: &Face, v: f64| -> Vec<Point> {
            (0..=WIDTH_PLACES).map(|k| face.point(f64::from(k) / f64::from(WIDTH_PLACES), v)).collect()
        };
        let width_mm = |depth: u32| {
            let v = 1.0 - f64::from(depth) / f64::from(WIDTH_DEPTHS);
            let (pressure, suction) = (places(&slot.pressure, v), places(&slot.suction, v));
            let gaps = pressure.iter().flat_map(|p| suction.iter().map(move |s| (s - p).norm()));
            gaps.fold(f64::INFINITY, f64::min) - 2.0 * allowance_mm
        };
        let [from, to] = [0.0, 1.0].map(|u| slot.pressure.point(u, 0.5));
        let [low_mm, high_mm] = blisk.blank.faces_mm;
        let along_ratio = (to - from).norm() / (to.z - from.z).abs();
        let middle = slot.pressure.point(0.5, 0.5);
        SlotSize {
            depth_mm: blisk.blank.radius_mm - blisk.hub.radius_mm(middle.z) - allowance_mm,
            length_mm: (high_mm - low_mm) * along_ratio,
            widths_mm: (0..=WIDTH_DEPTHS).map(width_mm).collect(),
        }
    }

    /// Width at a fraction of the depth, interpolated linearly.
    fn width_mm(&self, part: f64) -> f64 {
        let last = self.widths_mm.len() - 1;
        let place = part.clamp(0.0, 1.0) * last as f64;
        let index = (place as usize).min(last.saturating_sub(1));
        let next = self.widths_mm[(index + 1).min(last)];
        self.widths_mm[index] + (next - self.widths_mm[index]) * (place - index as f64)
    }
}

/// Time of one slot on the planned path; `feed_mm_per_min` gives the feed of each purpose. Indexing is not included.
pub fn planned_time(path: &SlotPath, feed_mm_per_min: impl Fn(Purpose) -> f64, volume_mm3: f64) -> PlannedTime {
    let steps = path.steps();
    let mut purposes: Vec<Purpose> = steps.iter().map(|step| step.purpose).collect();
    purposes.sort_unstable();
    purposes.dedup();
    let part = |purpose: Purpose| {
        let length_mm: f64 = steps.iter().filter(|step| step.purpose == purpose).map(|step| step.length_mm()).sum();
        let feed_mm_per_min = feed_mm_per_min(purpose);
        PartTime { purpose, length_mm, feed_mm_per_min, time_min: length_mm / feed_mm_per_min }
    };
    let parts: Vec<PartTime> = purposes.into_iter().map(part).collect();
    let cutting_min: f64 = parts.iter().map(|part| part.time_min).sum();
    PlannedTime { parts, slot: SlotTime { cutting_min, rate_mm3_per_min: volume_mm3 / cutting_min } }
}

/// Next whole number, ignoring the rounding error of a division.
fn whole(ratio: f64) -> usize {
    libm::ceil((ratio - 1e-9).max(0.0)) as usize
}

#[cfg(test)]
mod tests {
    use arcfeed_nc::modal::Turn;

    use super::*;
    use crate::path::Level;
    use crate::vector::Flat;

    const MILL: FlankMilling =
        FlankMilling { diameter_mm: 10.0, feed_mm_per_min: 100.0, axial_depth_mm: 2.5, stepover_mm: 4.0 };

    fn slot(widths_mm: &[f64]) -> SlotSize {
        SlotSize { depth_mm: 10.0, length_mm: 40.0, widths_mm: widths_mm.to_vec() }
    }

    #[test]
    fn a_slot_as_wide_as_the_ball_is_one_pass_a_level() {
        assert_eq!(MILL.passes(&slot(&[10.0, 10.0])), Ok(Passes { levels: 4, passes: 4 }));
        let time = MILL.time(&slot(&[10.0]), 8_000.0).unwrap();
        assert!((time.cutting_min - 2.0).abs() < 1e-12 && (time.rate_mm3_per_min - 4_000.0).abs() < 1e-9);
    }

    #[test]
    fn a_slot_that_narrows_takes_fewer_passes_further_down() {
        // Tops at 18, 16, 14, 12: 8, 6, 4, 2 mm beside the ball.
        assert_eq!(MILL.passes(&slot(&[18.0, 10.0])), Ok(Passes { levels: 4, passes: 3 + 3 + 2 + 2 }));
    }

    #[test]
    fn a_ball_that_does_not_pass_is_reported_where() {
        let error = MILL.passes(&slot(&[12.0, 9.5, 11.0])).unwrap_err();
        assert_eq!(error, BaselineError::Narrow { diameter_mm: 10.0, width_mm: 9.5, depth_mm: 5.0 });
        let still = FlankMilling { feed_mm_per_min: 0.0, ..MILL };
        assert_eq!(still.passes(&slot(&[12.0])), Err(BaselineError::NotPositive));
    }

    #[test]
    fn a_path_takes_its_lengths_over_its_feeds() {
        let level =
            |height_mm| Level { height_mm, exterior_end: Flat::new(0.0, -20.0), interior_end: Flat::new(10.0, 10.0) };
        let path = SlotPath {
            exterior: Flat::new(0.0, -10.0),
            interior: Flat::new(0.0, 10.0),
            base: Flat::new(0.0, 0.0),
            outward: Turn::Ccw,
            levels: vec![level(-1.0)],
            clear_mm: 4.0,
            contact_mm: 0.0,
        };
        let time = planned_time(&path, |purpose| if purpose.movement().is_some() { 10.0 } else { 5.0 }, 100.0);
        // 5 mm down, a quarter of a circle of 10 mm there and back, 5 mm up.
        let arcs_mm = 10.0 * std::f64::consts::PI;
        let wanted_min = 10.0 / 5.0 + arcs_mm / 10.0;
        assert!((time.slot.cutting_min - wanted_min).abs() < 1e-12, "{time:?}");
        let lengths_mm: f64 = time.parts.iter().map(|part| part.length_mm).sum();
        assert!((lengths_mm - 10.0 - arcs_mm).abs() < 1e-12);
    }
}
