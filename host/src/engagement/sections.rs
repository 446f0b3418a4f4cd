//! Sections of descending moves in an engagement map, and the material's tangential force, for the plunge law.

use std::fmt::Write;

use arcfeed_nc::segment::Segment;
use serde::Deserialize;
use toml::Spanned;

use super::{AGAIN, hex, key};

/// Engaged section of the tool at one place of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MappedSection {
    /// Path of the move up to it, mm.
    pub at_mm: f64,
    /// Largest sum of the moments of the end's edges over a turn.
    pub end_mm2: f64,
    /// The same of the sides, which cut only on a ramp.
    pub side_mm2: f64,
}

/// Tangential force of a chip for each millimetre of its width, k h^(1 - m) + e.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TangentialForce {
    /// k, N/mm2.
    pub specific_mpa: f64,
    /// m; 0 for a linear model.
    pub exponent_ratio: f64,
    /// e, N/mm.
    pub edge_n_per_mm: f64,
}

impl TangentialForce {
    /// Force of a chip of this thickness, N/mm; none without a chip.
    pub fn n_per_mm(&self, thickness_mm: f64) -> f64 {
        if thickness_mm > 0.0 {
            self.specific_mpa * libm::pow(thickness_mm, 1.0 - self.exponent_ratio) + self.edge_n_per_mm
        } else {
            0.0
        }
    }
}

/// A descending move of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct MappedDescent {
    /// Line of the program, counted from 1.
    pub line: usize,
    /// N of its block.
    pub sequence: Option<i64>,
    /// [`key`] of the move.
    pub key: u64,
    /// Sections along it; empty if they are unknown.
    pub sections: Vec<MappedSection>,
}

/// The descending moves of a map, in the order of execution.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MappedDescents {
    /// Tangential force of the material.
    pub force: TangentialForce,
    /// The moves.
    pub moves: Vec<MappedDescent>,
}

/// Looks descending moves up in the order of execution; state.
#[derive(Clone, Debug)]
pub struct DescentLookup<'m> {
    ahead: &'m [MappedDescent],
}

/// The descending moves as serde reads them.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DescentTables {
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
}

impl MappedDescents {
    /// Lookup before the first move.
    pub fn lookup(&self) -> DescentLookup<'_> {
        DescentLookup { ahead: &self.moves }
    }

    pub(super) fn parse(tables: &DescentTables) -> Result<Self, (usize, String)> {
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
             [plunge]\ntangential = [{specific_mpa:?}, {exponent_ratio:?}, {edge_n_per_mm:?}]\n"
        );
        for MappedDescent { line, sequence, key, sections } in &self.moves {
            let _ = write!(text, "\n[[plunge.move]]\nline = {line}\n");
            if let Some(n) = sequence {
                let _ = writeln!(text, "n = {n}");
            }
            let rows: Vec<String> = sections.iter().map(row).collect();
            let _ = write!(text, "key = \"{key:016x}\"\nsection = [\n    {}\n]\n", rows.join(",\n    "));
        }
    }
}

impl<'m> DescentLookup<'m> {
    /// Sections of a move: those of the next entry with the same path. An entry whose move never comes does not hide
    /// later ones.
    pub fn next(&mut self, segment: &Segment) -> Option<&'m [MappedSection]> {
        let key = key(segment);
        let at = self.ahead.iter().position(|moved| moved.key == key)?;
        let found = &self.ahead[at];
        self.ahead = &self.ahead[at + 1..];
        Some(found.sections.as_slice()).filter(|sections| !sections.is_empty())
    }
}

impl MappedDescent {
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
        Ok(MappedDescent { line: table.line, sequence: table.n, key, sections: rows.iter().map(section).collect() })
    }
}

/// Row of the file.
fn row(section: &MappedSection) -> String {
    let up = |load: f64| libm::ceil(load * 1e3) / 1e3;
    format!("[{:.4}, {:.3}, {:.3}]", section.at_mm, up(section.end_mm2), up(section.side_mm2))
}
