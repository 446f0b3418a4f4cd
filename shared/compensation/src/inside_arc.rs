//! Feed of a control on arcs inside a contour under G41 and G42.
//!
//! With Rc the radius of the path of the tool centre, Rp that of the programmed arc, and M the least ratio:
//!
//! ```text
//! F max(Rc / Rp, M)   where Rc < Rp     (1)
//! ```
//!
//! The programmed feed is then that at the contour. Moves around corners, lines and outside arcs keep F. M is parameter 1710
//! of a Fanuc. The reduction is in force under G41 and G42 with or without G62, and in dry run.
//!
//! Source: Rc / Rp and its scope: B-63124EN, page 54. M is known from lists of parameters only.

use arcfeed_nc::segment::Segment;

/// Parts per million in one: 100 % of the feed.
pub const PPM: u32 = 1_000_000;

/// Factor by which the control reduces the programmed F on the path of the tool centre, parts per million, rounded
/// down; `center` is the offset path of `programmed`. `least_percent` is M, the smallest factor, and `None` for a
/// control without the reduction. (1)
pub fn feed_ratio_ppm(programmed: &Segment, center: &Segment, least_percent: Option<u8>) -> u32 {
    let (Some(arc), Some(center), Some(least_percent)) = (programmed.arc(), center.arc(), least_percent) else {
        return PPM;
    };
    let ratio = center.radius_mm() / arc.radius_mm();
    let least = u32::from(least_percent.min(100)) * (PPM / 100);
    // The conversion saturates.
    if ratio < 1.0 { ((ratio * f64::from(PPM)) as u32).max(least) } else { PPM }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_nc::modal::Feed;
    use arcfeed_nc::motion::{Plane, Pose, Turn};
    use arcfeed_nc::segment::{Arc, Path};
    use arcfeed_units::Nm;

    fn arc(radius_mm: f64) -> Segment {
        let [from, to] = [[radius_mm, 0.0], [0.0, radius_mm]].map(|point| point.map(Nm::from_mm));
        let arc = Arc { plane: Plane::Xy, turn: Turn::Ccw, center: [Nm(0); 2], from, to };
        let pose = |[x, y]: [Nm; 2]| Pose { linear: [x, y, Nm(0)], ..Pose::ORIGIN };
        Segment { sequence: None, start: pose(from), end: pose(to), feed: Feed::Missing, path: Path::Arc(arc) }
    }

    #[test]
    fn an_inside_arc_has_the_ratio_of_the_radii_down_to_the_least() {
        for (programmed, center, least, ratio) in [
            (8.0, 3.0, Some(0), 375_000),
            (8.0, 3.0, Some(25), 375_000),
            (8.0, 3.0, Some(40), 400_000),
            (8.0, 3.0, Some(100), PPM),
            (8.0, 3.0, None, PPM),
            (8.0, 13.0, Some(0), PPM),
            (8.0, 8.0, Some(0), PPM),
        ] {
            assert_eq!(feed_ratio_ppm(&arc(programmed), &arc(center), least), ratio, "{programmed} {center} {least:?}");
        }
        let line = Segment { path: Path::Line, ..arc(8.0) };
        assert_eq!(feed_ratio_ppm(&line, &line, Some(0)), PPM);
    }
}
