//! Plunges into the faces of a cube that a table turns to the tool: sections, feeds and loads are those of the same plunges upright.

use arcfeed_tests::{Scratch, of_full_set, run};
use serde_json::Value;

/// A cube about the point where the rotary axes cross.
const JOB: &str = "units = \"mm\"\nprogram = \"program.nc\"\n\
    [tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = 3\nheight = 30\n\
    [workpiece]\nblock = { from = [-20, -20, -20], to = [20, 20, 20] }\nstep = 0.4\nindexed = true\n\
    [cutting]\nmaterial = \"Ti-6Al-4V\"\nradial = 0.4\naxial = 0.2\naxial_depth = 1\nlayers = 2\n\
    [spindle]\nrev_per_min = 800\nmax_power = \"0.5 kW\"\n[limits]\nmax_feed = 2000\n\
    [law]\nkind = \"plunge\"\nfeed_per_tooth = 0.08\n[plunge]\nmap = \"map.toml\"\n\
    [override]\nmode = \"rewrite-only\"\n[machine]\npreset = \"mikron-ucp710\"\n";
/// Positions of A and C that present the top and three sides.
const FACES: [[i32; 2]; 4] = [[0, 0], [-90, 0], [-90, 90], [-90, 270]];
/// Plunges in a face: approach in air, then down.
const PLUNGES: usize = 3;

/// A row of plunges in each face.
fn program() -> String {
    let mut text = String::from("%\nG21G17G90G94\nS800M3\nG0Z60.\n");
    for (face, [a, c]) in FACES.iter().enumerate() {
        text += &format!("G0A{a}.C{c}.\n");
        for plunge in 0..PLUNGES {
            let (n, x) = (10 * (face * PLUNGES + plunge + 1), -4 + 4 * plunge as i32);
            text += &format!("G0X{x}.Y1.\nN{n}G1Z21.F2000.\nN{}G1Z12.F192.\nG0Z60.\n", n + 1);
        }
    }
    text + "M30\n%\n"
}

fn output(arguments: &[&str]) -> String {
    let output = run(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// Sections of the plunges in a map: path, end, side.
fn sections(map: &str) -> Vec<Vec<[f64; 3]>> {
    let map: toml::Table = map.parse().expect("a map");
    let moves = map["plunge"]["move"].as_array().expect("moves");
    let number = |value: &toml::Value| value.as_float().expect("a number");
    let row = |row: &toml::Value| -> [f64; 3] {
        row.as_array().expect("a row").iter().map(number).collect::<Vec<_>>().try_into().expect("three numbers")
    };
    moves.iter().map(|one| one["section"].as_array().expect("sections").iter().map(row).collect()).collect()
}

#[test]
fn plunges_into_turned_faces_have_the_sections_feeds_and_loads_of_upright_ones() {
    let scratch = Scratch::new("plunge-indexed");
    scratch.write("program.nc", program());
    let job = scratch.write("job.toml", JOB);
    output(&["engage", &job]);
    let sections = sections(&std::fs::read_to_string(scratch.path("map.toml")).expect("a map"));
    assert_eq!(sections.len(), 2 * PLUNGES * FACES.len(), "approaches and plunges");
    let (upright, turned) = sections.split_at(2 * PLUNGES);
    let mut worst = 0.0_f64;
    for face in turned.chunks(2 * PLUNGES) {
        for (own, expected) in face.iter().zip(upright) {
            let most = |sections: &[[f64; 3]]| sections.iter().map(|section| section[1]).fold(0.0, f64::max);
            worst = worst.max((most(own) - most(expected)).abs());
            assert!((most(own) - most(expected)).abs() <= 0.03 * most(expected), "{} {}", most(own), most(expected));
        }
    }
    println!("moments of turned plunges within {worst:.4} mm2 of those upright");

    let adapted = output(&["adapt", &job, "--json"]);
    let adapted: Vec<Value> = adapted.lines().map(|line| serde_json::from_str(line).expect("an object")).collect();
    let of = |n: usize, key: &str| {
        let block = adapted.iter().find(|block| block["n"] == n).unwrap_or_else(|| panic!("N{n}"));
        block[key].clone()
    };
    for index in 0..PLUNGES * FACES.len() {
        let n = 10 * (index + 1);
        assert_eq!((of(n, "law"), of(n + 1, "law")), (Value::Null, "plunge".into()), "approach and plunge N{n}");
    }

    let report: Value = serde_json::from_str(&output(&["simulate", &job, "--json"])).expect("one object");
    let blocks = report["loads"]["blocks"].as_array().expect("blocks");
    let power = |run: &str, n: usize| {
        // Pieces of a plunge: the first one has its N.
        let at = blocks.iter().position(|block| block["n"] == n).unwrap_or_else(|| panic!("N{n}"));
        let pieces = blocks[at..].iter().take_while(|block| block["n"] == n || block["n"].is_null());
        pieces.filter_map(|block| block[run]["power_max_w"].as_f64()).fold(0.0, f64::max)
    };
    for index in 0..PLUNGES * FACES.len() {
        let (n, first) = (10 * (index + 1) + 1, 10 * (index % PLUNGES + 1) + 1);
        let [own, programmed] = ["load", "baseline"].map(|run| power(run, n));
        println!("N{n}: {own:.0} W under the law, {programmed:.0} W as programmed");
        assert!(own <= 500.0 && own > 0.0, "N{n}: {own} W");
        let upright = power("baseline", first);
        assert!((programmed - upright).abs() <= 0.05 * upright, "N{n}: {programmed} W, upright {upright} W");
    }
    assert!(power("baseline", 11) > 500.0, "the programmed feed is too fast");
}

#[test]
fn without_indexed_plunges_at_other_positions_keep_their_feed() {
    let scratch = Scratch::new("plunge-not-indexed");
    scratch.write("program.nc", program());
    let job = scratch.write("job.toml", JOB.replace("indexed = true\n", ""));
    output(&["engage", &job]);
    let adapted = output(&["adapt", &job, "--json"]);
    let count = |reason: &str| {
        let blocks = adapted.lines().map(|line| serde_json::from_str::<Value>(line).expect("an object"));
        blocks.filter(|block| block["law"] == "plunge" && block["reason"] == reason).count()
    };
    assert_eq!(count("law"), PLUNGES, "those of the first face");
    assert_eq!(count("unmapped"), 2 * PLUNGES * (FACES.len() - 1), "all of the others");
}

/// Random plunges at random positions of the rotary axes, beside and through each other.
fn random_program(random: &mut fastrand::Rng) -> String {
    let mut text = String::from("%\nG21G17G90G94\nS800M3\nG0Z60.\n");
    for position in 0..5 {
        let [a, c] = if position == 0 { [0, 0] } else { [-random.i32(1..90), random.i32(0..360)] };
        text += &format!("G0A{a}.C{c}.\n");
        for _ in 0..4 {
            let [x, y] = [random.f64() * 16.0 - 8.0, random.f64() * 16.0 - 8.0];
            text += &format!("G0X{x:.3}Y{y:.3}\nG1Z36.F2000.\nG1Z{:.3}F192.\nG0Z60.\n", 10.0 + 8.0 * random.f64());
        }
    }
    text + "M30\n%\n"
}

#[test]
fn no_plunge_at_a_random_position_of_the_rotary_axes_is_above_the_limits() {
    let (mut above, mut descents) = (0, 0);
    for seed in 0..of_full_set(24, 2) {
        let scratch = Scratch::new(&format!("plunge-indexed-{seed}"));
        scratch.write("program.nc", random_program(&mut fastrand::Rng::with_seed(2600 + seed)));
        let job = scratch.write("job.toml", JOB);
        output(&["engage", &job]);
        let report: Value = serde_json::from_str(&output(&["simulate", &job, "--json"])).expect("one object");
        let blocks = report["loads"]["blocks"].as_array().expect("blocks");
        let most =
            |run: &str, key: &str| blocks.iter().filter_map(|block| block[run][key].as_f64()).fold(0.0, f64::max);
        let (power, chip) = (["load", "baseline"].map(|run| most(run, "power_max_w")), most("load", "end_chip_max"));
        println!(
            "seed {seed}: {:.1} W under the law, {:.1} W as programmed, chip {chip:.4} mm, {} blocks",
            power[0],
            power[1],
            blocks.len()
        );
        assert!(power[0] <= 500.0 * 1.01 && chip <= 0.08 * 1.005, "seed {seed}: {power:?} {chip}");
        above += usize::from(power[1] > 500.0);
        descents += blocks.len();
    }
    assert!(above > 0 && descents >= 20, "{above} {descents}");
}
