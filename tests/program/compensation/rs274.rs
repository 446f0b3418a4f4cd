//! Every contour of `tests/cases/contours-rs274` against what LinuxCNC's interpreter makes of it.

use arcfeed_compensation::compensator::CenterMove;
use arcfeed_nc::segment::Segment;
use arcfeed_nc::settings::StartUp;
use arcfeed_tests::root;
use arcfeed_units::Nm;

use super::compensated::compensated;
use super::geometry::{Track, length, minus, turn};

/// Half of the last decimal that rs274 prints, and what a tangent joint of rounded coordinates adds.
const PRINTED_MM: f64 = 0.000_05 + 0.000_02;
/// Below this angle LinuxCNC takes a joint for a tangent one; our path ends at the intersection.
const SHALLOW_RAD: f64 = 0.05;
/// Below this angle a joint is tangent: what rounded coordinates make of one.
const TANGENT_RAD: f64 = 1e-5;

/// A move of rs274: kind (0 rapid, 1 line, +-2 arc), end, centre.
type Theirs = (i32, [f64; 3], [f64; 2]);

#[derive(Debug, Default)]
struct Joints {
    tangent: usize,
    shallow: usize,
    inside: usize,
    obtuse: usize,
    acute: usize,
    arcs: usize,
}

fn contours(file: &str) -> Vec<String> {
    let path = root().join("tests/cases/contours-rs274").join(file);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    text.split("(SEED ").skip(1).map(|part| part.split_once('\n').expect("a line").1.to_owned()).collect()
}

fn theirs(text: &str) -> Vec<Theirs> {
    let row = |row: &str| {
        let numbers: Vec<f64> = row.split(' ').map(|number| number.parse().expect("a number")).collect();
        let [kind, x, y, z, u, v] = numbers[..] else { panic!("{row}") };
        (kind as i32, [x, y, z], [u, v])
    };
    text.lines().map(row).collect()
}

fn assert_near(found: [f64; 2], wanted: [f64; 2], what: &str) {
    assert!(length(minus(found, wanted)) <= PRINTED_MM * 1.42, "{what}: {found:?}, not {wanted:?}");
}

/// Compares one contour.
fn compare(text: &str, theirs: &[Theirs], joints: &mut Joints) {
    let found = compensated(text, StartUp::A).expect("it is accepted");
    let mains: Vec<&Segment> = found
        .centers
        .iter()
        .filter_map(|center_move| match center_move {
            CenterMove::Main(segment) => Some(segment),
            CenterMove::Corner(_) => None,
        })
        .collect();
    assert_eq!(mains.len(), found.programmed.len(), "each move comes out once");
    let d: f64 = text.split_once('D').and_then(|(_, rest)| rest.split_once('G')).expect("a D").0.parse().expect("D");
    let sense = if text.contains("G41") { 1.0 } else { -1.0 };
    let programmed: Vec<Track> = found.programmed.iter().map(Track::of).collect();
    let mut rest = theirs.iter();
    for (index, main) in mains.iter().enumerate() {
        let (kind, end, center) = rest.next().expect("rs274 has this move");
        let what = format!("{text}move {index}");
        let ours = Track::of(main);
        let end_in_plane = [end[0], end[1]];
        assert!((main.end.linear[2].to_mm() - end[2]).abs() <= PRINTED_MM, "{what}: height");
        if let Some(arc) = main.arc() {
            joints.arcs += 1;
            assert_eq!(*kind, 2 * i32::from(arc.turn.sign()), "{what}");
            assert_near(arc.center.map(Nm::to_mm), *center, &what);
        }
        let is_in_contour = (2..programmed.len() - 2).contains(&index);
        let at_corner =
            turn(programmed[index].at(1.0).1, programmed.get(index + 1).map_or([0.0; 2], |next| next.at(0.0).1));
        let towards_tool = at_corner * sense;
        if is_in_contour && (TANGENT_RAD..SHALLOW_RAD).contains(&towards_tool.abs()) {
            joints.shallow += 1;
            let off = length(minus(ours.to, end_in_plane));
            assert!(off <= 0.5 * d * towards_tool.abs() + 2.0 * PRINTED_MM, "{what}: {off}");
            continue;
        }
        if !is_in_contour || towards_tool > -TANGENT_RAD {
            assert_near(ours.to, end_in_plane, &what);
            if is_in_contour {
                let count = if towards_tool > TANGENT_RAD { &mut joints.inside } else { &mut joints.tangent };
                *count += 1;
            }
            continue;
        }
        // LinuxCNC goes around the corner on an arc; its ends are contact points on our moves before and behind.
        let (kind, around_end, around) = rest.next().expect("an arc around the corner");
        assert_eq!(kind.abs(), 2, "{what}");
        assert_near(*around, programmed[index].to, &what);
        assert!((length(minus(end_in_plane, *around)) - d / 2.0).abs() < 2.0 * PRINTED_MM, "{what}");
        assert!(ours.distance(end_in_plane) <= 2.0 * PRINTED_MM, "{what}: contact before the corner");
        let behind = Track::of(mains[index + 1]).distance([around_end[0], around_end[1]]);
        assert!(behind <= 2.0 * PRINTED_MM, "{what}: contact behind the corner");
        let count = if towards_tool < -std::f64::consts::FRAC_PI_2 { &mut joints.acute } else { &mut joints.obtuse };
        *count += 1;
    }
    assert_eq!(rest.next(), None, "{text}");
}

#[test]
fn every_contour_has_the_offset_that_linuxcnc_gives_it() {
    let (programs, expected) = (contours("program.nc"), contours("expected.txt"));
    assert_eq!(programs.len(), expected.len());
    let mut joints = Joints::default();
    for (program, expected) in programs.iter().zip(&expected) {
        compare(program, &theirs(expected), &mut joints);
    }
    println!("{} contours: {joints:?}", programs.len());
    assert!(programs.len() >= 200 && joints.inside > 100 && joints.obtuse > 100 && joints.acute > 50);
}
