//! The command: files, the feed at the contact measured on the program, refusals.

use std::path::Path;
use std::process::Output;

use arcfeed::part::finish::FinishPart;
use arcfeed_plan::vector::{Point, Vector};
use arcfeed_tests::{Scratch, root, run};

use super::plans::foot;

const PART: &str = "examples/finish-blisk/PART.toml";

/// The example with a few passes only.
fn short() -> String {
    let text = std::fs::read_to_string(root().join(PART)).unwrap();
    text.replace("scallop = 0.01", "scallop = 0.02\nfrom = 0.5\nto = 0.53")
}

fn plan(part: &str, more: &[&str]) -> Output {
    run(&[&["plan", "finish", part], more].concat())
}

/// Tip, tool axis and F of each block with a position. The table is Tournier's: eq. 1.
fn blocks(program: &str) -> Vec<(Point, Vector, f64)> {
    let (mut state, mut found) = ([0.0; 6], Vec::new());
    let following = program.lines().skip_while(|line| !line.starts_with("G43.4")).skip(1);
    for line in following.take_while(|line| line.starts_with("G0") || line.starts_with("G1")) {
        for (at, letter) in line.char_indices().filter(|(_, letter)| letter.is_ascii_alphabetic()) {
            let rest = &line[at + 1..];
            let end = rest.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(rest.len());
            if let (Some(index), Ok(number)) = ("XYZCAF".find(letter), rest[..end].parse()) {
                state[index] = number;
            }
        }
        let [x, y, z, c, a, f] = state;
        let ((sin_c, cos_c), (sin_a, cos_a)) = (libm::sincos(f64::to_radians(c)), libm::sincos(f64::to_radians(a)));
        found.push((Point::new(x, y, z), Vector::new(sin_c * sin_a, -cos_c * sin_a, cos_a), f));
    }
    found
}

#[test]
fn the_program_keeps_the_feed_at_the_contact_and_the_limits_of_the_machine() {
    let scratch = Scratch::new("finish-example");
    let (part, folder) = (scratch.write("PART.toml", short()), scratch.path("out"));
    let output = plan(&part, &["-o", &folder]);
    println!("{}", String::from_utf8_lossy(&output.stdout));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let program = std::fs::read_to_string(format!("{folder}/finish-blisk.nc")).unwrap();
    let loaded = FinishPart::load(Path::new(&part)).unwrap();
    let target = loaded.feeds.rev_per_min * loaded.feeds.per_tooth_mm * 2.0;
    let blocks = blocks(&program);
    let top = blocks[0].0.coords.xy().norm();
    let (mut at_contact, mut at_end, mut raised) = (0.0_f64, 0.0_f64, 0);
    for pair in blocks.windows(2) {
        let [(from, axis_from, _), (to, axis_to, f)] = [pair[0], pair[1]];
        // Approach and way out are not cuts.
        if from.coords.xy().norm() > top - 1.0 || to.coords.xy().norm() > top - 1.0 {
            continue;
        }
        let minutes = (to - from).norm() / f;
        let centres = [from + axis_from * 2.5, to + axis_to * 2.5];
        let [foot_from, foot_to] = centres.map(|centre| foot(&loaded.blisk, &centre));
        // Words have 0.001 mm and 0.001 degrees, and both sides end up to a micrometre apart at an edge.
        at_contact = at_contact.max(((foot_to - foot_from).norm() - 0.004).max(0.0) / minutes);
        at_end = at_end.max(((centres[1] - centres[0]).norm() - 0.002).max(0.0) / minutes);
        raised += usize::from(f > target);
    }
    println!(
        "{} blocks: at the contact at most {at_contact:.1}, at the ball {at_end:.1} of {target:.1} mm/min; {raised} above",
        blocks.len()
    );
    assert!(blocks.len() > 200 && at_contact <= 1.005 * target && at_end <= 2.0 * 1.005 * target);

    let checked =
        run(&["check", &format!("{folder}/finish-blisk.nc"), "--machine", "mikron-ucp710", "--tool-length", "150"]);
    let said = String::from_utf8_lossy(&checked.stderr).into_owned();
    assert!(checked.status.success(), "{said}");
    let job = run(&["check", &format!("{folder}/job.toml")]);
    assert!(job.status.success(), "{}", String::from_utf8_lossy(&job.stderr));
    for name in ["finish.apt", "axes.svg", "report.html"] {
        assert!(std::fs::metadata(format!("{folder}/{name}")).unwrap().len() > 1000, "{name}");
    }
}

#[test]
fn wrong_parts_are_refused_with_their_place_and_nothing_is_written() {
    let scratch = Scratch::new("finish-refused");
    let folder = scratch.path("out");
    for (from, to, message) in [
        ("[finish]", "[finishing]", "unknown field `finishing`"),
        ("[machine]\npreset = \"mikron-ucp710\"", "", "finishing needs the table [machine]"),
        ("teeth = 2", "teeth = 2\ncorner_radius = 3", "corner_radius is at most the mill's radius of 2.500 mm"),
        ("length = 6", "length = 2", "length must be more than corner_radius"),
        ("safety = 0.5", "tilt_deg = [50, 20]", "tilt_deg is [least, greatest] angle from the normal"),
        ("safety = 0.5", "stations = [[0.5, 0, 0], [0.2, 0, 0]]", "a station is [place, tilt, yaw]"),
        ("scallop = 0.02", "scallop = 3", "no stepover"),
        ("neck = [[2.2, 34]]", "neck = [[9, 34]]", "no tool axis is admissible"),
        (
            "neck = [[2.2, 34]]",
            "neck = [[2.2, 34]]\nstations = [[0, 10, 0]]",
            "its axis does not lead out of the rotor",
        ),
        ("neck = [[2.2, 34]]", "neck = [[9, 34]]\nstations = [[0, 80, -90]]", "the neck keeps only"),
    ] {
        let text = short();
        assert!(text.contains(from), "{from}");
        let part = scratch.write("PART.toml", text.replace(from, to));
        let output = plan(&part, &["-o", &folder]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        println!("{said}");
        assert_eq!(output.status.code(), Some(1), "{to}: {said}");
        assert!(said.contains(message), "{to}: {said}");
        assert!(!Path::new(&folder).exists(), "{to}");
    }
}
