//! `arcfeed law`: one case of a feed law, with every intermediate quantity and a drawing.

mod case;

mod of_job;

mod drawing;

use std::path::PathBuf;

use arcfeed_law::contour::ContourLimits;
use arcfeed_model::cut::ContourSide;
use arcfeed_model::tool::Edge;
use arcfeed_units::LengthUnit;
use serde::Serialize;

use super::control_args::unit_named;
use super::outcome::{Failure, json_text, say, write_whole};
use crate::init::answers::Length;
use case::{Case, CaseQuantity, Contact, Contour, Dimension, Evaluated, Rotation};

/// Feed of the tool's centre that a law demands in one case, with each intermediate quantity and its equation
///
/// The circumference law of a cup mill (--edge outer or inner) at a contact angle or at a stock line, or the contour law of an
/// end mill (--edge inside or outside). The numbers are those of docs/laws.md and of the files that it names.
#[derive(Debug, clap::Args)]
pub struct Law {
    /// Take the case from a block of this job's program
    #[arg(long, value_name = "JOB.toml", requires = "line", conflicts_with_all = ["rho", "radius", "edge"])]
    job: Option<PathBuf>,
    /// Line of the block in the program
    #[arg(long, value_name = "N", requires = "job")]
    line: Option<usize>,
    /// Place on the block's arc: 0 its start, 1 its end
    #[arg(long, value_name = "FRACTION", default_value_t = 0.0, requires = "job")]
    at: f64,
    /// rho: radius of the centre's path about the rotation centre A
    #[arg(long, value_name = "LENGTH", required_unless_present = "job")]
    rho: Option<Length>,
    /// r0: radius of the cutting circle
    #[arg(long, value_name = "LENGTH", required_unless_present = "job")]
    radius: Option<Length>,
    /// Edge that cuts: outer or inner of a cup mill; inside or outside: end mill, by the side of the contour
    #[arg(long, value_enum, required_unless_present = "job")]
    edge: Option<CuttingSide>,
    /// a: feed per tooth on the circumference, or at the contour
    #[arg(long, value_name = "LENGTH", required_unless_present = "job")]
    feed_per_tooth: Option<Length>,
    /// Angle of the contact B at the centre O, degrees from the direction of A towards the cutting side
    #[arg(long, value_name = "DEGREES", conflicts_with_all = ["job", "stock_normal"])]
    contact: Option<f64>,
    /// Direction of the stock line's normal, which points out of the material, degrees from +X
    #[arg(
        long,
        value_name = "DEGREES",
        requires = "stock_offset",
        requires = "position",
        allow_negative_numbers = true,
        conflicts_with = "job"
    )]
    stock_normal: Option<f64>,
    /// Distance of the stock line from A along its normal
    #[arg(long, value_name = "LENGTH", requires = "stock_normal", allow_negative_numbers = true)]
    stock_offset: Option<f64>,
    /// Direction from A to the tool's centre O, degrees from +X
    #[arg(long, value_name = "DEGREES", requires = "stock_normal", allow_negative_numbers = true)]
    position: Option<f64>,
    /// The centre moves clockwise about A; without it counter-clockwise
    #[arg(long, requires = "stock_normal")]
    clockwise: bool,
    /// Spindle speed, for the feed in length per minute
    #[arg(long, value_name = "REV_PER_MIN", requires = "teeth", conflicts_with = "job")]
    spindle: Option<f64>,
    /// Teeth that cut in a turn
    #[arg(long, value_name = "COUNT", requires = "spindle", value_parser = clap::value_parser!(u16).range(1..=1000))]
    teeth: Option<u16>,
    /// Unit of lengths without one of their own, and of the result
    #[arg(long, value_name = "inch|mm", value_parser = unit_named, default_value = "mm", conflicts_with = "job")]
    units: LengthUnit,
    /// Write the drawing here, as SVG
    #[arg(long, value_name = "OUT.svg")]
    svg: Option<PathBuf>,
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    json: bool,
}

/// Edge or side of `--edge`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum CuttingSide {
    Outer,
    Inner,
    Inside,
    Outside,
}

/// The case as JSON.
#[derive(Serialize)]
struct LawFigures<'a> {
    law: &'static str,
    unit: &'static str,
    /// Path of the centre per tooth.
    ipt_center: f64,
    /// The same of the controller, in single precision.
    ipt_center_controller: f64,
    feed: Option<f64>,
    quantities: Vec<QuantityFigures<'a>>,
}

/// CaseQuantity as JSON.
#[derive(Serialize)]
struct QuantityFigures<'a> {
    symbol: &'a str,
    value: f64,
    unit: String,
    equation: &'a str,
    meaning: &'a str,
}

impl Law {
    /// Runs the command.
    ///
    /// # Errors
    /// A value makes no sense, the job or the block has no such law, or the law has no demand.
    pub fn run(&self) -> Result<(), Failure> {
        let (case, unit) = match (&self.job, self.line) {
            (Some(job), Some(line)) => of_job::case(job, line, self.at)?,
            _ => (self.case()?, self.units),
        };
        let evaluated = case.evaluate().map_err(Failure::Input)?;
        if let Some(path) = &self.svg {
            write_whole(path, drawing::svg(&case, &evaluated).as_bytes())?;
        }
        let figures = figures(&case, &evaluated, unit);
        if self.json {
            say(format_args!("{}", json_text(&figures)));
        } else {
            print(&figures);
        }
        Ok(())
    }

    /// Case that the options describe.
    fn case(&self) -> Result<Case, Failure> {
        let (Some(rho), Some(radius), Some(edge), Some(a)) = (&self.rho, &self.radius, self.edge, &self.feed_per_tooth)
        else {
            return Err(Failure::Usage("--rho, --radius, --edge and --feed-per-tooth are needed".into()));
        };
        let [rho_mm, radius_mm, feed_per_tooth_mm] = [rho, radius, a].map(|length| length.to_mm(self.units));
        let teeth_per_min = self.spindle.zip(self.teeth).map(|(speed, teeth)| speed * f64::from(teeth));
        if teeth_per_min.is_some_and(|teeth| !(teeth > 0.0 && teeth.is_finite())) {
            return Err(Failure::Usage("--spindle: write a positive speed".into()));
        }
        let side = match edge {
            CuttingSide::Inside => ContourSide::Inside,
            CuttingSide::Outside => ContourSide::Outside,
            CuttingSide::Outer | CuttingSide::Inner => {
                let edge = if edge == CuttingSide::Outer { Edge::Outer } else { Edge::Inner };
                let contact = self.contact()?;
                return Ok(Case::Circumference(Rotation {
                    rho_mm,
                    radius_mm,
                    edge,
                    feed_per_tooth_mm,
                    contact,
                    teeth_per_min,
                }));
            }
        };
        if self.contact.is_some() || self.stock_normal.is_some() {
            return Err(Failure::Usage(
                "--contact, --stock-normal: the contour law (--edge inside, outside) does not know the stock".into(),
            ));
        }
        let limits = ContourLimits { inside_only: false, floor_ratio: 0.0 };
        Ok(Case::Contour(Contour { rho_mm, radius_mm, side, feed_per_tooth_mm, limits, teeth_per_min }))
    }

    fn contact(&self) -> Result<Contact, Failure> {
        match (self.contact, self.stock_normal, self.stock_offset, self.position) {
            (Some(degrees), ..) if degrees > 0.0 && degrees < 180.0 => Ok(Contact::Angle(degrees.to_radians())),
            (Some(degrees), ..) => Err(Failure::Usage(format!(
                "--contact {degrees}: the edge advances into the material at more than 0 and less than 180 degrees"
            ))),
            (None, Some(normal), Some(offset), Some(position)) => {
                let (sin, cos) = libm::sincos(position.to_radians());
                Ok(Contact::Line {
                    normal_deg: normal,
                    offset_mm: offset * self.units.mm(),
                    position: [cos, sin],
                    is_clockwise: self.clockwise,
                })
            }
            _ => Err(Failure::Usage(
                "--contact DEGREES is missing, or --stock-normal, --stock-offset and --position".into(),
            )),
        }
    }
}

fn figures<'a>(case: &Case, evaluated: &'a Evaluated, unit: LengthUnit) -> LawFigures<'a> {
    let mm = unit.mm();
    let quantity = |found: &'a CaseQuantity| {
        let CaseQuantity { symbol, value, dimension, equation, meaning } = found;
        let (factor, unit) = match dimension {
            Dimension::Length => (mm, unit.label().to_owned()),
            Dimension::Area => (mm * mm, format!("{}2", unit.label())),
            Dimension::Feed => (mm, format!("{}/min", unit.label())),
            Dimension::Degrees => (1.0, "deg".into()),
            Dimension::Ratio => (1.0, String::new()),
            Dimension::PerMin => (1.0, "1/min".into()),
        };
        QuantityFigures { symbol, value: value / factor, unit, equation, meaning }
    };
    LawFigures {
        law: case.law(),
        unit: unit.label(),
        ipt_center: evaluated.path_mm / mm,
        ipt_center_controller: evaluated.controller_path_mm / mm,
        feed: evaluated.feed_mm_per_min.map(|feed| feed / mm),
        quantities: evaluated.quantities.iter().map(quantity).collect(),
    }
}

fn print(figures: &LawFigures<'_>) {
    say(format_args!("{} law", figures.law));
    for QuantityFigures { symbol, value, unit, equation, meaning } in &figures.quantities {
        let text = format!("{value:.9}");
        say(format_args!("  {symbol:>6} {text:>18} {unit:<7} {equation:<12} {meaning}"));
    }
    let difference = figures.ipt_center_controller / figures.ipt_center - 1.0;
    say(format_args!(
        "the controller, in single precision: {:.9} {} per tooth, {difference:+.1e} of it",
        figures.ipt_center_controller, figures.unit
    ));
}
