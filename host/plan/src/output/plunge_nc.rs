//! NC program of a plunged rotor: all passages, the rotary axes standing during each plunge. Fanuc's dialect, G17.
//!
//! Per plunge: rapid above the start, where alone the rotary axes turn; down to 1 mm above the material at the approach feed; at half the feed until the
//! whole end has material above it; at the full feed; the last millimetre at half the feed; off the wall; rapid out.
//!
//! ```text
//! F = n z f_z                       flat end: the chip is the feed per tooth, however wide the cut        (1)
//! ```
//!
//! The angles of the rotary axes are rounded to the control's resolution first, and the places are computed for the rounded angles.

use arcfeed_units::{LengthUnit, MM_PER_INCH};
use nalgebra::{Matrix3, Rotation3};

use crate::output::words::{Format, Sheet, degrees, microdegrees};
use crate::plunge::passage_plan::Plunge;
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
    /// Feed F of the plunges (1).
    pub plunge_mm_per_min: f64,
    /// Feed of the approach down to the material.
    pub approach_mm_per_min: f64,
}

/// Linear relation between the position of a rotary axis and an angle of the tool axis in the rotor's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleRelation {
    /// Degrees of the axis per degree of the angle: 1 or -1.
    pub sign: f64,
    /// Position of the rotary axis at which that angle is 0.
    pub zero_deg: f64,
}

impl AngleRelation {
    /// Position of the axis as a control reads it, and the angle that it presents, degrees.
    fn rounded_deg(&self, angle_rad: f64) -> [f64; 2] {
        let axis_deg = libm::round((self.sign * angle_rad.to_degrees() + self.zero_deg) * 1e3) / 1e3;
        [axis_deg, self.sign * (axis_deg - self.zero_deg)]
    }
}

/// Settings of the NC program apart from the plunges.
#[derive(Clone, Debug, PartialEq)]
pub struct PlungeSetup {
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
    /// A, by the angle of the tool's axis from planes across the rotor's; without such plunges the same for all.
    pub tilt: AngleRelation,
    /// B, by the angle about the rotor's axis.
    pub index: AngleRelation,
    /// Number of passages.
    pub passages: u32,
    /// Feeds.
    pub feeds: PlungeFeeds,
}

/// One move of a plunge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlungeMove {
    /// End of the move: middle of the mill's end, in the plunge's frame.
    pub to: Point,
    /// Feed; `None` for rapid.
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

/// Angles of a tool whose frame has x along the circumference: of its axis about the rotor's, and from planes across it.
pub fn tool_angles_rad(to_tool: &Rotation3<f64>) -> [f64; 2] {
    let (x, axis) = (to_tool.matrix().row(0), to_tool.matrix().row(2));
    [libm::atan2(-x[0], x[1]), libm::atan2(axis[2], libm::hypot(axis[0], axis[1]))]
}

/// Rotation from the part frame into that of a tool at these angles: the slot frame (frame.rs), also along the rotor's axis.
fn presented([index_rad, tilt_rad]: [f64; 2]) -> Rotation3<f64> {
    let ((sin, cos), (up, out)) = (libm::sincos(index_rad), libm::sincos(tilt_rad));
    let x = Vector::new(-sin, cos, 0.0);
    let y = Vector::new(-up * cos, -up * sin, out);
    let z = Vector::new(out * cos, out * sin, up);
    Rotation3::from_matrix_unchecked(Matrix3::from_rows(&[x.transpose(), y.transpose(), z.transpose()]))
}

/// Text of the program for the plunges of one passage in all passages.
pub fn write(plunges: &[Plunge], setup: &PlungeSetup) -> String {
    let format = Format { unit: setup.unit };
    let mut writer = Writer { setup, format, sheet: Sheet::new(format), at: None, angles: [None; 2] };
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
    /// A and B as written.
    angles: [Option<i64>; 2],
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
        let [index_rad, tilt_rad] = tool_angles_rad(&plunge.to_tool);
        let [index_deg, angle_deg] = self.setup.index.rounded_deg(index_rad + passage_rad);
        let [tilt_deg, lean_deg] = self.setup.tilt.rounded_deg(tilt_rad);
        let turn = presented([angle_deg, lean_deg].map(f64::to_radians));
        for (number, step) in plunge_moves(plunge, &self.setup.feeds).iter().enumerate() {
            let place = turn * in_part(plunge, &step.to, passage_rad);
            let to = [place.x, place.y, place.z].map(|mm| self.format.steps(mm));
            if number == 0 { self.above(to, [tilt_deg, index_deg]) } else { self.straight(to, step.feed_mm_per_min) }
        }
    }

    /// Rapid above a plunge, with the rotary axes.
    fn above(&mut self, to: [i64; 3], angles_deg: [f64; 2]) {
        let first = self.at.is_none();
        let mut words = format!("{}{}", self.sheet.word('X', to[0]), self.sheet.word('Y', to[1]));
        for (letter, (written, angle_deg)) in ['A', 'B'].into_iter().zip(self.angles.iter_mut().zip(angles_deg)) {
            let turned = Some(microdegrees(angle_deg));
            if *written != turned {
                *written = turned;
                words += &format!("{letter}{}", degrees(angle_deg));
            }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::slot_frame;

    #[test]
    fn the_angles_of_a_tool_present_its_frame() {
        for (index, tilt) in [(0.3, 0.0), (-2.0, 0.7), (3.0, -1.5)] {
            let (out, up) = (libm::cos(tilt), libm::sin(tilt));
            let turn = slot_frame(&Vector::new(out * libm::cos(index), out * libm::sin(index), up)).unwrap();
            let found = tool_angles_rad(&turn);
            assert!((found[0] - index).abs() < 1e-12 && (found[1] - tilt).abs() < 1e-12, "{found:?}");
            assert!((presented(found).matrix() - turn.matrix()).norm() < 1e-12);
        }
        // Along the rotor's axis, where there is no slot frame, x stays along the circumference.
        let along = presented([0.4, core::f64::consts::FRAC_PI_2]);
        assert!((along.inverse() * Vector::z() - Vector::z()).norm() < 1e-12);
        assert!((tool_angles_rad(&along)[0] - 0.4).abs() < 1e-12);
    }
}
