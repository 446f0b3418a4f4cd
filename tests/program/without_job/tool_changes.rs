//! Programs without a job file whose tools change at random: each block has the law of the tool in the spindle.

use arcfeed_tests::{Scratch, run};
use fastrand::Rng;

use super::text_of;

#[test]
fn each_block_has_the_law_of_the_tool_in_the_spindle() {
    let scratch = Scratch::new("without-job-sequence");
    let diameters = [4, 6, 10, 16];
    let mut rng = Rng::with_seed(23);
    let (mut text, mut expected) = ("%\nO1\nG21G90G94G17\nG0X0Y0Z0\n".to_owned(), Vec::new());
    let mut next = 0;
    for _ in 0..400 {
        // A T behind an M6 is preselected: the tool in the spindle stays. With another T beside the next M6, the machine's ladder decides
        // which tool that loads, and all feeds stay.
        let tool = if rng.bool() { next } else { rng.usize(0..4) };
        let change = if tool == next && rng.bool() { "M6".to_owned() } else { format!("T{}M6", tool + 1) };
        let is_known = expected.is_empty() || tool == next;
        text += &if expected.is_empty() { format!("T{}M6", tool + 1) } else { change };
        next = rng.usize(0..4);
        text += &format!("\nS5000M3T{}\n", next + 1);
        for _ in 0..rng.usize(1..4) {
            let (radius, feed) = (f64::from(rng.u16(30..200)) / 10.0, f64::from(rng.u16(100..900)));
            text += &format!("G91G3X{:.1}I{radius:.1}F{feed:.0}.\n", 2.0 * radius);
            let contour = radius + f64::from(diameters[tool]) / 2.0;
            expected.push(if is_known { feed * (radius / contour).max(0.2) } else { feed });
        }
    }
    text += "M30\n%\n";
    let path = scratch.write("p.nc", &text);
    let tools: Vec<String> = (1..).zip(diameters).map(|(tool, diameter)| format!("T{tool}={diameter}")).collect();
    let options = tools.iter().flat_map(|tool| ["--tool", tool]);
    let output = run(&["adapt", &path, "--json"].into_iter().chain(options).collect::<Vec<_>>());
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output.stderr));
    let blocks = text_of(&output.stdout);
    let blocks = blocks.lines().map(|line| serde_json::from_str(line).expect("an object"));
    let arcs = blocks.filter(|block: &serde_json::Value| block["kind"] == "arc");
    let sent: Vec<f64> = arcs.map(|block| block["sent_feed"].as_f64().expect("a feed")).collect();
    assert_eq!(sent.len(), expected.len());
    for (index, (sent, expected)) in sent.iter().zip(&expected).enumerate() {
        // Written with four digits, rounded down.
        let step = if *expected < 100.0 { 0.1 } else { 1.0 };
        assert!(*sent <= expected + 1e-3 && *sent > expected - step, "arc {index}: {sent} for {expected}\n{text}");
    }
}
