//! NC program of a planned rotor: the same path in every slot, with the rotor indexed in between. Fanuc's dialect, G17.
//!
//! ```text
//! I, J = A - P                                                               (1)
//! ```
//!
//! with A the true rotation centre and P the start as written: the control's own centre then lies within half a step of
//! A, independently of earlier rounding, and start and end radius agree within one and a half steps (3.8 um in inches).
//! Source of words and order: the published listing (Petean, annex); the blocks before the first slot and behind the
//! last are ours.

use arcfeed_nc::modal::Turn;
use arcfeed_units::{LengthUnit, MM_PER_INCH};
use thiserror::Error;

use crate::output::words::{Format, Sheet, degrees, microdegrees};
use crate::path::{Purpose, SlotPath, Step};
use crate::vector::Flat;

/// Shortest arc in steps of the resolution; shorter ones are left out. Rounding moves each end by up to 0.71 steps;
/// below 1.42 the written ends could be in reversed order, and the control would execute a full circle.
const ARC_STEPS_MIN: f64 = 2.0;

/// Largest O number.
const NUMBER_MAX: u32 = 9_999;

/// Settings of the NC program apart from the path.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// O number of the program.
    pub number: u32,
    /// Comments at the top.
    pub title: Vec<String>,
    /// Unit of the program: G20 or G21.
    pub unit: LengthUnit,
    /// Number of the tool and of its length offset: T and H.
    pub tool: u32,
    /// Spindle speed (S).
    pub rev_per_min: f64,
    /// Whether the coolant is switched on and off (M8, M9).
    pub coolant: bool,
    /// Position of the axis A, the same for all slots.
    pub tilt_deg: f64,
    /// Position of the axis B for each slot, in order.
    pub slots_deg: Vec<f64>,
    /// Feeds by the purpose of a move.
    pub feeds: Feeds,
    /// Way in which the rotor is indexed from slot to slot.
    pub indexing: Indexing,
    /// Whether comments such as `(LEVEL 3 MOVEMENT 1)` are written.
    pub labels: bool,
    /// The control prints slot and level (DPRNT). `adapt` does not accept a program with macro statements: for one that
    /// is to be adapted leave them out, and have the sender request reports (docs/dnc.md).
    pub reports: bool,
}

/// Feeds of the program, by the purpose of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feeds {
    /// Feed of all arcs, and of steps without a feed of their own.
    pub cutting_mm_per_min: f64,
    /// Feed down to above the blank, and up from the last level.
    pub approach_mm_per_min: Option<f64>,
    /// Feed into the blank, and from level to level.
    pub axial_mm_per_min: Option<f64>,
    /// Feed of indexing, inverse time.
    pub indexing_per_min: f64,
}

impl Feeds {
    /// Feed for a purpose, mm/min.
    pub fn of(&self, purpose: Purpose) -> f64 {
        let own = match purpose {
            Purpose::Approach | Purpose::Retract => self.approach_mm_per_min,
            Purpose::Entry | Purpose::Link => self.axial_mm_per_min,
            _ => None,
        };
        own.unwrap_or(self.cutting_mm_per_min)
    }
}

/// Way in which the rotor is indexed (turned) from slot to slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Indexing {
    /// The rotor turns while the tool is above it.
    AtClearance,
    /// The rotor turns while the tool goes down to the first level, as in the published listing: the tool is in the
    /// blank before the rotor stops.
    WhileDescending,
}

/// Reason why the NC program cannot be written.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum NcError {
    /// The program number is out of range.
    #[error("a program's number is between 1 and {NUMBER_MAX}, not {0}")]
    Number(u32),
    /// The path has no levels, or there are no slots.
    #[error("the path has no levels, or there are no slots")]
    Empty,
    /// A value is not a number, or a feed is not usable.
    #[error("a place, an angle or a feed of the program is not a usable number")]
    NotANumber,
}

/// Writes the NC program of a planned rotor.
///
/// # Errors
/// Describes the value that cannot be written.
pub fn write(path: &SlotPath, setup: &Setup) -> Result<String, NcError> {
    check(path, setup)?;
    let format = Format { unit: setup.unit };
    let mut writer = Writer { setup, format, sheet: Sheet::new(format), at: [0; 3], turned: None };
    writer.header(path);
    let steps = path.steps();
    for (index, slot_deg) in setup.slots_deg.iter().enumerate() {
        writer.slot(index, *slot_deg, &steps);
    }
    writer.footer();
    Ok(writer.sheet.into_text())
}

fn check(path: &SlotPath, setup: &Setup) -> Result<(), NcError> {
    if !(1..=NUMBER_MAX).contains(&setup.number) {
        return Err(NcError::Number(setup.number));
    }
    let steps = path.steps();
    if steps.is_empty() || setup.slots_deg.is_empty() {
        return Err(NcError::Empty);
    }
    let feeds = [setup.feeds.cutting_mm_per_min, setup.feeds.indexing_per_min, setup.rev_per_min];
    let places = steps.iter().flat_map(|step| step.to.into_iter().chain(step.about.map(|(a, _)| a.x + a.y)));
    let is_sound = places.chain([setup.tilt_deg]).chain(setup.slots_deg.iter().copied()).all(f64::is_finite)
        && feeds
            .into_iter()
            .chain(setup.feeds.axial_mm_per_min)
            .chain(setup.feeds.approach_mm_per_min)
            .all(|feed| feed > 0.0 && feed.is_finite());
    if is_sound { Ok(()) } else { Err(NcError::NotANumber) }
}

struct Writer<'s> {
    setup: &'s Setup,
    format: Format,
    sheet: Sheet,
    /// X, Y, Z as written.
    at: [i64; 3],
    /// B as written.
    turned: Option<i64>,
}

impl Writer<'_> {
    fn header(&mut self, path: &SlotPath) {
        let Setup { number, title, unit, tool, rev_per_min, tilt_deg, .. } = self.setup;
        self.sheet.line("%");
        self.sheet.line(&format!("O{number:04}"));
        title.iter().for_each(|line| self.sheet.comment(line));
        let unit = match unit {
            LengthUnit::Inch => "G20",
            LengthUnit::Mm => "G21",
        };
        self.sheet.block(&format!("{unit}G17G40G49G80G90G94"));
        self.sheet.block(&format!("T{tool}M6"));
        self.sheet.block(&format!("S{}M3", libm::round(*rev_per_min)));
        if self.setup.coolant {
            self.sheet.block("M8");
        }
        self.at = self.places([path.base.x, path.base.y, path.clear_mm]);
        let [x, y, z] = self.at;
        let mut words = self.words("XY", [x, y]);
        if microdegrees(*tilt_deg) != 0 {
            words += &format!("A{}", degrees(*tilt_deg));
        }
        if let (Indexing::AtClearance, Some(first_deg)) = (self.setup.indexing, self.setup.slots_deg.first()) {
            words += &format!("B{}", degrees(*first_deg));
            self.turned = Some(microdegrees(*first_deg));
        }
        self.sheet.motion("G0", &words, None);
        let height = self.sheet.word('Z', z);
        self.sheet.block(&format!("G43{height}H{tool}"));
    }

    fn slot(&mut self, index: usize, slot_deg: f64, steps: &[Step]) {
        if self.setup.labels {
            self.sheet.comment(&format!("slot {} of {}", index + 1, self.setup.slots_deg.len()));
        }
        let mut level = None;
        for step in steps {
            if level != Some(step.level) && step.purpose != Purpose::Retract {
                level = Some(step.level);
                self.report(index, step);
            }
            match (step.purpose, step.about) {
                (Purpose::Approach, _) => self.approach(slot_deg, step),
                (_, Some((center, turn))) => self.arc(step, center, turn),
                (_, None) => self.straight(step),
            }
        }
    }

    fn approach(&mut self, slot_deg: f64, step: &Step) {
        let turn = format!("B{}", degrees(slot_deg));
        let feed = Some(("G93", self.setup.feeds.indexing_per_min));
        let before = self.turned.replace(microdegrees(slot_deg));
        match self.setup.indexing {
            Indexing::WhileDescending => {
                self.at = self.places(step.to);
                let words = self.words("XYZ", self.at) + &turn;
                self.sheet.motion("G1", &words, feed);
            }
            Indexing::AtClearance => {
                if before != self.turned {
                    let words = self.words("XY", [self.at[0], self.at[1]]) + &turn;
                    self.sheet.motion("G1", &words, feed);
                }
                self.straight(step);
            }
        }
    }

    /// Writes only the axes that move, but both axes of the plane together.
    fn straight(&mut self, step: &Step) {
        let to = self.places(step.to);
        let mut words = String::new();
        if to[..2] != self.at[..2] {
            words += &self.words("XY", [to[0], to[1]]);
        }
        if to[2] != self.at[2] {
            words += &self.words("Z", [to[2]]);
        }
        self.at = to;
        if !words.is_empty() {
            let feed = self.in_unit(self.setup.feeds.of(step.purpose));
            self.sheet.motion("G1", &words, Some(("G94", feed)));
        }
    }

    fn arc(&mut self, step: &Step, center: Flat, turn: Turn) {
        if step.length_mm() < ARC_STEPS_MIN * self.format.step().to_mm() {
            return;
        }
        if let (true, Some(movement)) = (self.setup.labels, step.purpose.movement()) {
            self.sheet.comment(&format!("level {} movement {movement}", step.level + 1));
        }
        let [x, y, _] = self.at;
        let from_mm = |steps: i64| steps as f64 * self.format.step().to_mm();
        let offset = [center.x - from_mm(x), center.y - from_mm(y)].map(|mm| self.format.steps(mm)); // (1)
        self.at = self.places(step.to);
        let words = self.words("XY", [self.at[0], self.at[1]]) + &self.words("IJ", offset);
        let code = match turn {
            Turn::Cw => "G2",
            Turn::Ccw => "G3",
        };
        let feed = self.in_unit(self.setup.feeds.cutting_mm_per_min);
        self.sheet.motion(code, &words, Some(("G94", feed)));
    }

    /// Writes the report that the control prints when it has read so far.
    fn report(&mut self, slot: usize, step: &Step) {
        if self.setup.reports {
            let digits = match self.setup.unit {
                LengthUnit::Inch => "[34]",
                LengthUnit::Mm => "[43]",
            };
            self.sheet.line("POPEN");
            self.sheet.line(&format!("DPRNT[SLOT*{}*LEVEL*{}*Z#5003{digits}]", slot + 1, step.level + 1));
            self.sheet.line("PCLOS");
        }
    }

    fn footer(&mut self) {
        if self.setup.coolant {
            self.sheet.block("M9");
        }
        ["M5", "G91G28Z.0", "G49", "G28X.0Y.0", "G90", "M30"].iter().for_each(|words| self.sheet.block(words));
        self.sheet.line("%");
    }

    fn places(&self, place_mm: [f64; 3]) -> [i64; 3] {
        place_mm.map(|mm| self.format.steps(mm))
    }

    fn words<const N: usize>(&self, letters: &str, steps: [i64; N]) -> String {
        letters.chars().zip(steps).map(|(letter, steps)| self.sheet.word(letter, steps)).collect()
    }

    fn in_unit(&self, feed_mm_per_min: f64) -> f64 {
        match self.setup.unit {
            LengthUnit::Inch => feed_mm_per_min / MM_PER_INCH,
            LengthUnit::Mm => feed_mm_per_min,
        }
    }
}

#[cfg(test)]
mod tests;
