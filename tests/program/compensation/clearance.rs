//! No point of the tool centre's path is nearer to the contour than the tool's radius.
//!
//! A control looks at neighbouring blocks only. Contours whose parts come near each other in other ways are recognised
//! by their geometry alone, and left out.

use std::f64::consts::SQRT_2;

use arcfeed_compensation::compensator::CenterMove;
use arcfeed_nc::settings::StartUp;
use arcfeed_tests::of_full_set;

use super::compensated::compensated;
use super::contours::ContourProgram;
use super::geometry::{Track, length, minus, turn};

/// Points of the path are this near to each other, mm.
const STEP_MM: f64 = 0.05;
/// Distance within which parts of a contour count as too near to each other.
const NEAR_MM: f64 = 0.02;
/// What a path may lack of the radius.
const TOLERANCE_MM: f64 = 1e-3;

/// Side of the tool: +1 for G41.
fn side(program: &ContourProgram) -> f64 {
    if program.text.contains("G41") { 1.0 } else { -1.0 }
}

/// Whether the tool beside one part of the contour would touch another part, other than in the corner between both.
fn is_narrow(contour: &[Track], offset: f64) -> bool {
    let last = contour.len() - 1;
    let is_closed = last > 1 && length(minus(contour[0].from, contour[last].to)) < 1e-9;
    contour.iter().enumerate().any(|(index, track)| {
        let centers: Vec<[f64; 2]> = track
            .samples(STEP_MM)
            .into_iter()
            .map(|(point, direction)| [point[0] - offset * direction[1], point[1] + offset * direction[0]])
            .collect();
        contour.iter().enumerate().filter(|(other, _)| *other != index).any(|(other_index, other)| {
            let follows = other_index == index + 1 || (is_closed && index == last && other_index == 0);
            let precedes = other_index + 1 == index || (is_closed && index == 0 && other_index == last);
            let distances = centers.iter().map(|center| other.distance(*center) - offset.abs());
            if follows {
                comes_back(distances.rev())
            } else if precedes {
                comes_back(distances)
            } else {
                distances.into_iter().any(|distance| distance < NEAR_MM)
            }
        })
    })
}

/// Whether a distance from the corner on, once it is positive, falls again before or after it is more than near.
fn comes_back(distances: impl Iterator<Item = f64>) -> bool {
    let (mut before, mut is_away) = (f64::NEG_INFINITY, false);
    for distance in distances {
        if (is_away && distance < NEAR_MM) || (!is_away && before > 0.0 && distance < before - 1e-6) {
            return true;
        }
        is_away |= distance >= NEAR_MM;
        before = distance;
    }
    false
}

/// Whether the tool on its way around a corner would touch any part of the contour.
fn has_narrow_corner(contour: &[Track], offset: f64) -> bool {
    const DIRECTIONS: usize = 8;
    contour.windows(2).any(|pair| {
        let ((corner, before), (_, behind)) = (pair[0].at(1.0), pair[1].at(0.0));
        let turned = turn(before, behind);
        let ways = (0..=DIRECTIONS).map(|index| turned * index as f64 / DIRECTIONS as f64);
        turned * offset < 0.0
            && ways.flat_map(|by| [1.2, SQRT_2].map(|reach| (by, reach * offset))).any(|(by, reach)| {
                let (sin, cos) = libm::sincos(by);
                let way = [cos * before[0] - sin * before[1], sin * before[0] + cos * before[1]];
                let center = [corner[0] - reach * way[1], corner[1] + reach * way[0]];
                contour.iter().any(|track| track.distance(center) < offset.abs() + NEAR_MM)
            })
    })
}

#[test]
fn the_tool_never_comes_nearer_to_the_contour_than_its_radius() {
    let (mut checked, mut impossible, mut narrow, mut points, mut least) = (0, 0, 0, 0_usize, f64::INFINITY);
    for seed in 0..of_full_set(40_000, 4_000) {
        let program = ContourProgram::of_seed(seed);
        let Ok(found) = compensated(&format!("G21G17\n{}", program.text), StartUp::A) else {
            impossible += 1;
            continue;
        };
        let tracks: Vec<Track> = found.programmed.iter().map(Track::of).collect();
        let contour = &tracks[2..tracks.len() - 1];
        let offset = side(&program) * program.radius_mm();
        if is_narrow(contour, offset) || has_narrow_corner(contour, offset) {
            narrow += 1;
            continue;
        }
        checked += 1;
        let mains = found.centers.iter().scan(0, |mains, center_move| {
            let before = *mains;
            *mains += usize::from(matches!(center_move, CenterMove::Main(_)));
            Some((before, center_move))
        });
        let along = mains.filter(|(index, _)| (2..tracks.len() - 1).contains(index));
        for (_, center_move) in along {
            let (CenterMove::Corner(segment) | CenterMove::Main(segment)) = center_move;
            for (point, _) in Track::of(segment).samples(STEP_MM) {
                let distance = contour.iter().map(|track| track.distance(point)).fold(f64::INFINITY, f64::min);
                let lack = distance - program.radius_mm();
                assert!(lack >= -TOLERANCE_MM, "seed {seed} at {point:?}: {lack} mm\n{}", program.text);
                least = least.min(lack);
                points += 1;
            }
        }
    }
    println!("{checked} contours, {points} points, least {least:.7} mm; alarms {impossible}, narrow {narrow}");
    assert!(checked > 1_000);
}
