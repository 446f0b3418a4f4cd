//! Arcs against another interpreter (end, centre, sense and rise of `tests/cases/arcs-rs274`, as LinuxCNC reads it), and
//! the centre of arcs given by R against whole numbers, which know no rounding.

use arcfeed_nc::block::Reading;
use arcfeed_nc::modal::{Plane, Turn};
use arcfeed_nc::radius::center_offset;
use arcfeed_nc::reader::Reader;
use arcfeed_nc::segment::{Arc, RADIUS_TOLERANCE, Segment};
use arcfeed_tests::root;
use arcfeed_units::{LengthUnit, Nm};
use fastrand::Rng;

const CASE: &str = "tests/cases/arcs-rs274";
/// Half of the last decimal that rs274 prints, and half a nanometre of our own.
const ROUNDING_MM: f64 = 0.000_050_5;

fn case(file: &str) -> String {
    let path = root().join(CASE).join(file);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Arc as rs274 prints it: end and centre in the plane, direction, end across it.
type Read = [f64; 6];

fn expected() -> Vec<Read> {
    let number = |text: &str| text.trim().parse().expect("a number");
    let line = |line: &str| line.split(',').map(number).collect::<Vec<f64>>().try_into().expect("six numbers");
    case("expected.txt").lines().map(line).collect()
}

/// The same from our segment.
fn read(segment: &Segment, arc: &Arc) -> Read {
    let (first, second, normal) = arc.plane.axes();
    let end = segment.end.linear.map(Nm::to_mm);
    let [center_x, center_y] = arc.center.map(Nm::to_mm);
    [end[first], end[second], center_x, center_y, f64::from(arc.turn.sign()), end[normal]]
}

fn arcs() -> Vec<(String, Segment, Arc)> {
    let mut reader = Reader::new(LengthUnit::Mm, Reading::Strict);
    let program = case("program.nc");
    let mut of_line = |line: &str| {
        let segment = reader.read(line.as_bytes()).unwrap_or_else(|fault| panic!("{line}: {fault:?}")).segment?;
        Some((line.to_owned(), segment, *segment.arc()?))
    };
    program.lines().filter_map(&mut of_line).collect()
}

#[test]
fn every_arc_is_the_one_that_linuxcnc_reads() {
    let (arcs, expected) = (arcs(), expected());
    assert_eq!((arcs.len(), expected.len()), (96, 96));
    let mut worst_mm = 0.0_f64;
    for ((line, segment, arc), expected) in arcs.iter().zip(&expected) {
        let found = read(segment, arc);
        let off_mm = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off_mm <= ROUNDING_MM, "{line}: {found:?}, not {expected:?}");
        worst_mm = worst_mm.max(off_mm);
    }
    println!("{} arcs, worst difference {worst_mm:.7} mm of {ROUNDING_MM:.7} that printing explains", arcs.len());
}

#[test]
fn the_case_holds_every_kind_of_arc() {
    let arcs = arcs();
    for plane in [Plane::Xy, Plane::Zx, Plane::Yz] {
        for turn in [Turn::Cw, Turn::Ccw] {
            for is_helix in [false, true] {
                let is_like = |arc: &Arc, segment: &Segment| {
                    (arc.plane, arc.turn, segment.rise() != Nm(0)) == (plane, turn, is_helix)
                };
                let lines: Vec<&String> =
                    arcs.iter().filter(|(_, segment, arc)| is_like(arc, segment)).map(|(line, ..)| line).collect();
                let count = |wanted: &dyn Fn(&str) -> bool| lines.iter().filter(|line| wanted(line)).count();
                let axis = |line: &str, letters: &[char]| line.contains(letters);
                let kinds = [
                    count(&|line| line.contains('R') && !line.contains("R-")),
                    count(&|line| line.contains("R-")),
                    count(&|line| axis(line, &['I', 'J', 'K'])),
                ];
                assert!(kinds[0] >= 2 && kinds[1] >= 2 && kinds[2] >= 4, "{plane:?} {turn:?} {is_helix}: {kinds:?}");
            }
        }
    }
}

#[test]
fn the_centre_of_an_arc_given_by_radius_is_the_exact_one_rounded() {
    const SEED: u64 = 3410;
    // Half of the diagonal of a square nanometre.
    const ROUNDING_NM: f64 = std::f64::consts::FRAC_1_SQRT_2;
    let mut random = Rng::with_seed(SEED);
    let mut worst_nm = 0.0_f64;
    for case in 0..20_000 {
        // From a micrometre to ten metres; the radius from that of half a turn, to the nanometre, upwards.
        let reach = 10_i64.pow(random.u32(3..=10));
        let [x, y] = [(); 2].map(|()| random.i64(-reach..=reach));
        let square = i128::from(x) * i128::from(x) + i128::from(y) * i128::from(y);
        if square == 0 {
            continue;
        }
        let least = (libm::sqrt(square as f64) / 2.0) as i64 + 1;
        let radius = least + if case % 2 == 0 { random.i64(0..=3) } else { random.i64(0..=reach) };
        let (turn, sign) = (random.choice([Turn::Cw, Turn::Ccw]).expect("two"), random.choice([1, -1]).expect("two"));
        let found = center_offset([Nm(x), Nm(y)], Nm(sign * radius), turn, RADIUS_TOLERANCE).expect("an arc");
        let [center_x, center_y] = found.map(|Nm(nm)| i128::from(nm));
        let [x, y] = [x, y].map(i128::from);
        let chord = libm::sqrt(square as f64);
        // Along the chord the centre is at its middle; across it, the height of the triangle to its left or right.
        let along = (2 * (x * center_x + y * center_y) - square) as f64 / (2.0 * chord);
        let diameter = 2 * i128::from(radius);
        let height = libm::sqrt((diameter * diameter - square) as f64) / 2.0;
        let left = (x * center_y - y * center_x) as f64 / chord;
        let across = left - height * f64::from(turn.sign()) * sign as f64;
        let off = libm::hypot(along, across);
        worst_nm = worst_nm.max(off);
        // Ten metres leave f64 a millionth of a nanometre.
        assert!(off <= ROUNDING_NM + 1e-4, "case {case}, seed {SEED}: {off} nm");
    }
    println!("worst centre {worst_nm:.4} nm off");
}
