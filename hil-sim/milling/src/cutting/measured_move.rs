//! Measured quantity of one move: the chip or the feed per tooth that its cut rule keeps constant, from two positions
//! one tooth apart.
//!
//! ```text
//! contour:   |c(p + delta) - c(p)|,   c(p) = p + r n(p)                               (1)
//! ```
//!
//! with n the unit normal of the path at p towards the contour: away from the rotation centre inside a contour and in a
//! slot, towards it outside. On a line (1) is the travel of the centre.
//!
//! Source: plane geometry; docs/laws.md#measured-chip.

use arcfeed_model::cut::{ContourSide, CutRule, Work};
use arcfeed_model::engaged::EngagedTable;
use arcfeed_model::job::{LawKind, ToolAxis, ToolSetup};
use arcfeed_model::stock::{Stock, StockLine};
use arcfeed_model::tool::{Edge, Tool};
use arcfeed_nc::modal::{Plane, Pose};
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_units::{MmPerTooth, Nm};
use nalgebra::Vector2;

use super::boundary::{Boundary, PlanePath};
use super::chip::Circle;

/// Quantity of a move that the chip meter measures and compares with the target of the move's cut rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChipMeasure {
    /// Chip at the contact of a ring's circle with a stock line.
    Contact,
    /// Feed per tooth at the contour of an end mill.
    Contour,
    /// Thickest chip over the engaged arc.
    Thickest,
}

/// Cut rule that applies to a move, with its tool.
#[derive(Clone, Copy, Debug)]
pub struct GoverningRule<'a> {
    /// Index of the rule in the job's list of cut rules.
    pub index: usize,
    /// The rule.
    pub rule: &'a CutRule,
    /// Tool of the rule.
    pub setup: &'a ToolSetup,
    /// Engaged arcs along the move; `None` unless the rule expects engagement for each move.
    pub along: Option<&'a EngagedTable>,
    /// Target of this move alone, mm per tooth; `None` if the rule's or the tool's target applies.
    pub target: Option<MmPerTooth>,
}

/// Geometry of one move, prepared for measuring its chip or feed per tooth.
#[derive(Clone, Debug)]
pub struct MeasuredMove {
    axes: (usize, usize),
    target_mm_per_tooth: f64,
    quantity: Quantity,
}

#[derive(Clone, Debug)]
enum Quantity {
    Contact(RingCut),
    Contour {
        center_mm: Option<Vector2<f64>>,
        radius_mm: f64,
        is_outside: bool,
    },
    /// Each circle with the stock that it meets.
    Thickest(Vec<(Circle, Boundary)>),
}

/// An arc of a ring up to a stock line.
#[derive(Clone, Copy, Debug)]
struct RingCut {
    rotation_center_mm: Vector2<f64>,
    /// The circle that cuts.
    cutting: Circle,
    /// The outer and the inner circle.
    circles: [Circle; 2],
    line: StockLine,
}

impl ChipMeasure {
    /// Quantity that is measured under a rule with this tool; `None` if nothing is measured under it.
    pub fn of(rule: &CutRule, setup: &ToolSetup) -> Option<Self> {
        match (&setup.tool, &rule.work, setup.law) {
            (Tool::CupMill(_), Work::Ring(_, stock), _) if stock.line().is_some() => Some(ChipMeasure::Contact),
            (_, Work::Ring(..), LawKind::EngagedArc { .. }) => Some(ChipMeasure::Thickest),
            (Tool::EndMill(_), Work::Mill { .. }, LawKind::Engagement) => Some(ChipMeasure::Thickest),
            (Tool::EndMill(_), Work::Mill { .. }, _) => Some(ChipMeasure::Contour),
            _ => None,
        }
    }
}

impl GoverningRule<'_> {
    /// Target that applies to the move: its own, or otherwise that of the rule or the tool, mm per tooth.
    pub fn target_mm_per_tooth(&self) -> f64 {
        f64::from(self.target.or(self.rule.feed_per_tooth).unwrap_or(self.setup.feed_per_tooth).0)
    }
}

impl MeasuredMove {
    /// Geometry of a move under its cut rule; `None` if nothing can be measured on it.
    pub fn new(segment: &Segment, governing: &GoverningRule<'_>) -> Option<Self> {
        let plane = PlaneMove::new(segment, governing.setup)?;
        let quantity = match ChipMeasure::of(governing.rule, governing.setup)? {
            ChipMeasure::Contact => Quantity::Contact(plane.ring_cut(governing)?),
            ChipMeasure::Contour => plane.contour(governing)?,
            ChipMeasure::Thickest => Quantity::Thickest(plane.circles(governing)?),
        };
        Some(MeasuredMove { axes: plane.axes, target_mm_per_tooth: governing.target_mm_per_tooth(), quantity })
    }

    /// Target of the measured quantity, mm per tooth.
    pub fn target_mm_per_tooth(&self) -> f64 {
        self.target_mm_per_tooth
    }

    /// Whether the stock is given by the path travelled since the start of the move (engaged arcs), so that the start must be known.
    pub fn counts_from_start(&self) -> bool {
        let Quantity::Thickest(circles) = &self.quantity else { return false };
        circles.iter().any(|(_, boundary)| matches!(boundary, Boundary::Table { .. }))
    }

    /// Position of the machine, mm, in the plane of the move.
    pub fn in_plane(&self, position: &Pose) -> Vector2<f64> {
        let (first, second) = self.axes;
        Vector2::new(position.linear[first].to_mm(), position.linear[second].to_mm())
    }

    /// Measured quantity of a tooth during which the centre moves from `position_mm` by `delta_mm`, divided by the target; `None`
    /// without a contact.
    pub fn ratio(&self, position_mm: &Vector2<f64>, delta_mm: &Vector2<f64>) -> Option<f64> {
        let measured_mm = match &self.quantity {
            Quantity::Contact(RingCut { rotation_center_mm, cutting, line, .. }) => {
                cutting.contact_chip_mm(position_mm, rotation_center_mm, delta_mm, line)?
            }
            Quantity::Contour { center_mm, radius_mm, is_outside } => {
                let contact = |at_mm: Vector2<f64>| contact_mm(at_mm, *center_mm, *radius_mm, *is_outside);
                (contact(position_mm + delta_mm)? - contact(*position_mm)?).norm() // (1)
            }
            Quantity::Thickest(circles) => {
                let chips = circles
                    .iter()
                    .filter_map(|(circle, boundary)| boundary.thickest_chip_mm(circle, position_mm, delta_mm));
                chips.max_by(f64::total_cmp)?
            }
        };
        Some(measured_mm / self.target_mm_per_tooth)
    }

    /// Thickest chips of a ring's outer and inner circle in the half plane of its stock line, divided by the target; `None` for a circle
    /// that does not cut, and on moves under another quantity than [`ChipMeasure::Contact`].
    pub fn thickest_of_ring(&self, position_mm: &Vector2<f64>, delta_mm: &Vector2<f64>) -> [Option<f64>; 2] {
        let Quantity::Contact(cut) = &self.quantity else { return [None; 2] };
        let chip_mm = |circle: Circle| circle.thickest_chip_mm(position_mm, delta_mm, &cut.line);
        cut.circles.map(|circle| Some(chip_mm(circle)? / self.target_mm_per_tooth))
    }
}

/// Contact point of the tool with its contour; `None` if the tool is too large for it.
fn contact_mm(
    at_mm: Vector2<f64>,
    center_mm: Option<Vector2<f64>>,
    radius_mm: f64,
    is_outside: bool,
) -> Option<Vector2<f64>> {
    let Some(center_mm) = center_mm else { return Some(at_mm) };
    let outward = at_mm - center_mm;
    if is_outside && outward.norm() <= radius_mm {
        return None;
    }
    let towards_contour = if is_outside { -1.0 } else { 1.0 };
    Some(at_mm + outward.try_normalize(0.0)? * (radius_mm * towards_contour))
}

/// Path of a move in the plane of its tool.
struct PlaneMove {
    axes: (usize, usize),
    /// Coordinate along the normal of the plane at the start, mm.
    height_mm: f64,
    path: PlanePath,
}

impl PlaneMove {
    fn new(segment: &Segment, setup: &ToolSetup) -> Option<Self> {
        let plane = segment.arc().map_or(plane_across(setup), |arc| arc.plane);
        let (first, second, normal) = plane.axes();
        let at = |pose: &Pose| Vector2::new(pose.linear[first].to_mm(), pose.linear[second].to_mm());
        let path = match &segment.path {
            Path::Rapid => return None,
            Path::Line => {
                let start_mm = at(&segment.start);
                PlanePath::Line { start_mm, direction: (at(&segment.end) - start_mm).try_normalize(0.0)? }
            }
            Path::Arc(arc) => PlanePath::Arc {
                center_mm: Vector2::from(arc.center.map(Nm::to_mm)),
                radius_mm: arc.radius_mm(),
                start_rad: arc.angles().start_rad,
                sweep_rad: arc.sweep_rad(),
                turn_sign: f64::from(arc.turn.sign()),
            },
        };
        Some(PlaneMove { axes: (first, second), height_mm: segment.start.linear[normal].to_mm(), path })
    }

    fn ring_cut(&self, governing: &GoverningRule<'_>) -> Option<RingCut> {
        let (Tool::CupMill(mill), Work::Ring(edge, stock)) = (&governing.setup.tool, &governing.rule.work) else {
            return None;
        };
        let PlanePath::Arc { center_mm, .. } = self.path else { return None };
        let circle = |edge: Edge| circle(mill.radius(edge), edge);
        Some(RingCut {
            rotation_center_mm: center_mm,
            cutting: circle(*edge),
            circles: [circle(Edge::Outer), circle(Edge::Inner)],
            line: stock.line()?.at_height(self.height_mm),
        })
    }

    fn contour(&self, governing: &GoverningRule<'_>) -> Option<Quantity> {
        let (Tool::EndMill(mill), Work::Mill { side, .. }) = (&governing.setup.tool, &governing.rule.work) else {
            return None;
        };
        let center_mm = match self.path {
            PlanePath::Arc { center_mm, .. } => Some(center_mm),
            PlanePath::Line { .. } => None,
        };
        let (radius_mm, is_outside) = (mill.radius.to_mm(), *side == ContourSide::Outside);
        Some(Quantity::Contour { center_mm, radius_mm, is_outside })
    }

    /// Circles that the rule's law protects, with their stock.
    fn circles(&self, governing: &GoverningRule<'_>) -> Option<Vec<(Circle, Boundary)>> {
        let both = matches!(governing.setup.law, LawKind::EngagedArc { both_edges: true });
        match (&governing.setup.tool, &governing.rule.work) {
            (Tool::EndMill(mill), Work::Mill { side, radial_depth }) => {
                let boundary = self.wall(*side, radial_depth.to_mm(), mill.radius.to_mm())?;
                Some(vec![(circle(mill.radius, Edge::Outer), boundary)])
            }
            (Tool::EndMill(mill), Work::Ring(_, stock)) => {
                let boundary = self.boundary(stock, Edge::Outer, governing.along)?;
                Some(vec![(circle(mill.radius, Edge::Outer), boundary)])
            }
            (Tool::CupMill(mill), Work::Ring(edge, stock)) => {
                let edges = [Edge::Outer, Edge::Inner].into_iter().filter(|other| both || other == edge);
                let circles = edges
                    .map(|edge| Some((circle(mill.radius(edge), edge), self.boundary(stock, edge, governing.along)?)));
                circles.collect()
            }
            (Tool::CupMill(_), Work::Mill { .. }) => None,
        }
    }

    /// Stock of a rule for one circle; `None` if it is unknown.
    fn boundary(&self, stock: &Stock, edge: Edge, along: Option<&EngagedTable>) -> Option<Boundary> {
        let table = |table: &EngagedTable| Boundary::Table { table: table.clone(), edge, path: self.path };
        match stock {
            Stock::Convex(lines) => {
                Some(Boundary::Lines(lines.iter().map(|line| line.at_height(self.height_mm)).collect()))
            }
            Stock::Disc { center_mm, radius_mm } => Some(Boundary::Circle {
                center_mm: Vector2::from(*center_mm),
                radius_mm: *radius_mm,
                is_hollow: false,
                along: None,
            }),
            Stock::Engaged(engaged) => Some(table(engaged)),
            Stock::PerMove => along.map(table),
        }
    }

    /// Stock that a radial depth describes; `None` if the tool is too large for its contour.
    fn wall(&self, side: ContourSide, depth_mm: f64, tool_mm: f64) -> Option<Boundary> {
        match (&self.path, side) {
            (_, ContourSide::Slot) => Some(Boundary::Lines(Vec::new())),
            (PlanePath::Line { start_mm, direction }, _) => {
                // The thickest chip is the same for a contour on the left and on the right.
                let normal = Vector2::new(direction.y, -direction.x);
                let offset_mm = normal.dot(start_mm) - (tool_mm - depth_mm);
                Some(Boundary::Lines(vec![StockLine { normal: normal.into(), offset_mm, rise_ratio: 0.0 }]))
            }
            (PlanePath::Arc { center_mm, radius_mm: path_mm, .. }, ContourSide::Inside | ContourSide::Outside) => {
                let is_hollow = side == ContourSide::Inside;
                let contour_mm = if is_hollow { path_mm + tool_mm } else { path_mm - tool_mm };
                let radius_mm = if is_hollow { contour_mm - depth_mm } else { contour_mm + depth_mm };
                match (is_hollow, radius_mm > 0.0) {
                    (true, false) => Some(Boundary::Lines(Vec::new())),
                    (false, _) if contour_mm <= 0.0 => None,
                    _ => Some(Boundary::Circle { center_mm: *center_mm, radius_mm, is_hollow, along: Some(self.path) }),
                }
            }
        }
    }
}

fn circle(radius: Nm, edge: Edge) -> Circle {
    Circle { radius_mm: radius.to_mm(), advance_ratio: f64::from(edge.advance()) }
}

/// Plane perpendicular to the tool's axis.
fn plane_across(setup: &ToolSetup) -> Plane {
    match setup.axis {
        ToolAxis::Z => Plane::Xy,
        ToolAxis::Y => Plane::Zx,
        ToolAxis::X => Plane::Yz,
    }
}
