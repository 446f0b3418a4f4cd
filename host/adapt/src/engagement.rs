//! Engagement maps: the engaged arcs of the tool's circles along each move, computed beforehand by `arcfeed engage` and
//! named by a job's rules.
//!
//! A map belongs to one program, tool and workpiece and carries their fingerprint; with others it is rejected. A move
//! is identified by its path, so that a changed transmission of the program (other feeds, a start in the middle) finds
//! its moves.

pub mod knot_cover;

pub mod sections;

use std::fmt::Write;
use std::path::Path;

use arcfeed_model::engaged::{ENGAGED_KNOTS_MAX, EngagedError, EngagedInterval, EngagedKnot, EngagedTable};
use arcfeed_nc::segment::{Path as Way, Segment};
use arcfeed_units::{MicroDeg, Mm, Nm};
use serde::Deserialize;
use toml::Spanned;

use crate::checksum::fingerprint;
use crate::file_error::FileError;
use crate::files;
use crate::place::place;
use crate::toml_reader;
use sections::{DescentTables, MappedDescents};

/// Remedy for nearly every fault.
const AGAIN: &str = "make the map anew with `arcfeed engage`";

/// Engagement map: the moves of a program with the engaged arcs of the tool along each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EngagementMap {
    /// Moves in the order of execution.
    pub moves: Vec<MappedMove>,
    /// Descending moves with their sections, for the plunge law.
    pub descents: MappedDescents,
}

/// Move of an engagement map, with the engaged arcs along it.
#[derive(Clone, Debug, PartialEq)]
pub struct MappedMove {
    /// Line of the program, counted from 1.
    pub line: usize,
    /// N number of the move's block; `None` without one.
    pub sequence: Option<i64>,
    /// Hash of the path by which the move is found ([`key`]).
    pub key: u64,
    /// Engaged arcs of the outer and the inner cutting circle along the move; `None` if they are unknown.
    pub table: Option<EngagedTable>,
}

/// Finds the moves of a program in an engagement map, in the order of execution. It keeps its place in the map.
#[derive(Clone, Debug)]
pub struct Lookup<'m> {
    ahead: &'m [MappedMove],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MapTable {
    made_of: Spanned<String>,
    #[serde(default)]
    r#move: Vec<MoveTable>,
    plunge: Option<DescentTables>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MoveTable {
    line: usize,
    n: Option<i64>,
    key: Spanned<String>,
    engaged: Option<Spanned<Vec<[f64; 5]>>>,
}

/// Hash of a move's path; feed and N number have no influence on it.
pub fn key(segment: &Segment) -> u64 {
    let ends = [segment.start, segment.end];
    let rotary = ends.iter().flat_map(|end| end.rotary.map(|MicroDeg(microdeg)| microdeg));
    key_of(linear(segment).into_iter().chain(rotary))
}

/// Hash of a move's path; feed, N number and the positions of the rotary axes have no influence on it.
pub fn key_at_any_position(segment: &Segment) -> u64 {
    key_of(linear(segment).into_iter())
}

fn key_of(numbers: impl Iterator<Item = i64>) -> u64 {
    fingerprint(&numbers.flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>())
}

/// End points and shape of a move.
fn linear(segment: &Segment) -> Vec<i64> {
    let ends = [segment.start, segment.end];
    let mut numbers: Vec<i64> = ends.iter().flat_map(|end| end.linear.map(|Nm(nm)| nm)).collect();
    match &segment.path {
        Way::Rapid => numbers.push(0),
        Way::Line => numbers.push(1),
        Way::Arc(arc) => {
            let (first, second, _) = arc.plane.axes();
            let plane = [first as i64, second as i64];
            numbers.extend([2, i64::from(arc.turn.sign())].into_iter().chain(plane));
            numbers.extend(arc.center.map(|Nm(nm)| nm));
        }
    }
    numbers
}

impl EngagementMap {
    /// Reads a map from its file. `made_of` is the fingerprint of the input from which the map must have been
    /// computed.
    ///
    /// # Errors
    /// The file is not an engagement map, or its input was different.
    pub fn read(path: &Path, made_of: u64) -> Result<Self, FileError> {
        let text = files::read_to_string(path).map_err(|source| match source.kind() {
            std::io::ErrorKind::NotFound => FileError::Content {
                path: path.into(),
                line: 1,
                column: 1,
                message: "there is no such engagement map yet; make it with `arcfeed engage`".into(),
            },
            _ => FileError::Read { path: path.into(), source },
        })?;
        EngagementMap::parse(&text, made_of).map_err(|(offset, message)| {
            let [line, column] = place(&text, offset);
            FileError::Content { path: path.into(), line, column, message }
        })
    }

    fn parse(text: &str, made_of: u64) -> Result<Self, (usize, String)> {
        let table: MapTable = toml_reader::read(text)
            .map_err(|(offset, message)| (offset, format!("no engagement map: {message}; {AGAIN}")))?;
        if hex(&table.made_of) != Some(made_of) {
            let message = format!("this map is of another program, tool or workpiece than the job's; {AGAIN}");
            return Err((table.made_of.span().start, message));
        }
        let moves = table.r#move.iter().map(MappedMove::parse);
        let descents = table.plunge.as_ref().map(MappedDescents::parse).transpose()?.unwrap_or_default();
        Ok(EngagementMap { moves: moves.collect::<Result<_, _>>()?, descents })
    }

    /// Text of the map's file. `made_of` is the fingerprint of the input from which the map was computed.
    pub fn text(&self, made_of: u64) -> String {
        let mut text = format!(
            "# Where the tool's circles are engaged along each move, by `arcfeed engage`: path, mm; outer circle from, to, inner circle from, to, degrees\n\
             # (0: towards the rotation centre, on a line to its left; 90: straight ahead).\n\
             made_of = \"{made_of:016x}\"\n"
        );
        for MappedMove { line, sequence, key, table } in &self.moves {
            // Writing to a string never fails.
            let _ = write!(text, "\n[[move]]\nline = {line}\n");
            if let Some(n) = sequence {
                let _ = writeln!(text, "n = {n}");
            }
            let _ = writeln!(text, "key = \"{key:016x}\"");
            if let Some(table) = table {
                let rows: Vec<String> = table.knots().iter().map(row).collect();
                let _ = writeln!(text, "engaged = [\n    {},\n]", rows.join(",\n    "));
            }
        }
        self.descents.write(&mut text);
        text
    }

    /// Lookup that starts at the first move of the map.
    pub fn lookup(&self) -> Lookup<'_> {
        Lookup { ahead: &self.moves }
    }
}

impl<'m> Lookup<'m> {
    /// Engaged arcs of the program's next move: those of the next entry of the map with the same path; `None` if there
    /// is none. Entries before it, whose moves did not come, are skipped.
    pub fn next(&mut self, segment: &Segment) -> Option<&'m EngagedTable> {
        let key = key(segment);
        let at = self.ahead.iter().position(|moved| moved.key == key)?;
        let found = &self.ahead[at];
        self.ahead = &self.ahead[at + 1..];
        found.table.as_ref()
    }
}

impl MappedMove {
    fn parse(table: &MoveTable) -> Result<Self, (usize, String)> {
        let wrong = |offset: usize, what: String| (offset, format!("{what}; {AGAIN}"));
        let key = hex(&table.key);
        let key = key.ok_or_else(|| wrong(table.key.span().start, "`key` is 16 hexadecimal digits".into()))?;
        let engaged = table.engaged.as_ref().map(|rows| {
            let knots = rows.as_ref().iter().map(knot).collect::<Option<Vec<EngagedKnot>>>();
            let knots =
                knots.ok_or("from and to are degrees between -360 and 360, `to` at most 360 above `from`".into());
            let built = knots.and_then(|knots| EngagedTable::new(&knots).map_err(|error| description(&error)));
            built.map_err(|what| wrong(rows.span().start, what))
        });
        Ok(MappedMove { line: table.line, sequence: table.n, key, table: engaged.transpose()? })
    }
}

fn description(error: &EngagedError) -> String {
    match error {
        EngagedError::Count => format!("a move has 1 to {ENGAGED_KNOTS_MAX} knots"),
        EngagedError::Order(index) => format!("the path must grow from knot to knot, and does not at {}", index + 1),
    }
}

fn knot([path_mm, outer_from, outer_to, inner_from, inner_to]: &[f64; 5]) -> Option<EngagedKnot> {
    Some(EngagedKnot {
        travelled: Mm(*path_mm as f32),
        outer: EngagedInterval::from_degrees(*outer_from, *outer_to)?,
        inner: EngagedInterval::from_degrees(*inner_from, *inner_to)?,
    })
}

/// Row of the file, read back without a rounding error: an interval is in whole ninetieths of a degree.
fn row(knot: &EngagedKnot) -> String {
    let ([a, b], [c, d]) = (knot.outer.degrees(), knot.inner.degrees());
    format!("[{}, {a:.3}, {b:.3}, {c:.3}, {d:.3}]", float(knot.travelled.0))
}

/// Writes a float with a point, by which TOML distinguishes it from an integer.
fn float(number: f32) -> String {
    format!("{number:?}")
}

fn hex(text: &Spanned<String>) -> Option<u64> {
    let text = text.as_ref();
    (text.len() == 16).then(|| u64::from_str_radix(text, 16).ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::sections::{MappedDescent, MappedJoint, MappedSection, TangentialForce};
    use super::*;
    use arcfeed_nc::modal::{Feed, Pose};

    fn line_to(x: i64) -> Segment {
        let end = Pose { linear: [Nm(x), Nm(0), Nm(0)], ..Pose::default() };
        Segment { sequence: None, start: Pose::default(), end, feed: Feed::Missing, path: Way::Line }
    }

    fn moved(x: i64, travelled_mm: f32) -> MappedMove {
        let interval = |from, to| EngagedInterval::from_degrees(from, to).unwrap();
        let knot =
            |mm| EngagedKnot { travelled: Mm(mm), outer: interval(1.0 / 3.0, 91.0), inner: interval(-0.1, 7.01) };
        let table = EngagedTable::new(&[knot(0.0), knot(travelled_mm)]).ok();
        MappedMove { line: 3, sequence: Some(x), key: key(&line_to(x)), table }
    }

    fn descents() -> MappedDescents {
        let section = |at_mm, end_mm2| MappedSection { at_mm, end_mm2, side_mm2: 0.125 };
        let sections = vec![section(0.0, 0.0), section(1.5, 12.345)];
        let joint = MappedJoint { end_mm2: 12.345, side_mm2: 0.125, sine_ratio: 1.0, cosine_ratio: 0.5 };
        let joints = [None, Some(joint)];
        let known = MappedDescent { line: 4, sequence: Some(9), key: key(&line_to(2)), sections, joints };
        let unknown =
            MappedDescent { line: 6, sequence: None, key: key(&line_to(3)), sections: Vec::new(), joints: [None; 2] };
        let force = TangentialForce { specific_mpa: 800.0, exponent_ratio: 0.25, edge_n_per_mm: 0.0 };
        MappedDescents { force, moves: vec![known, unknown] }
    }

    #[test]
    fn a_descending_move_finds_the_next_of_its_kind() {
        let descents = descents();
        let mut lookup = descents.lookup();
        assert_eq!(lookup.next(&line_to(5)), None);
        assert_eq!(lookup.next(&line_to(2)).map(|found| found.sections.len()), Some(2));
        assert_eq!((lookup.next(&line_to(2)), lookup.next(&line_to(3))), (None, None));
    }

    #[test]
    fn a_map_comes_back_to_the_bit() {
        let unknown = MappedMove { table: None, sequence: None, ..moved(9, 1.0) };
        let map = EngagementMap { moves: vec![moved(5, 0.1), unknown, moved(7, 12.345_679)], descents: descents() };
        assert_eq!(EngagementMap::parse(&map.text(77), 77), Ok(map));
    }

    #[test]
    fn sections_of_another_version_are_refused() {
        let map = EngagementMap { moves: Vec::new(), descents: descents() };
        for (to, expected) in
            [("version = 1", "these sections are of another version"), ("", "missing field `version`")]
        {
            let (_, said) = EngagementMap::parse(&map.text(77).replacen("version = 3", to, 1), 77).unwrap_err();
            assert!(said.contains(expected) && said.contains("arcfeed engage"), "{said}");
        }
    }

    #[test]
    fn a_move_finds_the_next_of_its_kind_and_passes_those_that_never_come() {
        let map =
            EngagementMap { moves: vec![moved(5, 1.0), moved(7, 2.0), moved(5, 3.0)], ..EngagementMap::default() };
        let mut lookup = map.lookup();
        let path = |table: Option<&EngagedTable>| table.map(|table| table.knots()[1].travelled.0);
        assert_eq!(path(lookup.next(&line_to(7))), Some(2.0));
        assert_eq!(path(lookup.next(&line_to(6))), None);
        assert_eq!(path(lookup.next(&line_to(5))), Some(3.0));
        assert_eq!(path(lookup.next(&line_to(5))), None);
    }

    #[test]
    fn what_is_no_map_of_this_is_refused_with_its_place() {
        let text = EngagementMap { moves: vec![moved(5, 1.0)], ..EngagementMap::default() }.text(77);
        let said = |text: &str, made_of| {
            let (offset, message) = EngagementMap::parse(text, made_of).unwrap_err();
            format!("{:?} {message}", place(text, offset))
        };
        assert!(said(&text, 78).starts_with("[3, 11] this map is of another program"), "{}", said(&text, 78));
        for (from, to, expected) in [
            ("engaged = [", "engage = [", "[9, 1] no engagement map"),
            ("key = \"", "key = \"0", "[8, 7] `key` is 16"),
            ("[1.0,", "[0.0,", "[9, 11] the path must grow"),
            ("91.000", "999.0", "[9, 11] from and to are degrees"),
        ] {
            let said = said(&text.replacen(from, to, 1), 77);
            assert!(said.starts_with(expected) && said.contains("arcfeed engage"), "{said}");
        }
    }
}
