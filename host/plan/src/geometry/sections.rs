//! Table of sections: one point per line, columns by name.
//!
//! ```text
//! s,R_mm,side,i,x_mm,y_mm,z_mm                                      s,side,z_mm,r_mm,theta_deg
//! 0.0000,70.0000,PS,0,-6.095401,-11.478319,69.734110                0.0000,PS,-11.478319,70.0000,94.995
//! ```
//!
//! A column `blade` numbers the blades of a rotor with splitters: 1 is the main blade, 2 the splitter. A section has one `s`; each side goes from the leading to the trailing edge. `R_mm` (distance from the axis) and `i`
//! (from 0) are checked against the points. Polar columns are in the part frame: z along the rotor's axis, theta about it.
//! Sides with fewer points than the longest one are resampled.

use arcfeed_units::{LengthUnit, MM_PER_M};

use crate::vector::Point;

use super::blade::{RotorAxis, Sections};
use super::blisk::Revolution;
use super::point_file::{Fault, PointFileFrame, ReadError, lines, number, refuse_commas, words};
use super::resampling::resampled;

/// Least number of points of a side.
const POINTS_MIN: usize = 5;

/// Tolerance of R, as a fraction of it.
const RADIUS_RATIO: f64 = 1e-3;

/// Points of a side nearer than this are in one place, mm.
const SAME_MM: f64 = 1e-6;

/// Column with the factor that its unit has, mm or rad.
#[derive(Clone, Copy)]
struct Column {
    at: usize,
    factor: f64,
}

/// Columns of the coordinates.
#[derive(Clone, Copy)]
enum Coordinates {
    /// x, y, z of the file.
    Cartesian([Column; 3]),
    /// z, r, theta of the part frame.
    Polar([Column; 3]),
}

/// Columns of a table.
struct Columns {
    count: usize,
    blade: Option<usize>,
    span: usize,
    side: usize,
    coordinates: Coordinates,
    radius: Option<Column>,
    index: Option<usize>,
}

/// Side of a section, and the lines of its points.
struct Side {
    is_splitter: bool,
    span: f64,
    is_pressure: bool,
    line: usize,
    points: Vec<Point>,
}

/// Reads a table of sections of a rotor with this hub: the main blade, and the splitter if there is one.
///
/// # Errors
/// The fault with its place.
pub fn read(text: &str, frame: &PointFileFrame, hub: &Revolution) -> Result<Vec<Sections>, ReadError> {
    let mut lines = lines(text).filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'));
    let (first, header) = lines.next().unwrap_or((1, ""));
    let columns = Columns::of(header, first, frame)?;
    let mut sides: Vec<Side> = Vec::new();
    let mut before = first;
    for (line, text) in lines {
        let row = row(text, line, &columns, frame)?;
        let is_next = |side: &Side| !row.is_of(side);
        if sides.last().is_none_or(is_next) {
            row.check_new(&sides, line)?;
            let Row { is_splitter, span, is_pressure, .. } = row;
            sides.push(Side { is_splitter, span, is_pressure, line, points: Vec::new() });
        }
        if let Some(side) = sides.last_mut() {
            row.check_index(side.points.len(), line)?;
            if side.points.last().is_some_and(|last| (row.point - last).norm() < SAME_MM) {
                return Err(Fault::Coincident { before }.at(line, 1));
            }
            side.points.push(row.point);
        }
        before = line;
    }
    let (splitter, main): (Vec<Side>, Vec<Side>) = sides.into_iter().partition(|side| side.is_splitter);
    let (main, lines) = paired(main)?;
    frame.check(&main, hub, &lines)?;
    let bulge_mm = main.bulge_mm();
    if bulge_mm < 0.0 {
        return Err(Fault::Swapped { shorter_mm: -bulge_mm }.at(lines[0], 1));
    }
    if splitter.is_empty() {
        return Ok(vec![main]);
    }
    let (splitter, lines) = paired(splitter)?;
    frame.check(&splitter, hub, &lines)?;
    // By the main blade: a splitter may have no camber.
    if splitter.is_pressure_ahead() != main.is_pressure_ahead() {
        return Err(Fault::SplitterSides.at(lines[0], 1));
    }
    Ok(vec![main, splitter])
}

/// Name of a column without its unit, and the unit.
fn split_unit(name: &str) -> (String, Option<String>) {
    let name = name.to_lowercase();
    match name.split_once('_') {
        Some((name, unit)) => (name.to_owned(), Some(unit.to_owned())),
        None => (name, None),
    }
}

impl Columns {
    fn of(header: &str, line: usize, frame: &PointFileFrame) -> Result<Self, ReadError> {
        let words = words(header);
        let names: Vec<(String, Option<String>)> = words.iter().map(|(_, word)| split_unit(word)).collect();
        let find = |name: &'static str| names.iter().position(|(known, _)| known == name);
        let must = |name: &'static str| find(name).ok_or(Fault::Column(name).at(line, 1));
        let wrong = |at: usize, wanted| Fault::Unit { found: words[at].1.to_owned(), wanted }.at(line, words[at].0);
        let length = |at: usize| {
            let factor = match names[at].1.as_deref() {
                None => Some(frame.unit_mm),
                Some("mm") => Some(1.0),
                Some("cm") => Some(10.0),
                Some("m") => Some(MM_PER_M),
                Some("in" | "inch") => Some(LengthUnit::Inch.mm()),
                Some(_) => None,
            };
            let factor =
                factor.ok_or_else(|| wrong(at, "a length with `_mm`, `_cm`, `_m` or `_in` behind its name"))?;
            Ok(Column { at, factor })
        };
        let angle = |at: usize| {
            let factor = match names[at].1.as_deref() {
                Some("deg") => Some(1_f64.to_radians()),
                Some("rad") => Some(1.0),
                _ => None,
            };
            let factor = factor.ok_or_else(|| wrong(at, "`theta_deg` or `theta_rad`"))?;
            Ok::<Column, ReadError>(Column { at, factor })
        };
        let z = length(must("z")?)?;
        let (coordinates, radius) = match find("theta") {
            Some(theta) => (Coordinates::Polar([z, length(must("r")?)?, angle(theta)?]), None),
            None => {
                let [x, y] = [length(must("x")?)?, length(must("y")?)?];
                (Coordinates::Cartesian([x, y, z]), find("r").map(length).transpose()?)
            }
        };
        let (span, side) = (must("s")?, must("side")?);
        Ok(Columns { count: words.len(), blade: find("blade"), span, side, coordinates, radius, index: find("i") })
    }
}

struct Row {
    is_splitter: bool,
    span: f64,
    is_pressure: bool,
    point: Point,
    index: Option<(usize, String)>,
}

impl Row {
    fn check_index(&self, expected: usize, line: usize) -> Result<(), ReadError> {
        match &self.index {
            Some((column, found)) if found.parse() != Ok(expected) => {
                Err(Fault::Index { found: found.clone(), expected }.at(line, *column))
            }
            _ => Ok(()),
        }
    }

    /// Whether the row is one of a side of a section.
    fn is_of(&self, side: &Side) -> bool {
        side.is_splitter == self.is_splitter && side.span == self.span && side.is_pressure == self.is_pressure
    }

    /// Rejects a side that is there already.
    fn check_new(&self, sides: &[Side], line: usize) -> Result<(), ReadError> {
        match sides.iter().find(|side| self.is_of(side)) {
            Some(first) => {
                let side = if self.is_pressure { "pressure" } else { "suction" };
                Err(Fault::Repeated { span: self.span, side, before: first.line }.at(line, 1))
            }
            None => Ok(()),
        }
    }
}

fn row(text: &str, line: usize, columns: &Columns, frame: &PointFileFrame) -> Result<Row, ReadError> {
    refuse_commas(line, text)?;
    let words = words(text);
    let end = text.chars().count() + 1;
    if words.len() != columns.count {
        let column = words.get(columns.count).map_or(end, |(column, _)| *column);
        return Err(Fault::Values { found: words.len(), columns: columns.count }.at(line, column));
    }
    let word = |at: usize| words.get(at).copied().unwrap_or((end, ""));
    let value = |column: Column| Ok::<f64, ReadError>(number(line, word(column.at))? * column.factor);
    let is_splitter = match columns.blade.map(word) {
        None | Some((_, "1")) => false,
        Some((_, "2")) => true,
        Some((column, other)) => return Err(Fault::Blade(other.to_owned()).at(line, column)),
    };
    let (column, side) = word(columns.side);
    let is_pressure = match side.to_lowercase().as_str() {
        "ps" | "pressure" => true,
        "ss" | "suction" => false,
        _ => return Err(Fault::Side(side.to_owned()).at(line, column)),
    };
    let point = match columns.coordinates {
        Coordinates::Cartesian([x, y, z]) => {
            let place_mm = [value(x)?, value(y)?, value(z)?];
            if let Some(radius) = columns.radius {
                check_radius(value(radius)?, place_mm, frame.axis)
                    .map_err(|fault| fault.at(line, word(radius.at).0))?;
            }
            frame.axis.to_part(place_mm)
        }
        Coordinates::Polar([z, r, theta]) => {
            let radius_mm = value(r)?;
            if radius_mm <= 0.0 {
                return Err(Fault::RadiusSign(radius_mm).at(line, word(r.at).0));
            }
            let (sin, cos) = libm::sincos(value(theta)?);
            Point::new(radius_mm * cos, radius_mm * sin, value(z)?)
        }
    };
    let index = columns.index.map(word).map(|(column, word)| (column, word.to_owned()));
    Ok(Row { is_splitter, span: number(line, word(columns.span))?, is_pressure, point, index })
}

fn check_radius(stated_mm: f64, place_mm: [f64; 3], axis: RotorAxis) -> Result<(), Fault> {
    let from = |axis: RotorAxis| {
        let point = axis.to_part(place_mm);
        libm::hypot(point.x, point.y)
    };
    let fits = |found_mm: f64| (found_mm - stated_mm).abs() <= RADIUS_RATIO * stated_mm.abs();
    let found_mm = from(axis);
    if fits(found_mm) {
        return Ok(());
    }
    let hints =
        [(RotorAxis::X, ": \"x\" would do"), (RotorAxis::Y, ": \"y\" would do"), (RotorAxis::Z, ": \"z\" would do")];
    let hint = hints.iter().find(|(other, _)| fits(from(*other))).map_or(" or the units", |(_, hint)| hint);
    Err(Fault::Radius { stated_mm, found_mm, axis, hint })
}

/// Both sides of each section, all with the same number of points, and the lines where the sections begin.
fn paired(sides: Vec<Side>) -> Result<(Sections, Vec<usize>), ReadError> {
    let last = sides.last().map_or(1, |side| side.line);
    for (at, side) in sides.iter().enumerate() {
        if !sides.iter().any(|other| other.span == side.span && other.is_pressure != side.is_pressure) {
            let (missing, word) = if side.is_pressure { ("suction", "SS") } else { ("pressure", "PS") };
            return Err(Fault::OneSide { span: side.span, missing, word }.at(side.line, 1));
        }
        if side.points.len() < POINTS_MIN {
            let fault = Fault::Points { section: at / 2 + 1, found: side.points.len(), least: POINTS_MIN };
            return Err(fault.at(side.line, 1));
        }
    }
    let (pressure, mut suction): (Vec<Side>, Vec<Side>) = sides.into_iter().partition(|side| side.is_pressure);
    suction.sort_by_key(|side| pressure.iter().position(|other| other.span == side.span));
    if pressure.len() < 2 {
        return Err(Fault::Sections { found: pressure.len() }.at(last, 1));
    }
    let each = || pressure.iter().chain(&suction);
    let most = each().map(|side| side.points.len()).max().unwrap_or(0);
    let is_even = each().all(|side| side.points.len() == most);
    let spread = |side: &Side| if is_even { side.points.clone() } else { resampled(&side.points, most) };
    let lines = pressure.iter().zip(&suction).map(|(one, other)| one.line.min(other.line)).collect();
    let blade =
        Sections { pressure: pressure.iter().map(spread).collect(), suction: suction.iter().map(spread).collect() };
    Ok((blade, lines))
}
