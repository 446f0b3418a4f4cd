//! Wrong inputs of the planner, one change each in a part that is right, and the message for each: `refusals.txt` has them all to read.
//! `UPDATE_GOLDEN=1` writes it.

use std::fs;
use std::path::{Path, PathBuf};

use arcfeed::file_error::FileError;
use arcfeed::part::PartFile;
use arcfeed::part::finish::FinishPart;
use arcfeed::part::plunge::PlungePart;
use arcfeed::part::repair::RepairFile;
use arcfeed_plan::vector::Vector;
use arcfeed_tests::{Scratch, root};
use nalgebra::Rotation3;

use crate::files;
use crate::published_rotor::{ROTOR, TEXT};
use crate::symmetry::moved;

const EXPECTED: &str = "tests/plan/refusals.txt";

/// Words in the example's part file, and their replacement.
const PART: &[(&str, &str)] = &[
    ("units = \"inch\"", "units = \"feet\""),
    ("[roughing]\n", "[roughing]\npasses_max = 0\n"),
    ("[roughing]\n", "[roughing]\npasses_max = 5\n"),
    ("units = \"inch\"\n", ""),
    ("[cutter]", "[cuter]"),
    ("blades = 19", "blades = -19"),
    ("blades = 19", "blades = 0"),
    ("blades = 19", "blades = 1"),
    ("blades = 19", "blades = 1e308"),
    ("blades = 19", "blades = 19.5"),
    ("blades = 19", "blades = 5000"),
    ("hub_radius = \"70 mm\"", "hub_radius = 1e6"),
    ("hub_radius = \"70 mm\"", "hub_radius = 1e308"),
    ("hub_radius = \"70 mm\"", "hub_radius = -70"),
    ("hub_radius = \"70 mm\"", "hub_radius = \"70 m\""),
    ("hub_radius = \"70 mm\"", "hub_radius = \"70,5 mm\""),
    ("hub_radius = \"70 mm\"", "hub_radius = \"99 mm\""),
    ("tip_radius = \"98.6 mm\"", "tip_radius = \"198.6 mm\""),
    ("chord = [\"26 mm\", \"26 mm\"]", "chord = [0, 0]"),
    ("chord = [\"26 mm\", \"26 mm\"]", "chord = \"26 mm\""),
    ("chord = [\"26 mm\", \"26 mm\"]", "chord = [1e6, 1e6]"),
    ("stagger_deg = [28, 42]", "stagger_deg = [28, 100]"),
    ("stagger_deg = [28, 42]", "stagger_deg = [nan, 42]"),
    ("camber_deg = [14, 10]", "camber_deg = [0, 0]"),
    ("thickness_ratio = [0.1, 0.055]", "thickness_ratio = [10, 5.5]"),
    ("thickness_ratio = [0.1, 0.055]", "thickness_ratio = [0.9, 0.9]"),
    ("generate = {", "generate = { hand = \"both\","),
    ("generate = {", "generate = { edge = 5,"),
    ("generate = {", "sections = { file = \"none.csv\", blades = 19, hub_radius = 3 }\ngenerate = {"),
    ("radius = \"98.6 mm\"\nfrom", "radius = 1e6\nfrom"),
    ("radius = \"98.6 mm\"\nfrom", "radius = 1e308\nfrom"),
    ("radius = \"98.6 mm\"\nfrom", "radius = 0\nfrom"),
    ("radius = \"98.6 mm\"\nfrom", "radius = \"90 mm\"\nfrom"),
    ("from = \"-14 mm\"", "from = \"14 mm\""),
    ("from = \"-14 mm\"", "from = \"-5 mm\""),
    ("from = \"-14 mm\"", "from = 1e308"),
    ("outer_radius = 5.06205", "outer_radius = 4"),
    ("outer_radius = 5.06205", "outer_radius = 1e6"),
    ("inner_radius = 4.43706", "inner_radius = 0"),
    ("insert_radius = 0.03", "insert_radius = -0.03"),
    ("insert_radius = 0.03", "insert_radius = 0.76"),
    ("active_teeth = 10", "active_teeth = 0"),
    ("active_teeth = 10", "active_teeth = -4"),
    ("active_teeth = 10", "active_teeth = 100000"),
    ("cavity_depth = 1.5", "cavity_depth = 2.5"),
    ("cavity_depth = 1.5", "cavity_depth = 0.01"),
    ("holder = [[2.0, 4.0]]", "holder = [[2.0]]"),
    ("holder = [[2.0, 4.0]]", "holder = [[-2.0, 4.0]]"),
    ("allowance = 0.035", "allowance = 0"),
    ("allowance = 0.035", "allowance = 0.5"),
    ("allowance = 0.035", "alowance = 0.035"),
    ("allowance = 0.035", "allowance = 0.035\nslot = 2"),
    ("axial_depth_max = 0.1", "axial_depth_max = 0"),
    ("axial_depth_max = 0.1", "axial_depth_max = 0.0001"),
    ("rev_per_min = 100", "rev_per_min = -100"),
    ("rev_per_min = 100", "rev_per_min = 9000"),
    ("rev_per_min = 100", "rev_per_min = \"fast\""),
    ("feed_per_tooth = 0.004", "feed_per_tooth = \"0.004 inches\""),
    ("axial_feed = 2", "axial_feed = 0"),
    ("[machine]", "[[fixture]]\nfrom = [0, 0, 0]\nto = [1, 1, -1]\n[machine]"),
    ("\"mitsui-seiki-hu80a-5x\"", "\"hermle\""),
    ("number = 1546", "number = 0"),
    ("teeth = 3", "teeth = 0"),
];

/// Changes of the table of sections: name, and the text.
fn tables() -> Vec<(&'static str, String)> {
    let lines: Vec<&str> = TEXT.lines().collect();
    let joined = |lines: &[&str]| lines.join("\n") + "\n";
    let with = |at: usize, line: &str| {
        let mut lines = lines.clone();
        lines[at] = line;
        joined(&lines)
    };
    let of = |section: usize| 1 + 162 * section..1 + 162 * (section + 1);
    let without = |range: std::ops::Range<usize>| {
        let mut lines = lines.clone();
        lines.drain(range);
        joined(&lines)
    };
    let mut doubled = lines.clone();
    doubled.insert(5, lines[4]);
    let mut twice = lines.clone();
    twice.extend(&lines[of(3)]);
    let commas = |separator: &str| {
        let line = |line: &&str| line.split(',').map(|word| word.replace('.', ",")).collect::<Vec<_>>().join(separator);
        std::iter::once(lines[0].replace(',', separator))
            .chain(lines[1..].iter().map(line))
            .collect::<Vec<_>>()
            .join("\n")
    };
    vec![
        ("decimal commas, semicolons", commas(";")),
        ("decimal commas, tabs", commas("\t")),
        ("decimal commas between commas", commas(",")),
        ("a point twice", joined(&doubled).replace(",i,", ",n,")),
        ("a section twice", joined(&twice)),
        ("no suction side in one section", without(of(2).start + 81..of(2).end)),
        (
            "no suction side at all",
            joined(&lines.iter().filter(|line| !line.contains(",SS,")).copied().collect::<Vec<_>>()),
        ),
        ("one section", without(of(1).start..lines.len())),
        ("no points", lines[0].to_owned()),
        ("nothing", String::new()),
        ("no header", joined(&lines[1..])),
        ("a word for a number", with(9, &lines[9].replacen("-5.", "x5.", 1))),
        ("a line cut off", with(9, "0.0000,70.0000,PS,8,-5.4")),
        ("an unknown side", with(9, &lines[9].replace(",PS,", ",LS,"))),
        (
            "sections from the tip",
            joined(
                &std::iter::once(lines[0]).chain((0..9).rev().flat_map(|k| lines[of(k)].to_vec())).collect::<Vec<_>>(),
            ),
        ),
        ("inches under `_mm`", TEXT.replace("_mm", "_in")),
        ("an angle without a unit", TEXT.replace("s,R_mm,side,i,x_mm,y_mm,z_mm", "s,r_mm,side,i,z_mm,q,theta")),
        ("an unknown unit", TEXT.replace("x_mm", "x_furlong")),
        ("sides exchanged", TEXT.replace(",PS,", ",QS,").replace(",SS,", ",PS,").replace(",QS,", ",SS,")),
        ("coordinates of 1e308", with(9, "0.0000,70.0000,PS,8,1e308,1e308,1e308")),
    ]
}

/// Geometry tables with files that are wrong: name, table, and the file.
const FILES: &[(&str, &str, &[u8])] = &[
    ("no such file", "sections = { file = \"none.csv\", blades = 19, hub_radius = 3 }", b""),
    ("UTF-16", "sections = { file = \"f\", blades = 19, hub_radius = 3 }", b"\xff\xfes\0,\0"),
    ("no hub", "sections = { file = \"f\", blades = 19 }", b""),
    ("two hubs", "stl = { blade = \"f\", blades = 19, hub = \"f\", hub_radius = 3 }", b""),
    ("no STL", "stl = { blade = \"f\", blades = 19, hub_radius = 3 }", b"v 1 2 3\n"),
    ("STL cut off", "stl = { blade = \"f\", blades = 19, hub_radius = 3 }", &[0; 100]),
    ("STL without triangles", "stl = { blade = \"f\", blades = 19, hub_radius = 3 }", b"solid x\nendsolid x\n"),
    ("no STEP", "step = { file = \"f\", blade = [\"B\"], blades = 19, hub_radius = 3 }", b"solid x\n"),
    (
        "STEP cut off",
        "step = { file = \"f\", blade = [\"B\"], blades = 19, hub_radius = 3 }",
        b"ISO-10303-21;\nDATA;\n#1=A(1,\n",
    ),
    ("IGES", "iges = { file = \"f\", blades = 19 }", b""),
    ("IGES as STEP", "step = { file = \"f.igs\", blade = [\"B\"], blades = 19, hub_radius = 3 }", b""),
    ("IGES as STL", "stl = { blade = \"f.IGES\", blades = 19, hub_radius = 3 }", b""),
    ("IGES as hub", "stl = { blade = \"f\", blades = 19, hub = \"f.igs\" }", b""),
];

/// Curve files of a rotor with splitters.
pub const CURVES: &str = "curves = { hub = \"hub.curve\", shroud = \"shroud.curve\", profile = \"profile.curve\", blades = 9, units = \"mm\" }";

/// Profile of main blades with copies of them as splitters, each turned by an angle.
fn profile(turns_deg: &[f64]) -> String {
    let main = ROTOR.sections(3, 81).expect("a blade");
    let turned = |turn_deg: &f64| {
        let turn = Rotation3::from_axis_angle(&Vector::z_axis(), turn_deg.to_radians());
        files::profile(&moved(&main, |point| turn * point), false, false)
    };
    turns_deg.iter().map(turned).collect()
}

/// Table of the main blade, and of its copy that is turned by half a pitch as the blade `splitter`.
fn table(splitter: &str) -> String {
    let (sin, cos) = libm::sincos(core::f64::consts::TAU / 18.0);
    let turned = |line: &str| {
        let words: Vec<&str> = line.split(',').collect();
        let [x, y, z] = [4, 5, 6].map(|at: usize| words[at].parse::<f64>().expect("a number"));
        format!("{splitter},{},{:.6},{y:.6},{:.6}\n", words[..4].join(","), x * cos + z * sin, z * cos - x * sin)
    };
    let rows = || TEXT.lines().skip(1);
    let main = rows().map(|line| format!("1,{line}\n"));
    std::iter::once("blade,s,R_mm,side,i,x_mm,y_mm,z_mm\n".to_owned()).chain(main).chain(rows().map(turned)).collect()
}

/// Geometry tables of rotors with splitters: name, table, and its profile or points.
fn splitters() -> Vec<(&'static str, String, String)> {
    let curves = |name, turns_deg: &[f64]| (name, CURVES.to_owned(), profile(turns_deg));
    let points =
        "sections = { file = \"profile.curve\", blades = 9, axis = \"y\", units = \"mm\", hub_radius = \"70 mm\" }";
    let exchanged = table("2").lines().fold(String::new(), |text, line| {
        let line = match line.strip_prefix("2,") {
            Some(_) if line.contains(",PS,") => line.replace(",PS,", ",SS,"),
            Some(_) => line.replace(",SS,", ",PS,"),
            None => line.to_owned(),
        };
        text + &line + "\n"
    });
    let unnamed = table("2").lines().fold(String::new(), |text, line| {
        let (blade, line) = line.split_once(',').expect("columns");
        text + &if blade == "2" { format!("2{line}") } else { line.to_owned() } + "\n"
    });
    vec![
        curves("two splitters in a pitch", &[0.0, 13.0, 26.0]),
        curves("a splitter that crosses the main blade", &[0.0, 1.5]),
        curves("a splitter that crosses the next main blade", &[0.0, 38.5]),
        curves("the main blade twice", &[0.0, 80.0]),
        curves("a splitter near the main blade", &[0.0, 3.5]),
        ("the number of a third blade", points.to_owned(), table("3")),
        ("sides of the splitter exchanged", points.to_owned(), exchanged),
        ("a second blade without `blade`", points.to_owned(), unnamed),
        (
            "the splitter alone",
            points.to_owned(),
            table("2")
                .lines()
                .filter(|line| !line.starts_with("1,"))
                .fold(String::new(), |text, line| text + line + "\n"),
        ),
    ]
}

/// Message of a part, or of its rotor's flaws; `None` if nothing is wrong with it.
fn message(folder: &Path, text: &str) -> Option<String> {
    let shown = |message: String| message.replace(&format!("{}/", folder.display()), "");
    match PartFile::parse(&folder.join("PART.toml"), text) {
        Err(error) => Some(shown(error.to_string())),
        Ok(part) => {
            let found = part.flaws();
            (!found.is_empty()).then(|| found.join("; "))
        }
    }
}

/// Messages for rotors with splitters.
fn splitter_messages(scratch: &Scratch, folder: &Path, example: &str, generate: &str) -> Vec<(String, Option<String>)> {
    scratch.write("hub.curve", files::curve(70.0, [-20.0, 20.0]));
    scratch.write("shroud.curve", files::curve(98.6, [-20.0, 20.0]));
    let of = |(name, geometry, text): (&str, String, String)| {
        scratch.write("profile.curve", text);
        (format!("splitters: {name}"), message(folder, &example.replace(generate, &geometry)))
    };
    let mut cases: Vec<_> = splitters().into_iter().map(of).collect();
    scratch.write("profile.curve", profile(&[0.0, 20.0]));
    let good = example.replace(generate, CURVES);
    assert_eq!(message(folder, &good), None);
    for slot in [0, 3] {
        let part = good.replace("allowance = 0.035", &format!("allowance = 0.035\nslot = {slot}"));
        cases.push((format!("splitters: slot = {slot}"), message(folder, &part)));
    }
    let shown = |error: FileError| error.to_string().replace(&format!("{}/", folder.display()), "");
    let plunge = PlungePart::parse(&folder.join("PART.toml"), &good).err().map(shown);
    cases.push(("splitters: plan plunge".to_owned(), plunge));
    let finish = fs::read_to_string(root().join("examples/finish-blisk/PART.toml")).expect("the example");
    let generate = finish.lines().find(|line| line.starts_with("generate")).expect("the rotor");
    let finish = finish.replace(generate, CURVES);
    let path = scratch.write("PART.toml", &finish);
    let finish = FinishPart::parse(Path::new(&path), &finish).err().map(shown);
    cases.push(("splitters: plan finish".to_owned(), finish));
    let repair = fs::read_to_string(root().join("examples/repaired-blade/REPAIR.toml")).expect("the example");
    let repair = repair.replace("../finish-blisk/PART.toml", "PART.toml");
    let repair = RepairFile::parse(&folder.join("REPAIR.toml"), &repair).err().map(shown);
    cases.push(("splitters: plan repair".to_owned(), repair));
    cases
}

#[test]
fn wrong_inputs_are_refused_with_their_place_and_a_remedy() {
    let scratch = Scratch::new("plan-refusals");
    let folder = PathBuf::from(scratch.path("").trim_end_matches('/'));
    let machine =
        fs::read_to_string(root().join("host/adapt/machines/mitsui-seiki-hu80a-5x.toml")).expect("the machine");
    scratch.write("machine.toml", format!("spindle_range = [50, 6000]\n{machine}"));
    let example = fs::read_to_string(root().join("examples/blisk-19/PART.toml")).expect("the example");
    let example = example.lines().filter(|line| !line.starts_with('#')).collect::<Vec<_>>().join("\n");
    let limited = example.replace("preset = \"mitsui-seiki-hu80a-5x\"", "file = \"machine.toml\"");
    assert_eq!([message(&folder, &example), message(&folder, &limited)], [None, None]);
    let generate = example.lines().find(|line| line.starts_with("generate")).expect("the rotor").to_owned();
    let mut cases: Vec<(String, Option<String>)> = Vec::new();
    for (old, new) in PART {
        let base = if old.contains("mitsui") { &example } else { &limited };
        assert!(base.contains(old), "{old}");
        let name = if new.is_empty() { format!("without {old}") } else { (*new).to_owned() };
        cases.push((name.trim().replace('\n', " | "), message(&folder, &base.replacen(old, new, 1))));
    }
    let points =
        "sections = { file = \"points.csv\", blades = 19, axis = \"y\", units = \"mm\", hub_radius = \"70 mm\" }";
    for (name, text) in tables() {
        scratch.write("points.csv", text);
        cases.push((format!("table: {name}"), message(&folder, &example.replace(&generate, points))));
    }
    for (name, geometry, bytes) in FILES {
        scratch.write("f", bytes);
        cases.push((format!("file: {name}"), message(&folder, &example.replace(&generate, geometry))));
    }
    cases.extend(splitter_messages(&scratch, &folder, &example, &generate));
    let found: String = cases
        .iter()
        .map(|(name, message)| format!("{name}\n    {}\n", message.as_deref().unwrap_or("NOT REFUSED")))
        .collect();
    println!("{} wrong inputs", cases.len());
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        fs::write(root().join(EXPECTED), &found).expect("the table can be written");
    }
    let expected = fs::read_to_string(root().join(EXPECTED)).expect("the table");
    assert!(!found.contains("NOT REFUSED") && cases.len() >= 80, "{} inputs\n{found}", cases.len());
    assert_eq!(found, expected, "run with UPDATE_GOLDEN=1 and read the difference");
}
