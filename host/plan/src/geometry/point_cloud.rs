//! Measured points: tables of a coordinate measuring machine, and clouds of a scanner.
//!
//! A table has one point a line and names its columns: `x`, `y`, `z`, with their unit behind (`x_mm`, `x_in`) or that of the whole file; other columns
//! are skipped. A PLY file (Stanford, version 1.0) is ASCII or binary of either order; of an STL file the corners are taken.

use std::collections::HashSet;
use std::io::{Cursor, Error, ErrorKind};

use arcfeed_units::{LengthUnit, MM_PER_M};

use super::point_file::{Fault, PointFileFrame, ReadError, lines, number, refuse_commas, words};
use crate::vector::Point;

/// Least number of points of a measurement.
const POINTS_MIN: usize = 20;
/// Types of PLY's properties, and their sizes in bytes.
const PLY_TYPES: [(&str, usize); 16] = [
    ("char", 1),
    ("int8", 1),
    ("uchar", 1),
    ("uint8", 1),
    ("short", 2),
    ("int16", 2),
    ("ushort", 2),
    ("uint16", 2),
    ("int", 4),
    ("int32", 4),
    ("uint", 4),
    ("uint32", 4),
    ("float", 4),
    ("float32", 4),
    ("double", 8),
    ("float64", 8),
];

/// Points of a table.
///
/// # Errors
/// The fault with its place.
pub fn from_table(text: &str, frame: &PointFileFrame) -> Result<Vec<Point>, ReadError> {
    let mut lines = lines(text).filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'));
    let (first, header) = lines.next().unwrap_or((1, ""));
    let names = words(header);
    let mut columns = [(0, 0.0); 3];
    for (column, name) in columns.iter_mut().zip(["x", "y", "z"]) {
        let is_it = |(_, word): &(usize, &str)| word.to_lowercase().split('_').next() == Some(name);
        let at = names.iter().position(is_it).ok_or(Fault::Column(name).at(first, 1))?;
        *column = (at, unit(names[at], frame.unit_mm).map_err(|fault| fault.at(first, names[at].0))?);
    }
    let mut points = Vec::new();
    let mut last = first;
    for (line, text) in lines {
        refuse_commas(line, text)?;
        let words = words(text);
        if words.len() != names.len() {
            let column = words.get(names.len()).map_or(text.chars().count() + 1, |(column, _)| *column);
            return Err(Fault::Values { found: words.len(), columns: names.len() }.at(line, column));
        }
        let mut place = [0.0; 3];
        for (value, (at, factor)) in place.iter_mut().zip(columns) {
            *value = number(line, words[at])? * factor;
        }
        points.push(frame.axis.to_part(place));
        last = line;
    }
    if points.len() < POINTS_MIN {
        return Err(Fault::Measurement { found: points.len(), least: POINTS_MIN }.at(last, 1));
    }
    Ok(points)
}

fn unit((_, name): (usize, &str), file_mm: f64) -> Result<f64, Fault> {
    match name.to_lowercase().split_once('_').map(|(_, unit)| unit) {
        None => Ok(file_mm),
        Some("mm") => Ok(1.0),
        Some("cm") => Ok(10.0),
        Some("m") => Ok(MM_PER_M),
        Some("in" | "inch") => Ok(LengthUnit::Inch.mm()),
        Some(_) => {
            let wanted = "a length with `_mm`, `_cm`, `_m` or `_in` behind its name";
            Err(Fault::Unit { found: name.to_owned(), wanted })
        }
    }
}

/// Corners of an STL file, each once.
///
/// # Errors
/// The file is no STL file, or not complete.
pub fn from_stl(bytes: &[u8], frame: &PointFileFrame) -> std::io::Result<Vec<Point>> {
    let mut seen = HashSet::new();
    let mut points = Vec::new();
    for triangle in stl_io::create_stl_reader(&mut Cursor::new(bytes))? {
        for vertex in triangle?.vertices {
            if seen.insert(vertex.0.map(f32::to_bits)) {
                points.push(frame.point(vertex.0.map(f64::from)));
            }
        }
    }
    Ok(points)
}

/// Layout of the vertices of a PLY file.
struct PlyLayout {
    is_ascii: bool,
    is_big_endian: bool,
    vertices: usize,
    /// Type and size of each property of a vertex.
    properties: Vec<(String, usize)>,
    /// x, y, z among the properties.
    columns: [usize; 3],
    /// Place at which the data begin.
    start: usize,
}

/// Vertices of a PLY file.
///
/// # Errors
/// The file is no PLY file, or not complete.
pub fn from_ply(bytes: &[u8], frame: &PointFileFrame) -> std::io::Result<Vec<Point>> {
    let layout = PlyLayout::read(bytes)?;
    let data = &bytes[layout.start..];
    let places = if layout.is_ascii { layout.ascii(data) } else { layout.binary(data) };
    let places = places.ok_or_else(|| broken("the vertices are not complete"))?;
    Ok(places.into_iter().map(|place| frame.point(place)).collect())
}

fn broken(message: &str) -> Error {
    Error::new(ErrorKind::InvalidData, message.to_owned())
}

impl PlyLayout {
    fn read(bytes: &[u8]) -> std::io::Result<Self> {
        const END: &[u8] = b"end_header";
        let end = bytes.windows(END.len()).position(|window| window == END).ok_or_else(|| broken("no end_header"))?;
        let data = bytes[end..].iter().position(|byte| *byte == b'\n').ok_or_else(|| broken("no data"))?;
        let header = String::from_utf8_lossy(&bytes[..end]);
        let mut layout = PlyLayout {
            is_ascii: false,
            is_big_endian: false,
            vertices: 0,
            properties: Vec::new(),
            columns: [usize::MAX; 3],
            start: end + data + 1,
        };
        let mut is_vertex = false;
        let mut elements = 0;
        for line in header.lines() {
            match line.split_whitespace().collect::<Vec<_>>().as_slice() {
                ["format", kind, ..] => {
                    layout.is_ascii = *kind == "ascii";
                    layout.is_big_endian = *kind == "binary_big_endian";
                }
                ["element", name, count] => {
                    is_vertex = *name == "vertex" && elements == 0;
                    elements += 1;
                    if is_vertex {
                        layout.vertices = count.parse().map_err(|_| broken("no number of vertices"))?;
                    }
                }
                ["property", kind, name] if is_vertex => layout.add(kind, name)?,
                ["property", "list", ..] if is_vertex => return Err(broken("a list in the vertices")),
                _ => {}
            }
        }
        let is_whole = bytes.starts_with(b"ply") && layout.vertices > 0 && !layout.columns.contains(&usize::MAX);
        if is_whole { Ok(layout) } else { Err(broken("the first element must be `vertex` with x, y and z")) }
    }

    fn add(&mut self, kind: &str, name: &str) -> std::io::Result<()> {
        let known = PLY_TYPES.iter().find(|(known, _)| *known == kind).ok_or_else(|| broken("an unknown type"))?;
        if let Some(axis) = ["x", "y", "z"].iter().position(|axis| *axis == name) {
            if !kind.starts_with("float") && !kind.starts_with("double") {
                return Err(broken("x, y and z must be of type float or double"));
            }
            self.columns[axis] = self.properties.len();
        }
        self.properties.push((kind.to_owned(), known.1));
        Ok(())
    }

    fn ascii(&self, data: &[u8]) -> Option<Vec<[f64; 3]>> {
        let text = String::from_utf8_lossy(data);
        let mut places = Vec::with_capacity(self.vertices.min(data.len()));
        for line in text.lines().filter(|line| !line.trim().is_empty()).take(self.vertices) {
            let words: Vec<&str> = line.split_whitespace().collect();
            let mut place = [0.0; 3];
            for (value, column) in place.iter_mut().zip(self.columns) {
                *value = words.get(column)?.parse().ok().filter(|value: &f64| value.is_finite())?;
            }
            places.push(place);
        }
        (places.len() == self.vertices).then_some(places)
    }

    fn binary(&self, data: &[u8]) -> Option<Vec<[f64; 3]>> {
        let size: usize = self.properties.iter().map(|(_, size)| size).sum();
        let data = data.get(..self.vertices.checked_mul(size)?)?;
        let starts = self.columns.map(|column| self.properties[..column].iter().map(|(_, size)| size).sum::<usize>());
        let value = |vertex: &[u8], axis: usize| {
            let bytes = vertex.get(starts[axis]..)?;
            let value = match (self.properties[self.columns[axis]].1, self.is_big_endian) {
                (4, false) => f64::from(f32::from_le_bytes(bytes.first_chunk().copied()?)),
                (4, true) => f64::from(f32::from_be_bytes(bytes.first_chunk().copied()?)),
                (_, false) => f64::from_le_bytes(bytes.first_chunk().copied()?),
                (_, true) => f64::from_be_bytes(bytes.first_chunk().copied()?),
            };
            value.is_finite().then_some(value)
        };
        data.chunks_exact(size).map(|vertex| Some([value(vertex, 0)?, value(vertex, 1)?, value(vertex, 2)?])).collect()
    }
}
