//! NC program of a plunged rotor: all passages, the rotary axes standing during each plunge. Fanuc's dialect, G17.
//!
//! Per plunge: rapid above the start, where alone the rotary axes turn; down to 1 mm above the material at the approach feed; at half the feed until the
//! whole end has material above it; at the full feed; the last millimetre at half the feed; off the wall; rapid out.
//!
//! ```text
//! F = n z f_z                       flat end: the chip is the feed per tooth, however wide the cut        (1)
//! ```
//!
//! The index angle is rounded to the control's resolution first, and the places are computed for the rounded angle.

use arcfeed_units::{LengthUnit, MM_PER_INCH};
use nalgebra::Rotation3;

use crate::frame::slot_frame;
use crate::output::words::{Format, Sheet, degrees, microdegrees};
use crate::plunge::plan::Plunge;
use crate::vector::{Point, Vector};

/// Distance from the material at which the approach ends, and from the tip at which the feed is reduced, mm.
const NEAR_MM: f64 = 1.0;
/// Share of the feed while the mill enters and at the end.
const REDUCED: f64 = 0.5;
/// Places nearer to each other than this are one, mm.
const SAME_MM: f64 = 1e-4;

/// Feeds of a plunging program, mm/min.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlungeFeeds {
    /// (1)
    pub plunge_mm_per_min: f64,
    /// Down to the material.
    pub approach_mm_per_min: f64,
}

/// Relation of the indexing axis to the angle about the rotor's axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IndexAxis {
    /// Degrees of the axis per degree of the tool axis' angle: 1 or -1.
    pub sign: f64,
    /// Position of the axis for a tool axis along x of the part.
    pub zero_deg: f64,
}

/// Settings of a plunging program.
#[derive(Clone, Debug, PartialEq)]
pub struct PlungeSetup {
    /// O number.
    pub number: u32,
    /// Comments at the top.
    pub title: Vec<String>,
    /// G20 or G21.
    pub unit: LengthUnit,
    /// T and H.
    pub tool: u32,
    /// S
    pub rev_per_min: f64,
    /// M8 and M9.
    pub coolant: bool,
    /// A, the same for all plunges.
    pub tilt_deg: f64,
    /// B
    pub index: IndexAxis,
    /// Number of passages.
    pub passages: u32,
    /// Feeds.
    pub feeds: PlungeFeeds,
}

/// Move of a plunge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlungeMove {
    /// End of the move: middle of the mill's end, in the plunge's frame.
    pub to: Point,
    /// Feed; `None`: rapid.
    pub feed_mm_per_min: Option<f64>,
}

/// Moves of a plunge, from above its start to above its end.
pub fn plunge_moves(plunge: &Plunge, feeds: &PlungeFeeds) -> Vec<PlungeMove> {
    let [above, low, off, out] = plunge.places();
    let [high_mm, whole_mm] = plunge.roof_mm;
    let last_mm = low.z + NEAR_MM;
    let start_mm = (high_mm + NEAR_MM).clamp(last_mm, above.z);
    let reduced = feeds.plunge_mm_per_min * REDUCED;
    let mut moves = vec![PlungeMove { to: above, feed_mm_per_min: None }];
    for (height_mm, feed) in [
        (start_mm, feeds.approach_mm_per_min),
        (whole_mm.clamp(last_mm, start_mm), reduced),
        (last_mm, feeds.plunge_mm_per_min),
        (low.z, reduced),
    ] {
        if moves[moves.len() - 1].to.z - height_mm > SAME_MM {
            moves.push(PlungeMove { to: Point::new(low.x, low.y, height_mm), feed_mm_per_min: Some(feed) });
        }
    }
    if plunge.relief_mm != 0.0 {
        moves.push(PlungeMove { to: off, feed_mm_per_min: Some(feeds.plunge_mm_per_min) });
    }
    moves.push(PlungeMove { to: out, feed_mm_per_min: None });
    moves
}

/// Time of the feed moves of plunges, minutes.
pub fn plunging_min(plunges: &[Plunge], feeds: &PlungeFeeds) -> f64 {
    let of_one = |plunge: &Plunge| {
        let moves = plunge_moves(plunge, feeds);
        let timed =
            moves.windows(2).filter_map(|pair| Some((pair[1].to - pair[0].to).norm() / pair[1].feed_mm_per_min?));
        timed.sum::<f64>()
    };
    plunges.iter().map(of_one).sum()
}

/// Point of a plunge in the part frame, in a passage at an angle from the first.
pub fn in_part(plunge: &Plunge, to: &Point, passage_rad: f64) -> Point {
    passage_turn(passage_rad) * (plunge.to_tool.inverse() * to)
}

/// Tool axis of a plunge in the part frame, in a passage at an angle from the first.
pub fn axis_in_part(plunge: &Plunge, passage_rad: f64) -> Vector {
    passage_turn(passage_rad) * plunge.axis
}

fn passage_turn(passage_rad: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector::z_axis(), passage_rad)
}

/// Text of the NC program: the plunges of one passage, repeated in all passages.
pub fn write(plunges: &[Plunge], setup: &PlungeSetup) -> String {
    let format = Format { unit: setup.unit };
    let mut writer = Writer { setup, format, sheet: Sheet::new(format), at: None, index: None };
    writer.header();
    let pitch_rad = core::f64::consts::TAU / f64::from(setup.passages);
    for passage in 0..setup.passages {
        writer.sheet.comment(&format!("passage {} of {}", passage + 1, setup.passages));
        for plunge in plunges {
            writer.plunge(plunge, f64::from(passage) * pitch_rad);
        }
    }
    writer.footer();
    writer.sheet.into_text()
}

struct Writer<'s> {
    setup: &'s PlungeSetup,
    format: Format,
    sheet: Sheet,
    /// X, Y, Z as written; `None` before the first.
    at: Option<[i64; 3]>,
    /// B as written.
    index: Option<i64>,
}

impl Writer<'_> {
    fn header(&mut self) {
        let PlungeSetup { number, title, unit, tool, rev_per_min, coolant, .. } = self.setup;
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
        if *coolant {
            self.sheet.block("M8");
        }
    }

    fn plunge(&mut self, plunge: &Plunge, passage_rad: f64) {
        let IndexAxis { sign, zero_deg } = self.setup.index;
        let angle_rad = libm::atan2(plunge.axis.y, plunge.axis.x) + passage_rad;
        let index_deg = libm::round((sign * angle_rad.to_degrees() + zero_deg) * 1e3) / 1e3;
        let (sin, cos) = libm::sincos((sign * (index_deg - zero_deg)).to_radians());
        let Some(turn) = slot_frame(&Vector::new(cos, sin, 0.0)) else { return };
        for (number, step) in plunge_moves(plunge, &self.setup.feeds).iter().enumerate() {
            let place = turn * in_part(plunge, &step.to, passage_rad);
            let to = [place.x, place.y, place.z].map(|mm| self.format.steps(mm));
            if number == 0 { self.above(to, index_deg) } else { self.straight(to, step.feed_mm_per_min) }
        }
    }

    /// Rapid above a plunge, with the rotary axes.
    fn above(&mut self, to: [i64; 3], index_deg: f64) {
        let first = self.at.is_none();
        let mut words = format!("{}{}", self.sheet.word('X', to[0]), self.sheet.word('Y', to[1]));
        if first && microdegrees(self.setup.tilt_deg) != 0 {
            words += &format!("A{}", degrees(self.setup.tilt_deg));
        }
        let turned = Some(microdegrees(index_deg));
        if self.index != turned {
            self.index = turned;
            words += &format!("B{}", degrees(index_deg));
        }
        if first {
            self.sheet.motion("G0", &words, None);
            let height = self.sheet.word('Z', to[2]);
            self.sheet.block(&format!("G43{height}H{}", self.setup.tool));
        } else {
            if self.at.is_some_and(|at| at[2] != to[2]) {
                words += &self.sheet.word('Z', to[2]);
            }
            self.sheet.motion("G0", &words, None);
        }
        self.at = Some(to);
    }

    fn straight(&mut self, to: [i64; 3], feed_mm_per_min: Option<f64>) {
        let from = self.at.replace(to).unwrap_or(to);
        let moved = ['X', 'Y', 'Z'].into_iter().enumerate().filter(|(axis, _)| from[*axis] != to[*axis]);
        let words: String = moved.map(|(axis, letter)| self.sheet.word(letter, to[axis])).collect();
        if words.is_empty() {
            return;
        }
        match feed_mm_per_min {
            None => self.sheet.motion("G0", &words, None),
            Some(feed) => {
                let feed = match self.setup.unit {
                    LengthUnit::Inch => feed / MM_PER_INCH,
                    LengthUnit::Mm => feed,
                };
                self.sheet.motion("G1", &words, Some(("G94", feed)));
            }
        }
    }

    fn footer(&mut self) {
        if self.setup.coolant {
            self.sheet.block("M9");
        }
        ["M5", "G91G28Z.0", "G49", "G28X.0Y.0", "G90", "M30"].iter().for_each(|words| self.sheet.block(words));
        self.sheet.line("%");
    }
}
