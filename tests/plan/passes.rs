//! Several passes through a slot: what the later ones remove, by the simulator's dexels and by its run of the program before.

use arcfeed_dexel::files::read_stl;
use arcfeed_plan::cup_mill::plan::AxisChoice;
use arcfeed_plan::geometry::blisk::Blisk;
use arcfeed_plan::optimisation::Problem;
use arcfeed_plan::proof::verdict::{ProofCase, ProofResolution, prove};
use arcfeed_plan::vector::Vector;
use arcfeed_tests::{Scratch, number, object, run};
use nalgebra::Rotation3;
use serde_json::Value;

use crate::proof_cases::published_tool;
use crate::proof_dexels::Dexels;
use crate::proof_published::{ALLOWANCE_MM, ROUGHING};
use crate::published_rotor;
use crate::wheel::{MM3_PER_IN3, fast_part};

/// Tool axis of the rotor with 13 blades with which one pass removes most; the roomiest axis takes much of what that leaves.
const BEST_AXIS: [f64; 3] = [0.974, 0.226, 0.0];

#[test]
fn a_second_pass_removes_what_the_dexels_lose() {
    let blisk = Blisk { blades: 13, ..published_rotor::blisk() };
    let (slot, tool) = (blisk.slot(), published_tool());
    let [first, second] = [AxisChoice::Given(Vector::from(BEST_AXIS)), AxisChoice::Roomiest];
    let mut problem = Problem::new(&blisk, &slot, &tool, &ROUGHING).expect("a slot");
    let alone = problem.along(second).expect("a plan");
    let before = problem.along(first).expect("a plan");
    problem.add_pass(&before.plan);
    let after = problem.along(second).expect("a plan");
    assert!(after.share_ratio < alone.share_ratio, "{} {}", after.share_ratio, alone.share_ratio);

    let (path, to_slot) = (&after.plan.path, after.plan.turn);
    let earlier = [before.plan.pass()];
    let case = ProofCase {
        blisk: &blisk,
        tool: &tool,
        path,
        to_slot,
        allowance_mm: ALLOWANCE_MM,
        fixture: &[],
        earlier: &earlier,
    };
    let proof = prove(&case, &ProofResolution::default()).expect("blades above the hub");
    let mut dexels = Dexels::new(&blisk, &tool, &after.plan);
    dexels.cut(&before.plan, &(to_slot * before.plan.turn.inverse()));
    let simulated = dexels.cut(&after.plan, &Rotation3::identity());
    let (planned_mm3, simulated_mm3) = (proof.removed.total_mm3(), simulated.mean_mm3());
    println!("{:.4} + {:.4} of the slot, {:.4} alone", before.share_ratio, after.share_ratio, alone.share_ratio);
    println!("columns {planned_mm3:.1} +- {:.1}, dexels {simulated_mm3:.1} mm3", proof.removed.error_mm3);
    let spread_mm3 = proof.removed.error_mm3 + simulated.spread_mm3();
    assert!((planned_mm3 - simulated_mm3).abs() < spread_mm3, "{planned_mm3} {simulated_mm3}");

    // The first path once more finds nothing.
    let first_case = ProofCase { path: &before.plan.path, to_slot: before.plan.turn, earlier: &[], ..case };
    let proven = |case: &ProofCase<'_>| prove(case, &ProofResolution::default()).expect("blades above the hub");
    let first_proof = proven(&first_case);
    let repeated_mm3 = proven(&ProofCase { earlier: &earlier, ..first_case }).removed.total_mm3();
    assert!(repeated_mm3 < 1.0 && first_proof.removed.total_mm3() > 20_000.0, "{repeated_mm3}");

    // After both passes no place has more material than after the first one.
    let (both, one) = (&proof.left, &first_proof.left);
    for (both, one) in [(&both.pressure, &one.pressure), (&both.suction, &one.suction)] {
        let pairs = both.values_mm.iter().zip(&one.values_mm);
        let less_mm: Vec<f64> = pairs.map(|(both_mm, one_mm)| one_mm - both_mm).collect();
        println!("{:.2?} mm less", less_mm.iter().copied().fold(0.0, f64::max));
        assert!(less_mm.iter().all(|less_mm| *less_mm > -0.01) && less_mm.iter().any(|less_mm| *less_mm > 0.5));
    }
}

fn part(passes_max: u32) -> String {
    // Levels of four times the depth: a quarter of the cuts.
    fast_part()
        .replace("blades = 19", "blades = 13")
        .replace("axial_depth_max = 0.1\n", "axial_depth_max = 0.4\n")
        .replace("[roughing]", &format!("[roughing]\npasses_max = {passes_max}"))
}

/// The objects that `plan` prints with these arguments and `--json`, one for each pass.
fn plans(arguments: &[&str]) -> Vec<Value> {
    let output = run(&[&["plan", "cup-mill", "--json"], arguments].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("text");
    text.lines().map(|line| serde_json::from_str(line).expect("an object")).collect()
}

fn volume_mm3(file: &str) -> f64 {
    read_stl(std::fs::File::open(file).expect("the file")).expect("a closed surface").volume_mm3()
}

#[test]
fn the_job_of_the_second_pass_begins_with_what_the_first_program_leaves() {
    let scratch = Scratch::new("plan-passes");
    let (part_file, folder) = (scratch.write("PART.toml", part(2)), scratch.path("out"));
    let plans = plans(&[&part_file, "-o", &folder]);
    let [first, second] = plans.as_slice() else { panic!("{} plans", plans.len()) };
    assert!(first["pass"] == 1 && second["pass"] == 2 && second["safe"] == true);
    let ratio = |plan: &Value, name: &str| number(plan, &format!("/removed/{name}"));
    let sum = ratio(first, "share_ratio") + ratio(second, "share_ratio");
    assert!((ratio(second, "with_earlier_ratio") - sum).abs() < 1e-12, "{sum}");

    let program = |file: &str| std::fs::read_to_string(format!("{folder}/{file}")).expect("a program");
    assert!(program("blisk-19.nc").contains("O1546") && program("pass-2/blisk-19-pass-2.nc").contains("O1547"));
    let words = "(PASS 2: ONLY AFTER PASS 1 IN ALL SLOTS)";
    assert!(program("pass-2/blisk-19-pass-2.nc").contains(words) && !program("blisk-19.nc").contains("(PASS"));
    let left = scratch.path("left.stl");
    object(&["simulate", &format!("{folder}/job.toml"), "--surface", &left]);
    let [blank_mm3, left_mm3, second_mm3] =
        [&format!("{folder}/stock.stl"), &left, &format!("{folder}/pass-2/stock.stl")].map(|file| volume_mm3(file));
    println!("blank {blank_mm3:.0} mm3, after the first program {left_mm3:.0}, stock of the second {second_mm3:.0}");
    let removed_mm3 = blank_mm3 - left_mm3;
    assert!(((blank_mm3 - second_mm3) / removed_mm3 - 1.0).abs() < 0.01, "{second_mm3}");

    let report = object(&["simulate", &format!("{folder}/pass-2/job.toml")]);
    assert_eq!(number(&report["material"], "/at_rapid"), 0.0);
    let replanned = scratch.write("PART.toml", part(1));
    object(&["plan", "cup-mill", &replanned, "-o", &folder]);
    let is_there = |file: &str| std::path::Path::new(&format!("{folder}/pass-2/{file}")).exists();
    assert!(is_there("job.toml.old") && !is_there("job.toml") && !is_there("blisk-19-pass-2.nc"));
}

#[test]
fn a_wheel_has_lost_the_first_pass_in_all_slots_before_the_second() {
    let scratch = Scratch::new("plan-passes-wheel");
    let folder = scratch.path("out");
    let plans = plans(&[&scratch.write("PART.toml", part(2)), "-o", &folder, "--wheel"]);
    let planned_mm3 = |plan: &Value| number(plan, "/slots") * number(plan, "/removed/total_mm3");
    let [blank_mm3, second_mm3] = ["stock.stl", "pass-2/stock.stl"].map(|file| volume_mm3(&format!("{folder}/{file}")));
    println!(
        "blank {blank_mm3:.0} mm3, stock of the second pass {second_mm3:.0}, planned {:.0}",
        planned_mm3(&plans[0])
    );
    assert!(((blank_mm3 - second_mm3) / planned_mm3(&plans[0]) - 1.0).abs() < 0.01, "{second_mm3}");

    let job = std::fs::read_to_string(format!("{folder}/pass-2/job.toml")).expect("the job");
    assert!(job.contains("stl = \"stock.stl\"\nindexed = true\n"), "{job}");
    // Coarse rays are enough for volumes.
    let coarse = scratch.write("out/pass-2/coarse.toml", job.replace("step = 0.019685\n", "step = 0.08\n"));
    object(&["engage", "--alike", &coarse]);
    let report = object(&["simulate", &coarse]);
    let removed_mm3 = number(&report["material"], "/removal/removed") * MM3_PER_IN3;
    println!("{removed_mm3:.0} mm3 simulated, {:.0} planned", planned_mm3(&plans[1]));
    assert!((removed_mm3 / planned_mm3(&plans[1]) - 1.0).abs() < 0.03, "{removed_mm3}");
    assert_eq!(number(&report["material"], "/at_rapid"), 0.0);
}
