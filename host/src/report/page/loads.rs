//! Section of the page with the loads of the edges.

use std::fmt::Write;

use super::{Section, escaped};
use crate::report::loads::LoadsFigures;
use crate::report::material::short;

/// Section of the report page with the loads of each movement, before and after.
pub fn section(loads: &LoadsFigures) -> Section {
    let mut body = String::new();
    for warning in loads.warnings() {
        let _ = writeln!(body, "<p class=\"warning\">{}</p>", escaped(&warning));
    }
    let _ = write!(body, "<table>\n<tr><th></th>");
    for column in loads.columns() {
        let _ = write!(body, "<th>{column}, before</th><th>after</th>");
    }
    let _ = writeln!(body, "</tr>");
    for (name, [before, after]) in loads.rows() {
        let _ = write!(body, "<tr><td>{name}</td>");
        for (before, after) in before.cells().into_iter().zip(after.cells()) {
            let _ = write!(body, "<td>{before}</td><td>{after}</td>");
        }
        let _ = writeln!(body, "</tr>");
    }
    let _ = writeln!(
        body,
        "</table>\n<p>Largest values. Force is that across the tool's axis, and varies by its largest less its least over \
         its mean, in the mean of all turns; thrust is along the axis; the chip is the thickest of any tooth's side. Layers are {} {} high, steps {:.2} degrees.</p>",
        short(loads.layer),
        loads.unit,
        loads.step_deg
    );
    Section { heading: "Chips and forces".into(), body }
}
