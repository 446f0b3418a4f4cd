//! The command: files of the example, figures, refusals.

use std::process::Output;

use arcfeed_tests::{Scratch, root, run};

const EXAMPLE: &str = "examples/repaired-blade";

fn plan(repair: &str, more: &[&str]) -> Output {
    run(&[&["plan", "repair", repair], more].concat())
}

/// The example's repair file with its files named from the project's root.
fn repair_text() -> String {
    let text = std::fs::read_to_string(root().join(EXAMPLE).join("REPAIR.toml")).unwrap();
    let named = |name: &str| root().join("examples").join(name).display().to_string();
    text.replace("../finish-blisk/PART.toml", &named("finish-blisk/PART.toml"))
        .replace("points.csv", &named("repaired-blade/points.csv"))
}

pub fn column<'l>(names: &str, line: &'l str, name: &str) -> &'l str {
    let at = names.split(',').position(|known| known == name).unwrap();
    line.split(',').nth(at).unwrap()
}

/// Checks the allowances of a table. Points of the old surface were made 0.05 mm above the nominal one, those of the weld 0.9 mm, with
/// noise of 5 um.
fn check_allowance(table: &str) {
    let mut lines = table.lines().skip(1);
    let names = lines.next().unwrap();
    let mut counts = [0; 3];
    for line in lines {
        let number = |name: &str| column(names, line, name).parse::<f64>().ok();
        let [u, v] = ["u", "v"].map(|name| number(name).unwrap());
        let is_inside = (0.05..0.95).contains(&u) && (0.05..0.95).contains(&v);
        match column(names, line, "region") {
            "norm" => {
                counts[0] += 1;
                assert_eq!(column(names, line, "left_mm"), "", "{line}");
                assert!(!is_inside || (number("along_mm").unwrap() - 0.05).abs() < 0.03, "{line}");
            }
            "transition" => {
                counts[1] += 1;
                let left = number("left_mm").unwrap();
                assert!((0.019..0.06).contains(&left), "{line}");
            }
            _ => {
                counts[2] += 1;
                let standing = number("along_mm").unwrap();
                assert!(standing > 0.02 && (!is_inside || standing > 0.1), "{line}");
                let is_deep = u > 0.55 + 0.2 * v + 0.08;
                assert!(!is_deep || !is_inside || (standing - 0.9).abs() < 0.03, "{line}");
            }
        }
    }
    println!("{counts:?} places of norm, transition and repaired region");
    assert!(counts.iter().all(|count| *count > 200), "{counts:?}");
}

#[test]
fn the_example_leaves_the_old_surface_and_writes_its_program() {
    let scratch = Scratch::new("repair-example");
    let folder = scratch.path("out");
    let output = plan(&format!("{EXAMPLE}/REPAIR.toml"), &["-o", &folder]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    println!("{text}{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success());
    assert!(text.contains("clearances of the whole mill"), "{text}");
    let mut names: Vec<String> =
        std::fs::read_dir(&folder).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    let expected = [
        "allowance.csv",
        "contacts.csv",
        "finished.stl",
        "job.toml",
        "repair.apt",
        "repaired-blade.nc",
        "report.html",
        "stock.stl",
    ];
    assert_eq!(names, expected);

    check_allowance(&std::fs::read_to_string(format!("{folder}/allowance.csv")).unwrap());
    let contacts = std::fs::read_to_string(format!("{folder}/contacts.csv")).unwrap();
    let layers: Vec<&str> = contacts.lines().skip(2).map(|line| line.split(',').next().unwrap()).collect();
    let count = |layer: &str| layers.iter().filter(|found| **found == layer).count();
    println!("contacts: finish {}, layers {} {} {}", count("0"), count("1"), count("2"), count("3"));
    assert!(count("0") > 1000 && count("1") > 100 && count("3") > 100 && count("4") == 0);
    let page = std::fs::read_to_string(format!("{folder}/report.html")).unwrap();
    // Four maps, the chart of the rotary axes, and the viewer's triad.
    assert_eq!(page.matches("<svg").count(), 6);
    let program = format!("{folder}/repaired-blade.nc");
    let checked = run(&["check", &program, "--machine", "mikron-ucp710", "--tool-length", "150"]);
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stderr));
    let job = run(&["check", &format!("{folder}/job.toml")]);
    assert!(job.status.success(), "{}", String::from_utf8_lossy(&job.stderr));
}

#[test]
fn wrong_files_and_points_are_refused_with_place_and_remedy_and_nothing_is_written() {
    let scratch = Scratch::new("repair-refused");
    let good = repair_text();
    let refused = |from: &str, to: &str, wanted: &[&str]| {
        assert!(good.contains(from), "{from}");
        let file = scratch.write("REPAIR.toml", good.replacen(from, to, 1));
        let folder = scratch.path("out");
        let output = plan(&file, &["-o", &folder]);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        println!("{message}");
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(wanted.iter().all(|word| message.contains(word)), "{message}");
        assert!(!std::path::Path::new(&folder).exists(), "{message}");
    };
    let points = root().join(EXAMPLE).join("points.csv").display().to_string();
    let named = format!("points = \"{points}\"");
    refused("blade = 1", "blade = 2", &["fit blade 1", "`blade`"]);
    refused("blade = 1", "blade = 20", &["REPAIR.toml:7:9", "blades 1 to 19"]);
    refused("side = \"pressure\"", "side = \"suction\"", &["nothing is repaired"]);
    refused("free = []", "free = [\"omega_w\"]", &["omega_x, omega_y, omega_z"]);
    refused("width = 4.0", "width = 0.4", &["1 in", "`width`"]);
    refused("least = 0.02", "least = 0.95", &["REPAIR.toml:", "`rough` must be more than `least`"]);
    refused("rough = 0.3", "rough = 1.2\nhole = 0.1", &["in holes of the measurement", "`hole`"]);
    refused(&named, "points = \"none.csv\"", &["none.csv"]);
    let table = std::fs::read_to_string(&points).unwrap();
    let inches = scratch.write("inches.csv", table.replacen("x_mm,y_mm,z_mm", "x_in,y_in,z_in", 1));
    refused(&points, &inches, &["millimetres read as inches", "`units`"]);
    let bad = scratch.write("bad.csv", table.replacen("HUB,", "HUB,x", 1));
    refused(&points, &bad, &["bad.csv:3831:5", "is no number"]);
    let mirrored = scratch.write("mirrored.csv", mirrored(&table));
    refused(&points, &mirrored, &["mirror image", "`hand`"]);
    let over = scratch.write("over.csv", format!("{table}PS,98.84,-3.32,-3.98\n"));
    refused(&points, &over, &["weld stands 0.", "beyond the tip at (98.84, -3.32, -3.98)", "take off"]);
    let short = scratch.write("short.csv", with_pit(&table));
    refused(&points, &short, &["material is missing", "weld more on"]);
}

/// Table with z reversed.
fn mirrored(table: &str) -> String {
    let line = |line: &str| match line.rsplit_once(',').map(|(rest, z)| (rest, z.parse::<f64>())) {
        Some((rest, Ok(z))) => format!("{rest},{}\n", -z),
        _ => format!("{line}\n"),
    };
    table.lines().map(line).collect()
}

/// Table whose points of the weld about one place are pressed 0.95 mm into the blade, along y, on which the pressure side nearly faces.
fn with_pit(table: &str) -> String {
    let line = |line: &str| {
        let words: Vec<&str> = line.split(',').collect();
        let values: Vec<f64> = words.iter().skip(1).filter_map(|word| word.parse().ok()).collect();
        let [x, y, z] = values.as_slice() else { return format!("{line}\n") };
        let is_pit = words[0] == "PS" && (libm::hypot(*x, *y) - 94.0).abs() < 2.0 && z.abs() < 2.0;
        if is_pit { format!("PS,{x},{:.4},{z}\n", y - 1.2) } else { format!("{line}\n") }
    };
    table.lines().map(line).collect()
}
