//! Sections of the page with the figures of a report.

use std::fmt::Write;

use arcfeed_units::LengthUnit;

use super::{Section, escaped};
use crate::report::figures::RunReport;
use crate::report::material::{DeviationFigures, MaterialFigures, RemovalFigures, RuleFigures, short};
use crate::report::spindle::SpindleFigures;
use crate::report::summary::RunSummary;

/// Section of the report page with the command's printed summary.
pub fn summary(title: &str, report: &RunReport) -> Section {
    let text = RunSummary { title: title.to_owned(), report }.to_string();
    Section {
        heading: "Summary".into(),
        body: format!("<pre tabindex=\"0\" role=\"group\" aria-label=\"Summary\">{}</pre>\n", escaped(&text)),
    }
}

/// Section of the report page with the removed material of each movement.
pub fn material(material: &MaterialFigures, unit: LengthUnit) -> Section {
    let MaterialFigures { volume_unit, rate_unit, left, at_rapid, .. } = material;
    let mut body = String::new();
    for warning in material.warnings(unit) {
        let _ = writeln!(body, "<p class=\"warning\">{}</p>", escaped(&warning));
    }
    let _ = writeln!(
        body,
        "<table>\n<tr><th></th><th>removed, {volume_unit}</th><th>cutting, s, before</th><th>after</th>\
         <th>mean {rate_unit}, before</th><th>after</th><th>largest, before</th><th>after</th></tr>"
    );
    for RuleFigures { rule, removal, baseline } in &material.rules {
        let name = rule.map_or("other blocks".into(), |rule| format!("movement {rule}"));
        row(&mut body, &name, removal, baseline);
    }
    row(&mut body, "all", &material.removal, &material.baseline);
    let _ = writeln!(body, "</table>");
    let at_rapid =
        if *at_rapid > 0.0 { format!(", of the removed {} at rapid", short(*at_rapid)) } else { String::new() };
    let spread = short(material.removal.spread);
    let _ = writeln!(
        body,
        "<p>{} {volume_unit} left{at_rapid}. The rays along X, Y and Z agree within {spread} {volume_unit} on what was removed; \
         they stand {} apart.</p>",
        short(*left),
        short(material.step)
    );
    if let Some(DeviationFigures { min, max, rms, largest, x, y, .. }) = &material.deviation {
        let _ = writeln!(
            body,
            "<p>From the target: {min:+.4} to {max:+.4}, root of the mean square {rms:.4}; the largest, {largest:+.4}, at \
             X{x:.3} Y{y:.3}.</p>"
        );
    }
    Section { heading: "Material".into(), body }
}

/// Section of the report page with the warnings of the spindle's load; `None` without one.
pub fn spindle(figures: &SpindleFigures) -> Option<Section> {
    let mut body = String::new();
    for warning in figures.warnings() {
        let _ = writeln!(body, "<p class=\"warning\">{}</p>", escaped(&warning));
    }
    (!body.is_empty()).then(|| Section { heading: "Spindle".into(), body })
}

fn row(body: &mut String, name: &str, after: &RemovalFigures, before: &RemovalFigures) {
    let _ = write!(body, "<tr><td>{name}</td><td>{}</td>", short(after.removed));
    let times = [before.cutting_time_s, after.cutting_time_s].map(|time_s| format!("{time_s:.1}"));
    let rates = [before.rate_mean, after.rate_mean, before.rate_max, after.rate_max].map(short);
    for cell in times.iter().chain(&rates) {
        let _ = write!(body, "<td>{cell}</td>");
    }
    let _ = writeln!(body, "</tr>");
}
