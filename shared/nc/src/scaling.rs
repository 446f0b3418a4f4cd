//! Scaling and mirroring in the modal state: G50, G51, G50.1, G51.1.

use super::alarm::{Fault, NotModelled};
use super::axis_scaling::{AxisScaling, WHOLE, scaled_coordinate};
use super::block::Block;
use super::frame::CoordinateFrame;
use super::modal::{Modal, Pose, Turn};
use super::settings::Settings;
use arcfeed_units::Nm;

/// Largest magnification, in thousandths.
const LARGEST: i32 = 999_999;
/// X, Y, Z with the letters of their magnifications.
const AXES: [(u8, u8); 3] = [(b'X', b'I'), (b'Y', b'J'), (b'Z', b'K')];

impl Modal {
    fn set_scaling(&mut self, scaling: Option<AxisScaling>) {
        if self.frame.scaling() != scaling.as_ref() {
            self.frame = CoordinateFrame::new(self.frame.shift(), scaling, self.frame.rotation().copied());
            self.program = self.frame.to_program(self.position);
        }
    }

    /// Cancels G51 (G50) or all of G51.1 (G50.1 without an axis).
    pub(super) fn end_scaling(&mut self, code: u16) {
        if self.frame.scaling().is_some_and(|scaling| scaling.code == code) {
            self.set_scaling(None);
        }
    }

    /// G51: scaling about the given point, or about the tool's position, with P for all axes or I, J and K for each.
    pub(super) fn start_scaling(&mut self, block: &Block, settings: &Settings) -> Result<(), Fault> {
        self.check_scaling_allowed(510)?;
        let given = self.given(block, settings);
        let thousandths = |letter| {
            block.word(letter).map(|word| {
                let whole = word.number.as_whole().and_then(|whole| i32::try_from(whole).ok());
                (whole.unwrap_or(0), word.column)
            })
        };
        let all = thousandths(b'P');
        let own = AXES.map(|(_, letter)| thousandths(letter));
        if all.is_none() && own.iter().all(Option::is_none) {
            // Without a magnification in the block, a parameter of the control gives it.
            return Err(Fault::not_modelled(NotModelled::GCode(510), 0));
        }
        let mut scaling = AxisScaling { code: 510, center: given.linear, thousandths: [WHOLE; 3] };
        for (by, found) in scaling.thousandths.iter_mut().zip(own.map(|own| own.or(all))) {
            let (thousandths, column) = found.unwrap_or((WHOLE, 0));
            if thousandths == 0 || !(-LARGEST..=LARGEST).contains(&thousandths) {
                return Err(Fault::not_modelled(NotModelled::GCode(510), column));
            }
            *by = thousandths;
        }
        self.set_scaling(Some(scaling));
        Ok(())
    }

    /// G51.1: mirrors each named axis at the given coordinate; axes that are already mirrored stay mirrored.
    pub(super) fn start_mirror(&mut self, block: &Block, settings: &Settings) -> Result<(), Fault> {
        self.check_scaling_allowed(511)?;
        let given = self.given(block, settings);
        let none = AxisScaling { code: 511, center: [Nm(0); 3], thousandths: [WHOLE; 3] };
        let mut scaling = self.frame.scaling().copied().unwrap_or(none);
        let places = scaling.center.iter_mut().zip(&mut scaling.thousandths).zip(given.linear);
        for (((center, by), at), (letter, _)) in places.zip(AXES) {
            if block.word(letter).is_some() {
                (*center, *by) = (at, -WHOLE);
            }
        }
        self.set_scaling(Some(scaling));
        Ok(())
    }

    /// G50.1: cancels the mirroring of the named axes.
    pub(super) fn end_mirror(&mut self, block: &Block) {
        let Some(mut scaling) = self.frame.scaling().copied().filter(|scaling| scaling.code == 511) else { return };
        for (by, (letter, _)) in scaling.thousandths.iter_mut().zip(AXES) {
            if block.word(letter).is_some() {
                *by = WHOLE;
            }
        }
        self.set_scaling(Some(scaling).filter(|scaling| scaling.thousandths != [WHOLE; 3]));
    }

    /// Checks that G51 and G51.1 are not combined, and are not used within G68 or a cycle.
    fn check_scaling_allowed(&self, code: u16) -> Result<(), Fault> {
        let has_other = self.frame.scaling().is_some_and(|scaling| scaling.code != code);
        if has_other || self.frame.rotation().is_some() || self.cycle.is_some() {
            return Err(Fault::not_modelled(NotModelled::GCode(code), 0));
        }
        Ok(())
    }

    /// Rejects changes of offsets under G51 and G51.1, and cycles that drill along a scaled axis or shift a boring
    /// tool.
    pub(super) fn reject_under_scaling(&self, normal: Option<usize>) -> Result<(), Fault> {
        match self.frame.scaling() {
            Some(scaling) if normal.is_none_or(|normal| scaling.is_along(normal)) => {
                Err(Fault::not_modelled(NotModelled::MoveUnder(scaling.code), 0))
            }
            _ => Ok(()),
        }
    }

    /// Radius and sense of an arc in path coordinates.
    pub(super) fn scale_arc(&self, radius: Nm, turn: Turn) -> Result<(Nm, Turn), Fault> {
        let Some(scaling) = self.frame.scaling() else { return Ok((radius, turn)) };
        let refused = Fault::not_modelled(NotModelled::MoveUnder(scaling.code), 0);
        let (by, is_mirrored) = scaling.of_arc(self.plane).ok_or(refused)?;
        let turn = match (is_mirrored, turn) {
            (false, turn) => turn,
            (true, Turn::Cw) => Turn::Ccw,
            (true, Turn::Ccw) => Turn::Cw,
        };
        Ok((scaled_coordinate(radius, Nm(0), by, WHOLE), turn))
    }

    /// Restores the axes of a scaled point that the block does not name, so that rounding does not move them.
    pub(super) fn keep_unnamed(&self, mut end: Pose, named: u8) -> Pose {
        if self.frame.scaling().is_some() && self.frame.rotation().is_none() {
            for (axis, (place, here)) in end.linear.iter_mut().zip(self.position.linear).enumerate() {
                if named >> axis & 1 == 0 {
                    *place = here;
                }
            }
        }
        end
    }
}
