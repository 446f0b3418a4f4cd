//! One-shot blocks, whose axis words are not a target on the path: G4, G5, G8, G10, G28, G30, G51, G52, G53, G68, G92; and
//! G54.1, whose P is not a dwell.

use super::address::whole;
use super::alarm::{Alarm, Fault, NotModelled};
use super::block::Block;
use super::codes::OneShot;
use super::frame::{CoordinateFrame, CoordinateRotation};
use super::modal::{Center, Feed, Modal, Motion, MotionKind, Pose, Step};
use super::moves::rotary;
use super::series::Series;
use super::settings::{ADDITIONAL_SYSTEMS, OFFSETS, Settings, Tables};
use super::word::Word;
use arcfeed_units::{MicroDeg, Micros, Nm, US_PER_MS, US_PER_S};

/// The letters of the axes, in the order of the bits of `Target::named`.
const AXES: [u8; 6] = *b"XYZABC";

impl Modal {
    /// Executes a one-shot code.
    pub(super) fn execute_one_shot(
        &mut self,
        what: OneShot,
        block: &Block,
        (settings, tables): (&Settings, &Tables),
        step: &mut Step,
    ) -> Result<(), Fault> {
        match what {
            OneShot::No | OneShot::Tracked | OneShot::AdditionalSystem => {}
            OneShot::Dwell => step.dwell = Some(dwell_time(block)?),
            OneShot::LookAhead => {
                if whole(block, b'P').is_none_or(|(value, _)| value > 1) {
                    return Err(Fault::alarm(Alarm::LookAheadFormat, 0));
                }
            }
            OneShot::HighSpeed => match block.word(b'P').map(|word| word.number.as_whole()) {
                // High-precision contour control on and off. Other P call a machining cycle or read binary data.
                Some(Some(0 | 10_000)) => {}
                _ => return Err(Fault::not_modelled(NotModelled::GCode(50), 0)),
            },
            OneShot::Smoothing => match block.word(b'Q').map(|word| word.number.as_whole()) {
                Some(Some(0 | 1)) => {}
                // Under Q2 the path differs from that of the blocks.
                _ => return Err(Fault::not_modelled(NotModelled::GCode(51), 0)),
            },
            OneShot::Data => {
                step.sets_data = true;
            }
            OneShot::Reference(code) => step.series = Some(self.go_to_reference(code, block, settings, tables)?),
            OneShot::Machine => step.motion = self.move_in_machine_coordinates(block, settings, tables)?,
            OneShot::Rotate => self.start_rotation(block, settings)?,
            OneShot::Scale => self.start_scaling(block, settings)?,
            OneShot::Mirror => self.start_mirror(block, settings)?,
            OneShot::MirrorOff => self.end_mirror(block),
            OneShot::Local => {
                self.reject_under_scaling(None)?;
                let target = self.given(block, settings);
                self.each_axis(block, |modal, axis| {
                    *modal.local.axis_mut(axis)? = target.axis(axis);
                    Some(())
                });
                self.update_frame(tables);
            }
            OneShot::Preset => {
                self.reject_under_scaling(None)?;
                // G92 renames the current position: it moves the program's origin, not the tool.
                let target = self.given(block, settings);
                let shift = self.program.minus(target);
                self.each_axis(block, |modal, axis| {
                    let here = modal.local.axis(axis) + shift.axis(axis);
                    *modal.preset.axis_mut(axis)? += here;
                    *modal.local.axis_mut(axis)? = 0;
                    Some(())
                });
                self.update_frame(tables);
            }
            OneShot::PresetBack => {
                self.reject_under_scaling(None)?;
                self.each_axis(block, |modal, axis| {
                    *modal.preset.axis_mut(axis)? = 0;
                    *modal.local.axis_mut(axis)? = 0;
                    Some(())
                });
                self.update_frame(tables);
            }
        }
        Ok(())
    }

    /// G54.1 P: applies to the moves of its own block already.
    pub(super) fn select_additional(
        &mut self,
        block: &Block,
        (settings, tables): (&Settings, &Tables),
    ) -> Result<(), Fault> {
        let (number, column) = whole(block, b'P').unwrap_or((1, 0));
        if !(1..=i64::from(settings.additional_systems)).contains(&number) {
            return Err(Fault::alarm(Alarm::OffsetNumber, column));
        }
        self.system = 5 + number as u16;
        self.update_frame(tables);
        Ok(())
    }

    /// The axis words as absolute values, regardless of G90 and G91.
    pub(super) fn given(&self, block: &Block, settings: &Settings) -> Pose {
        Modal { absolute: true, ..*self }.target(block, settings.decimals).end
    }

    fn each_axis(&mut self, block: &Block, mut act: impl FnMut(&mut Modal, u8) -> Option<()>) {
        for axis in AXES.into_iter().filter(|axis| block.word(*axis).is_some()) {
            let _is_an_axis = act(self, axis);
        }
    }

    /// Converts a point from machine to path coordinates: subtracts the tool length along Z.
    fn on_path(&self, machine: Pose, tables: &Tables) -> Pose {
        let mut shift = Pose::ORIGIN;
        let [_, _, z] = &mut shift.linear;
        *z = self.tool_length(tables);
        machine.minus(shift)
    }

    /// G28, G30: moves to the intermediate point of the axis words, then moves these axes to the reference point.
    fn go_to_reference(
        &mut self,
        code: u8,
        block: &Block,
        settings: &Settings,
        tables: &Tables,
    ) -> Result<Series, Fault> {
        if self.cycle.is_some() {
            return Err(Fault::alarm(Alarm::ReferenceInCycle, 0));
        }
        let point = match (code, whole(block, b'P')) {
            (28, _) => 0,
            (_, None) => 1,
            (_, Some((number @ 2..=4, _))) => number as usize - 1,
            (_, Some((_, column))) => return Err(Fault::alarm(Alarm::ReferencePoint, column)),
        };
        let target = self.target(block, settings.decimals);
        // G91 G28 Z0 Y0 has no intermediate point: rotated coordinates make no difference to it.
        let stays = !self.absolute && target.end == self.program && self.unmodelled == 0;
        let between = if stays {
            self.position
        } else {
            self.check_move(&target)?;
            self.keep_unnamed(self.frame.to_path(target.end), target.named)
        };
        let reference = settings.reference.get(point).copied().unwrap_or_default();
        let reference = self.on_path(reference, tables);
        let mut end = between;
        for axis in AXES.into_iter().filter(|axis| block.word(*axis).is_some()) {
            if let Some(place) = end.axis_mut(axis) {
                *place = reference.axis(axis);
            }
        }
        let way = [self.position, between, end];
        (self.position, self.program) = (end, self.frame.to_program(end));
        Ok(Series::Reference(way))
    }

    /// G53: moves these axes in machine coordinates at rapid. Under G91 it has no effect.
    fn move_in_machine_coordinates(
        &mut self,
        block: &Block,
        settings: &Settings,
        tables: &Tables,
    ) -> Result<Option<Motion>, Fault> {
        let target = self.given(block, settings);
        let machine = self.on_path(target, tables);
        let mut end = self.position;
        self.each_axis(block, |_, axis| {
            *end.axis_mut(axis)? = machine.axis(axis);
            Some(())
        });
        if !self.absolute || end == self.position {
            return Ok(None);
        }
        let start = self.position;
        (self.position, self.program) = (end, self.frame.to_program(end));
        let center = Center::Offset([Nm(0); 3]);
        Ok(Some(Motion { kind: MotionKind::Rapid, plane: self.plane, start, end, center, feed: Feed::Missing }))
    }

    /// G68: rotation about the given point, or about the tool's position.
    fn start_rotation(&mut self, block: &Block, settings: &Settings) -> Result<(), Fault> {
        let tilts = block.words.iter().find(|word| matches!(word.letter, b'I' | b'J' | b'K'));
        if let Some(word) = tilts {
            return Err(Fault::not_modelled(NotModelled::GCode(680), word.column));
        }
        let (first, second, _) = self.plane.axes();
        let unturned = CoordinateFrame::new(self.frame.shift(), self.frame.scaling().copied(), None);
        let here = unturned.to_program(self.position);
        let given = self.given(block, settings);
        let mut around = here.linear;
        for (index, (place, given)) in around.iter_mut().zip(given.linear).enumerate() {
            *place = if block.word(b'X' + index as u8).is_some() { given } else { *place };
        }
        if let Some(scaling) = self.frame.scaling() {
            scaling.apply(&mut around);
        }
        let center = [first, second].map(|index| around.get(index).copied().unwrap_or_default());
        let angle = block.word(b'R').map_or(0, |word| rotary(word.number, settings.decimals));
        self.rotate(Some(CoordinateRotation::new(self.plane, center, MicroDeg(angle))));
        Ok(())
    }
}

/// Dwell time of G4: P in milliseconds, X in seconds.
pub(super) fn dwell_time(block: &Block) -> Result<Micros, Fault> {
    let (word, scale) = match (block.word(b'P'), block.word(b'X')) {
        (Some(word), _) => (word, US_PER_MS),
        // X without a decimal point is in milliseconds, the least increment.
        (None, Some(word)) if !word.number.has_point() => (word, US_PER_MS),
        (None, Some(word)) => (word, US_PER_S),
        (None, None) => return Ok(Micros(0)),
    };
    let span = word.number.scaled(scale as i64);
    u64::try_from(span).map(Micros).map_err(|_| Fault::alarm(Alarm::MinusSign, word.column + 1))
}

/// Executes G10: writes the offsets that the block gives into `tables`.
///
/// # Errors
/// PS0031 for a target that does not exist; tool life data and parameters are not interpreted.
pub fn set_data(modal: &Modal, block: &Block, settings: &Settings, tables: &mut Tables) -> Result<(), Fault> {
    let target_fault = |column| Fault::alarm(Alarm::DataTarget, column);
    let (kind, column) = whole(block, b'L').unwrap_or((1, 0));
    let (number, at) = whole(block, b'P').ok_or(target_fault(0))?;
    match (kind, number) {
        (20, number) if number > ADDITIONAL_SYSTEMS as i64 && number <= i64::from(settings.additional_systems) => {
            return Err(Fault::not_modelled(NotModelled::FarSystem, at));
        }
        (2, 0) => write_system(modal, block, settings, &mut tables.external),
        (2, 1..=6) | (20, 1..=48) => {
            let index = number as usize - 1 + if kind == 20 { 6 } else { 0 };
            let system = tables.systems.get_mut(index).ok_or(target_fault(at))?;
            write_system(modal, block, settings, system);
        }
        (1 | 10..=13, number) if (1..=OFFSETS as i64).contains(&number) => {
            let offsets = if kind < 12 { &mut tables.lengths } else { &mut tables.radii };
            let [geometry, wear] = offsets.get_mut(number as usize - 1).ok_or(target_fault(at))?;
            let place = if matches!(kind, 11 | 13) { wear } else { geometry };
            let word: &Word = block.word(b'R').ok_or(target_fault(0))?;
            let value = modal.length(word.number, settings.decimals);
            place.0 = if modal.absolute { value } else { place.0.saturating_add(value) };
        }
        (1 | 2 | 10..=13 | 20, _) => return Err(target_fault(at)),
        (3 | 50 | 52, _) => return Err(Fault::not_modelled(NotModelled::GCode(100), column)),
        _ => return Err(target_fault(column)),
    }
    Ok(())
}

fn write_system(modal: &Modal, block: &Block, settings: &Settings, system: &mut Pose) {
    let given = modal.given(block, settings);
    for axis in AXES.into_iter().filter(|axis| block.word(*axis).is_some()) {
        if let Some(place) = system.axis_mut(axis) {
            *place = if modal.absolute { given.axis(axis) } else { place.saturating_add(given.axis(axis)) };
        }
    }
}
