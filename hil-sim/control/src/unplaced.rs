//! Axes at machine positions whose distance from the workpiece is unknown.
//!
//! G28, G30 and G53 move to machine positions. Where the workpiece is on the machine, only a work offset says: without one
//! the axes are at an unknown distance from it, until a move gives them in the program's coordinates again.

use arcfeed_nc::reader::{InterpretedLine, Reader};
use arcfeed_nc::series::Series;
use arcfeed_units::Nm;

use super::action::WorkpiecePlace;

/// Linear axes, in the order of their coordinates.
const LETTERS: [u8; 3] = *b"XYZ";

/// Which linear axes are at an unknown distance from the workpiece.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct UnplacedAxes([bool; 3]);

impl UnplacedAxes {
    /// Takes the next block, which `reader` has just read; returns what is known of the position of its moves.
    pub(super) fn pass(&mut self, line: &InterpretedLine, reader: &Reader) -> WorkpiecePlace {
        let before = self.is_any();
        let has = |code: i64| {
            line.parsed.block.words.iter().any(|word| word.letter == b'G' && word.number.as_whole() == Some(code))
        };
        let named = LETTERS.map(|letter| line.parsed.block.word(letter).is_some());
        let origin = reader.tables().origin(reader.modal().system).linear;
        let unknown = |target: [Nm; 3]| [0, 1, 2].map(|axis: usize| origin[axis] == Nm(0) && target[axis] == Nm(0));
        let (is_return, found) = match line.step.series {
            Some(Series::Reference(_)) => (true, unknown(reader.machine().linear)),
            _ => (false, unknown([Nm(0); 3])),
        };
        let to_machine = is_return || has(53) && line.segment.is_some();
        let gives = line.segment.is_some() && reader.modal().absolute || has(92);
        for axis in (0..3).filter(|axis| named[*axis]) {
            if to_machine {
                self.0[axis] = found[axis];
            } else if gives || line.step.series.is_some() && reader.modal().absolute {
                self.0[axis] = false;
            }
        }
        match (before, to_machine && self.is_any()) {
            (false, false) => WorkpiecePlace::Known,
            (false, true) if is_return => WorkpiecePlace::ToIntermediate,
            _ => WorkpiecePlace::Unknown,
        }
    }

    fn is_any(self) -> bool {
        self.0.contains(&true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use WorkpiecePlace::{Known, ToIntermediate, Unknown};
    use arcfeed_nc::settings::{Preset, Reading, Scope, Settings, Tables};
    use arcfeed_units::LengthUnit;

    fn places(program: &str, edit: impl Fn(&mut Settings, &mut Tables)) -> Vec<WorkpiecePlace> {
        let mut settings = Settings {
            scope: Scope::Everything,
            ..Settings::preset(Preset::Fanuc16i, LengthUnit::Mm, Reading::Lenient)
        };
        let mut tables = Tables::default();
        edit(&mut settings, &mut tables);
        let (mut reader, mut axes) = (Reader::with(settings, tables), UnplacedAxes::default());
        program.lines().map(|text| axes.pass(&reader.read(text.as_bytes()).unwrap(), &reader)).collect()
    }

    #[test]
    fn an_axis_that_returned_is_unknown_until_a_move_gives_it() {
        let program = "G90G0X10.Y10.Z5.\nG91G28Z0\nG90M6\nG0X50.\nG43H1Z20.\nX60.\nG53Z0\nX1.\nG92Z100.\nX2.";
        // The block of G92 makes no move; those behind it are known.
        let wanted = [Known, ToIntermediate, Unknown, Unknown, Unknown, Known, Unknown, Unknown, Unknown, Known];
        assert_eq!(places(program, |_, _| {})[..], wanted);
        // An increment does not give it.
        assert_eq!(places("G28Z0\nG91G0Z5.\nX1.", |_, _| {}), [ToIntermediate, Unknown, Unknown]);
    }

    #[test]
    fn a_work_offset_or_a_reference_point_places_the_machine() {
        let program = "G28Z0\nX5.\nG53Z-10.\nX6.";
        let offset = |_: &mut Settings, tables: &mut Tables| tables.systems[0].linear[2] = Nm::from_mm(-400.0);
        assert_eq!(places(program, offset), [Known; 4]);
        let reference = |settings: &mut Settings, _: &mut Tables| settings.reference[0].linear[2] = Nm::from_mm(90.0);
        assert_eq!(places(program, reference), [Known, Known, Unknown, Unknown]);
    }
}
