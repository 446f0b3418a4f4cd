//! Common parts of point files: words with their places, numbers, and faults.

use thiserror::Error;

use super::blade::{RotorAxis, Sections};
use super::blisk::Revolution;
use crate::vector::Point;

/// Largest number of a file.
const NUMBER_MAX: f64 = 1e9;

/// Coordinates of a point file: axis of rotation and unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointFileFrame {
    /// Axis of rotation in the file's coordinates.
    pub axis: RotorAxis,
    /// Millimetres per unit of the file.
    pub unit_mm: f64,
}

/// Fault in a point file, with its line and column.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{line}:{column}: {fault}")]
pub struct ReadError {
    /// Line, counted from 1.
    pub line: usize,
    /// Column, counted from 1.
    pub column: usize,
    /// Fault.
    pub fault: Fault,
}

/// Kind of a fault in a file of points or sections.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Fault {
    /// A word is not a finite number.
    #[error("`{0}` is no number")]
    NotANumber(String),
    /// A number is larger than any part.
    #[error("`{0}` is too large for a part; check the file's units")]
    TooLarge(String),
    /// The text is not that of a STEP file.
    #[error("this is no complete STEP file (ISO 10303-21); export it anew as AP203 or AP214")]
    NotStep,
    /// A number has a decimal comma.
    #[error("`{0}` has a decimal comma; export numbers with a decimal point")]
    DecimalComma(String),
    /// A line has more or fewer values than the table has columns.
    #[error(
        "{found} values in a line of {columns} columns; numbers need a decimal point, a comma separates two values"
    )]
    Values {
        /// Number of values.
        found: usize,
        /// Number of columns.
        columns: usize,
    },
    /// A line has fewer than three coordinates; their number.
    #[error("a point has three coordinates, x y z, not {0}")]
    Coordinates(usize),
    /// A column of the table is missing.
    #[error(
        "no column `{0}`; the first line names the columns: s,side,x_mm,y_mm,z_mm or s,side,z_mm,r_mm,theta_deg, and R_mm and i where they \
         are known"
    )]
    Column(&'static str),
    /// A column has no unit, or one of the wrong kind.
    #[error("`{found}` has no unit that fits; write {wanted}")]
    Unit {
        /// Name of the column.
        found: String,
        /// Possible names.
        wanted: &'static str,
    },
    /// A radius is negative; its value.
    #[error("a radius of {0}; the distance from the rotor's axis is above zero")]
    RadiusSign(f64),
    /// A point coincides with the one before.
    #[error("this point lies in the place of the one before (line {before}); delete one of them")]
    Coincident {
        /// Line of the other point.
        before: usize,
    },
    /// The same side of a section comes a second time.
    #[error(
        "section s = {span} has a second {side} side here, the first one begins in line {before}; give each section another `s`, and keep \
         the points of a side together"
    )]
    Repeated {
        /// `s`
        span: f64,
        /// Side.
        side: &'static str,
        /// Line of the first one.
        before: usize,
    },
    /// A section has one side only.
    #[error("section s = {span} has no {missing} side ({word}); give both sides of each section")]
    OneSide {
        /// `s`
        span: f64,
        /// Missing side.
        missing: &'static str,
        /// Word for it in the file.
        word: &'static str,
    },
    /// The number of the blade is neither that of the main blade nor that of the splitter.
    #[error(
        "`{0}` is no blade; write 1 for the main blade and 2 for the splitter, of which there is one at most between two main blades"
    )]
    Blade(String),
    /// The names of the splitter's sides are exchanged.
    #[error(
        "the splitter's pressure side lies where the main blade has its suction side; exchange PS and SS of the splitter"
    )]
    SplitterSides,
    /// The word for the side is neither that of the pressure nor that of the suction side.
    #[error("`{0}` is no side; write PS (pressure, the concave one) or SS (suction, the convex one)")]
    Side(String),
    /// The word after a point is no mark of an edge.
    #[error("`{0}` marks nothing; a point may be marked `le` or `te`, as the leading or trailing edge")]
    Mark(String),
    /// A section has the same mark twice, or only one of both.
    #[error("section {section} has {found} points marked `{mark}`; mark one leading and one trailing edge, or none")]
    Marks {
        /// Section, counted from 1.
        section: usize,
        /// Mark.
        mark: &'static str,
        /// Number of marked points.
        found: usize,
    },
    /// The points of a side are not numbered in order from 0.
    #[error(
        "point {found} where point {expected} was to come; number the points of a side from 0, the leading edge first"
    )]
    Index {
        /// Number in the file.
        found: String,
        /// Expected number.
        expected: usize,
    },
    /// There are too few sections.
    #[error("a blade needs 2 sections at least, from the hub to the tip, on both sides alike; there are {found}")]
    Sections {
        /// Number of sections.
        found: usize,
    },
    /// There are too few measured points.
    #[error("{found} points are no measurement; {least} at least are needed")]
    Measurement {
        /// Points of the file.
        found: usize,
        /// Least number.
        least: usize,
    },
    /// A section has too few points.
    #[error("section {section} has {found} points on a side; {least} at least make a curve")]
    Points {
        /// Section, counted from 1.
        section: usize,
        /// Number of points.
        found: usize,
        /// Least number.
        least: usize,
    },
    /// The loop of a section is not closed.
    #[error(
        "section {section} is open: {gap_mm:.3} mm from its last point to its first, over steps of {step_mm:.3} mm at most; close the loop around the blade"
    )]
    Open {
        /// Section, counted from 1.
        section: usize,
        /// Distance between its ends.
        gap_mm: f64,
        /// Greatest step.
        step_mm: f64,
    },
    /// The sections do not follow each other from the hub to the tip.
    #[error(
        "section {section} lies {below_mm:.3} mm lower over the hub than the one before; sections go from the hub to the tip"
    )]
    Order {
        /// Section, counted from 1.
        section: usize,
        /// Height by which it lies below the section before.
        below_mm: f64,
    },
    /// After the sections of two blades, those of another one begin.
    #[error(
        "section {section} begins a third blade; a file has the sections of the main blade and of one splitter at most. If all blades of the rotor \
         are alike, keep those of the first one only; a rotor with two splitters between its main blades is not planned"
    )]
    ThirdBlade {
        /// Section, counted from 1.
        section: usize,
    },
    /// After sections up to the tip, the sections of another blade begin, in a table that does not name its blades.
    #[error(
        "section {section} begins a second blade: it lies {below_mm:.3} mm lower over the hub than the one before, near section 1. If all blades of \
         the rotor are alike, keep those of the first one only; if this is a splitter, add a column `blade`: 1 for the main blade, 2 for the splitter"
    )]
    SecondBlade {
        /// Section, counted from 1.
        section: usize,
        /// Height by which it lies below the section before.
        below_mm: f64,
    },
    /// The stated radius of a point does not agree with its coordinates.
    #[error(
        "the file says R = {stated_mm:.3} mm here, but the point is {found_mm:.3} mm from the {axis:?} axis; give the rotor's `axis`{hint}"
    )]
    Radius {
        /// Radius in the column.
        stated_mm: f64,
        /// Radius from the coordinates.
        found_mm: f64,
        /// Axis of the file.
        axis: RotorAxis,
        /// Axis that would agree.
        hint: &'static str,
    },
    /// The given axis of rotation passes through the blade or close to it.
    #[error(
        "the {axis:?} axis runs through or close by section {section} (from {least_mm:.3} to {most_mm:.3} mm off it); give the rotor's `axis`"
    )]
    Axis {
        /// Section, counted from 1.
        section: usize,
        /// Axis.
        axis: RotorAxis,
        /// Least distance.
        least_mm: f64,
        /// Greatest distance.
        most_mm: f64,
    },
    /// The curve of hub or shroud turns back along the axis of rotation.
    #[error(
        "the curve turns back along the {axis:?} axis here; give it from inlet to outlet in one sense, or give the rotor's `axis`"
    )]
    TurnsBack {
        /// Axis.
        axis: RotorAxis,
    },
    /// The shroud lies inside the hub.
    #[error(
        "the shroud lies {below_mm:.3} mm below the hub at {z_mm:.3} mm along the axis; the files may be exchanged"
    )]
    Shroud {
        /// Distance.
        below_mm: f64,
        /// Place along the axis.
        z_mm: f64,
    },
    /// The first section is far from the hub.
    #[error(
        "section 1 lies {height_mm:.3} mm off the hub; the files do not belong together, or `axis` or `units` is wrong"
    )]
    OffTheHub {
        /// Height, greater than the blade's own size.
        height_mm: f64,
    },
    /// The names of the sides are exchanged: the convex side must be the suction side.
    #[error(
        "the suction side is {shorter_mm:.3} mm shorter than the pressure side, all sections together: the convex side is the suction side; exchange PS and SS"
    )]
    Swapped {
        /// Difference of their lengths.
        shorter_mm: f64,
    },
}

impl Fault {
    /// Adds the place to the fault.
    pub fn at(self, line: usize, column: usize) -> ReadError {
        ReadError { line, column, fault: self }
    }
}

/// Words of a line with their columns, counted from 1; blanks, commas and semicolons separate them.
pub fn words(line: &str) -> Vec<(usize, &str)> {
    let is_gap = |c: char| c.is_whitespace() || matches!(c, ',' | ';');
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(start) = line[at..].find(|c| !is_gap(c)) {
        let from = at + start;
        let to = line[from..].find(is_gap).map_or(line.len(), |length| from + length);
        found.push((line[..from].chars().count() + 1, &line[from..to]));
        at = to;
    }
    found
}

/// Lines of a text from 1, without the byte order mark that some programs write first.
pub(super) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.strip_prefix('\u{feff}').unwrap_or(text).lines().enumerate().map(|(at, line)| (at + 1, line))
}

/// Rejects decimal commas: a comma between two digits, in a line without points whose values other characters separate.
///
/// # Errors
/// The first such number.
pub(super) fn refuse_commas(line: usize, text: &str) -> Result<(), ReadError> {
    let is_gap = |c: char| c.is_whitespace() || c == ';';
    if text.contains('.') || !text.trim().contains(is_gap) {
        return Ok(());
    }
    let is_decimal = |word: &&str| {
        word.split_once(',').is_some_and(|(whole, rest)| {
            whole.ends_with(|c: char| c.is_ascii_digit()) && rest.starts_with(|c: char| c.is_ascii_digit())
        })
    };
    match text.split(is_gap).find(is_decimal) {
        Some(word) => {
            let column = text.find(word).map_or(1, |at| text[..at].chars().count() + 1);
            Err(Fault::DecimalComma(word.to_owned()).at(line, column))
        }
        None => Ok(()),
    }
}

/// Parses a finite number.
///
/// # Errors
/// The word is no such number.
pub fn number(line: usize, (column, word): (usize, &str)) -> Result<f64, ReadError> {
    let value = word.parse::<f64>().ok().filter(|value| value.is_finite());
    let value = value.ok_or_else(|| Fault::NotANumber(word.to_owned()).at(line, column))?;
    if value.abs() <= NUMBER_MAX { Ok(value) } else { Err(Fault::TooLarge(word.to_owned()).at(line, column)) }
}

impl PointFileFrame {
    /// Converts a place of the file to the part frame.
    pub fn point(&self, place: [f64; 3]) -> Point {
        self.axis.to_part(place.map(|value| value * self.unit_mm))
    }

    /// Checks a blade as a whole; `lines` are the lines where its sections begin.
    pub(super) fn check(&self, blade: &Sections, hub: &Revolution, lines: &[usize]) -> Result<(), ReadError> {
        let line = |section: usize| lines.get(section).copied().unwrap_or(1);
        for (section, (pressure, suction)) in blade.pressure.iter().zip(&blade.suction).enumerate() {
            let radii = || pressure.iter().chain(suction).map(|point| libm::hypot(point.x, point.y));
            let (least_mm, most_mm) = (radii().fold(f64::INFINITY, f64::min), radii().fold(0.0, f64::max));
            if least_mm < most_mm / 4.0 {
                let fault = Fault::Axis { section: section + 1, axis: self.axis, least_mm, most_mm };
                return Err(fault.at(line(section), 1));
            }
        }
        let heights = blade.heights_mm(hub);
        let across_mm = blade.pressure[0].first().zip(blade.pressure[0].last()).map_or(0.0, |(a, b)| (a - b).norm());
        if heights[0].abs() > across_mm {
            return Err(Fault::OffTheHub { height_mm: heights[0] }.at(line(0), 1));
        }
        match heights.windows(2).position(|pair| pair[1] <= pair[0]) {
            Some(at) => {
                let (section, below_mm) = (at + 2, heights[at] - heights[at + 1]);
                let is_at_hub = at > 0 && heights[at + 1] - heights[0] < (heights[at] - heights[0]) / 2.0;
                let fault = if is_at_hub {
                    Fault::SecondBlade { section, below_mm }
                } else {
                    Fault::Order { section, below_mm }
                };
                Err(fault.at(line(at + 1), 1))
            }
            None => Ok(()),
        }
    }
}
