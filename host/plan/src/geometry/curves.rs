//! Blades in the format of ANSYS TurboGrid: `hub.curve`, `shroud.curve` and `profile.curve`.
//!
//! ```text
//! # Profile 1 at 0.00 %
//! -6.095401  -11.478319  69.734110  le
//! ...                                          a closed loop around the blade
//! # Profile 2 at 50.00 %
//! ```
//!
//! One point a line, `x y z`, parted by blanks or commas. In a profile file each line that begins with `#` opens a section, in the other two it
//! is a remark. A section that is as low as the first one, after others above it, is the first one of the splitter. Hub and shroud run from inlet to outlet. A point may be marked `le` or `te`, with a number behind it or
//! without. Source: the layout that published writers and readers of these files share; docs/plan.md.

use crate::vector::Point;

use super::blade::Sections;
use super::blisk::Revolution;
use super::closed_loop::{Loop, Mark};
use super::point_file::{Fault, PointFileFrame, ReadError, lines, number, refuse_commas, words};
use super::resampling::resampled;

/// Least and most points of a side; within these the number in the file is kept.
const POINTS: [usize; 2] = [41, 161];

/// Most blades of a profile file: main blade and splitter.
const BLADES_MAX: usize = 2;

/// Rotor as read from a set of curve files.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    /// Inner wall of the gas path.
    pub hub: Revolution,
    /// Outer wall of the gas path.
    pub shroud: Revolution,
    /// Sections of the main blade, and of the splitter if there is one.
    pub blades: Vec<Sections>,
}

/// Curve file in which a fault was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveFile {
    /// `hub.curve`
    Hub,
    /// `shroud.curve`
    Shroud,
    /// `profile.curve`
    Profile,
}

/// Texts of the three curve files: hub, shroud, profile.
#[derive(Clone, Copy, Debug)]
pub struct Texts<'t> {
    /// `hub.curve`
    pub hub: &'t str,
    /// `shroud.curve`
    pub shroud: &'t str,
    /// `profile.curve`
    pub profile: &'t str,
}

/// Reads a set of curve files.
///
/// # Errors
/// The file and the fault with its place.
pub fn read(texts: &Texts<'_>, frame: &PointFileFrame) -> Result<Curves, (CurveFile, ReadError)> {
    let (hub, from_low_z) = revolution(texts.hub, frame).map_err(|error| (CurveFile::Hub, error))?;
    let (shroud, _) = revolution(texts.shroud, frame).map_err(|error| (CurveFile::Shroud, error))?;
    check_shroud(&hub, &shroud).map_err(|fault| (CurveFile::Shroud, fault.at(1, 1)))?;
    let blades = profiles(texts.profile, frame, &hub, from_low_z).map_err(|error| (CurveFile::Profile, error))?;
    Ok(Curves { hub, shroud, blades })
}

/// Generatrix from a file such as `hub.curve`, and whether it begins at low z.
///
/// # Errors
/// The fault with its place.
pub fn revolution(text: &str, frame: &PointFileFrame) -> Result<(Revolution, bool), ReadError> {
    let mut places: Vec<([f64; 2], usize)> = Vec::new();
    for (at, line) in lines(text) {
        if let Some((place, _)) = point(line, at, frame)? {
            places.push(([place.z, libm::hypot(place.x, place.y)], at));
        }
    }
    if places.len() < 2 {
        return Err(Fault::Points { section: 1, found: places.len(), least: 2 }.at(text.lines().count().max(1), 1));
    }
    let is_growing = places[places.len() - 1].0[0] > places[0].0[0];
    let goes_on =
        |pair: &[([f64; 2], usize)]| (pair[1].0[0] > pair[0].0[0]) == is_growing && pair[1].0[0] != pair[0].0[0];
    if let Some(back) = places.windows(2).find(|pair| !goes_on(pair)) {
        return Err(Fault::TurnsBack { axis: frame.axis }.at(back[1].1, 1));
    }
    let mut profile_mm: Vec<[f64; 2]> = places.into_iter().map(|(place, _)| place).collect();
    if !is_growing {
        profile_mm.reverse();
    }
    Ok((Revolution { profile_mm }, is_growing))
}

fn check_shroud(hub: &Revolution, shroud: &Revolution) -> Result<(), Fault> {
    let below = |place: &[f64; 2]| (hub.radius_mm(place[0]) - place[1], place[0]);
    match shroud.profile_mm.iter().map(below).find(|(below_mm, _)| *below_mm >= 0.0) {
        Some((below_mm, z_mm)) => Err(Fault::Shroud { below_mm, z_mm }),
        None => Ok(()),
    }
}

/// Point of a line and its mark; `None` for a line with only a remark.
fn point(text: &str, line: usize, frame: &PointFileFrame) -> Result<Option<(Point, Option<Mark>)>, ReadError> {
    let words = words(text);
    let mut place = [0.0; 3];
    match words.as_slice() {
        [] => return Ok(None),
        [(_, first), ..] if first.starts_with('#') => return Ok(None),
        _ if refuse_commas(line, text).is_err() => refuse_commas(line, text)?,
        few if few.len() < 3 => return Err(Fault::Coordinates(few.len()).at(line, few[0].0)),
        _ => {}
    }
    for (value, word) in place.iter_mut().zip(&words) {
        *value = number(line, *word)?;
    }
    let mark = words.get(3).filter(|(_, word)| !word.starts_with('#')).map(|(column, word)| {
        match word.to_lowercase().trim_end_matches(|c: char| c.is_ascii_digit()) {
            "le" => Ok(Mark::Leading),
            "te" => Ok(Mark::Trailing),
            _ => Err(Fault::Mark((*word).to_owned()).at(line, *column)),
        }
    });
    Ok(Some((frame.point(place), mark.transpose()?)))
}

fn profiles(
    text: &str,
    frame: &PointFileFrame,
    hub: &Revolution,
    from_low_z: bool,
) -> Result<Vec<Sections>, ReadError> {
    let mut loops: Vec<(Loop, usize)> = Vec::new();
    let mut is_new = true;
    for (at, line) in lines(text) {
        is_new |= line.trim_start().starts_with('#');
        let Some((place, mark)) = point(line, at, frame)? else { continue };
        if std::mem::take(&mut is_new) {
            loops.push((Loop::default(), at));
        }
        if let Some((around, _)) = loops.last_mut() {
            around.marks.extend(mark.map(|mark| (around.points.len(), mark)));
            around.points.push(place);
        }
    }
    if loops.len() < 2 {
        return Err(Fault::Sections { found: loops.len() }.at(text.lines().count().max(1), 1));
    }
    let starts: Vec<usize> = loops.iter().map(|(_, line)| *line).collect();
    let mut sides = Vec::new();
    for (at, (around, line)) in loops.into_iter().enumerate() {
        sides.push(around.split(at + 1, from_low_z).map_err(|fault| fault.at(line, 1))?);
    }
    let first_sections = first_sections(&sides, hub);
    if let Some(third) = first_sections.get(BLADES_MAX) {
        return Err(Fault::ThirdBlade { section: third + 1 }.at(starts[*third], 1));
    }
    let mut blades: Vec<Sections> = Vec::new();
    for first in first_sections.into_iter().rev() {
        let sides = sides.split_off(first);
        if sides.len() < 2 {
            return Err(Fault::Sections { found: sides.len() }.at(starts[first], 1));
        }
        let most = sides.iter().flatten().map(Vec::len).max().unwrap_or(0).clamp(POINTS[0], POINTS[1]);
        let blade = assigned_sides(sides, |side| resampled(side, most));
        frame.check(&blade, hub, &starts[first..])?;
        blades.insert(0, blade);
    }
    let main = blades[0].clone();
    Ok(blades.into_iter().map(|blade| blade.named_as(&main)).collect())
}

/// Indices of the first sections of all blades.
fn first_sections(sides: &[[Vec<Point>; 2]], hub: &Revolution) -> Vec<usize> {
    let height_mm = |sides: &[Vec<Point>; 2]| {
        let points = || sides.iter().flatten();
        points().map(|point| hub.height_mm(point)).sum::<f64>() / points().count() as f64
    };
    let heights: Vec<f64> = sides.iter().map(height_mm).collect();
    let mut found = vec![0];
    for at in 1..heights.len() {
        let first = found[found.len() - 1];
        let [before_mm, here_mm] = [at - 1, at].map(|at| heights[at] - heights[first]);
        if before_mm > 0.0 && here_mm < before_mm / 2.0 {
            found.push(at);
        }
    }
    found
}

/// Assigns the sides: the convex one is the suction side. Every section's first side is the one at greater angles.
pub(super) fn assigned_sides(sides: Vec<[Vec<Point>; 2]>, spread: impl Fn(&[Point]) -> Vec<Point>) -> Sections {
    let mut blade = Sections::default();
    for [one, other] in sides {
        let [one, other] = [spread(&one), spread(&other)];
        let middle = one.len() / 2;
        let across = one[middle] - other[middle];
        let is_ahead = one[middle].coords.cross(&across).z > 0.0;
        let (ahead, behind) = if is_ahead { (one, other) } else { (other, one) };
        blade.pressure.push(ahead);
        blade.suction.push(behind);
    }
    if blade.bulge_mm() < 0.0 { blade.swapped() } else { blade }
}
