//! Job of a planned program: the data for a feed controller, as the text of a job file (docs/job.md).

use std::fmt::Write;

use arcfeed_model::cut::RotationCircle;
use arcfeed_model::tool::Edge;
use arcfeed_nc::modal::Turn;
use arcfeed_units::{LengthUnit, MM_PER_INCH};

use crate::cutter::CupMill;
use crate::output::limits::{BlankFace, StockLimit};
use crate::output::toml_text::{number, quoted};
use crate::output::workpiece::Workpiece;

/// Content of a job file for a planned path of a cup mill.
#[derive(Clone, Debug, PartialEq)]
pub struct JobFile<'a> {
    /// Unit of the file, and of the program.
    pub unit: LengthUnit,
    /// Path of the program, relative to the job file.
    pub program: &'a str,
    /// Cup mill with its dimensions.
    pub mill: &'a CupMill,
    /// T number of the program.
    pub tool: u32,
    /// F of the program's cutting moves, mm/min.
    pub cutting_mm_per_min: f64,
    /// Spindle speed (S) of the program.
    pub rev_per_min: f64,
    /// Feed per tooth that the law keeps.
    pub feed_per_tooth_mm: f64,
    /// Stock limits: one for each cut rule.
    pub limits: &'a [StockLimit],
    /// Feed law of the cut rules.
    pub law: Law<'a>,
    /// Workpiece for the simulation; `None` without one.
    pub workpiece: Option<Workpiece<'a>>,
    /// Preset of the simulated control.
    pub control: &'a str,
    /// Path of a file with settings of the control, relative to the job file; `None` without one.
    pub settings: Option<&'a str>,
    /// Machine; `None` if it is not known.
    pub machine: Option<Machine<'a>>,
}

/// Feed law in a job file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law<'a> {
    /// Law of the cup-mill source: it considers the contact of one circle of the ring with one stock line only. Where the other circle, or
    /// the other limit of the stock, has a chip that is thicker by some ratio ([`StockLimit::elsewhere_ratio`]), the rule's feed per tooth
    /// is divided by this ratio. A movement with a high ratio gets no rule and keeps its programmed feed.
    Circumference,
    /// Law for the whole engaged arc of both circles, by this engagement map, relative to the job file.
    EngagedArc(&'a str),
}

/// Source of the machine's description in the job file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Machine<'a> {
    /// Machine file, relative to the job file.
    File(&'a str),
    /// Name of a built-in preset.
    Preset(&'a str),
}

/// First words of a job file that a planner wrote.
pub const FIRST_WORDS: &str = "# The job of a planned program";

/// Largest raise of the planned feed.
const RAISE: f64 = 4.0;

impl JobFile<'_> {
    /// Text of the job file.
    pub fn text(&self) -> String {
        let unit = match self.unit {
            LengthUnit::Inch => "inch",
            LengthUnit::Mm => "mm",
        };
        let mut text = format!(
            "{FIRST_WORDS}: `arcfeed adapt` and `arcfeed simulate` take it. The planner wrote it, and writes it anew.\n\
             units = \"{unit}\"\nprogram = {}\n",
            quoted(self.program)
        );
        self.tool(&mut text);
        let _ = writeln!(text, "\n[spindle]\nrev_per_min = {}", number(self.rev_per_min));
        let _ = writeln!(
            text,
            "\n# The feed that keeps the chip is up to four times the planned one; no feed is raised further.\n[limits]\nmax_feed = {}\n\
             max_raise = {RAISE}",
            self.length(RAISE * self.cutting_mm_per_min)
        );
        let (why, law) = match self.law {
            Law::Circumference => {
                ("The same chip on the circumference all along an arc, at the stock's limit", "circumference")
            }
            Law::EngagedArc(_) => (
                "The thickest chip of both circles the same all along an arc, in the material that is left there",
                "engaged-arc",
            ),
        };
        let feed = self.length(self.feed_per_tooth_mm);
        let _ = writeln!(text, "\n# {why}.\n[law]\nkind = \"{law}\"\nfeed_per_tooth = {feed}");
        self.cuts(&mut text);
        if let Some(workpiece) = &self.workpiece {
            let _ = write!(text, "\n{}", workpiece.text(|length_mm| self.length(length_mm)));
        }
        let _ = writeln!(text, "\n[control]\npreset = {}", quoted(self.control));
        if let Some(settings) = self.settings {
            let _ = writeln!(text, "settings = {}", quoted(settings));
        }
        text += "\n# A Fanuc's usual: seven bits, even parity, DC1 and DC3. Give your line's own.\n[serial]\nbaudrate = 9600\nbytesize = 7\n\
                 parity = \"E\"\nstopbits = 2\nxonxoff = true\n";
        match self.machine {
            Some(Machine::File(file)) => text += &format!("\n[machine]\nfile = {}\n", quoted(file)),
            Some(Machine::Preset(preset)) => text += &format!("\n[machine]\npreset = {}\n", quoted(preset)),
            None => {}
        }
        text
    }

    fn tool(&self, text: &mut String) {
        let CupMill { outer_radius_mm, inner_radius_mm, insert_radius_mm, cavity_depth_mm, active_teeth, .. } =
            self.mill;
        let [outer, inner, corner, height] =
            [outer_radius_mm, inner_radius_mm, insert_radius_mm, cavity_depth_mm].map(|mm| self.length(*mm));
        let _ = writeln!(
            text,
            "\n# Its height is the cavity's depth: so far up it cuts as a ring.\n[tool]\nkind = \"cup-mill\"\nnumber = {}\nouter_radius = {outer}\n\
             inner_radius = {inner}\nactive_teeth = {active_teeth}\ncorner_radius = {corner}\nheight = {height}",
            self.tool
        );
    }

    fn cuts(&self, text: &mut String) {
        *text += match self.law {
            Law::Circumference => {
                "\n# The blank's faces are the stock's limits. Each lies square to the rotor's axis and leans with the tool: `rise` is what its\n\
                 # distance grows by per unit of Z. A rule holds on the levels where its movement cuts, the last way back left out.\n"
            }
            Law::EngagedArc(_) => {
                "\n# The map has the material in front of both circles along each arc, after all arcs and links before it. It belongs to this\n\
                 # program, tool and stock: `arcfeed engage --alike` makes it anew.\n"
            }
        };
        for limit in self.limits {
            self.cut(text, limit);
        }
    }

    fn cut(&self, text: &mut String, limit: &StockLimit) {
        let (rotation, point) = match limit.rotation {
            RotationCircle::Interior => ("interior", "B1, on the inner circle"),
            RotationCircle::Exterior => ("exterior", "A, on the outer circle"),
        };
        let side = match limit.edge {
            Edge::Outer => "outer",
            Edge::Inner => "inner",
        };
        let direction = match limit.turn {
            Turn::Cw => "cw",
            Turn::Ccw => "ccw",
        };
        let _ = write!(text, "\n# Movement {}: about {point}", limit.movement);
        let rule = match self.law {
            Law::Circumference => self.line_rule(text, limit, side),
            Law::EngagedArc(map) => {
                *text += ".\n";
                Some(format!("stock = {{ map = {} }}\n", quoted(map)))
            }
        };
        if let Some(rule) = rule {
            let _ = write!(
                text,
                "[[cut]]\nrotation = \"{rotation}\"\ndirection = \"{direction}\"\nside = \"{side}\"\n{rule}"
            );
        }
    }

    /// Ends the remark on a movement, and returns the part of its rule that describes the stock by a line; `None` if
    /// such a rule would be slower than the programmed feed, at which no chip is thicker than its target.
    fn line_rule(&self, text: &mut String, limit: &StockLimit, side: &str) -> Option<String> {
        let face = match limit.face {
            BlankFace::Lower => "lower",
            BlankFace::Upper => "upper",
        };
        let [least_deg, most_deg] = limit.contact_deg;
        let _ = writeln!(
            text,
            "; thickest chip with the {side} circle at the {face} face, {least_deg:.0} to {most_deg:.0} degrees from that point."
        );
        if !limit.is_governed_by_line() {
            *text += "# The other circle, or the other face, has much thicker chips: no rule, the programmed feed.\n";
            return None;
        }
        if limit.kept_ratio < 1.0 {
            let _ = writeln!(
                text,
                "# Where the circle meets the line once more, on its far side, the law keeps the chip there: that at the face is down to \
                 {:.2} of it.",
                limit.kept_ratio
            );
        }
        let [low, high] = limit.heights_mm.map(|mm| self.length(mm));
        let mut rule = format!(
            "stock = {{ normal_deg = {}, offset = {}, rise = {} }}\nz = [{low}, {high}]\n",
            number(limit.normal_deg),
            self.length(limit.offset_mm),
            limit.rise_ratio
        );
        if limit.elsewhere_ratio > 1.0 {
            let ratio = limit.elsewhere_ratio;
            let _ = writeln!(
                text,
                "# The other circle, or the other face, has up to {ratio:.2} times this chip, which is lower by as much."
            );
            let _ = writeln!(rule, "feed_per_tooth = {}", self.length(self.feed_per_tooth_mm / ratio));
        }
        Some(rule)
    }

    fn length(&self, length_mm: f64) -> String {
        match self.unit {
            LengthUnit::Inch => number(length_mm / MM_PER_INCH),
            LengthUnit::Mm => number(length_mm),
        }
    }
}
