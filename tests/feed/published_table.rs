//! Petean 2004, table 5.4, through the command line. A consistency check: tests/cases/table-5-4/README.md says why.

use std::fmt::Write;

use arcfeed_tests::{Scratch, root, run, shared_or_skip};
use serde_json::Value;

const CASE: &str = "tests/cases/table-5-4";
/// F of the program.
const PROGRAMMED_IN_PER_MIN: f64 = 25.0;
/// n z: 1000 rev/min, 10 teeth.
const TEETH_PER_MIN: f64 = 1e4;
/// n z a: no tooth takes less than its chip on the circumference.
const FLOOR_IN_PER_MIN: f64 = 40.0;
/// Tolerance of the feeds against the table.
const FEED_TOLERANCE: f64 = 0.2;
/// Tolerance of the contact angles against those that the table implies; the last row's are known only to a degree.
const CONTACT_TOLERANCE_DEG: f64 = 0.5;

/// Relative error of a/sin(contact) against the exact step: 0.9e-4 to 3.5e-4 on the published tool, rounded up.
const FIRST_ORDER_RATIO: f64 = 5e-4;

/// A row of the table, and what it implies.
struct Row {
    n: i64,
    movement: [&'static str; 3],
    feed_in_per_min: [f64; 2],
    contact_deg: [f64; 2],
}

const TABLE: [Row; 4] = [
    Row { n: 144, movement: ["interior", "ccw", "outer"], feed_in_per_min: [74.6, 76.0], contact_deg: [32.4, 31.8] },
    Row { n: 146, movement: ["exterior", "cw", "outer"], feed_in_per_min: [41.0, 48.0], contact_deg: [77.3, 56.4] },
    Row { n: 150, movement: ["exterior", "ccw", "inner"], feed_in_per_min: [60.5, 62.0], contact_deg: [41.4, 40.2] },
    Row { n: 152, movement: ["interior", "cw", "inner"], feed_in_per_min: [40.0, 50.6], contact_deg: [88.0, 52.0] },
];

/// The blocks that `adapt --json` prints for a job.
fn adapt(job: &str) -> Vec<Value> {
    let output = run(&["adapt", job, "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("JSON is text");
    text.lines().map(|line| serde_json::from_str(line).expect("one object a line")).collect()
}

/// The blocks of the case.
fn four_arcs() -> Vec<Value> {
    adapt(&format!("{CASE}/job.toml"))
}

fn block<'a>(blocks: &'a [Value], row: &Row) -> &'a Value {
    blocks.iter().find(|block| block["n"] == row.n).unwrap_or_else(|| panic!("no N{}", row.n))
}

fn pair(block: &Value, from: &str, to: &str) -> [f64; 2] {
    [from, to].map(|field| block[field].as_f64().unwrap_or_else(|| panic!("{field} in {block}")))
}

fn assert_close<const N: usize>(found: [f64; N], wanted: [f64; N], tolerance: f64, what: &str) {
    for (found, wanted) in found.into_iter().zip(wanted) {
        assert!((found - wanted).abs() <= tolerance, "{what}: {found} where {wanted} is wanted");
    }
}

fn assert_published_feeds(blocks: &[Value]) {
    for row in &TABLE {
        let feed = pair(block(blocks, row), "feed_min", "feed_max");
        println!("N{}: {:.3} .. {:.3} in/min, published {:?}", row.n, feed[0], feed[1], row.feed_in_per_min);
        assert_close(feed, row.feed_in_per_min, FEED_TOLERANCE, &format!("feed of N{}", row.n));
    }
}

/// The table as it comes out, to fixed digits.
fn render(blocks: &[Value]) -> String {
    let mut text =
        "block movement           feed, in/min  table 5.4   factor        centre, in/tooth    contact, deg  reason\n"
            .to_owned();
    for row in &TABLE {
        let block = block(blocks, row);
        let range = |from, to, decimals| {
            let [from, to] = pair(block, from, to);
            format!("{from:.decimals$} - {to:.decimals$}")
        };
        let [low, high] = row.feed_in_per_min;
        writeln!(
            text,
            "N{:<5}{:<19}{:<14}{:<12}{:<14}{:<20}{:<14}{}",
            row.n,
            row.movement.join(" "),
            range("feed_min", "feed_max", 2),
            format!("{low:.1} - {high:.1}"),
            range("factor_min", "factor_max", 3),
            range("ipt_center_min", "ipt_center_max", 6),
            range("contact_deg_start", "contact_deg_end", 2),
            block["reason"].as_str().expect("a reason")
        )
        .expect("strings take what is written");
    }
    text
}

#[test]
fn the_published_arcs_get_the_published_feeds() {
    assert_published_feeds(&four_arcs());
}

#[test]
fn each_arc_is_the_movement_it_is_published_as_and_the_law_governs_it() {
    let blocks = four_arcs();
    for row in &TABLE {
        let block = block(&blocks, row);
        let movement = ["rotation", "direction", "side"].map(|field| block[field].as_str().unwrap_or("-"));
        assert_eq!(movement, row.movement, "N{}", row.n);
        let governed = ["kind", "law", "reason", "feed_unit"].map(|field| block[field].as_str().unwrap_or("-"));
        assert_eq!(governed, ["arc", "circumference", "law", "in/min"], "N{}", row.n);
    }
}

#[test]
fn the_contacts_are_those_that_the_table_implies() {
    let blocks = four_arcs();
    for row in &TABLE {
        let contact = pair(block(&blocks, row), "contact_deg_start", "contact_deg_end");
        assert_close(contact, row.contact_deg, CONTACT_TOLERANCE_DEG, &format!("contact of N{}", row.n));
    }
}

#[test]
fn feed_factor_and_feed_per_tooth_say_the_same() {
    let blocks = four_arcs();
    for block in TABLE.iter().map(|row| block(&blocks, row)) {
        let feed = pair(block, "feed_min", "feed_max");
        let relative = feed[0] * 1e-6;
        let factor = pair(block, "factor_min", "factor_max").map(|factor| factor * PROGRAMMED_IN_PER_MIN);
        assert_close(factor, feed, relative, "factor times F");
        let ipt = pair(block, "ipt_center_min", "ipt_center_max").map(|ipt| ipt * TEETH_PER_MIN);
        assert_close(ipt, feed, relative, "feed per tooth times n z");
        assert_eq!(block["programmed_feed"], PROGRAMMED_IN_PER_MIN);
        // Safe at 100 %: never more than the least feed wanted, and less by the control's resolution at most.
        let sent = block["sent_feed"].as_f64().expect("a feed that is sent");
        assert!(sent <= feed[0] && sent > feed[0] - 0.0101, "{sent} sent where {} is wanted", feed[0]);
    }
}

#[test]
fn feed_and_contact_obey_the_first_order_of_the_law() {
    let blocks = four_arcs();
    for block in TABLE.iter().map(|row| block(&blocks, row)) {
        let contact_deg = pair(block, "contact_deg_start", "contact_deg_end");
        let first_order = contact_deg.map(|contact| FLOOR_IN_PER_MIN / libm::sin(contact.to_radians()));
        let [least, most] = pair(block, "feed_min", "feed_max");
        // All four begin with the least feed. Movements 1 and 3 pass through their largest before the arc ends.
        assert_close([least], [first_order[0]], FIRST_ORDER_RATIO * least, "feed at the start");
        assert!(
            most > first_order[1] * (1.0 - FIRST_ORDER_RATIO),
            "{most} is less than the end wants: {first_order:?}"
        );
        assert!(least >= FLOOR_IN_PER_MIN);
    }
}

#[test]
fn adapted_program_equals_the_reviewed_file() {
    let golden = root().join(CASE).join("expected.txt");
    let text = render(&four_arcs());
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&golden, &text).expect("the golden can be written");
    }
    let expected = std::fs::read_to_string(&golden).expect("the case has an expected.txt");
    assert_eq!(text, expected, "UPDATE_GOLDEN=1 rewrites {}", golden.display());
    assert!(expected.lines().count() <= 40);
}

#[test]
fn the_whole_published_program_gives_its_four_arcs_the_same_feeds() {
    let test = "the whole published program gives its four arcs the same feeds";
    let Some(listing) = shared_or_skip("data/published-listing-slots-2-4.nc", test) else { return };
    let scratch = Scratch::new("published-table");
    let job = std::fs::read_to_string(root().join(CASE).join("job.toml")).expect("the case has a job");
    let program = format!("program = {:?}", listing.to_str().expect("the folder is named in ASCII"));
    let blocks = adapt(&scratch.write("job.toml", job.replace("program = \"program.nc\"", &program)));
    assert_published_feeds(&blocks);
    let governed = blocks.iter().filter(|block| !block["law"].is_null()).count();
    assert_eq!((governed, blocks.len() > 100), (TABLE.len(), true));
}
