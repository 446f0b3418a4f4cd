//! Job of plunges or of finishing passes, as the text of a job file (docs/job.md): every feed stays the program's own, or the plunge
//! law governs the plunges.

use std::fmt::Write;

use arcfeed_units::{LengthUnit, MM_PER_INCH};

use crate::output::job::Machine;
use crate::output::toml_text::{number, quoted};
use crate::output::workpiece::{BlankRing, StockShape, Workpiece};

/// Content of a job file for a planned path of an end mill.
#[derive(Clone, Debug, PartialEq)]
pub struct EndMillJob<'a> {
    /// Unit of the file, and of the program.
    pub unit: LengthUnit,
    /// Path of the program, relative to the job file.
    pub program: &'a str,
    /// Tool with its dimensions.
    pub shape: ToolShape,
    /// T number of the program.
    pub tool: u32,
    /// Spindle speed (S) of the program.
    pub rev_per_min: f64,
    /// Feed per tooth.
    pub feed_per_tooth_mm: f64,
    /// Largest feed of the program, mm/min.
    pub feed_max_mm_per_min: f64,
    /// Remark about the feeds, written as a comment.
    pub remark: &'a str,
    /// Plunge law with its limits; `None` if all feeds stay the program's own.
    pub law: Option<PlungeLaw<'a>>,
    /// Distance of the rays of the simulation's tri-dexel model; `None` if there are no `stock.stl` and `finished.stl` beside the file.
    pub rays_mm: Option<f64>,
    /// Preset of the simulated control.
    pub control: &'a str,
    /// Machine; `None` if it is not known.
    pub machine: Option<Machine<'a>>,
}

/// Plunge law of a job, with all that it needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlungeLaw<'a> {
    /// Limits of the spindle and the material.
    pub limits: &'a PlungeLimits,
    /// Blank in the program's coordinates at the first plunge.
    pub ring: BlankRing,
}

/// Limits that the plunge law keeps: those of the spindle, for a material of the workpiece.
#[derive(Clone, Debug, PartialEq)]
pub struct PlungeLimits {
    /// Name of the material.
    pub material: String,
    /// Radial and axial force of a chip, each divided by its tangential force.
    pub force_ratios: [f64; 2],
    /// Largest power of the spindle, W; `None`: not limited.
    pub power_w: Option<f64>,
    /// Largest torque of the spindle, N m; `None`: not limited.
    pub torque_n_m: Option<f64>,
}

/// Height of the layers in which the sections of plunges are found, mm.
const LAYER_MM: f64 = 0.5;

/// Shape of an end mill, dimensions in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolShape {
    /// Radius.
    pub radius_mm: f64,
    /// Radius of the corner.
    pub corner_radius_mm: f64,
    /// Height of the cutting part.
    pub height_mm: f64,
    /// Number of teeth.
    pub teeth: u16,
}

impl EndMillJob<'_> {
    /// Text of the job file.
    pub fn text(&self) -> String {
        let unit = match self.unit {
            LengthUnit::Inch => "inch",
            LengthUnit::Mm => "mm",
        };
        let length = |length_mm: f64| match self.unit {
            LengthUnit::Inch => number(length_mm / MM_PER_INCH),
            LengthUnit::Mm => number(length_mm),
        };
        let ToolShape { radius_mm, corner_radius_mm, height_mm, teeth } = self.shape;
        let mut text = format!(
            "# The job of a planned program. The planner wrote it, and writes it anew.\nunits = \"{unit}\"\nprogram = {}\n\n\
             [tool]\nkind = \"end-mill\"\nnumber = {}\ndiameter = {}\nteeth = {teeth}\ncorner_radius = {}\nheight = {}\n\n\
             [spindle]\nrev_per_min = {}\n{}\n[limits]\nmax_feed = {}\n\n\
             # {}\n\
             [law]\nkind = \"{}\"\nfeed_per_tooth = {}\n\n",
            quoted(self.program),
            self.tool,
            length(2.0 * radius_mm),
            length(corner_radius_mm),
            length(height_mm),
            number(self.rev_per_min),
            self.law.map_or(String::new(), |law| law.limits.text()),
            length(self.feed_max_mm_per_min),
            self.remark,
            if self.law.is_some() { "plunge" } else { "programmed" },
            length(self.feed_per_tooth_mm),
        );
        if let Some(law) = self.law {
            let PlungeLimits { material, force_ratios: [radial, axial], .. } = law.limits;
            let _ = write!(
                text,
                "[plunge]\nmap = \"engaged.toml\"\n\n\
                 [cutting]\nmaterial = {}\nradial = {radial}\naxial = {axial}\naxial_depth = {}\nlayers = 2\n\n",
                quoted(material),
                length(2.0 * LAYER_MM),
            );
        }
        if let Some(step_mm) = self.rays_mm {
            let stock = self.law.map_or(StockShape::Mesh("stock.stl"), |law| StockShape::Ring(law.ring));
            text += &Workpiece { stock, target: Some("finished.stl"), step_mm }.text(length);
            text += "\n";
        }
        let _ = write!(
            text,
            "[control]\npreset = {}\n\n\
             # A Fanuc's usual: seven bits, even parity, DC1 and DC3. Give your line's own.\n[serial]\nbaudrate = 9600\nbytesize = 7\n\
             parity = \"E\"\nstopbits = 2\nxonxoff = true\n",
            quoted(self.control)
        );
        match self.machine {
            Some(Machine::File(file)) => text += &format!("\n[machine]\nfile = {}\n", quoted(file)),
            Some(Machine::Preset(preset)) => text += &format!("\n[machine]\npreset = {}\n", quoted(preset)),
            None => {}
        }
        text
    }
}

impl PlungeLimits {
    /// Lines of `[spindle]`.
    fn text(&self) -> String {
        let power = self.power_w.map(|power_w| format!("max_power = \"{} W\"\n", number(power_w)));
        let torque = self.torque_n_m.map(|torque_n_m| format!("max_torque = \"{} Nm\"\n", number(torque_n_m)));
        power.into_iter().chain(torque).collect()
    }
}
