//! One case of a feed law computed in double precision, step by step as its equations are numbered, next to the controller's own result.
//!
//! Source of the equations: `firmware/law/src/{circumference,step,contour}.rs`; docs/laws.md. "Petean" are the numbers of the
//! thesis.

use arcfeed_law::circumference::Circumference;
use arcfeed_law::contour::{Contour as ContourLaw, ContourLimits};
use arcfeed_law::step::Cut;
use arcfeed_law::{FeedLaw, NoDemand, Place};
use arcfeed_model::cut::ContourSide;
use arcfeed_model::stock::StockLine;
use arcfeed_model::tool::Edge;
use arcfeed_nc::motion::{Plane, Turn};
use arcfeed_nc::segment::Arc;
use arcfeed_units::{Mm, MmPerTooth, Nm};

/// Largest length that a case may have.
const LENGTH_MAX_MM: f64 = 1e5;

/// Case of a law.
#[derive(Clone, Copy, Debug)]
pub enum Case {
    /// Circumference law of a cup mill.
    Circumference(Rotation),
    /// Contour law of an end mill.
    Contour(Contour),
}

/// Case of a cup mill whose centre O moves on an arc about the point A.
#[derive(Clone, Copy, Debug)]
pub struct Rotation {
    /// Radius of the path of the centre O about A, mm.
    pub rho_mm: f64,
    /// Radius of the cutting circle, mm.
    pub radius_mm: f64,
    /// Cutting circle of the mill that cuts: outer or inner.
    pub edge: Edge,
    /// Target feed per tooth on the circumference, mm.
    pub feed_per_tooth_mm: f64,
    /// Place where the cutting circle meets the stock.
    pub contact: Contact,
    /// Number of teeth that pass in a minute; `None` if the spindle speed is unknown.
    pub teeth_per_min: Option<f64>,
}

/// Place where the cutting circle meets the stock.
#[derive(Clone, Copy, Debug)]
pub enum Contact {
    /// Given by its angle at the tool's centre O, counted from the direction of A towards the cutting side, rad.
    Angle(f64),
    /// Computed from a straight limit of the stock (stock line), relative to A.
    Line {
        /// Direction of the line's normal, which points out of the material, degrees.
        normal_deg: f64,
        /// Distance of the line from A along the normal, mm.
        offset_mm: f64,
        /// Unit vector from A to O.
        position: [f64; 2],
        /// The centre O moves clockwise about A.
        is_clockwise: bool,
    },
}

/// Case of an end mill on an arc along a contour.
#[derive(Clone, Copy, Debug)]
pub struct Contour {
    /// Radius of the path of the tool's centre, mm.
    pub rho_mm: f64,
    /// Radius of the tool, mm.
    pub radius_mm: f64,
    /// Side of the arc on which the tool runs: inside or outside.
    pub side: ContourSide,
    /// Target feed per tooth at the contour, mm.
    pub feed_per_tooth_mm: f64,
    /// Smallest and largest feed that the contour law permits.
    pub limits: ContourLimits,
    /// Number of teeth that pass in a minute; `None` if the spindle speed is unknown.
    pub teeth_per_min: Option<f64>,
}

/// Dimension of a quantity in a case; all lengths are in mm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Length, mm.
    Length,
    /// Area, mm2.
    Area,
    /// Feed, mm/min.
    Feed,
    /// Angle, degrees.
    Degrees,
    /// Ratio without a unit.
    Ratio,
    /// Frequency, 1/min.
    PerMin,
}

/// Input or intermediate result of a case, with its equation.
#[derive(Clone, Copy, Debug)]
pub struct CaseQuantity {
    /// Symbol in the equations.
    pub symbol: &'static str,
    /// Value, in the unit of its dimension.
    pub value: f64,
    /// Dimension, which gives the unit of the value.
    pub dimension: Dimension,
    /// File and number of the equation that gives it; empty for an input.
    pub equation: &'static str,
    /// Meaning in words.
    pub meaning: &'static str,
}

/// Result of a case with all intermediate quantities.
#[derive(Clone, Debug)]
pub struct Evaluated {
    /// Quantities in the order of their computation.
    pub quantities: Vec<CaseQuantity>,
    /// Direction from the tool's centre to the contact: components ux (along the motion) and uy (towards A). For a contour only the sign
    /// of uy counts.
    pub contact: [f64; 2],
    /// Path of the tool's centre per tooth by the equations, mm.
    pub path_mm: f64,
    /// The same path as the controller's code computes it, mm.
    pub controller_path_mm: f64,
    /// Feed of the tool's centre, mm/min; `None` without a spindle speed.
    pub feed_mm_per_min: Option<f64>,
}

impl Case {
    /// Name of the law, as in job files.
    pub const fn law(&self) -> &'static str {
        match self {
            Case::Circumference(_) => "circumference",
            Case::Contour(_) => "contour",
        }
    }

    /// Computes the case by its equations and by the controller's code.
    ///
    /// # Errors
    /// The reason why the law has no demand in this case.
    pub fn evaluate(&self) -> Result<Evaluated, String> {
        let (lengths, teeth_per_min) = match self {
            Case::Circumference(case) => ([case.rho_mm, case.radius_mm, case.feed_per_tooth_mm], case.teeth_per_min),
            Case::Contour(case) => ([case.rho_mm, case.radius_mm, case.feed_per_tooth_mm], case.teeth_per_min),
        };
        if lengths.iter().any(|mm| !(*mm > 0.0 && *mm < LENGTH_MAX_MM)) {
            return Err(format!("radii and feed per tooth must be positive and below {LENGTH_MAX_MM} mm"));
        }
        let mut found = match self {
            Case::Circumference(case) => case.evaluate(),
            Case::Contour(case) => case.evaluate(),
        }?;
        if let Some(teeth) = teeth_per_min {
            let feed = teeth * found.path_mm; // Petean 30
            found.quantities.extend([
                quantity("n z", teeth, Dimension::PerMin, "", "teeth in a minute"),
                quantity("F", feed, Dimension::Feed, "Petean 30", "feed of the tool's centre along its arc"),
            ]);
            found.feed_mm_per_min = Some(feed);
        }
        Ok(found)
    }
}

impl Rotation {
    fn evaluate(&self) -> Result<Evaluated, String> {
        use Dimension::{Area, Degrees, Length, Ratio};
        let Rotation { rho_mm: rho, radius_mm: r0, edge, feed_per_tooth_mm: a, .. } = *self;
        let k = f64::from(edge.advance());
        let mut quantities = vec![
            quantity("rho", rho, Length, "", "radius of the centre's path about A"),
            quantity("r0", r0, Length, "", "radius of the cutting circle"),
            quantity("k", k, Ratio, "", "1: the edge advances outward, -1: inward"),
            quantity("a", a, Length, "", "feed per tooth wanted at the contact B"),
        ];
        let [ux, uy] = self.contact(&mut quantities)?;
        let step = self.step([ux, uy])?;
        let Step { reach, excess, h, p, d, tau } = step;
        let alpha = 2.0 * libm::atan(tau / (2.0 * rho)); // (5)
        let path = rho * alpha; // (6)
        quantities.extend([
            quantity(
                "theta",
                libm::atan2(k * ux, uy).to_degrees(),
                Degrees,
                "contact",
                "angle of B at O, from A towards the cutting side",
            ),
            quantity("ux", ux, Ratio, "step (1)", "u along the motion, u = (B - O)/r0"),
            quantity("uy", uy, Ratio, "step (1)", "u towards A"),
            quantity("L", reach, Length, "step (1)", "r0 + k a: distance of C from O"),
            quantity("w", excess, Area, "step (1)", "a (2 r0 + k a)"),
            quantity("h", h, Length, "step (2)", "L k ux: the edge advances where it is above 0"),
            quantity("p", p, Ratio, "step (3)", "k (1 - L uy/rho) + w/(4 rho^2)"),
            quantity("D", d, Area, "step (4)", "h^2 - p w: below 0 the chip cannot be reached"),
            quantity("tau", tau, Length, "step (5)", "w/(h + sqrt D) = 2 rho tan(alpha/2)"),
            quantity("alpha", alpha.to_degrees(), Degrees, "step (5)", "turn of O about A per tooth"),
            quantity("s", 2.0 * rho * libm::sin(alpha / 2.0), Length, "Petean 26", "chord |O'O| of a tooth"),
            quantity("path", path, Length, "step (6)", "rho alpha: path of the centre per tooth"),
        ]);
        let controller = self.controller([ux, uy]).map_err(no_demand)?;
        Ok(Evaluated {
            quantities,
            contact: [ux, uy],
            path_mm: path,
            controller_path_mm: f64::from(controller),
            feed_mm_per_min: None,
        })
    }

    /// The step to tau for a contact.
    fn step(&self, [ux, uy]: [f64; 2]) -> Result<Step, String> {
        let Rotation { rho_mm: rho, radius_mm: r0, edge, feed_per_tooth_mm: a, .. } = *self;
        let k = f64::from(edge.advance());
        let (reach, excess) = (r0 + k * a, a * (2.0 * r0 + k * a)); // (1)
        let h = reach * k * ux; // (2)
        let p = k * (1.0 - reach * uy / rho) + excess / (4.0 * rho * rho); // (3)
        let d = h * h - p * excess; // (4)
        if reach <= 0.0 {
            return Err("the feed per tooth is larger than the inner circle".into());
        }
        if h <= 0.0 {
            return Err(no_demand(NoDemand::OutsideValidity));
        }
        if d < 0.0 {
            return Err(no_demand(NoDemand::ChipUnreachable));
        }
        Ok(Step { reach, excess, h, p, d, tau: excess / (h + libm::sqrt(d)) }) // (5)
    }

    /// The contact B in the moving frame: ux, uy.
    fn contact(&self, quantities: &mut Vec<CaseQuantity>) -> Result<[f64; 2], String> {
        let k = f64::from(self.edge.advance());
        match self.contact {
            Contact::Angle(angle) => {
                let (sin, cos) = libm::sincos(angle);
                Ok([k * sin, cos])
            }
            Contact::Line { normal_deg, offset_mm, position: [px, py], is_clockwise } => {
                let (ny, nx) = libm::sincos(normal_deg.to_radians());
                let turn = if is_clockwise { -1.0 } else { 1.0 };
                // The normal in the moving frame: along the motion, and towards A.
                let normal = [turn * (ny * px - nx * py), -(nx * px + ny * py)];
                let q = offset_mm + self.rho_mm * normal[1];
                let half = libm::sqrt((self.radius_mm - q) * (self.radius_mm + q));
                quantities.extend([
                    quantity(
                        "q",
                        q,
                        Dimension::Length,
                        "contact (1)",
                        "distance of the stock line from O along its normal",
                    ),
                    quantity(
                        "sqrt",
                        half,
                        Dimension::Length,
                        "contact (1)",
                        "half the chord that the line cuts from the circle",
                    ),
                ]);
                if half.is_nan() {
                    return Err(no_demand(NoDemand::NoContact));
                }
                let at = |sign: f64| {
                    let [nx, ny] = normal;
                    [q * nx - sign * half * ny, q * ny + sign * half * nx].map(|mm| mm / self.radius_mm) // (1)
                };
                self.admissible([at(1.0), at(-1.0)])
            }
        }
    }

    /// The admissible contact; of two, the one with the thicker chip.
    fn admissible(&self, both: [[f64; 2]; 2]) -> Result<[f64; 2], String> {
        let k = f64::from(self.edge.advance());
        let admissible = both.into_iter().filter(|[ux, uy]| *uy >= 0.0 && k * ux > 0.0);
        let steps = admissible.map(|contact| self.step(contact).map(|step| (step.tau, contact)));
        let mut found: Vec<_> = steps.collect();
        found.sort_by(|one, other| match (one, other) {
            (Ok((one, _)), Ok((other, _))) => one.total_cmp(other),
            (one, other) => one.is_err().cmp(&other.is_err()),
        });
        let first = found.into_iter().next().unwrap_or_else(|| Err(no_demand(NoDemand::OutsideValidity)));
        first.map(|(_, contact)| contact)
    }

    /// Path of the centre per tooth by the controller's law.
    fn controller(&self, [ux, uy]: [f64; 2]) -> Result<f32, NoDemand> {
        let Rotation { rho_mm, radius_mm, edge, feed_per_tooth_mm, contact, .. } = *self;
        let edge_radius = Mm(radius_mm as f32);
        let feed_per_tooth = MmPerTooth(feed_per_tooth_mm as f32);
        match contact {
            Contact::Angle(_) => {
                let cut = Cut { path_radius: Mm(rho_mm as f32), edge_radius, edge, feed_per_tooth };
                cut.path_per_tooth(ux as f32, uy as f32).map(|path| path.0)
            }
            Contact::Line { normal_deg, offset_mm, position, is_clockwise } => {
                let turn = if is_clockwise { Turn::Cw } else { Turn::Ccw };
                let from = [Nm::from_mm(rho_mm), Nm(0)];
                let arc = Arc { plane: Plane::Xy, turn, center: [Nm(0); 2], from, to: from };
                let line = StockLine::from_angle(normal_deg, offset_mm);
                let law = Circumference::for_arc(&arc, edge_radius, edge, &line, feed_per_tooth);
                let sign = f32::from(turn.sign());
                let place = Place::on_arc(position.map(|ratio| ratio as f32), sign, rho_mm as f32, 0.0);
                law.demand(&place).map(|demand| demand.path_mm_per_tooth)
            }
        }
    }
}

/// Quantities of the step per tooth.
struct Step {
    reach: f64,
    excess: f64,
    h: f64,
    p: f64,
    d: f64,
    tau: f64,
}

impl Contour {
    fn evaluate(&self) -> Result<Evaluated, String> {
        use Dimension::{Length, Ratio};
        let Contour { rho_mm: q, radius_mm: r, side, feed_per_tooth_mm: a, limits, .. } = *self;
        let is_outside = side == ContourSide::Outside;
        let (contour, equation) = if is_outside { (q - r, "contour (2)") } else { (q + r, "contour (1)") };
        if contour <= 0.0 {
            return Err("outside a contour the centre's path must be larger than the tool".into());
        }
        let law_factor = if is_outside && limits.inside_only { 1.0 } else { q / contour }; // (1), (2)
        let factor = law_factor.max(f64::from(limits.floor_ratio));
        let quantities = vec![
            quantity("q", q, Length, "", "radius of the centre's path"),
            quantity("r", r, Length, "", "radius of the tool"),
            quantity("a", a, Length, "", "feed per tooth wanted at the contour"),
            quantity("Rc", contour, Length, equation, "radius of the contour"),
            quantity(
                "q/Rc",
                law_factor,
                Ratio,
                equation,
                "feed of the centre over that at the contour; 1 outside with inside-only",
            ),
            quantity("floor", f64::from(limits.floor_ratio), Ratio, "", "least factor"),
            quantity("path", a * factor, Length, equation, "path of the centre per tooth"),
        ];
        let [path_radius, tool_radius] = [q, r].map(|mm| Mm(mm as f32));
        let law = ContourLaw::new(path_radius, tool_radius, side, MmPerTooth(a as f32), limits);
        let demand = law.demand(&Place::on_arc([1.0, 0.0], 1.0, q as f32, 0.0)).map_err(no_demand)?;
        Ok(Evaluated {
            quantities,
            contact: [0.0, if is_outside { 1.0 } else { -1.0 }],
            path_mm: a * factor,
            controller_path_mm: f64::from(demand.path_mm_per_tooth),
            feed_mm_per_min: None,
        })
    }
}

fn quantity(
    symbol: &'static str,
    value: f64,
    dimension: Dimension,
    equation: &'static str,
    meaning: &'static str,
) -> CaseQuantity {
    CaseQuantity { symbol, value, dimension, equation, meaning }
}

/// Why there is no demand; the block keeps its programmed feed then.
fn no_demand(cause: NoDemand) -> String {
    let why = match cause {
        NoDemand::NoContact => "the cutting circle does not meet the stock line",
        NoDemand::OutsideValidity => "no contact with u.(A - O) >= 0 at which the edge advances",
        NoDemand::ChipUnreachable => "no step gives this chip (D < 0): no feed is too high",
        NoDemand::NoLaw | NoDemand::BadInput => "a radius or the feed per tooth is no length that a tool has",
    };
    format!("the law has no demand here: {why} (docs/laws.md)")
}
