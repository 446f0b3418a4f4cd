//! Tables in a job: engaged arcs and feeds per tooth that were computed beforehand, through `adapt` and `simulate`.

use core::fmt::Write;

use arcfeed_tests::{Scratch, root, run};
use serde_json::Value;

const CASE: &str = "tests/cases/table-5-4";
/// n z: 1000 rev/min, 10 teeth.
const TEETH_PER_MIN: f64 = 1e4;
/// N146, movement 2, clockwise, inches: start, end, rotation centre.
const START: [f64; 2] = [-3.6044, 10.5358];
const END: [f64; 2] = [-2.5752, 11.5549];
const CENTER: [f64; 2] = [-3.6044 + 4.0397, 10.5358 - 3.0504];
/// Radius of its cutting circle.
const OUTER: f64 = 5.06205;
/// The stock line: direction of its normal, degrees, and offset.
const LINE: [f64; 2] = [48.104, 10.4502];

/// The case's job, changed, beside its program.
fn job(scratch: &Scratch, changes: &[(&str, &str)]) -> String {
    let read = |name: &str| std::fs::read_to_string(root().join(CASE).join(name)).expect("the case has it");
    scratch.write("program.nc", read("program.nc"));
    let text = changes.iter().fold(read("job.toml"), |text, (old, new)| {
        assert!(text.contains(old), "no {old} in the job");
        text.replace(old, new)
    });
    scratch.write("job.toml", text)
}

fn objects(command: &str, job: &str) -> Vec<Value> {
    let output = run(&[command, job, "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("JSON is text");
    text.lines().map(|line| serde_json::from_str(line).expect("one object a line")).collect()
}

fn block(job: &str, n: i64) -> Value {
    objects("adapt", job).into_iter().find(|block| block["n"] == n).expect("the block is there")
}

fn number(value: &Value, field: &str) -> f64 {
    value[field].as_f64().unwrap_or_else(|| panic!("{field} in {value}"))
}

/// Path and engaged arc of N146's circle in the half plane, as the host would find it, at so many knots.
fn rows(knots: usize) -> String {
    let ([sx, sy], [ex, ey], [ax, ay]) = (START, END, CENTER);
    let radius = libm::hypot(sx - ax, sy - ay);
    let (from, to) = (libm::atan2(sy - ay, sx - ax), libm::atan2(ey - ay, ex - ax));
    let (nx, ny) = (libm::cos(LINE[0].to_radians()), libm::sin(LINE[0].to_radians()));
    let mut text = String::new();
    for i in 0..knots {
        let turned = (to - from) * i as f64 / (knots - 1) as f64;
        let (x, y) = (libm::cos(from + turned), libm::sin(from + turned));
        // Clockwise: the motion is (y, -x); the rotation centre lies towards (-x, -y).
        let into_stock = libm::atan2(-(nx * y - ny * x), nx * x + ny * y).to_degrees();
        let distance = LINE[1] - (nx * (ax + radius * x) + ny * (ay + radius * y));
        let half = 180.0 - libm::acos(distance / OUTER).to_degrees();
        let (start, end) = (into_stock - half, into_stock + half);
        write!(text, "[{:.5}, {start:.3}, {end:.3}], ", -turned * radius).expect("strings take what is written");
    }
    text
}

#[test]
fn engaged_arcs_sampled_from_a_line_give_the_feeds_of_the_line() {
    let scratch = Scratch::new("tables-engaged");
    let law = ("\"circumference\"", "\"engaged-arc\"\nedges = \"side\"");
    let by_line = block(&job(&scratch, &[law]), 146);
    let table = format!("engaged = [{}]", rows(16));
    let by_table = block(&job(&scratch, &[law, ("normal_deg = 48.104, offset = 10.4502", &table)]), 146);
    for field in ["feed_min", "feed_max", "contact_deg_start", "contact_deg_end"] {
        let error = number(&by_table, field) / number(&by_line, field) - 1.0;
        println!("{field}: {error:+.1e}");
        // Angles are kept to 1/90 degree, and the rows written to a thousandth of one.
        assert!(libm::fabs(error) < 1e-4, "{by_table}");
    }
    assert_eq!([&by_table["law"], &by_table["side"], &by_table["reason"]], ["engaged-arc", "outer", "law"]);
}

#[test]
fn the_machine_runs_by_a_table_of_engaged_arcs() {
    let scratch = Scratch::new("tables-machine");
    let law = ("\"circumference\"", "\"engaged-arc\"\nedges = \"side\"");
    let table = format!("engaged = [{}]", rows(16));
    let top = |changes: &[(&str, &str)]| {
        let report = objects("simulate", &job(&scratch, changes)).remove(0);
        assert!(report["alarms"].as_array().is_some_and(Vec::is_empty));
        report["movements"][1]["override"]["max"].as_i64().expect("movement 2 ran")
    };
    assert_eq!(top(&[law]), top(&[law, ("normal_deg = 48.104, offset = 10.4502", &table)]));
}

/// A table with its lowest knot between two places at which the planner asks.
const FEEDS: &str = "table = [[0, 0.005], [0.4, 0.0042], [\"36 mm\", \"0.006 in\"]]\n";

fn with_feeds(feeds: &str) -> [(&str, &str); 6] {
    [
        ("\"circumference\"", "\"table\""),
        ("n = [146, 146]", feeds),
        ("n = [144, 144]", "n = [144, 144]\ntable = [[0, 0.004]]"),
        ("n = [150, 150]", "n = [150, 150]\ntable = [[0, 0.004]]"),
        ("n = [152, 152]", "n = [152, 152]\ntable = [[0, 0.004]]"),
        // It needs no stock.
        ("stock = { normal_deg = 54.187, offset = 4.2391 }\n", ""),
    ]
}

#[test]
fn feeds_per_tooth_from_a_table_are_sent_and_no_knot_is_undercut() {
    let scratch = Scratch::new("tables-feeds");
    let feeds = format!("n = [146, 146]\n{FEEDS}");
    let job = job(&scratch, &with_feeds(&feeds));
    let table = block(&job, 146);
    println!("{table}");
    assert_eq!([&table["law"], &table["reason"]], ["table", "law"]);
    assert!(table["contact_deg_start"].is_null());
    let lowest = 0.0042 * TEETH_PER_MIN;
    let sent = number(&table, "sent_feed");
    assert!(sent <= lowest && sent > lowest - 0.2, "{sent}");
    // The arc is longer than the table: level behind the last knot.
    assert!(libm::fabs(number(&table, "feed_max") - 60.0) < 1e-3);
    assert!(libm::fabs(number(&block(&job, 144), "feed_min") - 40.0) < 1e-3);
}

#[test]
fn the_machine_runs_by_a_table_of_feeds() {
    let scratch = Scratch::new("tables-run");
    let feeds = format!("n = [146, 146]\n{FEEDS}");
    let path = job(&scratch, &with_feeds(&feeds));
    let sent = number(&block(&path, 146), "sent_feed");
    let report = objects("simulate", &path).remove(0);
    let bounds = &report["movements"][1]["override"];
    // 60 in/min at the end, where the override is on its way down to the 100 % that the next block allows.
    let (most, wanted) = (number(bounds, "max"), 100.0 * 60.0 / sent);
    assert!((0.9 * wanted..=wanted).contains(&most), "{most} of {wanted}");
    assert_eq!(report["movements"][0]["override"]["changes"], 0);
}

/// On a line and on an arc of an end mill: the path is all that a table asks for.
#[test]
fn an_end_mills_lines_and_arcs_run_by_tables_too() {
    let scratch = Scratch::new("tables-pocket");
    let folder = root().join("examples/pocket");
    let program = std::fs::read_to_string(folder.join("pocket.nc")).expect("the example has it");
    scratch.write("pocket.nc", program);
    let head = "units = \"mm\"\nprogram = \"pocket.nc\"\nlimits = { max_feed = 90000, max_raise = 100 }\nlaw = { kind = \"table\", feed_per_tooth = 0.1 }\n\
                tool = { kind = \"end-mill\", diameter = 10, teeth = 4 }\nspindle = { rev_per_min = 8000 }\n";
    let rules = "[[cut]]\nmoves = \"lines\"\nside = \"inside\"\nradial_depth = 1\nn = [130, 130]\ntable = [[0, 0.1], [5, 0.08]]\n\
                 [[cut]]\nmoves = \"arcs\"\ndirection = \"ccw\"\nside = \"inside\"\nradial_depth = 1\nn = [140, 140]\n\
                 table = [[0, 0.05], [1, 0.0375], [2, 0.05]]\n";
    let job = scratch.write("job.toml", format!("{head}{rules}"));
    let feeds = |n: i64| {
        let block = block(&job, n);
        assert_eq!([&block["law"], &block["reason"]], ["table", "law"]);
        ["feed_min", "feed_max", "sent_feed"].map(|field| number(&block, field))
    };
    let ([least, most, sent], [arc_least, _, arc_sent]) = (feeds(130), feeds(140));
    assert!(libm::fabs(least - 2560.0) < 0.01 && libm::fabs(most - 3200.0) < 0.01, "{least} {most}");
    assert!(sent <= 2560.0 && sent > 2550.0, "{sent}");
    // The arc's lowest knot, 0.0375, lies between two of the points asked.
    assert!(arc_least >= 1200.0 && arc_sent <= 1200.0 && arc_sent > 1185.0, "{arc_least} {arc_sent}");
}
