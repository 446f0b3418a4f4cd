//! Programs without a job file on the simulated machine: assumed stocks, and the chip before and after.

use arcfeed_tests::{Scratch, run};

use super::{POCKET, adapted, blocks_of, refused, streamed, text_of};

#[test]
fn a_stock_is_assumed_and_named() {
    let simulate = |options: &[&str]| run(&[&["simulate", POCKET, "--tool", "10"], options].concat());
    let power = ["--teeth", "4", "--feed-per-tooth", "0.05", "--material", "6061"];
    let said = text_of(&simulate(&power).stdout);
    // Cuts from X-45. to X125., Y-20. to Y30. and down to Z-5.: the radius beside them, a tenth of the diameter below.
    let block = "stock ASSUMED, the cutting moves and the tool's radius about them: X -50.00 .. 130.0, Y -25.00 .. 35.00, Z -6.000 .. 0;";
    assert!(said.contains(block), "{said}");
    assert!(said.contains("spindle power, largest, kW, estimated with"), "{said}");
    let given = simulate(&["--stock", "-60,160,-40,70,-8,0", "--json"]);
    let report: serde_json::Value = serde_json::from_slice(&given.stdout).expect("one object");
    let stock = &report["material"]["assumed_stock"];
    assert_eq!(
        (&stock["source"], &stock["from"][0], &stock["to"][2]),
        (&"option".into(), &(-60.0).into(), &0.0.into())
    );
    let (code, message) = refused(&["simulate", POCKET, "--tool", "10", "--material", "6061"]);
    assert!(code == Some(2) && message.contains("--feed-per-tooth"), "{message}");
    let (code, message) = refused(&["simulate", "examples/pocket/job-contour.toml", "--stock", "0,1,0,1,0,1"]);
    assert!(code == Some(2) && message.contains("write [workpiece] into the job"), "{message}");
}

#[test]
fn a_stock_of_a_comment_has_the_closed_form_of_the_slot_that_is_cut() {
    let scratch = Scratch::new("without-job-stock");
    // A slot 40 long with an end mill of radius 5, 4 deep, along X and back on a half circle of radius 15 in its plane.
    let text = "%\nO1\n(STOCK/BLOCK,100,80,20,30,40,20)\nG21G17G90G94\nT1M6\nS5000M3\nG0X0Y0Z5.\nG1Z-4.F200.\nX40.F900.\n                G3X40.Y30.I0J15.\nG0Z5.\nX-20.\nG0Z-2.\nX-25.\nM30\n%\n";
    let output = run(&["simulate", &scratch.write("p.nc", text), "--tool", "10", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one object");
    let (stock, material) = (&report["material"]["assumed_stock"], &report["material"]);
    assert_eq!((&stock["source"], &stock["line"]), (&"comment".into(), &3.into()));
    assert_eq!(stock["from"], serde_json::json!([-30.0, -40.0, -20.0]));
    let pi = std::f64::consts::PI;
    // Two half discs at the ends; the second rapid takes a disc 2 deep and a step of 5 beside it.
    let cut = 4.0 * (10.0 * 40.0 + 10.0 * 15.0 * pi + 25.0 * pi);
    let rapid = 2.0 * (25.0 * pi + 5.0 * 10.0);
    let taken =
        [&material["removal"]["removed"], &material["at_rapid"]].map(|value| 1e3 * value.as_f64().expect("cm3"));
    println!("removed {:.1} of {:.1} mm3, at rapid {:.1} of {rapid:.1}", taken[0], cut + rapid, taken[1]);
    assert!((taken[0] / (cut + rapid) - 1.0).abs() < 5e-3 && (taken[1] / rapid - 1.0).abs() < 1e-2);
    assert!(text_of(&output.stderr).contains("taken at rapid from the assumed stock"), "{}", text_of(&output.stderr));
}

#[test]
fn chip_before_and_after_scales_with_the_programmed_feed() {
    let said = text_of(&run(&["simulate", POCKET, "--tool", "10"]).stdout);
    // Contour radius 8, centre radius 3: 8/3 times the feed at the contour before, once after.
    let inside = said.lines().find(|line| line.trim_start().starts_with("1 ccw inside")).expect("a movement");
    let words: Vec<&str> = inside.split_whitespace().collect();
    assert_eq!(words[4..6], ["own", "F"], "{said}");
    let number = |index: usize| words[index].parse::<f64>().expect("a ratio");
    let [before, after] = [[6, 8], [9, 11]].map(|columns| columns.map(number));
    assert!((before[1] - 8.0 / 3.0).abs() < 5e-3 && (after[1] - 1.0).abs() < 1e-3 && after[0] > 0.99, "{said}");
}

#[test]
fn a_circle_behind_a_helix_about_its_centre_has_its_chip_before_and_after() {
    let scratch = Scratch::new("without-job-helix");
    // Centre radius 4, tool radius 4: twice the feed of the tool centre at the contour, of a target that is half of F.
    let text = "G90G94G21G17\nS6000M3\nG0X4.Y0Z1.\nG3X-4.Y0Z-1.I-4.J0F300.\nX4.Y0Z-2.5I4.J0\nX-4.Y0I-4.J0F900.\nX4.Y0I4.J0\nG0Z9.\nM30\n";
    let path = scratch.write("p.nc", text);
    let said = text_of(&run(&["simulate", &path, "--tool", "8", "--teeth", "3", "--feed-per-tooth", "0.05"]).stdout);
    let inside = said.lines().find(|line| line.trim_start().starts_with("1 ccw inside")).expect("a movement");
    assert!(inside.contains(" 2  0.05000  0.10000 .. 0.10000  0.05000 .. 0.05000 "), "{said}");
}

#[test]
fn rounded_corners_alone_make_a_tool_an_end_mill_with_arcs() {
    let scratch = Scratch::new("without-job-rounded");
    let frame = "G90G94G21G17\nS5000M3\nG0X0Y0\nG1X50.F1000.,R3.\nY40.,R8.\nX0\nM30\n";
    let path = scratch.write("p.nc", frame);
    let wanted = frame
        .replace("G1X50.F1000.,R3.\nY40.,R8.\nX0", "G1X45.F1000.\nX50.,R3.F375.\nY30.F1000.\nY40.,R8.F615.3\nX0F1000.");
    assert_eq!(adapted(&path, &["--tool", "10"]), wanted);
    assert_eq!(blocks_of(&streamed(&path, &["--tool", "10"])), blocks_of(&wanted));
    // Feed at the contour over that of the own F: 8/3 in the first corner.
    let said = text_of(&run(&["simulate", &path, "--tool", "10"]).stdout);
    let inside = said.lines().find(|line| line.trim_start().starts_with("1 ccw inside")).expect("a movement");
    assert!(
        inside.contains("own F    1.62") && inside.contains(".. 2.66") && inside.contains("1.000 .. 1.000"),
        "{said}"
    );
}

#[test]
fn blocks_before_and_after_are_those_of_one_line_also_where_a_line_is_sent_in_two_blocks() {
    let scratch = Scratch::new("without-job-pairs");
    // The slower rounded corner has F of its block, so `adapt` sends the line before it in two blocks.
    let text = "%\nO1\nG21G17G90G94\nT1M6\nS5000M3\nG0X0Y0Z5.\nN1G1Z-2.F200.\nN2X40.,R6.F900.\nN3Y40.\nN4G3X20.Y60.I-20.J0\nN5G1X0\nG0Z5.\nM30\n%\n";
    let path = scratch.write("p.nc", text);
    let sent = adapted(&path, &["--tool", "10"]);
    assert_eq!(sent.lines().count(), text.lines().count() + 1, "{sent}");
    let output = run(&["simulate", &path, "--tool", "10", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one object");
    let material = &report["material"];
    let blocks = material["blocks"].as_array().expect("blocks");
    let removed = |of: &serde_json::Value| of["removed"].as_f64().expect("a volume");
    let names: Vec<i64> = blocks.iter().map(|block| block["n"].as_i64().expect("N")).collect();
    println!("{names:?}");
    assert_eq!(names, [1, 2, 3, 4, 5]);
    // Each block of the original program once: their volumes are those of the whole run.
    for (side, total) in [("removal", "removal"), ("baseline", "baseline")] {
        let sum: f64 = blocks.iter().map(|block| removed(&block[side])).sum();
        assert!((sum / removed(&material[total]) - 1.0).abs() < 1e-9, "{side}: {sum}");
    }
    // The same path is cut before and after.
    for block in blocks {
        assert!((removed(&block["removal"]) / removed(&block["baseline"]) - 1.0).abs() < 2e-2, "{block}");
    }
}

#[test]
fn a_report_of_adapt_prints_each_warning_once() {
    let scratch = Scratch::new("without-job-once");
    let (out, html) = (scratch.path("out.nc"), scratch.path("out.html"));
    let output = run(&["adapt", POCKET, "--tool", "10", "-o", &out, "--report", &html]);
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output.stderr));
    let said = text_of(&output.stderr);
    let lines: std::collections::BTreeSet<&str> = said.lines().collect();
    assert!(said.contains("note: ") && lines.len() == said.lines().count(), "{said}");
}

#[test]
fn several_tools_cut_one_stock_and_those_without_a_diameter_take_nothing() {
    let scratch = Scratch::new("without-job-tools-stock");
    // Two slots, each a line and a half circle, in whole layers of dexels; a drill beside them.
    let text = "%\nO1\n(STOCK/BLOCK,75,115,12,10,70,12)\nG21G17G90G94\nT1M6\nS5000M3\nG0X0Y0Z5.\nG1Z-4.2F200.\nX40.F900.\nG3X40.Y30.I0J15.\nG0Z5.\nT3M6\nS900M3\n\
                G0X5.Y40.\nG81X5.Y40.Z-9.R2.F90.\nG80\nT2M6\nS9000M3\nG0X0Y-60.Z5.\nG1Z-3.F200.\nX30.F700.\nG3X30.Y-40.I0J10.\nG0Z5.\nM30\n%\n";
    let pi = std::f64::consts::PI;
    let first = 4.2 * (10.0 * 40.0 + 10.0 * 15.0 * pi + 25.0 * pi);
    let second = 3.0 * (6.0 * 30.0 + 6.0 * 10.0 * pi + 9.0 * pi);
    let taken = |arguments: &[&str]| {
        let output = run(arguments);
        assert_eq!(output.status.code(), Some(0), "{}", text_of(&output.stderr));
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one object");
        (1e3 * report["material"]["removal"]["removed"].as_f64().expect("cm3"), text_of(&output.stderr))
    };
    let path = scratch.write("p.nc", text);
    let (removed, said) = taken(&["simulate", &path, "--tool", "T1=10", "--tool", "T2=6", "--json"]);
    println!("removed {removed:.1} of {:.1} mm3", first + second);
    assert!((removed / (first + second) - 1.0).abs() < 5e-3, "{removed}");
    assert!(said.contains("the shape of the tool in the spindle is not given"), "{said}");
    let (removed, _) = taken(&["simulate", &path, "--tool", "T2=6", "--json"]);
    assert!((removed / second - 1.0).abs() < 1e-2, "{removed}, not {second}");
    // A job: each tool with its height.
    let tool = |number: i32, diameter: f64, height: &str| {
        format!(
            "[[tool]]\nnumber = {number}\nkind = 'end-mill'\ndiameter = {diameter:?}\nteeth = 2\n{height}[[tool.cut]]\nmoves = 'arcs'\ndirection = 'ccw'\nside = 'slot'\n"
        )
    };
    let job = |height: &str| {
        format!(
            "units = 'mm'\nprogram = 'p.nc'\n[spindle]\nrev_per_min = 5000\n[law]\nkind = 'contour'\nfeed_per_tooth = 'programmed'\n[limits]\nmax_raise = 1.0\n[override]\nmode = 'rewrite-only'\n{}{}[workpiece]\nblock = {{ from = [-10, -70, -12], to = [65, 45, 0] }}\nstep = 0.3\n",
            tool(1, 10.0, height),
            tool(2, 6.0, "height = 12\n")
        )
    };
    let (removed, _) = taken(&["simulate", &scratch.write("job.toml", job("height = 12\n")), "--json"]);
    assert!((removed / (first + second) - 1.0).abs() < 5e-3, "{removed}");
    let (code, message) = refused(&["simulate", &scratch.write("job.toml", job(""))]);
    assert!(code == Some(1) && message.contains("the height of each [[tool]]"), "{message}");
}
