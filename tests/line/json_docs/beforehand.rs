//! Output of commands that plan, check or write, without a control.

use std::collections::BTreeSet;

use arcfeed_tests::Scratch;
use serde_json::Value;

use crate::json_docs::document::{Change, Documented, changed, file_text, object, objects};
use crate::json_docs::{CASE, CORPUS, EXAMPLE};

#[test]
fn what_plan_prints_is_documented_and_so_is_a_plan_that_is_refused() {
    let documented = Documented::read();
    let scratch = Scratch::new("json-plan");
    let text = file_text("examples/blisk-19/PART.toml").replace("[roughing]", "[roughing]\naxis = \"roomiest\"");
    let planned = object(&["plan", "cup-mill", &scratch.write("free.toml", text.as_str())], 0);
    documented.assert_fits("plan cup-mill", &planned);
    let fixture = "[[fixture]]\nfrom = [\"70 mm\", \"-60 mm\", \"-60 mm\"]\nto = [\"140 mm\", \"60 mm\", \"-15 mm\"]\n\n[machine]";
    let part = scratch.write("PART.toml", text.replace("[machine]", fixture));
    let refused = object(&["plan", "cup-mill", &part], 1);
    documented.assert_fits("plan cup-mill", &refused);
    assert!(planned["safe"] == true && refused["safe"] == false);
    let faulty =
        object(&["plan", "cup-mill", &scratch.write("faulty.toml", text.replace("blades = 19", "blades = -19"))], 1);
    documented.assert_fits("plan cup-mill, refused", &faulty);
    assert!(faulty["refused"].as_str().is_some_and(|why| why.contains("2 to 1000 blades")), "{faulty}");
}

#[test]
fn what_a_plan_of_plunges_prints_is_documented() {
    let documented = Documented::read();
    let planned = object(&["plan", "plunge", "examples/impeller-13/PART.toml"], 0);
    documented.assert_fits("plan plunge", &planned);
    assert!(planned["safe"] == true);
}

#[test]
fn what_a_plan_of_finishing_prints_is_documented() {
    let documented = Documented::read();
    let scratch = Scratch::new("json-finish");
    let text = file_text("examples/finish-blisk/PART.toml").replace("step = 1\n", "from = 0.5\nto = 0.52\n");
    let planned = object(&["plan", "finish", &scratch.write("PART.toml", text.as_str())], 0);
    documented.assert_fits("plan finish", &planned);
    assert!(planned["safe"] == true);
}

#[test]
fn what_a_plan_of_a_repair_prints_is_documented() {
    let documented = Documented::read();
    let planned = object(&["plan", "repair", "examples/repaired-blade/REPAIR.toml"], 0);
    documented.assert_fits("plan repair", &planned);
    assert!(planned["program"].is_null() && planned["is_rising"] == true, "{planned}");
}

#[test]
fn what_init_prints_is_documented_for_every_kind_of_program() {
    let documented = Documented::read();
    let scratch = Scratch::new("json-init");
    let bare = scratch.write("bare.nc", "G90G94\nG0X1.Y0\nG3X0Y1.Z1.I-1.F10.\nG14\n");
    let none = scratch.write("none.nc", "G21T2\nG1X1.F10.\n");
    let slot = format!("{EXAMPLE}/ibr-slot.nc");
    for (index, program) in [CORPUS, &slot, "examples/pocket/pocket.nc", &bare, &none].into_iter().enumerate() {
        let job = scratch.path(&format!("{index}.toml"));
        let report = object(&["init", program, "-o", &job], 0);
        documented.assert_fits("init", &report);
        assert_eq!(object(&["init", program, "-o", &job, "--force"], 0), report);
        assert_eq!(objects(&["init", program, "-o", &job]), (Some(1), vec![]));
    }
}

#[test]
fn what_engage_prints_is_documented() {
    let documented = Documented::read();
    let scratch = Scratch::new("json-engage");
    scratch.write("ibr-slot.nc", file_text(&format!("{EXAMPLE}/ibr-slot.nc")));
    let job = scratch.write("job.toml", file_text(&format!("{EXAMPLE}/job-engaged.toml")));
    let report = object(&["engage", &job], 0);
    documented.assert_fits("engage", &report);
    let moves = report["moves"].as_array().expect("moves");
    assert!(moves.iter().any(|found| found["outer_deg"].is_null()) && moves.iter().all(|found| found["n"].is_i64()));
}

const IN_MM: [Change<'static>; 4] = [
    ("\"inch\"", "\"mm\""),
    ("5.06205", "\"5.06205 in\""),
    ("4.43706", "\"4.43706 in\""),
    ("10.4502", "\"10.4502 in\""),
];
const BY_TABLE: [Change<'static>; 5] = [
    ("kind = \"circumference\"", "kind = \"table\""),
    ("n = [144, 144]", "n = [144, 144]\ntable = [[0, 0.005]]"),
    ("n = [146, 146]", "n = [146, 146]\ntable = [[0, 0.005], [1, 0.006]]"),
    ("n = [150, 150]", "n = [150, 150]\ntable = [[0, 0.005]]"),
    ("n = [152, 152]", "n = [152, 152]\ntable = [[0, 0.005]]"),
];
const BY_ARCS: [Change<'static>; 2] = [
    ("kind = \"circumference\"", "kind = \"engaged-arc\"\nedges = \"side\""),
    ("normal_deg = 54.187, offset = 4.2391", "engaged = [[0, 0, 40], [1, 60, 40]]"),
];

#[test]
fn what_adapt_prints_is_documented_for_every_reason_and_kind_there_is() {
    let documented = Documented::read();
    let scratch = Scratch::new("json-adapt");
    let with_override = |lines: &str| format!("[override]\n{lines}\n\n[control]");
    let (low, bound) = (with_override("max = 101"), with_override("mode = \"override-only\"\nmin = 60"));
    let in_pieces = with_override("mode = \"rewrite-only\"");
    let jobs: [(&str, &[Change<'_>], &[Change<'_>]); 20] = [
        (CASE, &[("[control]", &in_pieces)], &[]),
        (CASE, &[("[control]", &in_pieces)], &[("F25.", "F25.M8")]),
        (CASE, &[("[control]", "[machine]\nmax_feed = { x = 45, y = 45 }\n\n[control]")], &[]),
        (CASE, &[("[control]", "[control]\narc_clamp = { feed = 45, radius = 5 }")], &[]),
        (CASE, &BY_TABLE, &[]),
        (CASE, &BY_ARCS, &[]),
        (EXAMPLE, &[], &[]),
        (CASE, &[("max_feed = 100", "max_feed = 42")], &[]),
        (CASE, &[("active_teeth = 10", "active_teeth = 10\nnumber = 5")], &[("G20G17", "T1M6\nG20G17")]),
        (CASE, &[("\"operator\"", "\"program\"")], &[]),
        (CASE, &[("4.2391", "44.2391")], &[]),
        (CASE, &[("10.4502", "10.6")], &[]),
        (CASE, &[("[control]", &low)], &[]),
        (CASE, &[("[control]", &bound)], &[("F25.", "F100.")]),
        (CASE, &[("\"circumference\"", "\"programmed\"")], &[("N142", ""), ("F25.", "F25")]),
        (CASE, &IN_MM, &[]),
        (CASE, &[], &[("F25.", "")]),
        (CASE, &[], &[("F25.", "Z-27.7F25.")]),
        (CASE, &[], &[("F25.", "G63F25.")]),
        (CASE, &[("[control]", &in_pieces)], &[("F25.", "F25.\nG52X.0001")]),
    ];
    let (mut reasons, mut kinds, mut wholes) = (BTreeSet::new(), BTreeSet::new(), BTreeSet::new());
    for (folder, job, program) in jobs {
        let (code, blocks) = objects(&["adapt", &changed(&scratch, folder, job, program)]);
        assert_eq!((code, blocks.is_empty()), (Some(0), false));
        for block in &blocks {
            documented.assert_fits("adapt", block);
            reasons.insert(block["reason"].to_string());
            kinds.insert(block["kind"].to_string());
            wholes.insert(block["not_divided"].to_string());
        }
    }
    scratch.write("line.nc", "G21G90G94\nG1X10.F100.\nY0.\nX0.A5.\n/X30.\nM30\n");
    let line = "units = 'mm'\nprogram = 'line.nc'\ntool = { kind = 'end-mill', diameter = 10, teeth = 2 }\nlimits = { max_feed = 900 }\n\
                spindle = { rev_per_min = 1000, set_by = 'operator' }\nlaw = { kind = 'engagement', feed_per_tooth = 0.05 }\n\
                [[cut]]\nmoves = 'lines'\nside = 'outside'\nradial_depth = 5\n";
    let (_, at_unknown_position) = objects(&["adapt", &scratch.write("line.toml", line)]);
    reasons.extend(at_unknown_position.iter().map(|block| block["reason"].to_string()));
    // A corner roll of 3 um, and a corner in which the floor of the law decides.
    scratch.write("roll.nc", "G21G90G94\nG0X0Y0\nG3X.003Y.003I0J.003F1000.\nG3X1.003I.5J0F50.\nM30\n");
    let contour = line
        .replace("line.nc", "roll.nc")
        .replace("engagement", "contour")
        .replace("'lines'", "'arcs'\ndirection = 'ccw'");
    let (_, roll) = objects(&["adapt", &scratch.write("roll.toml", contour.replace("outside", "inside"))]);
    reasons.extend(roll.iter().map(|block| block["reason"].to_string()));
    let inside = contour.replace("outside", "inside");
    reasons.extend(along_contours(&scratch, &inside).into_iter().chain(before_a_corner(&scratch, &inside)));
    reasons.extend(of_plunges(&scratch));
    let schema = documented.texts.iter().find(|text| text["title"] == "adapt").expect("a schema");
    let listed = |field: &str| -> BTreeSet<String> {
        schema["properties"][field]["enum"].as_array().expect("a list").iter().map(Value::to_string).collect()
    };
    assert_eq!((reasons, kinds), (listed("reason"), listed("kind")));
    assert!(wholes.contains("\"coordinates\"") && wholes.is_subset(&listed("not_divided")), "{wholes:?}");
}

/// Reasons of a line before a rounded corner; `job` is one of the contour law for `roll.nc`.
fn before_a_corner(scratch: &Scratch, job: &str) -> Vec<String> {
    scratch.write("corner.nc", "G21G90G94\nG0X0Y0\nG1X50.F1000.,R3.\nY40.\nM30\n");
    let job = job.replace("roll.nc", "corner.nc") + "[override]\nmode = 'rewrite-only'\n";
    let (_, blocks) = objects(&["adapt", &scratch.write("corner.toml", job)]);
    blocks.iter().map(|block| block["reason"].to_string()).collect()
}

/// Reasons of plunges: with a torque below what the material rubs, and at another position of a rotary axis.
fn of_plunges(scratch: &Scratch) -> Vec<String> {
    let program = "G21G17G90G94\nS1000M3\nG0X0Y0Z3.\nG1Z-3.F100.\nG0Z3.\nB90.\nX1.\nG1Z-4.F100.\nG0Z3.\nM30\n";
    scratch.write("plunge.nc", program);
    let job = "units = 'mm'\nprogram = 'plunge.nc'\ntool = { kind = 'end-mill', diameter = 10, teeth = 2, height = 30 }\n\
               workpiece = { block = { from = [-9, -9, -9], to = [9, 9, 0] }, step = 0.5 }\n\
               cutting = { cutting = [1000, 0, 0], edge = [60, 0, 0], axial_depth = 2 }\n\
               spindle = { rev_per_min = 1000, max_torque = '1 Nm' }\nlimits = { max_feed = 900 }\n\
               law = { kind = 'plunge', feed_per_tooth = 0.05 }\nplunge = { map = 'plunge.map' }\n";
    let job = scratch.write("plunge.toml", job);
    objects(&["engage", &job]);
    objects(&["adapt", &job]).1.iter().map(|block| block["reason"].to_string()).collect()
}

/// Reasons of arcs under G41 in a job for the program `roll.nc`: another mode, no radius of D, a wrong one.
fn along_contours(scratch: &Scratch, job: &str) -> BTreeSet<String> {
    scratch.write("contour.nc", "G21G90G94\nG0X0Y0\nG41D1G1X20.F500.\nG3X40.Y20.J20.\nG1Y30.\nG40Y60.\nM30\n");
    scratch.write("machine.toml", "unit = 'mm'\n[radius]\n1 = 2.0\n");
    let job = job.replace("roll.nc", "contour.nc");
    let rewriting = job.replace("limits =", "override = { mode = 'rewrite-only' }\nlimits =");
    // The control itself reduces the feed there as much as the law wants it.
    scratch.write("reducing.toml", "unit = 'mm'\ninside_arc_least = 10\n[radius]\n1 = 5.0\n");
    let of =
        |settings: &str| rewriting.replace("limits =", &format!("control = {{ settings = '{settings}' }}\nlimits ="));
    let jobs = [job, rewriting.clone(), of("machine.toml"), of("reducing.toml")];
    let blocks = jobs.iter().flat_map(|job| objects(&["adapt", &scratch.write("contour.toml", job)]).1);
    blocks.map(|block| block["reason"].to_string()).collect()
}

#[test]
fn what_lobes_law_and_sweep_print_is_documented() {
    let documented = Documented::read();
    let scratch = Scratch::new("json-campaign");
    let job = "units = 'mm'\nprogram = 'p.nc'\ntool = { kind = 'end-mill', diameter = 10, teeth = 2, height = 5 }\n\
               spindle = { rev_per_min = 5000 }\nlaw = { kind = 'programmed', feed_per_tooth = 0.05 }\n\
               workpiece = { step = 1, block = { from = [0, 0, -20], to = [20, 20, 0] } }\n[cutting]\naxial_depth = 0.5\n\
               cutting = [600, 200, 0]\nedge = [0, 0, 0]\n\
               modes = [{ frequency = 922, damping = 0.011, stiffness = 1340.05, direction = [1, 0, 0] }]\n";
    let job = scratch.write("lobes.toml", job);
    documented.assert_fits("lobes", &object(&["lobes", &job, "--speeds", "4000,20000", "--points", "9"], 0));
    documented.assert_fits("law", &object(&["law", "--job", &format!("{CASE}/job.toml"), "--line", "5"], 0));
    let contour = ["law", "--rho", "3", "--radius", "5", "--edge", "inside", "--feed-per-tooth", "0.1"];
    documented.assert_fits("law", &object(&contour, 0));
    let sweep = format!(
        "job = {:?}\nassert = [\"time<=14.5s\"]\n[grid]\nlaw.feed_per_tooth = [0.08, 0.1]\n",
        arcfeed_tests::root().join("examples/pocket/job-contour.toml")
    );
    let report = object(&["sweep", &scratch.write("SWEEP.toml", sweep)], 1);
    documented.assert_fits("sweep", &report);
    assert_eq!((&report["ends"]["passed"], &report["failing"][0]["run"]), (&1.into(), &1.into()));
}
