//! From blades to chips: planned rotors, with the map that the plan writes, their feeds by the law, their chips by the edges.

use std::fs;

use arcfeed_tests::{Scratch, object, root};
use serde_json::Value;

const PART: &str = "examples/blisk-19/PART.toml";
/// Wanted, inches.
const CHIP_IN: f64 = 0.004;
/// Thickest chip accepted, over the wanted one.
const MOST_RATIO: f64 = 1.02;
/// Edges in the stock, which the part does not know, over the whole height of the cup: what shorter ones leave would be cut later.
fn cutting(height_in: f64) -> String {
    format!(
        "\n[cutting]\nmaterial = \"Ti-6Al-4V\"\nradial = 0.4\naxial = 0.2\naxial_depth = {height_in}\nlayers = 30\n"
    )
}

/// Folder of the plan of a part.
fn planned(scratch: &Scratch, part: &str) -> String {
    let folder = scratch.path("out");
    object(&["plan", "cup-mill", &scratch.write("PART.toml", part), "-o", &folder]);
    folder
}

/// Thickest chip of each governed movement of the first slot over the wanted one, by the edges. The map is that of the plan, which
/// knows no edges.
fn thickest(folder: &str, program: &str, height_in: f64) -> Vec<f64> {
    let path = |name: &str| format!("{folder}/{name}");
    let text = fs::read_to_string(path(program)).expect("the program");
    let (first, _) = text.split_once("(SLOT 2 OF").expect("more than one slot");
    fs::write(path("first.nc"), format!("{first}M30\n%\n")).expect("it can be written");
    let job = fs::read_to_string(path("job.toml")).expect("a job").replace(program, "first.nc");
    let stem = program.strip_suffix(".nc").expect("a program");
    let job = job.replace(&format!("\"{stem}.engaged.toml\""), "\"first.engaged.toml\"") + &cutting(height_in);
    fs::write(path("first.toml"), &job).expect("it can be written");
    if let Ok(map) = fs::read_to_string(path(&format!("{stem}.engaged.toml"))) {
        let of_edges = path("edges.engaged.toml");
        object(&["engage", &path("first.toml"), "-o", &of_edges]);
        let of_edges = fs::read_to_string(of_edges).expect("a map");
        let made_of =
            |map: &str| map.lines().find(|line| line.starts_with("made_of")).expect("a fingerprint").to_owned();
        fs::write(path("first.engaged.toml"), map.replace(&made_of(&map), &made_of(&of_edges)))
            .expect("it can be written");
    }
    let report = object(&["simulate", &path("first.toml")]);
    let rules = report["loads"]["rules"].as_array().expect("rules").iter().filter(|rule| !rule["rule"].is_null());
    let thickest = rules.map(|rule| {
        let circles = rule["load"]["chip_max"].as_array().expect("two circles").iter().filter_map(Value::as_f64);
        circles.fold(0.0, f64::max) / CHIP_IN
    });
    let thickest = thickest.collect();
    println!(
        "{program}: thickest chip of each movement over the wanted one {thickest:.3?}, {} s",
        report["cycle_time_s"]
    );
    thickest
}

#[test]
fn a_planned_slot_cuts_with_the_wanted_chip_by_the_map_of_its_plan() {
    let scratch = Scratch::new("engage-planned");
    let text = fs::read_to_string(root().join(PART)).expect("the example");
    let folder = planned(&scratch, &text.replace("[roughing]", "[roughing]\naxis = \"roomiest\""));
    let map = fs::read_to_string(format!("{folder}/blisk-19.engaged.toml")).expect("a map");
    let arcs = map.matches("[[move]]").count();
    assert_eq!((arcs, arcs % 19), (map.matches("engaged = [").count(), 0), "the slots are alike");
    let found = thickest(&folder, "blisk-19.nc", 1.49);
    assert_eq!(found.len(), 4);
    assert!(found.iter().all(|ratio| *ratio <= MOST_RATIO && *ratio > 0.5), "{found:?}");
}

/// Tall blades far apart: along the roomiest direction, with the line of its own face alone, movement 3 cuts 1.57 times the wanted chip.
const TALL: &str = "units = \"mm\"\nname = \"tall\"\n\
    [geometry]\ngenerate = { blades = 36, hub_radius = 180, tip_radius = 240, chord = [54, 54], stagger_deg = [-40, -58], camber_deg = [20, 8], \
    thickness_ratio = [0.08, 0.03], hand = \"left\" }\n\
    [blank]\nradius = 240\nfrom = -22\nto = 22\n\
    [cutter]\nouter_radius = 128.576\ninner_radius = 112.701\ninsert_radius = 0.762\nactive_teeth = 10\ncavity_depth = 90\nheight = 110\n\
    [roughing]\nallowance = 0.889\naxial_depth_max = 5\naxis = \"roomiest\"\nlaw = \"circumference\"\nrev_per_min = 100\nfeed_per_tooth = 0.1016\naxial_feed = 50.8\n\
    [output]\nunits = \"inch\"\n";

#[test]
fn the_law_of_the_source_keeps_the_chip_where_the_other_circle_or_the_other_face_has_more() {
    let mut thickest_ratio = 0.0_f64;
    for axis in ["blade", "roomiest"] {
        let scratch = Scratch::new("engage-tall");
        let found = thickest(&planned(&scratch, &TALL.replace("roomiest", axis)), "tall.nc", 3.54);
        // One movement has no bound by a line.
        assert_eq!(found.len(), 3);
        assert!(found.iter().all(|ratio| *ratio <= MOST_RATIO), "{axis}: {found:?}");
        thickest_ratio = found.into_iter().fold(thickest_ratio, f64::max);
    }
    assert!(thickest_ratio > 0.9, "{thickest_ratio}");
}
