//! Blocks of canned cycles.
//!
//! R, Z, Q and P are modal until G80 or a G code of group 01; K (L in the older format) applies to its block only. A
//! block without an axis word or R drills nothing. Under G91 R is relative to the initial level, Z to R, and X and Y
//! to the previous hole. Source: B-63534EN, 13.1.

use super::address::whole;
use super::alarm::{Alarm, Fault, NotModelled};
use super::block::Block;
use super::modal::{Cycle, Feed, Modal, Pose};
use super::moves::Target;
use super::series::{Drill, HoleCircle, Levels, Series};
use super::settings::{Decimals, Settings};
use arcfeed_units::{MicroDeg, Micros, Nm, US_PER_MS};

/// Maximum number of repeats of a cycle.
const REPEATS_MAX: i64 = 9_999;

impl Modal {
    /// The series of moves of a cycle's block; the position advances to its end.
    pub(super) fn drill(
        &mut self,
        mut cycle: Cycle,
        block: &Block,
        settings: &Settings,
        feed: Feed,
    ) -> Result<Option<Series>, Fault> {
        let (first, second, normal) = self.plane.axes();
        let depth_axis = b'X' + normal as u8;
        let initial =
            Nm(cycle.initial.0.saturating_sub(self.frame.shift().linear.get(normal).map_or(0, |axis| axis.0)));
        let length = |letter| block.word(letter).map(|word| self.length(word.number, settings.decimals));
        let relative = |from: Nm, value: i64| Nm(if self.absolute { value } else { from.0.saturating_add(value) });
        cycle.r = length(b'R').map(|value| relative(initial, value)).or(cycle.r);
        let r = cycle.r.unwrap_or(initial);
        cycle.bottom = length(depth_axis).map(|value| relative(r, value)).or(cycle.bottom);
        cycle.q = length(b'Q').map_or(cycle.q, |value| Nm(value.saturating_abs()));
        if let Some((ms, _)) = whole(block, b'P') {
            cycle.dwell = Micros(ms.unsigned_abs().saturating_mul(US_PER_MS));
        }
        self.cycle = Some(cycle);
        let mut target = self.target(block, settings.decimals);
        if target.named == 0 && block.word(b'R').is_none() {
            return Ok(None);
        }
        self.check_move(&target)?;
        if matches!(cycle.code, 73 | 83) && cycle.q == Nm(0) {
            return Err(Fault::alarm(Alarm::NoPeck, 0));
        }
        let (holes, column) = whole(block, b'K').or(whole(block, b'L')).unwrap_or((1, 0));
        if holes > REPEATS_MAX {
            return Err(Fault::alarm(Alarm::TooManyDigits, column));
        }
        self.check_series(holes, block)?;
        let circle = self.resolve_holes(block, &mut target, holes, settings.decimals);
        let mut above = target.end;
        if let (Some(level), Some(here)) = (above.linear.get_mut(normal), self.program.linear.get(normal)) {
            *level = *here;
        }
        let step = if self.absolute { Pose::ORIGIN } else { above.minus(self.program) };
        let bottom = cycle.bottom.unwrap_or(r);
        let clearance = if cycle.code == 83 { settings.peck_clearance } else { settings.peck_return };
        let drill = Drill {
            code: cycle.code,
            plane: self.plane,
            frame: self.frame,
            start: self.program,
            first: above,
            step,
            circle,
            holes: u32::try_from(holes).unwrap_or(0),
            levels: Levels { initial, r, bottom },
            returns_to_r: self.returns_to_r,
            q: cycle.q,
            clearance: Nm(clearance.0.min(cycle.q.0)),
            dwell: cycle.dwell,
            feed,
        };
        if drill.holes == 0 {
            return Ok(None);
        }
        let in_plane = (1_u8 << first) | (1_u8 << second);
        self.rotation_pending &= target.named & in_plane != in_plane;
        self.program = drill.end();
        self.position = self.frame.to_path(self.program);
        Ok(Some(Series::Drill(drill)))
    }

    /// Resolves polar coordinates, and returns the circle of holes that repeat an angle under G91; the last hole's angle counts
    /// from here on.
    fn resolve_holes(
        &mut self,
        block: &Block,
        target: &mut Target,
        holes: i64,
        decimals: Decimals,
    ) -> Option<HoleCircle> {
        let start = self.polar?;
        self.resolve_polar(block, target, decimals);
        let (absolute, polar) = (self.absolute, self.polar.as_mut()?);
        let first = *polar;
        if absolute || holes == 1 {
            return None;
        }
        let step = MicroDeg(first.angle.0.saturating_sub(start.angle.0));
        polar.angle.0 = first.angle.0.saturating_add(step.0.saturating_mul(holes.saturating_sub(1)));
        Some(HoleCircle { first, step })
    }

    /// Rejects cycles that are not modelled: repeated steps by a radius, and holes across a rotated plane, along a
    /// scaled axis or with a scaled shift.
    fn check_series(&self, holes: i64, block: &Block) -> Result<(), Fault> {
        let refuse = |code| Err(Fault::not_modelled(NotModelled::MoveUnder(code), 0));
        let (radius, _, normal) = self.plane.axes();
        // Each hole would be the pole of the next one.
        if self.polar.is_some() && !self.absolute && holes > 1 && block.word(b'X' + radius as u8).is_some() {
            return refuse(160);
        }
        let shifts = self.cycle.is_some_and(|cycle| matches!(cycle.code, 76 | 87));
        self.reject_under_scaling(Some(normal).filter(|_| !shifts))?;
        match self.frame.rotation() {
            Some(rotation) if rotation.plane != self.plane => refuse(680),
            _ => Ok(()),
        }
    }
}
