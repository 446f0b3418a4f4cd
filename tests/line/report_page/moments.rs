//! The tool and the stock at moments of a run, as the viewer has them, against closed forms.

use arcfeed_tests::{Running, Scratch, run};
use serde_json::{Value, json};

use super::{has_node, node};
use crate::live_page::Page;

const SPINDLE: &str = "[spindle]\nrev_per_min = 3000\n";
const LAW: &str = "[law]\nkind = \"programmed\"\nfeed_per_tooth = 0.05\n";
/// Positions of A and C that present the top and the four sides of a cube.
const FACES: [[f64; 2]; 5] = [[0.0, 0.0], [-90.0, 0.0], [-90.0, 90.0], [-90.0, 180.0], [-90.0, 270.0]];

/// Runs a command with a job, and looks for the facts in its report.
#[track_caller]
fn check_of(command: &[&str], test: &str, job: &str, program: &str, facts: Value) {
    if !has_node(test) {
        return;
    }
    let scratch = Scratch::new(test);
    scratch.write("program.nc", program);
    let job = scratch.write("job.toml", format!("units = \"mm\"\nprogram = \"program.nc\"\n{job}"));
    let page = scratch.path("run.html");
    let output = run(&[command, &[&job, "--json", "--report", &page]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let facts = scratch.write("facts.json", facts.to_string());
    println!("{}", node(&["test/moments.mjs", &page, &facts]));
}

/// Simulates a job, and looks for the facts in its report.
#[track_caller]
fn check(test: &str, job: &str, program: &str, facts: Value) {
    check_of(&["simulate"], test, job, program, facts);
}

/// Point of the tool's frame on the part: A turns about X, then C about Z.
fn on_part([a_deg, c_deg]: [f64; 2], [x, y, z]: [f64; 3]) -> [f64; 3] {
    let (sin, cos) = libm::sincos(a_deg.to_radians());
    let (y, z) = (y * cos - z * sin, y * sin + z * cos);
    let (sin, cos) = libm::sincos(c_deg.to_radians());
    [x * cos - y * sin, x * sin + y * cos, z]
}

/// Program that cuts along the top and the four sides of a cube, its job, and moments on each face.
fn faces() -> (String, String, Value) {
    let mut program = String::from("%\nG21G17G90G94\nG0Z60.\n");
    let mut facts = Vec::new();
    for face in FACES {
        let [a_deg, c_deg] = face;
        program += &format!("G0A{a_deg:.3}C{c_deg:.3}\nG0X-12.Y3.Z60.\nG1Z16.F600.\nG1X3.\nG0Z60.\n");
        let line = program.lines().count() - 1;
        // A third of the way along the face.
        let (place, axis) = (on_part(face, [-7.0, 3.0, 16.0]), on_part(face, [0.0, 0.0, 1.0]));
        facts.push(json!({ "line": line, "part": 1.0 / 3.0, "place": place, "axis": axis, "tolerance": 0.03 }));
    }
    program += "M30\n%\n";
    let job = format!(
        "[tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = 4\nheight = 30\n{SPINDLE}{LAW}\
         [workpiece]\nblock = {{ from = [-20, -20, -20], to = [20, 20, 20] }}\nstep = 1\n[machine]\npreset = \"mikron-ucp710\"\n"
    );
    (program, job, json!(facts))
}

#[test]
fn the_tool_is_on_the_part_in_every_position_of_the_rotary_axes() {
    let (program, job, facts) = faces();
    check("moments-faces", &job, &program, facts);
}

#[test]
fn in_the_report_of_a_sent_program_both_paths_are_on_the_part() {
    let (program, job, facts) = faces();
    check_of(&["stream", "--port", "sim:"], "moments-sent", &job, &program, facts);
}

#[test]
fn the_live_page_has_the_tool_on_the_part_in_every_position_of_the_rotary_axes() {
    let test = "moments-live";
    if !has_node(test) {
        return;
    }
    let scratch = Scratch::new(test);
    let (program, job, facts) = faces();
    scratch.write("program.nc", program);
    let job = scratch.write("job.toml", format!("units = \"mm\"\nprogram = \"program.nc\"\n{job}"));
    let stream = Running::start(&scratch, "stream", &["stream", &job, "--port", "sim:", "--speed", "5", "--web"]);
    let page = Page::of(&stream);
    let (html, browser) = (page.get(&page.path, "").1, page.browser());
    let planned = scratch.write("page.html", html);
    println!("{}", node(&["test/moments.mjs", &planned, &scratch.write("facts.json", facts.to_string())]));
    let ended = stream.end();
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    let seen = browser.join().expect("a client");
    let vector = |now: &Value, key: &str| [0, 1, 2].map(|axis: usize| now[key][axis].as_f64().expect("a number"));
    let is_near = |a: [f64; 3], b: [f64; 3], most: f64| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= most);
    let mut faces_seen = 0;
    for (face, fact) in FACES.into_iter().zip(facts.as_array().expect("a list")) {
        let on_face: Vec<&Value> = seen.iter().map(|(_, now)| now).filter(|now| now["line"] == fact["line"]).collect();
        for now in &on_face {
            let [tip, axis] = [vector(now, "position"), [0.0, 0.0, 1.0]].map(|place| on_part(face, place));
            assert!(
                is_near(vector(now, "tip"), tip, 1e-3) && is_near(vector(now, "axis"), axis, 1e-5),
                "{face:?}: {now}"
            );
        }
        faces_seen += usize::from(!on_face.is_empty());
    }
    // A busy computer may miss one: each lasts 0.3 s.
    assert!(faces_seen >= 4, "{faces_seen} faces in {} states", seen.len());
}

#[test]
fn the_stock_is_cut_behind_the_tool_and_whole_ahead_of_it() {
    // A mill of R 5 mm from X 0 to X 60 at the depth 4 mm, then back at 6 mm beside it.
    let program = "%\nG21G17G90G94\nG0X-10.Y0.Z5.\nG1Z-4.F1200.\nG1X60.\nG1Y10.\nG1Z-6.\nG1X-10.\nG0Z5.\nM30\n%\n";
    let job = format!(
        "[tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = 4\nheight = 30\n{SPINDLE}{LAW}\
         [workpiece]\nblock = {{ from = [0, -20, -12], to = [50, 20, 0] }}\nstep = 0.5\n"
    );
    let facts = [0.2, 0.5, 0.7].map(|part| {
        // The centre is at X c: the front of the mill is 5 mm ahead.
        let c = -10.0 + 70.0 * part;
        let heights = [[c + 3.5, 0.25, -4.0], [c + 6.5, 0.25, 0.0], [3.25, 0.25, -4.0], [3.25, 7.25, 0.0]];
        json!({ "line": 5, "part": part, "place": [c, 0.0, -4.0], "heights": heights, "tolerance": 0.05 })
    });
    let back = json!({ "line": 8, "part": 0.5, "tolerance": 0.05,
        "heights": [[25.0, 0.25, -4.0], [28.5, 10.25, -6.0], [18.0, 10.25, 0.0], [40.25, 10.25, -6.0]] });
    check("moments-stock", &job, program, json!(facts.into_iter().chain([back]).collect::<Vec<_>>()));
}

#[test]
fn each_of_several_tools_has_its_own_shape() {
    let program = "%\nG21G17G90G94\nT1M6\nG0X0.Y0.Z5.\nG1Z-2.F600.\nG1X20.\nG0Z5.\nT2M6\nG0X0.Y20.\nG1Z-2.F600.\nG1X20.\nG0Z5.\nM30\n%\n";
    let tool = |number: u32, diameter: u32| {
        format!("[[tool]]\nnumber = {number}\nkind = \"end-mill\"\ndiameter = {diameter}\nteeth = 2\nheight = 20\n")
    };
    let block = "[workpiece]\nblock = { from = [-10, -10, -12], to = [40, 40, 0] }\nstep = 0.5\n";
    let job = format!("{SPINDLE}{LAW}{block}{}{}", tool(1, 12), tool(2, 6));
    let fact = |line: usize, reach: f64, y: f64| {
        // The slot is as wide as its tool.
        let heights = [[10.25, y + reach - 0.75, -2.0], [10.25, y + reach + 0.75, 0.0]];
        json!({ "line": line, "part": 0.9, "place": [18.0, y, -2.0], "reach": reach, "heights": heights, "tolerance": 0.05 })
    };
    check("moments-tools", &job, program, json!([fact(6, 6.0, 0.0), fact(11, 3.0, 20.0)]));
}
