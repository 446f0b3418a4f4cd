//! Lines to what they do: a program's modal state carried from line to line.

use crate::nc::alarm::Fault;
use crate::nc::block::{Line, Parsed, Reading, parse_line};
use crate::nc::modal::{Feed, Modal, Step};
use crate::segment::{Path, Segment};
use crate::units::LengthUnit;

/// Reads a program line by line; the state is that of the control after the lines read so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reader {
    modal: Modal,
    reading: Reading,
}

/// A line, understood.
#[derive(Clone, Debug, PartialEq)]
pub struct Understood {
    /// Its words and notices.
    pub parsed: Parsed,
    /// What it does to the control; nothing for marks and titles.
    pub step: Step,
    /// Its move, geometry checked.
    pub segment: Option<Segment>,
}

impl Reader {
    /// At power-on.
    pub fn new(unit: LengthUnit, reading: Reading) -> Self {
        Reader { modal: Modal::at_power_on(unit), reading }
    }

    /// Reads the next line, which must not contain its line end.
    ///
    /// # Errors
    /// The first fault of the line. After an arc with bad geometry the state stands at its programmed end, so that
    /// one fault does not make the next block another.
    pub fn read(&mut self, text: &[u8]) -> Result<Understood, Fault> {
        let parsed = parse_line(text, self.reading)?;
        let Line::Block(block) = &parsed.line else {
            return Ok(Understood { parsed, step: Step::default(), segment: None });
        };
        let (next, step) = self.modal.interpret(block)?;
        self.modal = next;
        let sequence = block.sequence;
        let segment = step.motion.map(|motion| Segment::from_motion(&motion, sequence)).transpose()?;
        Ok(Understood { parsed, step, segment })
    }
}

impl Understood {
    /// Whether this is a cutting move for which no feed was ever given: PS0011.
    pub fn lacks_feed(&self) -> bool {
        self.segment.is_some_and(|segment| segment.path != Path::Rapid && segment.feed == Feed::Missing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nc::alarm::Alarm;

    #[test]
    fn one_bad_arc_is_one_fault() {
        let mut reader = Reader::new(LengthUnit::Mm, Reading::Lenient);
        for line in ["G0X10.", "G1F100.X10."] {
            assert!(reader.read(line.as_bytes()).is_ok());
        }
        let bad = reader.read(b"G3X0.Y11.I-10.");
        assert_eq!(bad, Err(Fault::alarm(Alarm::RadiusTolerance, 0)));
        let next = reader.read(b"G1Y0.").unwrap().segment.unwrap();
        assert!((next.length_mm() - 11.0).abs() < 1e-12);
    }

    #[test]
    fn only_cutting_moves_need_a_feed() {
        let mut reader = Reader::new(LengthUnit::Mm, Reading::Lenient);
        assert!(!reader.read(b"G0X1.").unwrap().lacks_feed());
        assert!(reader.read(b"G1X2.").unwrap().lacks_feed());
        assert!(!reader.read(b"X3.F100").unwrap().lacks_feed());
    }
}
