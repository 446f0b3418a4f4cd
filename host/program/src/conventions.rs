//! Conventions of the control for which a program was written, inferred from its text: decimal points, and the
//! reference of arc centres.

use arcfeed_nc::alarm::Alarm;
use arcfeed_nc::modal::MotionKind;
use arcfeed_nc::reader::InterpretedLine;
use arcfeed_nc::settings::{ArcCenters, Decimals, Settings};
use arcfeed_nc::word::Word;
use arcfeed_units::LengthUnit;

use super::{Diagnostic, ProgramLine, Severity, Source};

/// Groups of words that are compared with one another: X, Y, Z, IJK, ABC.
const GROUPS: usize = 5;
/// Coordinates X and Y.
const PLANE: [usize; 2] = [0, 1];
const DEPTHS: usize = 2;
const ARCS: usize = 3;
const ANGLES: usize = 4;
/// Most words without a point that are kept.
const KEPT_MAX: usize = 10_000;
/// Fewest words with a point that make a habit.
const HABIT_MIN: usize = 4;
/// A word is far smaller than the others if the median is this many powers of two above it.
const FAR_SMALLER: usize = 5;
/// Least increments below which a coordinate is tiny.
const TINY: i64 = 1_000;
const SMALL: &str = "a word without a decimal point in a program that writes points: as least increments it is far smaller than the \
                     other words of its axis; write the point, or read whole units with `--decimals calculator`";
const PLANE_TINY: &str = "no X or Y of the program has a decimal point, and as least increments none is as large as 1 mm or 0.1 in; write \
                          the points, or read whole units with `--decimals calculator`";
const ALL_TINY: &str = "no word of the program has a decimal point, and as least increments no coordinate is as large as 1 mm or \
                        0.1 in; read whole units with `--decimals calculator`";

/// Survey of numbers without decimal points, for a control that counts them in least increments.
#[derive(Debug)]
pub struct DecimalSurvey {
    /// Unit before the first line.
    unit: LengthUnit,
    is_asked: bool,
    count: usize,
    /// A line that could not be read has a point.
    has_unread_points: bool,
    /// Words without a point, but for zero, by group.
    plain: [usize; GROUPS],
    /// The first of them.
    kept: Vec<PlainWord>,
    /// Largest word without a point, by group.
    largest: [i64; GROUPS],
}

/// Words with a decimal point, by group and power of two of their value in least increments; zero does not count.
struct PointedWords {
    unit: LengthUnit,
    counts: [[usize; 64]; GROUPS],
}

#[derive(Debug)]
struct PlainWord {
    group: usize,
    power: usize,
    place: [usize; 3],
    text: Vec<u8>,
}

impl DecimalSurvey {
    /// Survey before the first line, for these settings.
    pub fn new(settings: &Settings) -> Self {
        DecimalSurvey {
            unit: settings.unit,
            is_asked: settings.decimals == Decimals::LeastIncrement,
            count: 0,
            has_unread_points: false,
            plain: [0; GROUPS],
            kept: Vec::new(),
            largest: [0; GROUPS],
        }
    }

    /// Examines the next line.
    pub fn add(&mut self, line: &ProgramLine) {
        self.count += 1;
        if !self.is_asked {
            return;
        }
        self.has_unread_points |= line.meaning.is_none() && line.text.contains(&b'.');
        let Some(meaning) = with_coordinates(line) else { return };
        for word in meaning.parsed.block.words.iter().filter(|word| !word.number.has_point()) {
            if let Some(group) = group_of(word, meaning) {
                self.add_word(word, group, &line.text);
            }
        }
    }

    fn add_word(&mut self, word: &Word, group: usize, text: &[u8]) {
        let increments = word.number.scaled(1).saturating_abs();
        let Some(power) = increments.checked_ilog2().map(|power| power as usize) else { return };
        self.plain[group] += 1;
        self.largest[group] = self.largest[group].max(increments);
        if self.kept.len() < KEPT_MAX {
            let column = usize::from(word.column);
            let place = [self.count, column, column + usize::from(word.len)];
            self.kept.push(PlainWord { group, power, place, text: text.to_vec() });
        }
    }

    /// Number of words without a point, but for zero.
    fn plain(&self) -> usize {
        self.plain.iter().sum()
    }

    /// Warnings of numbers whose size shows that a decimal point is missing, each with the text of its line. `lines` calls its
    /// argument with each line of the program again; it is only needed if there are numbers without a point.
    pub fn warnings(&self, lines: impl FnOnce(&mut dyn FnMut(&ProgramLine))) -> Vec<(Diagnostic, &[u8])> {
        if self.kept.is_empty() {
            return Vec::new();
        }
        let mut words = PointedWords { unit: self.unit, counts: [[0; 64]; GROUPS] };
        lines(&mut |line| words.add(line));
        let pointed: usize = words.counts.iter().flatten().sum();
        let is_tiny = |groups: &[usize]| {
            let [plain, points] = [&self.plain, &words.counts.map(|powers| powers.iter().sum())]
                .map(|counts| groups.iter().map(|group| counts[*group]).sum::<usize>());
            let largest = groups.iter().map(|group| self.largest[*group]).max();
            !self.has_unread_points && points == 0 && plain >= HABIT_MIN && largest < Some(TINY)
        };
        let first = |groups: &[usize], message: &str| {
            let word = self.kept.iter().find(|word| groups.contains(&word.group));
            word.map(|word| word.warning(message)).into_iter().collect()
        };
        let all: Vec<usize> = (0..GROUPS).collect();
        if is_tiny(&all) {
            return first(&all, ALL_TINY);
        }
        if is_tiny(&PLANE) {
            return first(&PLANE, PLANE_TINY);
        }
        if pointed < HABIT_MIN.max(self.plain()) {
            return Vec::new();
        }
        let medians = words.counts.map(|powers| median(&powers));
        let is_far_smaller =
            |word: &&PlainWord| medians[word.group].is_some_and(|usual| word.power + FAR_SMALLER <= usual);
        self.kept.iter().filter(is_far_smaller).map(|word| word.warning(SMALL)).collect()
    }
}

impl PointedWords {
    fn add(&mut self, line: &ProgramLine) {
        let Some(meaning) = with_coordinates(line) else { return };
        for word in &meaning.parsed.block.words {
            match (word.letter, word.number.as_whole()) {
                (b'G', Some(20)) => self.unit = LengthUnit::Inch,
                (b'G', Some(21)) => self.unit = LengthUnit::Mm,
                _ => {}
            }
            let Some(group) = group_of(word, meaning).filter(|_| word.number.has_point()) else { continue };
            let increments_per_unit = if self.unit == LengthUnit::Inch && group != ANGLES { 10_000 } else { 1_000 };
            let increments = word.number.scaled(increments_per_unit).saturating_abs();
            if let Some(power) = increments.checked_ilog2() {
                self.counts[group][power as usize] += 1;
            }
        }
    }
}

/// Meaning of a line, unless its words are times or data.
fn with_coordinates(line: &ProgramLine) -> Option<&InterpretedLine> {
    line.meaning.as_ref().filter(|meaning| meaning.step.dwell.is_none() && !meaning.step.sets_data)
}

/// Group of a word; `None` if it is compared with none.
fn group_of(word: &Word, meaning: &InterpretedLine) -> Option<usize> {
    let is_arc = || meaning.step.motion.as_ref().is_some_and(|motion| matches!(motion.kind, MotionKind::Arc(_)));
    match word.letter {
        b'X' => Some(0),
        b'Y' => Some(1),
        b'Z' => Some(DEPTHS),
        b'I' | b'J' | b'K' => Some(ARCS),
        b'A' | b'B' | b'C' => Some(ANGLES),
        b'R' if is_arc() => Some(ARCS),
        b'R' if meaning.step.series.is_some() => Some(DEPTHS),
        _ => None,
    }
}

impl PlainWord {
    fn warning(&self, message: &str) -> (Diagnostic, &[u8]) {
        let [line, column, end_column] = self.place;
        let found = self.text.get(column - 1..end_column - 1).unwrap_or_default().escape_ascii().to_string();
        let (severity, message) = (Severity::Warning, message.into());
        (Diagnostic { severity, line, column, end_column, alarm: None, message, found }, &self.text)
    }
}

/// Power of two of the median.
fn median(powers: &[usize; 64]) -> Option<usize> {
    let total: usize = powers.iter().sum();
    let mut below = 0;
    powers.iter().position(|count| {
        below += count;
        total > 0 && 2 * below >= total
    })
}

/// Advice for a program with arcs that do not close: a convention with which more of them close, if there is one. The
/// program is read again to find it.
pub fn fitting_convention(source: &Source) -> Option<String> {
    let settings = source.settings;
    let open_arcs = |settings: Settings| {
        let (mut open, mut survey) = (0, DecimalSurvey::new(&source.settings));
        let other = Source { settings, ..source.clone() };
        let is_open = |found: &Diagnostic| found.alarm == Some(Alarm::RadiusTolerance.number());
        other.survey(false, |line| survey.add(line), |found, _| open += usize::from(is_open(&found)));
        (open, survey.plain())
    };
    let (path, (open, _)) = (source.path.display(), open_arcs(settings));
    if open == 0 {
        return None;
    }
    if settings.decimals == Decimals::LeastIncrement {
        let (still_open, plain) = open_arcs(Settings { decimals: Decimals::Calculator, ..settings });
        if still_open < open && plain > 0 {
            return Some(format!(
                "{path}: {plain} words without a decimal point fit only with calculator decimals: {still_open} arcs do not close then, \
                 in place of {open}; give `--decimals calculator`, or write `decimals = \"calculator\"` under [control] of the job"
            ));
        }
    }
    if settings.arc_centers != ArcCenters::Absolute {
        let (still_open, _) = open_arcs(Settings { arc_centers: ArcCenters::Absolute, ..settings });
        if still_open < open {
            return Some(format!(
                "{path}: I, J, K fit only as coordinates of the centre: {still_open} arcs do not close then, in place of {open}; post \
                 them as distances from the arc's start, or, if the control reads coordinates, write `arc_centers = \"absolute\"` \
                 under [control] of the job or in the settings file"
            ));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use arcfeed_nc::settings::{Preset, Reading, Scope, Tables};

    use super::*;

    fn source(text: &str) -> Source {
        let settings = Settings::preset(Preset::Fanuc16i, LengthUnit::Mm, Reading::Lenient);
        let settings = Settings { scope: Scope::Everything, ..settings };
        Source {
            path: PathBuf::from("t.nc"),
            bytes: text.into(),
            settings,
            tables: Tables::default(),
            macro_line: None,
            places: None,
        }
    }

    fn warned(text: &str) -> Vec<(usize, usize)> {
        let source = source(text);
        let mut survey = DecimalSurvey::new(&source.settings);
        source.survey(true, |line| survey.add(line), |_, _| {});
        let again = |each: &mut dyn FnMut(&ProgramLine)| drop(source.survey(false, each, |_, _| {}));
        survey.warnings(again).iter().map(|(found, _)| (found.line, found.column)).collect()
    }

    #[test]
    fn missing_decimal_point_is_found_by_the_size_of_the_word() {
        let text = "G90\nG0X0.Y0.Z5.\nG1Z-2.F100\nX100\nY50.5\nX20.25Y3\nG4X1000\nG2X0Y0I10\nX10000\nM30\n";
        assert_eq!(warned(text), [(4, 1), (6, 7)]);
    }

    #[test]
    fn a_program_in_least_increments_is_left_in_peace() {
        assert!(warned("G0X10000Y5000\nG1Z-2000F100\nX0Y0\nX100\nX12000\nM30\n").is_empty());
        assert!(warned("G0X10.5Y5.25Z3.\nX12.Y0\nX0Y0\nM30\n").is_empty());
    }

    #[test]
    fn a_program_of_tiny_coordinates_is_found_as_a_whole() {
        assert_eq!(warned("G0X-30Y0\nZ2\nG1Z-1F150\nX130\nM30\n"), [(1, 3)]);
        // X and Y alone, beside depths that are written otherwise.
        assert_eq!(warned("G0X-30Y0\nZ5.\nG1Z-2.F150\nX130\nY50\nX10\nM30\n"), [(1, 3)]);
        assert_eq!(warned("G0X-30Y0\nZ5000\nG1Z-2000F150\nX130\nY50\nX10\nM30\n"), [(1, 3)]);
        assert!(warned("G0X-30Y0\nZ5.\nG1Z-2.F150\nX1300\nY50\nX10\nM30\n").is_empty());
        assert!(warned("G0X-30Y0\nZ5.\nG1Z-2.F150\nX1.3\nY50\nX10\nM30\n").is_empty());
    }

    #[test]
    fn a_convention_that_fits_better_is_named_after_a_reading_with_it() {
        let calculator = source("G0X100Y0\nG1F5X100\nG2X110.25Y10.25I0J10.25\nM30\n");
        let said = fitting_convention(&calculator).unwrap();
        assert!(said.contains("2 words") && said.contains("0 arcs do not close then, in place of 1"), "{said}");
        let absolute = source("G0X10.Y10.\nG2X20.Y20.I20.J10.F5.\nM30\n");
        let said = fitting_convention(&absolute).unwrap();
        assert!(said.contains("arc_centers"), "{said}");
        for other in
            ["G14\nX100\nM30\n", "G91.1\nG0X10.\nG2X20.Y10.I0J10.F5.\nM30\n", "G0X1.\nG2X2.Y2.I9.J9.F5.\nM30\n"]
        {
            assert_eq!(fitting_convention(&source(other)), None, "{other}");
        }
    }
}
