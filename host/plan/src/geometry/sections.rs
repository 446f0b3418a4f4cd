//! Table of sections: one point per line, columns by name.
//!
//! ```text
//! s,R_mm,side,i,x_mm,y_mm,z_mm
//! 0.0000,70.0000,PS,0,-6.095401,-11.478319,69.734110
//! ```
//!
//! A section has one `s`; each side goes from the leading to the trailing edge. `R_mm` (distance from the axis) and `i`
//! (from 0) are checked against the points. Sides with fewer points than the longest one are resampled.

use crate::vector::Point;

use super::blade::{RotorAxis, Sections};
use super::blisk::Revolution;
use super::point_file::{Fault, PointFileFrame, ReadError, number, words};
use super::resampling::resampled;

/// Least number of points of a side.
const POINTS_MIN: usize = 5;

/// Tolerance of R, as a fraction of it.
const RADIUS_RATIO: f64 = 1e-3;

/// Indices of the columns.
struct Columns {
    span: usize,
    side: usize,
    place: [usize; 3],
    radius: Option<usize>,
    index: Option<usize>,
}

/// Side of a section, and the line where it begins.
struct Side {
    is_pressure: bool,
    line: usize,
    points: Vec<Point>,
}

/// Reads a table of sections of a rotor with this hub.
///
/// # Errors
/// The fault with its place.
pub fn read(text: &str, frame: &PointFileFrame, hub: &Revolution) -> Result<Sections, ReadError> {
    let mut lines = text.lines().enumerate().map(|(at, line)| (at + 1, line));
    let (first, header) = lines.find(|(_, line)| !line.trim().is_empty()).unwrap_or((1, ""));
    let columns = columns(header).map_err(|fault| fault.at(first, 1))?;
    let mut sides: Vec<Side> = Vec::new();
    let mut last: Option<(f64, bool)> = None;
    for (line, text) in lines.filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#')) {
        let row = row(text, line, &columns, frame)?;
        if last != Some((row.span, row.is_pressure)) {
            sides.push(Side { is_pressure: row.is_pressure, line, points: Vec::new() });
            last = Some((row.span, row.is_pressure));
        }
        if let Some(side) = sides.last_mut() {
            row.check_index(side.points.len(), line)?;
            side.points.push(row.point);
        }
    }
    let (blade, lines) = paired(sides)?;
    frame.check(&blade, hub, &lines)?;
    let bulge_mm = blade.bulge_mm();
    if bulge_mm < 0.0 {
        return Err(Fault::Swapped { shorter_mm: -bulge_mm }.at(lines[0], 1));
    }
    Ok(blade)
}

fn columns(header: &str) -> Result<Columns, Fault> {
    let names: Vec<String> =
        words(header).iter().map(|(_, word)| word.trim_end_matches("_mm").to_lowercase()).collect();
    let find = |name: &'static str| names.iter().position(|known| known == name);
    let must = |name: &'static str| find(name).ok_or(Fault::Column(name));
    let place = [must("x")?, must("y")?, must("z")?];
    Ok(Columns { span: must("s")?, side: must("side")?, place, radius: find("r"), index: find("i") })
}

struct Row {
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
}

fn row(text: &str, line: usize, columns: &Columns, frame: &PointFileFrame) -> Result<Row, ReadError> {
    let words = words(text);
    let end = text.chars().count() + 1;
    let word = |at: usize| words.get(at).copied().unwrap_or((end, ""));
    let mut place = [0.0; 3];
    for (value, at) in place.iter_mut().zip(columns.place) {
        *value = number(line, word(at))?;
    }
    let (column, side) = word(columns.side);
    let is_pressure = match side.to_lowercase().as_str() {
        "ps" | "pressure" => true,
        "ss" | "suction" => false,
        _ => return Err(Fault::Side(side.to_owned()).at(line, column)),
    };
    let point = frame.point(place);
    if let Some(at) = columns.radius {
        let stated_mm = number(line, word(at))? * frame.unit_mm;
        check_radius(stated_mm, place.map(|value| value * frame.unit_mm), frame.axis)
            .map_err(|fault| fault.at(line, word(at).0))?;
    }
    let index = columns.index.map(word).map(|(column, word)| (column, word.to_owned()));
    Ok(Row { span: number(line, word(columns.span))?, is_pressure, point, index })
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
    let (pressure, suction): (Vec<Side>, Vec<Side>) = sides.into_iter().partition(|side| side.is_pressure);
    if pressure.len() < 2 || pressure.len() != suction.len() {
        return Err(Fault::Sections { found: pressure.len().min(suction.len()) }.at(last, 1));
    }
    let each = || pressure.iter().chain(&suction);
    for (at, side) in pressure.iter().enumerate().chain(suction.iter().enumerate()) {
        if side.points.len() < POINTS_MIN {
            let fault = Fault::Points { section: at + 1, found: side.points.len(), least: POINTS_MIN };
            return Err(fault.at(side.line, 1));
        }
    }
    let most = each().map(|side| side.points.len()).max().unwrap_or(0);
    let is_even = each().all(|side| side.points.len() == most);
    let spread = |side: &Side| if is_even { side.points.clone() } else { resampled(&side.points, most) };
    let lines = pressure.iter().zip(&suction).map(|(one, other)| one.line.min(other.line)).collect();
    let blade =
        Sections { pressure: pressure.iter().map(spread).collect(), suction: suction.iter().map(spread).collect() };
    Ok((blade, lines))
}
