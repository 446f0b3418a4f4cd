//! Section of the page with the marks on walls: the map, the layers, and the blocks with vibration.

use std::fmt::Write;

use super::{Section, escaped};
use crate::report::loads::LoadsFigures;
use crate::report::marks::{MarksFigures, RangeFigures, signed};
use crate::report::material::short;

/// Most layers and most blocks in the tables; those with the largest marks are shown.
const SHOWN: usize = 20;

/// Section of the report page with the map of the marks, and tables below it.
pub fn section(loads: &LoadsFigures, marks: &MarksFigures, map: &str) -> Section {
    let mut body = format!(
        "<p>Material left (red) and taken (blue) on walls, {}, against what a true tool without teeth leaves; where layers lie \
         over each other, the most.</p>\n{map}",
        loads.unit
    );
    let layers = marks.layers.iter().map(|layer| (format!("layer at Z{}", short(layer.z)), String::new(), layer.range));
    table(&mut body, "layer", worst(layers.collect()));
    let vibration = loads.vibration.iter().flat_map(|vibration| &vibration.unstable);
    let unstable = vibration.filter_map(|block| {
        let of_block = marks.blocks.iter().find(|marks| marks.block == block.block)?;
        Some((block.name(), format!("{}, {} from tooth to tooth", block.verdict, short(block.metric)), of_block.range))
    });
    table(&mut body, "not steady", worst(unstable.collect()));
    Section { heading: "Marks on walls, seen along Z".into(), body }
}

type Row = (String, String, RangeFigures);

fn worst(mut rows: Vec<Row>) -> Vec<Row> {
    let most = |(_, _, range): &Row| range.max.max(-range.min);
    rows.sort_by(|a, b| most(b).total_cmp(&most(a)));
    rows.truncate(SHOWN);
    rows
}

fn table(body: &mut String, head: &str, rows: Vec<Row>) {
    if rows.is_empty() {
        return;
    }
    let _ = writeln!(
        body,
        "<table>\n<tr><th>{head}</th><th></th><th>least</th><th>largest</th><th>root of mean square</th></tr>"
    );
    for (name, what, RangeFigures { min, max, rms, .. }) in rows {
        let (name, [min, max, rms]) = (escaped(&name), [signed(min), signed(max), short(rms)]);
        let _ = writeln!(body, "<tr><td>{name}</td><td>{what}</td><td>{min}</td><td>{max}</td><td>{rms}</td></tr>");
    }
    let _ = writeln!(body, "</table>");
}
