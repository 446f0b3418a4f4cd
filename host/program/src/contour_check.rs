//! Check of contours under G41 and G42, as the control offsets them, and of chamfers and rounded corners: it finds the
//! faults that only the geometry shows.

use arcfeed_compensation::compensator::{CompensationFault, Compensator, ContourMove};
use arcfeed_compensation::contour::ContourCommand;
use arcfeed_compensation::insertion::InsertedCorner;
use arcfeed_nc::alarm::{Alarm, Fault};
use arcfeed_nc::reader::{InterpretedLine, Reader};
use arcfeed_nc::segment::Segment;
use arcfeed_nc::settings::{CompensationType, Settings, Tables};
use arcfeed_nc::text::Lines;
use arcfeed_units::Nm;
use memchr::{memchr, memchr2_iter};

use super::Diagnostic;
use super::diagnostic::is_blank;

/// Message about a contour without a radius.
pub(super) const NO_RADIUS: &str = "G41 or G42 with a D of no radius: the contour is checked and simulated as written, without \
                                    the tool's radius, and no law governs it; give it in the settings file ([radius]) or by \
                                    G10 L12, or state in that file that D holds only wear (compensation = \"wear\", docs/compensation.md)";

/// Check of the contours of a program; a `Place` is that of a block.
#[derive(Debug)]
pub(super) struct ContourCheck<Place> {
    compensator: Compensator,
    /// Move that waits for the next one, because it ends in a chamfer or a rounded corner.
    before_corner: Option<(Segment, ContourCommand, Place)>,
    /// Block of the held move.
    held: Option<Place>,
    /// A fault leaves the rest of the contour unchecked.
    is_lost: bool,
    /// The contour has had a radius, so that D0 ends it.
    has_radius: bool,
    has_warned: bool,
    /// The program has the path of the tool centre: a D of no radius is one without wear.
    is_center_path: bool,
}

/// Finding of the check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ContourFinding<Place> {
    /// The control would stop at this block.
    Fault(Place, Fault),
    /// No radius is known.
    NoRadius(Place),
}

impl<Place: Copy> ContourCheck<Place> {
    /// Check before the first block.
    pub fn new(settings: &Settings) -> Self {
        let compensator = Compensator::new(settings.compensation);
        let is_center_path = settings.compensation.of_program == CompensationType::Wear;
        ContourCheck {
            compensator,
            before_corner: None,
            held: None,
            is_lost: false,
            has_radius: false,
            has_warned: false,
            is_center_path,
        }
    }

    /// Checks the next block; `reader` is the control after it. Returns a fault that has become certain.
    pub fn add(&mut self, line: &InterpretedLine, reader: &Reader, place: Place) -> Option<ContourFinding<Place>> {
        let command = ContourCommand::of(line, reader.modal(), reader.tables());
        let has_side = reader.modal().compensation.is_some();
        self.has_radius = has_side && (self.has_radius || command.offset != Nm(0));
        let lacks_radius = has_side && !self.has_radius && !self.is_center_path;
        if lacks_radius && line.step.motion.is_some() && !self.has_warned {
            self.has_warned = true;
            return Some(ContourFinding::NoRadius(place));
        }
        let is_unknown = line.step.motion.is_some() && (line.segment.is_none() || line.starts_unknown);
        if is_unknown || (self.is_lost && command.offset != Nm(0)) {
            self.lose();
            return None;
        }
        self.is_lost = false;
        let mut segment = line.segment;
        if segment.is_some()
            && let Some((first, before, first_place)) = self.before_corner.take()
        {
            match self.join(&first, before, &mut segment) {
                Ok(moves) => {
                    let found = moves.iter().find_map(|of_first| self.offset(&before, Some(of_first), first_place));
                    if found.is_some() {
                        return found;
                    }
                }
                Err(alarm) => {
                    let place = if alarm == Alarm::ShortCorner { first_place } else { place };
                    self.lose();
                    return Some(ContourFinding::Fault(place, Fault::alarm(alarm, 0)));
                }
            }
        }
        if let (Some(segment), Some(_)) = (segment, command.corner) {
            self.before_corner = Some((segment, command, place));
            return None;
        }
        self.offset(&command, segment.as_ref(), place)
    }

    /// Inserts the corner between a move and the `second`, whose start changes; returns the moves before that.
    fn join(
        &self,
        first: &Segment,
        before: ContourCommand,
        second: &mut Option<Segment>,
    ) -> Result<Vec<Segment>, Alarm> {
        let (Some(of_second), Some(corner)) = (second.as_mut(), before.corner) else { return Ok(vec![*first]) };
        let inserted = InsertedCorner::new(first, of_second, before.plane, corner)?;
        *of_second = inserted.second;
        Ok(std::iter::once(inserted.first).chain(inserted.between).collect())
    }

    fn offset(
        &mut self,
        command: &ContourCommand,
        segment: Option<&Segment>,
        place: Place,
    ) -> Option<ContourFinding<Place>> {
        match command.apply(segment, &mut self.compensator) {
            Ok(_) => {
                let is_held = |held: &ContourMove| Some(&held.segment) == segment;
                if self.compensator.held().is_some_and(is_held) {
                    self.held = Some(place);
                }
                None
            }
            Err(CompensationFault::Given(fault)) => {
                // A fault of the held move comes up first.
                self.stop().or(Some(ContourFinding::Fault(place, fault)))
            }
            Err(CompensationFault::Held(fault)) => self.fault_of_held(fault),
        }
    }

    /// Ends the contour, at a block that was not understood or at the end of the program; the rest of the contour is
    /// not checked.
    pub fn stop(&mut self) -> Option<ContourFinding<Place>> {
        let result = self.compensator.end_held();
        self.lose();
        match result {
            Ok(_) => None,
            Err(CompensationFault::Held(fault) | CompensationFault::Given(fault)) => self.fault_of_held(fault),
        }
    }

    fn lose(&mut self) {
        self.compensator.reset();
        self.before_corner = None;
        self.is_lost = true;
    }

    fn fault_of_held(&mut self, fault: Fault) -> Option<ContourFinding<Place>> {
        self.lose();
        Some(ContourFinding::Fault(self.held?, fault))
    }
}

/// Findings in the contours of a program without macro statements, in order of place.
pub(super) fn contour_diagnostics(bytes: &[u8], settings: Settings, tables: Tables) -> Vec<Diagnostic> {
    if !may_have_contours(bytes) {
        return Vec::new();
    }
    let mut reader = Reader::with(settings, tables).at_unknown_position();
    let (mut check, mut has_begun) = (ContourCheck::new(&settings), false);
    let (mut findings, mut line) = (Vec::new(), InterpretedLine::default());
    for (index, raw) in Lines::new(bytes).enumerate() {
        if has_begun && raw.text.first() == Some(&b'%') {
            break;
        }
        has_begun |= !is_blank(raw.text);
        findings.extend(match reader.read_into(raw.text, &mut line) {
            Ok(()) => check.add(&line, &reader, index),
            Err(_) => check.stop(),
        });
    }
    findings.extend(check.stop());
    let text = |index| Lines::new(bytes).nth(index).map_or(&[][..], |raw| raw.text);
    let diagnostic = |finding: ContourFinding<usize>| finding.diagnostic(|index| (index + 1, text(index)));
    let mut found: Vec<Diagnostic> = findings.into_iter().map(diagnostic).collect();
    found.sort_by_key(|diagnostic| diagnostic.line);
    found
}

impl<Place: Copy> ContourFinding<Place> {
    /// The diagnostic, with line and text of its place.
    pub fn diagnostic<'a>(self, line: impl Fn(Place) -> (usize, &'a [u8])) -> Diagnostic {
        match self {
            ContourFinding::Fault(place, fault) => {
                let (line, text) = line(place);
                Diagnostic::of_fault(line, text, fault)
            }
            ContourFinding::NoRadius(place) => {
                let (line, text) = line(place);
                Diagnostic::of_line(line, text, NO_RADIUS)
            }
        }
    }
}

/// Whether the text of a program may have G41, G42, a chamfer or a rounded corner.
pub fn may_have_contours(bytes: &[u8]) -> bool {
    let is_side = |at: usize| {
        let behind = |bytes: &[u8], passed: &[u8]| bytes.iter().position(|byte| !passed.contains(byte));
        // G, zeros and blanks, 4, blanks, 1 or 2.
        let number = &bytes[at + 1..];
        let Some(four) = behind(number, b" \t0").filter(|four| number[*four] == b'4') else { return false };
        let rest = &number[four + 1..];
        behind(rest, b" \t").is_some_and(|digit| matches!(rest[digit], b'1' | b'2'))
    };
    memchr(b',', bytes).is_some() || memchr2_iter(b'G', b'g', bytes).any(is_side)
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_nc::block::Reading;
    use arcfeed_nc::settings::{Preset, Scope};
    use arcfeed_units::LengthUnit;

    fn found(program: &str) -> Vec<(usize, Option<u16>)> {
        let mut settings = Settings::preset(Preset::Fanuc16i, LengthUnit::Mm, Reading::Lenient);
        settings.scope = Scope::Everything;
        let diagnostics = contour_diagnostics(program.as_bytes(), settings, Tables::default());
        diagnostics.into_iter().map(|diagnostic| (diagnostic.line, diagnostic.alarm)).collect()
    }

    #[test]
    fn codes_of_a_contour_are_found_in_any_spelling() {
        for text in ["G41", "g042X1.", "G 0 41D1", "G1X1.,R2.", "GG42", "X1G4G41", "G4 1"] {
            assert!(may_have_contours(text.as_bytes()), "{text}");
        }
        for text in ["G40", "G4 X1", "G43H1", "G401X41", "X41Y42", "G4X1.G2", "", "G140G142"] {
            assert!(!may_have_contours(text.as_bytes()), "{text}");
        }
    }

    #[test]
    fn a_fault_is_at_the_block_of_its_move_and_hides_only_the_rest_of_its_contour() {
        let contour = "G41D1G1X0Y0F100.\nX20.\nY1.\nX0\nX5.\nG40Y-9.\n";
        let program = format!("%\nG10L12P1R2.\nG0X-10.Y0\n{contour}G0X-10.Y0\n{contour}M30\n%\n");
        assert_eq!(found(&program), [(6, Some(41)), (13, Some(41))]);
    }

    #[test]
    fn an_unknown_radius_is_one_warning_and_d0_at_the_end_of_a_contour_is_none() {
        let program = "%\nG0X-10.Y0\nG41D1G1X0F100.\nX20.\nG40Y9.\nG41X0\nY30.\nM30\n";
        assert_eq!(found(program), [(3, None)]);
        assert_eq!(found("G10L12P1R2.\nG0X-10.Y0\nG41D1G1X0F100.\nX20.\nD0Y9.\nX3.\nM30\n"), []);
        assert_eq!(found("G0X41.\nM30\n"), []);
    }

    #[test]
    fn a_corner_that_does_not_fit_is_a_fault_of_the_move_that_is_too_short() {
        let program = |first: &str, second: &str| format!("G0X0Y0\nG1X{first}F100.,R5.\n(A)\nY{second}\nM30\n");
        for (first, second, wanted) in
            [("20.", "20.", vec![]), ("3.", "20.", vec![(2, Some(55))]), ("20.", "2.", vec![(4, Some(51))])]
        {
            assert_eq!(found(&program(first, second)), wanted, "{first} {second}");
        }
        // Inside a corner of 5 mm a tool of 6 mm has no room.
        let contour = "G10L12P1R6.\nG0X-20.Y0\nG41D1G1X0F100.\nX30.,R5.\nY30.\nG40X0\nM30\n";
        assert_eq!(found(contour), [(4, Some(41))]);
        assert_eq!(found(&contour.replace("R6.", "R4.")), []);
    }

    #[test]
    fn what_the_check_does_not_know_it_does_not_judge() {
        let program = "G10L12P1R2.\nG0X-10.Y0\nG41D1G1X0F100.\nX20.\nX2O.\nY1.\nX0\nX5.\nG40Y-9.\nM30\n";
        assert_eq!(found(program), []);
        assert_eq!(found("G10L12P1R2.\nG41D1G1X0F100.\nG3X9.Y9.J9.\nX0\nG40Y-9.\nM30\n"), []);
    }
}
