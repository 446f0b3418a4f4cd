//! Job of plunges or of finishing passes, as the text of a job file (docs/job.md): every feed stays the program's own.

use std::fmt::Write;

use arcfeed_units::{LengthUnit, MM_PER_INCH};

use crate::output::job::{Machine, number, quoted};

/// Content of a job file for a planned path of an end mill.
#[derive(Clone, Debug, PartialEq)]
pub struct EndMillJob<'a> {
    /// Unit of the file, and of the program.
    pub unit: LengthUnit,
    /// Program, relative to the file.
    pub program: &'a str,
    /// Tool.
    pub shape: ToolShape,
    /// T of the program.
    pub tool: u32,
    /// S of the program.
    pub rev_per_min: f64,
    /// Feed per tooth.
    pub feed_per_tooth_mm: f64,
    /// Largest feed of the program, mm/min.
    pub feed_max_mm_per_min: f64,
    /// Remark about the feeds.
    pub remark: &'a str,
    /// Distance of the simulation's dexel rays, if `stock.stl` and `finished.stl` stand beside the file.
    pub rays_mm: Option<f64>,
    /// Preset of the control.
    pub control: &'a str,
    /// Machine, if it is known.
    pub machine: Option<Machine<'a>>,
}

/// Shape of an end mill, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolShape {
    /// Radius.
    pub radius_mm: f64,
    /// Radius of the corner.
    pub corner_radius_mm: f64,
    /// Height of the cutting part.
    pub height_mm: f64,
    /// Teeth.
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
             [spindle]\nrev_per_min = {}\n\n[limits]\nmax_feed = {}\n\n\
             # {}\n\
             [law]\nkind = \"programmed\"\nfeed_per_tooth = {}\n\n",
            quoted(self.program),
            self.tool,
            length(2.0 * radius_mm),
            length(corner_radius_mm),
            length(height_mm),
            number(self.rev_per_min),
            length(self.feed_max_mm_per_min),
            self.remark,
            length(self.feed_per_tooth_mm),
        );
        if let Some(rays_mm) = self.rays_mm {
            let _ = write!(
                text,
                "[workpiece]\nstl = \"stock.stl\"\nstl_units = \"mm\"\ntarget = \"finished.stl\"\nstep = {}\n\n",
                length(rays_mm)
            );
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
