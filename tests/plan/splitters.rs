//! Rotors with splitters: by their symmetry, and against samples of blades that are written here anew.

use core::f64::consts::TAU;

use arcfeed_plan::cup_mill::neighbours::Neighbour;
use arcfeed_plan::cup_mill::normal_form::{GRAIN_MM, StartEdge};
use arcfeed_plan::cup_mill::plan::{AxisChoice, PreparedSlot, Request, SlotPlan};
use arcfeed_plan::cutter::{CupMill, ToolPart};
use arcfeed_plan::geometry::blisk::Blade;
use arcfeed_plan::geometry::blisk::{Blank, Blisk, Revolution};
use arcfeed_plan::geometry::generator::{Hand, Rotor};
use arcfeed_plan::optimisation::Problem;
use arcfeed_plan::proof::clearance::Obstacle;
use arcfeed_plan::proof::verdict::{Proof, ProofCase, ProofResolution, prove};
use arcfeed_plan::vector::Vector;
use arcfeed_tests::{Scratch, number, object, root, run};
use nalgebra::Rotation3;

use crate::files;
use crate::proof_cases::published_tool;
use crate::proof_published::{ALLOWANCE_MM, ROUGHING};
use crate::published_rotor::ROTOR;
use crate::refusals::CURVES;
use crate::sampler::Sampler;
use crate::symmetry::{SAME_MM, differences_mm, moved};
use crate::twisted::{BLANK_MM, HUB_MM, ROTORS, Twisted, ring, roughing};

/// Largest difference of the bounds of a distance in a fine proof, mm.
const GAP_MM: f64 = 1e-5;

fn turn(angle_rad: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector::z_axis(), angle_rad)
}

fn alike(blades: u32, hand: Hand) -> Blisk {
    let [pressure, suction] = Rotor { blades, hand, ..ROTOR }.sections(9, 81).unwrap().faces().unwrap();
    let hub = Revolution { profile_mm: vec![[-20.0, 70.0], [20.0, 70.0]] };
    let blank = Blank { radius_mm: 100.0, faces_mm: [-15.0, 15.0] };
    Blisk { blades, pressure, suction, further_blades: Vec::new(), hub, blank }
}

/// Plan along the blade's edge, from the better edges. Its numbers are rounded, so that the search does not depend on rounding errors.
fn along_blade(blisk: &Blisk, tool: &CupMill) -> SlotPlan {
    let slot = blisk.slot();
    Problem::new(blisk, &slot, tool, &ROUGHING).unwrap().along(AxisChoice::Blade).unwrap().plan
}

/// Blades about the slot that the ring could touch.
fn neighbours(blisk: &Blisk, tool: &CupMill) -> Vec<Neighbour> {
    let slot = blisk.slot();
    let prepared = PreparedSlot::new(blisk, &slot, ALLOWANCE_MM, StartEdge::Leading, Some(GRAIN_MM)).unwrap();
    prepared.plan(&Request::whole(tool, &ROUGHING)).unwrap().1.blades
}

/// Checks that blades are in the same places. Their points are rounded in different places, by half of the grain each: where they lie 0.01 mm
/// apart, at the round edges, the normals turn by 6e-6, which moves the surfaces with the allowance by 5e-6 mm.
fn check_neighbours(found: &[Neighbour], expected: &[Neighbour]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!((found.blade, found.side, found.is_own), (expected.blade, expected.side, expected.is_own));
        let pairs = found.patch.samples().zip(expected.patch.samples());
        let farthest_mm = pairs.map(|(found, expected)| (found - expected).norm()).fold(0.0, f64::max);
        assert!(farthest_mm < 1e-5, "{} {:?}: {farthest_mm}", found.blade, found.side);
    }
}

fn proof(blisk: &Blisk, plan: &SlotPlan, tool: &CupMill, resolution: &ProofResolution) -> Proof {
    let (path, to_slot) = (&plan.path, plan.turn);
    let case = ProofCase { blisk, tool, path, to_slot, allowance_mm: ALLOWANCE_MM, fixture: &[], earlier: &[] };
    prove(&case, resolution).unwrap()
}

#[test]
fn splitters_like_the_main_blades_give_the_plans_of_twice_as_many_blades() {
    let tool = published_tool();
    let resolution = ProofResolution { chord_mm: 0.05, gap_mm: GAP_MM, grid: [3, 5], cell_mm: 2.0 };
    for hand in [Hand::Right, Hand::Left] {
        let (single, main) = (alike(18, hand), alike(9, hand));
        let expected = along_blade(&single, &tool);
        let expected_proof = proof(&single, &expected, &tool, &resolution);
        let around = neighbours(&single, &tool);
        assert!(around.iter().any(|near| !near.is_own && near.blade.rem_euclid(2) == 1));
        // The splitter may be given in any pitch.
        let given =
            Blade { pressure: main.pressure.clone(), suction: main.suction.clone() }.turned(&turn(-3.5 * TAU / 9.0));
        let both = main.with_splitter(&given).unwrap();
        assert!((both.slot_ratio() - 0.5).abs() < 1e-12 && (both.kinds(), both.count()) == (2, 18));
        for (first, angle_rad) in [(0, 0.0), (1, TAU / 18.0)] {
            let blisk = both.from_blade(first);
            let found = along_blade(&blisk, &tool);
            let differences = differences_mm(&expected, &found, |place| place);
            let aside = (turn(angle_rad) * expected.tool_axis() - found.tool_axis()).norm();
            println!("{hand:?}, slot {}: {differences:?} mm, axis {aside:.1e}", first + 1);
            assert!(differences.iter().all(|mm| *mm < SAME_MM) && aside < SAME_MM);
            check_neighbours(&neighbours(&blisk, &tool), &around);
            let proof = proof(&blisk, &found, &tool, &resolution);
            for (found, expected) in proof.clearances.iter().zip(&expected_proof.clearances) {
                assert_eq!((found.part, found.obstacle), (expected.part, expected.obstacle));
                // The corners of the hub's triangles do not lie at the same angles from both slots.
                let most_mm = if found.obstacle == Obstacle::Blades { GAP_MM } else { 2.0 * resolution.chord_mm };
                let same = |k: usize| {
                    let [found, expected] = [found.bounds_mm[k], expected.bounds_mm[k]];
                    found == expected || (found - expected).abs() <= most_mm + SAME_MM
                };
                assert!(same(0) && same(1), "{found:?} {expected:?}");
            }
            let [share_ratio, expected_ratio] = [&proof, &expected_proof].map(|proof| proof.removed.share_ratio());
            assert!((share_ratio - expected_ratio).abs() < 1e-9, "{share_ratio} {expected_ratio}");
        }
    }
}

const MAIN: Twisted = ROTORS[0];
/// Two thirds as long, with the trailing edge about where the main blade has it.
const SPLITTER: Twisted = Twisted { name: "splitter", chord_mm: 17.0, shift_mm: 4.0, ..ROTORS[0] };
const PITCHES: u32 = 9;
/// Place of the splitter in the pitch.
const PLACE_RATIO: f64 = 0.51;

fn with_shorter_splitters() -> Blisk {
    let Blade { pressure, suction } = MAIN.blade(0.0);
    let hub = Revolution { profile_mm: vec![[-40.0, HUB_MM], [40.0, HUB_MM]] };
    let blank = Blank { radius_mm: BLANK_MM, faces_mm: [-16.0, 16.0] };
    let main = Blisk { blades: PITCHES, pressure, suction, further_blades: Vec::new(), hub, blank };
    main.with_splitter(&SPLITTER.blade(PLACE_RATIO * TAU / f64::from(PITCHES))).unwrap()
}

#[test]
fn no_sample_of_main_blades_and_splitters_is_nearer_than_the_proof_says() {
    let (both, tool, roughing) = (with_shorter_splitters(), ring(), roughing());
    let pitch_rad = TAU / f64::from(PITCHES);
    let angles = (0..PITCHES).map(|pitch| pitch_rad * f64::from(pitch));
    let blades = angles.flat_map(|angle| [(MAIN, angle), (SPLITTER, angle + PLACE_RATIO * pitch_rad)]);
    let blades: Vec<(Twisted, f64)> = blades.collect();
    for first in [0, 1] {
        let blisk = both.from_blade(first);
        let problem = Problem::new(&blisk, &blisk.slot(), &tool, &roughing).unwrap();
        let (valued, proof) = problem.proven(Some(AxisChoice::Roomiest), |_| true).unwrap();
        assert!(proof.holds(ALLOWANCE_MM, 0.15 * ALLOWANCE_MM), "{:?}", proof.clearances);
        let certified_mm = proof.clearance(ToolPart::Ring, Obstacle::Blades).unwrap().bounds_mm[0];
        let (steps, turn) = (valued.plan.path.steps(), valued.plan.turn);
        let sampler = Sampler { blades: blades.clone(), tool: &tool, steps, turn };
        let least_mm = sampler.least_mm();
        let share = proof.removed.share_ratio();
        println!("slot {}: certified {certified_mm:.4}, sampled {least_mm:.4} mm, {share:.3} removed", first + 1);
        assert!(least_mm >= certified_mm && least_mm < certified_mm + 0.1, "{least_mm} {certified_mm}");
    }
}

#[test]
fn a_path_through_a_splitter_is_not_proven() {
    let (both, tool, roughing) = (with_shorter_splitters(), ring(), roughing());
    let main = Blisk { further_blades: Vec::new(), ..both.clone() };
    let problem = Problem::new(&both, &both.slot(), &tool, &roughing).unwrap();
    let plan = problem.along(AxisChoice::Roomiest).unwrap().plan;
    // The path of slot 1, turned away from the main blade into the splitter.
    let aside = turn(f64::from(-both.facing()) * 8_f64.to_radians());
    let plan = SlotPlan { turn: plan.turn * aside, ..plan };
    let resolution = ProofResolution { grid: [2, 2], cell_mm: 4.0, ..ProofResolution::default() };
    let distance_mm = |blisk: &Blisk| {
        proof(blisk, &plan, &tool, &resolution).clearance(ToolPart::Ring, Obstacle::Blades).unwrap().bounds_mm[1]
    };
    let [without_mm, with_mm] = [&main, &both].map(distance_mm);
    println!("ring from main blades {without_mm:.3}, from main blades and splitters {with_mm:.3} mm");
    assert!(without_mm > 0.5 && with_mm < 0.0);
}

/// Part of 9 main blades with their copies, half a pitch on, as splitters.
fn part(slot: u32) -> String {
    let text = std::fs::read_to_string(root().join("examples/blisk-19/PART.toml")).expect("the example");
    let generate = text.lines().find(|line| line.starts_with("generate")).expect("the rotor").to_owned();
    text.replace(&generate, CURVES).replace("[roughing]", &format!("[roughing]\nslot = {slot}\naxis = \"blade\""))
}

/// Angles about the rotor's axis at which the blades' tips lie in an STL file of the slot frame, degrees.
fn tip_angles_deg(stl: &[u8], tool_axis_z: f64) -> Vec<f64> {
    let rotor_axis = Vector::new(0.0, libm::sqrt(1.0 - tool_axis_z * tool_axis_z), tool_axis_z);
    let number = |bytes: &[u8]| f64::from(f32::from_le_bytes(bytes.try_into().expect("four bytes")));
    let corners = stl[84..].chunks(50).flat_map(|facet| facet[12..48].chunks(12));
    let corners = corners.map(|at| Vector::new(number(&at[..4]), number(&at[4..8]), number(&at[8..])));
    let across = corners.map(|at| at - rotor_axis * at.dot(&rotor_axis)).filter(|across| across.norm() > 98.5);
    let aside = rotor_axis.cross(&Vector::x());
    let mut angles: Vec<f64> = across.map(|across| libm::atan2(across.x, across.dot(&aside)).to_degrees()).collect();
    angles.sort_by(f64::total_cmp);
    angles
}

#[test]
fn each_slot_has_its_program_at_its_own_position_and_all_blades_in_the_finished_part() {
    let scratch = Scratch::new("plan-splitters");
    scratch.write("hub.curve", files::curve(70.0, [-20.0, 20.0]));
    scratch.write("shroud.curve", files::curve(98.6, [-20.0, 20.0]));
    let main = ROTOR.sections(9, 81).unwrap();
    let splitter = moved(&main, |point| turn(TAU / 18.0) * point);
    scratch.write("profile.curve", [main, splitter].map(|blade| files::profile(&blade, false, false)).concat());

    let output = run(&["plan", "cup-mill", &scratch.write("first.toml", part(1))]);
    let first = String::from_utf8_lossy(&output.stdout);
    assert!(first.contains("This is slot 1 of 2, from the main blade's pressure side to the splitter; the part also needs the program of `slot = 2`"), "{first}");
    let folder = scratch.path("out");
    let second = object(&["plan", "cup-mill", &scratch.write("second.toml", part(2)), "-o", &folder]);
    assert!(second["slot"] == 2 && second["slot_kinds"] == 2 && second["slots"] == 9, "{second}");
    let text = std::fs::read_to_string(format!("{folder}/blisk-19.nc")).expect("the program");
    assert!(text.to_lowercase().contains("(slot 2 of 2, from the splitter"), "{text}");
    // Half a pitch apart, with the same tilt.
    let of_first =
        |word: &str| first.split_once(word).and_then(|(_, rest)| rest.split_whitespace().next()?.parse::<f64>().ok());
    let (tilt_deg, index_deg) = (of_first("tool: A ").expect("A"), of_first(" B ").expect("B"));
    let apart_deg = libm::remainder(number(&second, "/index_deg") - index_deg, 360.0).abs();
    println!("B {index_deg} and {} degrees", second["index_deg"]);
    assert!((apart_deg - 20.0).abs() < 2e-3 && (number(&second, "/tilt_deg") - tilt_deg).abs() < 2e-3);

    let stl = std::fs::read(format!("{folder}/finished.stl")).expect("the finished part");
    let angles_deg = tip_angles_deg(&stl, number(&second, "/tool_axis/2"));
    let blades = 1 + angles_deg.windows(2).filter(|pair| pair[1] - pair[0] > 3.0).count();
    assert_eq!(blades, 4, "{:?}", (angles_deg.first(), angles_deg.last()));
    let report = object(&["simulate", &format!("{folder}/job.toml")]);
    assert_eq!(report["alarms"], serde_json::Value::Array(vec![]));
    let lowest_mm = number(&report["material"], "/deviation/min") * 25.4;
    println!("cut at {lowest_mm:.3} mm from the finished part at the lowest");
    assert!(lowest_mm > -0.05, "{lowest_mm}");
}
