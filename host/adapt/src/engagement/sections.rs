//! Sections of descending moves in an engagement map, and the material's tangential force, for the plunge law.

use std::fmt::Write;

use arcfeed_nc::segment::Segment;
use serde::Deserialize;
use toml::Spanned;

use super::{AGAIN, hex, key};

/// Version of the sections in a file: 3 has whole arcs in front of descending moves.
const VERSION: u32 = 3;

/// Engaged section at one place of a descending move: the parts of the tool's end and sides that are in material. A moment is the sum of
/// radius times engaged width over the edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MappedSection {
    /// Path along the move up to the place, mm.
    pub at_mm: f64,
    /// Largest moment of the end's edges within a turn, mm2.
    pub end_mm2: f64,
    /// Largest moment of the sides' edges within a turn, mm2; 0 for a plunge, because sides cut only on a ramp.
    pub side_mm2: f64,
}

/// Tangential cutting force per millimetre of chip width, as a function of the chip thickness h in mm: k h^(1 - m) + e, N/mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TangentialForce {
    /// k: specific cutting force, N/mm2.
    pub specific_mpa: f64,
    /// m: exponent of the thickness; 0 for a linear model.
    pub exponent_ratio: f64,
    /// e: edge force, N/mm.
    pub edge_n_per_mm: f64,
}

impl TangentialForce {
    /// Force per width of a chip of this thickness, N/mm; 0 if there is no chip.
    pub fn n_per_mm(&self, thickness_mm: f64) -> f64 {
        if thickness_mm > 0.0 {
            self.specific_mpa * libm::pow(thickness_mm, 1.0 - self.exponent_ratio) + self.edge_n_per_mm
        } else {
            0.0
        }
    }
}

/// Engaged section where one descending move passes into another: there the first tooth cuts the material that both
/// moves have left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MappedJoint {
    /// Largest moment of the end's edges within a turn, mm2.
    pub end_mm2: f64,
    /// Largest moment of the sides' edges within a turn, mm2.
    pub side_mm2: f64,
    /// Larger one of the sines, for both moves, of the angle from the plane square to the tool's axis.
    pub sine_ratio: f64,
    /// Larger one of the cosines of these angles.
    pub cosine_ratio: f64,
}

/// Descending move of an engagement map, with the sections along it.
#[derive(Clone, Debug, PartialEq)]
pub struct MappedDescent {
    /// Line of the program, counted from 1.
    pub line: usize,
    /// N number of the move's block; `None` without one.
    pub sequence: Option<i64>,
    /// Hash of the path by which the move is found ([`key`]).
    pub key: u64,
    /// Sections in the order of the path; empty if they are unknown.
    pub sections: Vec<MappedSection>,
    /// Joints with the descending move directly before and directly after this one; `None` where there is no such move.
    pub joints: [Option<MappedJoint>; 2],
}

/// Descending moves of an engagement map, in the order of execution.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MappedDescents {
    /// Tangential cutting force of the workpiece's material.
    pub force: TangentialForce,
    /// Descending moves in the order of execution.
    pub moves: Vec<MappedDescent>,
}

/// Finds the descending moves of a program in an engagement map, in the order of execution. It keeps its place in the map.
#[derive(Clone, Debug)]
pub struct DescentLookup<'m> {
    ahead: &'m [MappedDescent],
}

/// The descending moves as serde reads them.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DescentTables {
    version: Spanned<u32>,
    tangential: [f64; 3],
    #[serde(default)]
    r#move: Vec<DescentTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DescentTable {
    line: usize,
    n: Option<i64>,
    key: Spanned<String>,
    section: Spanned<Vec<[f64; 3]>>,
    before: Option<Spanned<[f64; 4]>>,
    behind: Option<Spanned<[f64; 4]>>,
}

impl MappedDescents {
    /// Lookup that starts at the first move of the map.
    pub fn lookup(&self) -> DescentLookup<'_> {
        DescentLookup { ahead: &self.moves }
    }

    pub(super) fn parse(tables: &DescentTables) -> Result<Self, (usize, String)> {
        if *tables.version.as_ref() != VERSION {
            let message = format!("these sections are of another version than {VERSION}; {AGAIN}");
            return Err((tables.version.span().start, message));
        }
        let [specific_mpa, exponent_ratio, edge_n_per_mm] = tables.tangential;
        let moves = tables.r#move.iter().map(MappedDescent::parse).collect::<Result<_, _>>()?;
        Ok(MappedDescents { force: TangentialForce { specific_mpa, exponent_ratio, edge_n_per_mm }, moves })
    }

    /// Appends them to the text of the map. Loads are rounded up.
    pub(super) fn write(&self, text: &mut String) {
        if self.moves.is_empty() {
            return;
        }
        let TangentialForce { specific_mpa, exponent_ratio, edge_n_per_mm } = self.force;
        // Writing to a string never fails.
        let _ = write!(
            text,
            "\n# Sections of the moves that descend: path, mm; moments of the edges on the end and on the sides, mm2.\n\
             # Tangential force of a chip h mm thick and 1 mm wide: k h^(1 - m) + e, [k, m, e] in N and mm.\n\
             # before, behind: the same where the move joins another one, with the sine and cosine of the steeper and the flatter one.\n\
             [plunge]\nversion = {VERSION}\ntangential = [{specific_mpa:?}, {exponent_ratio:?}, {edge_n_per_mm:?}]\n"
        );
        for MappedDescent { line, sequence, key, sections, joints } in &self.moves {
            let _ = write!(text, "\n[[plunge.move]]\nline = {line}\n");
            if let Some(n) = sequence {
                let _ = writeln!(text, "n = {n}");
            }
            let rows: Vec<String> = sections.iter().map(row).collect();
            let _ = write!(text, "key = \"{key:016x}\"\nsection = [\n    {}\n]\n", rows.join(",\n    "));
            for (name, joint) in ["before", "behind"].into_iter().zip(joints) {
                let _ = joint.map_or(Ok(()), |joint| writeln!(text, "{name} = {}", joint.row()));
            }
        }
    }
}

impl<'m> DescentLookup<'m> {
    /// Entry of the program's next descending move: the next one of the map with the same path. Entries before it, whose
    /// moves did not come, are skipped. `None` if there is no such entry, or its sections are unknown.
    pub fn next(&mut self, segment: &Segment) -> Option<&'m MappedDescent> {
        let key = key(segment);
        let at = self.ahead.iter().position(|moved| moved.key == key)?;
        let found = &self.ahead[at];
        self.ahead = &self.ahead[at + 1..];
        Some(found).filter(|found| !found.sections.is_empty())
    }
}

impl MappedDescent {
    /// Whether the tool meets no material on the move.
    pub fn is_in_air(&self) -> bool {
        !self.sections.is_empty()
            && self.sections.iter().all(|section| section.end_mm2 <= 0.0 && section.side_mm2 <= 0.0)
    }

    fn parse(table: &DescentTable) -> Result<Self, (usize, String)> {
        let wrong = |offset: usize, what: &str| (offset, format!("{what}; {AGAIN}"));
        let key = hex(&table.key);
        let key = key.ok_or_else(|| wrong(table.key.span().start, "`key` is 16 hexadecimal digits"))?;
        let rows = table.section.as_ref();
        let grows = rows.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        if !grows || rows.iter().flatten().any(|number| !number.is_finite() || *number < -1.0) {
            return Err(wrong(
                table.section.span().start,
                "the path must grow from section to section, with loads from 0",
            ));
        }
        let section = |[at_mm, end_mm2, side_mm2]: &[f64; 3]| MappedSection {
            at_mm: *at_mm,
            end_mm2: *end_mm2,
            side_mm2: *side_mm2,
        };
        let joint = |joint: &Option<Spanned<[f64; 4]>>| {
            let parse = |row: &Spanned<[f64; 4]>| {
                let what = "a joint has two loads from 0, and a sine and a cosine from 0 to 1";
                MappedJoint::parse(row.as_ref()).ok_or_else(|| wrong(row.span().start, what))
            };
            joint.as_ref().map(parse).transpose()
        };
        Ok(MappedDescent {
            line: table.line,
            sequence: table.n,
            key,
            sections: rows.iter().map(section).collect(),
            joints: [joint(&table.before)?, joint(&table.behind)?],
        })
    }
}

impl MappedJoint {
    fn parse(&[end_mm2, side_mm2, sine_ratio, cosine_ratio]: &[f64; 4]) -> Option<Self> {
        let is_joint = [end_mm2, side_mm2].iter().all(|load| load.is_finite() && *load >= 0.0)
            && [sine_ratio, cosine_ratio].iter().all(|ratio| (0.0..=1.0).contains(ratio));
        is_joint.then_some(MappedJoint { end_mm2, side_mm2, sine_ratio, cosine_ratio })
    }

    /// Row of the file.
    fn row(&self) -> String {
        let up = |ratio: f64| (libm::ceil(ratio * 1e6) / 1e6).min(1.0);
        let [end, side] = [self.end_mm2, self.side_mm2].map(rounded_up);
        format!("[{end:.3}, {side:.3}, {:.6}, {:.6}]", up(self.sine_ratio), up(self.cosine_ratio))
    }
}

/// Row of the file.
fn row(section: &MappedSection) -> String {
    format!("[{:.4}, {:.3}, {:.3}]", section.at_mm, rounded_up(section.end_mm2), rounded_up(section.side_mm2))
}

fn rounded_up(load: f64) -> f64 {
    libm::ceil(load * 1e3) / 1e3
}
