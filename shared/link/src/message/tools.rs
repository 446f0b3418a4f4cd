//! Decoding of a job's tool and of its law.

use arcfeed_model::job::{LawKind, SpeedSource, ToolAxis, ToolSetup};
use arcfeed_model::tool::{CupMill, EndMill, Tool};
use arcfeed_units::{MmPerTooth, Nm, RevPerMin};

use super::codes::{AxisCode, LawCode, ToolCode};
use super::table;

/// The tool of a message; its law follows later.
pub fn setup(message: &table::Tool) -> ToolSetup {
    let table::Tool { outer_radius, inner_radius, teeth, .. } = *message;
    let tool = match message.shape {
        ToolCode::CupMill => Tool::CupMill(CupMill {
            outer_radius: Nm(outer_radius),
            inner_radius: Nm(inner_radius),
            active_teeth: teeth,
        }),
        ToolCode::EndMill => Tool::EndMill(EndMill { radius: Nm(outer_radius), teeth }),
    };
    let axis = match message.axis {
        AxisCode::X => ToolAxis::X,
        AxisCode::Y => ToolAxis::Y,
        AxisCode::Z => ToolAxis::Z,
    };
    let speed_source = if message.operator_speed { SpeedSource::Operator } else { SpeedSource::Program };
    let (spindle, feed) = (RevPerMin(message.spindle.value()), MmPerTooth(message.feed_per_tooth.value()));
    let number = message.number.map(i64::from);
    ToolSetup { number, axis, speed_source, ..ToolSetup::new(tool, spindle, LawKind::Programmed, feed) }
}

/// The law of a message.
pub fn law(message: &table::Law) -> LawKind {
    match message.law {
        LawCode::Circumference => LawKind::Circumference,
        LawCode::EngagedArc => LawKind::EngagedArc { both_edges: message.option },
        LawCode::Contour => LawKind::Contour { inside_only: message.option, floor_ratio: message.floor.value() },
        LawCode::Engagement => LawKind::Engagement,
        LawCode::Table => LawKind::Table,
        LawCode::Programmed => LawKind::Programmed,
    }
}
