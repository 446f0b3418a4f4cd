//! Feeds of the law with a map, compared with calculation by hand.

use serde_json::Value;

use arcfeed_tests::run;

use crate::engage::cut_job::{CHIP_MM, Cut, MILL};

/// Feed per minute of a feed per tooth: 3000 rev/min, four teeth.
const TEETH_PER_MIN: f64 = 12_000.0;

fn wanted(job: &str) -> Vec<[f64; 2]> {
    let output = run(&["adapt", job, "--json"]);
    let text = String::from_utf8_lossy(&output.stdout);
    let blocks = text.lines().map(|line| serde_json::from_str::<Value>(line).expect("an object"));
    let governed = blocks.filter(|block| !block["feed_min"].is_null());
    governed.map(|block| ["feed_min", "feed_max"].map(|field| block[field].as_f64().expect("a demand"))).collect()
}

#[test]
fn a_full_slot_gets_the_chip_and_a_shoulder_more_by_the_sine_of_its_edge() {
    // Beyond -4 mm of 5 the edge is behind 143 degrees.
    for (name, edge_mm, factor) in [("feed-slot", 20.0, 1.0), ("feed-shoulder", -4.0, 1.0 / 0.6)] {
        let workpiece = format!("block = {{ from = [0, -20, -2], to = [60, {edge_mm}, 0] }}");
        let cut = Cut {
            name,
            tool: MILL,
            workpiece: &workpiece,
            rule: "moves = \"lines\"\nside = \"outer\"\nn = [4, 4]",
            program: "%\nG21G17G90G94\nN1G0X-10.Y0.\nN2Z-2.\nN3G1X10.F600.\nN4G1X50.F600.\nN5M30\n%\n",
        };
        let (_scratch, job) = cut.engaged();
        let feeds = wanted(&job);
        let by_hand = CHIP_MM * TEETH_PER_MIN * factor;
        println!("{name}: {feeds:?} mm/min, by hand {by_hand:.1}");
        // Half a cell of margin along the circle is 1.4 degrees at the shoulder, 3.4 % of the sine; knots add 0.2 degrees.
        let [least, largest] = feeds[0];
        assert!(largest <= by_hand * 1.001 && least >= by_hand * 0.94, "{feeds:?} {by_hand}");
    }
}

#[test]
fn a_feed_in_pieces_and_one_by_the_override_want_the_same() {
    let cut = Cut {
        name: "feed-corner",
        tool: MILL,
        workpiece: "round = { from = [0, 0, -2], to = [0, 0, 0], radius = 40, bore = 12 }",
        rule: "moves = \"arcs\"\ndirection = \"ccw\"\nside = \"outer\"",
        program: "%\nG21G17G90G94\nN1G0X10.Y0.\nN2Z2.\nN3G1Z-2.F300.\nN4G3X-10.Y0.I-10.J0.F600.\nN5M30\n%\n",
    };
    let (scratch, job) = cut.engaged();
    let pieces = std::fs::read_to_string(&job).expect("a job") + "[override]\nmode = \"rewrite-only\"\n";
    let pieces = scratch.write("pieces.toml", pieces);
    assert_eq!(wanted(&job), wanted(&pieces));
    // The wall begins at 101 degrees: nearly straight ahead, but on the path of the centre the wall is 15 mm out.
    let [least, largest] = wanted(&job)[0];
    let ratio = CHIP_MM * TEETH_PER_MIN;
    assert!(least >= 0.98 * ratio && largest <= 1.1 * ratio, "{least} {largest} {ratio}");
}
