//! docs/json.md against what the commands print: every output obeys its schema, and the schemas forbid enough to notice
//! when one does not.
#![cfg(unix)]

mod document;

mod beforehand;

use std::collections::BTreeSet;

use arcfeed_tests::emulation::served::ServedBoard;
use arcfeed_tests::{Running, Scratch};
use serde_json::{Value, json};

use document::{Documented, changed, file_text, object, objects, objects_in};

const CORPUS: &str = "tests/corpus/cam-2003.nc";
const EXAMPLE: &str = "examples/ibr-slot";
const CASE: &str = "tests/cases/table-5-4";

#[test]
fn what_check_prints_is_documented() {
    let documented = Documented::read();
    for (arguments, code) in [(vec![CORPUS], 0), (vec![CORPUS, "--strict"], 1)] {
        documented.assert_fits("check", &object(&[&["check"], &arguments[..]].concat(), code));
    }
    let scratch = Scratch::new("json-check");
    let program = scratch.write("broken.nc", "%\nG20G90G94\nG0X0.Y0.\nG2X1.Y1.F10.\nG14\nG31X1.\n%\n");
    let report = object(&["check", &program], 1);
    documented.assert_fits("check", &report);
    let alarms: Vec<_> =
        report["errors"].as_array().expect("a list").iter().map(|error| error["alarm"].as_u64()).collect();
    assert_eq!(alarms, [Some(22), Some(10), None, Some(5010)]);
}

#[test]
fn what_check_and_adapt_print_of_a_program_with_calls_is_documented() {
    let documented = Documented::read();
    let scratch = Scratch::new("json-macros");
    let program = "%\nO1\nG21G17G90G94\nS9000M3\nG0X0.Y0.Z0.\nM98P2L3\nM30\nO2\nG1X8.F900.\nG3I-8.\nG1X0.\nM99\n%\n";
    scratch.write("program.nc", program);
    let job = "units = \"mm\"\nprogram = \"program.nc\"\ntool = { kind = \"end-mill\", diameter = 10, teeth = 4 }\n\
               spindle = { rev_per_min = 9000 }\nlaw = { kind = \"contour\", feed_per_tooth = 0.05 }\n\
               limits = { max_feed = 6000 }\n[[cut]]\nmoves = \"arcs\"\ndirection = \"ccw\"\nside = \"inside\"\n\
               radial_depth = 0.5\n";
    let job = scratch.write("job.toml", job);
    let report = object(&["check", &job], 0);
    documented.assert_fits("check", &report);
    assert_eq!(report["calls"], json!([{ "program": 2, "executions": 3 }]));
    let (code, blocks) = objects(&["adapt", &job]);
    blocks.iter().for_each(|block| documented.assert_fits("adapt", block));
    let lines: Vec<_> = blocks.iter().map(|block| block["line"].as_u64()).collect();
    assert_eq!((code, lines.len(), &lines[1..4]), (Some(0), 10, &[Some(9), Some(10), Some(11)][..]));
}

#[test]
fn what_check_and_post_print_of_a_five_axis_machine_is_documented() {
    let documented = Documented::read();
    let machine = |name: &str| format!("host/adapt/machines/{name}.toml");
    let scratch = Scratch::new("json-five-axis");
    let strategy_2 = "examples/five-axis/tournier-strategy-2.apt";
    let head = "FEDRAT/100\nGOTO/0,0,0,0,0,1\n";
    let far = scratch.write("far.apt", format!("{head}GOTO/9999,0,0,0,0.6,0.8\nGOTO/9999,0,0,0,-0.6,0.8\n"));
    let below = scratch.write("below.apt", format!("{head}GOTO/0,0,0,0,0.6,-0.8\nGOTO/0,0,0,0,0,-1\n"));
    let mut kinds = BTreeSet::new();
    for (path, name, code) in [
        (strategy_2, "mikron-ucp710", 0),
        (strategy_2, "ferrari-rtttr", 0),
        (&far, "ferrari-rtttr", 1),
        (&below, "mikron-ucp710", 1),
        (&below, "mitsui-seiki-hu80a-5x", 1),
    ] {
        let report = object(&["check", path, "--machine", &machine(name)], code);
        documented.assert_fits("check --machine", &report);
        let posted = ["post", path, "--machine", &machine(name), "-o", &scratch.path("out.nc")];
        let (_, reports) = objects(&posted);
        assert_eq!(reports, std::slice::from_ref(&report));
        kinds.extend(report["findings"].as_array().expect("a list").iter().map(|entry| entry["kind"].to_string()));
    }
    let program = "%\nG21G90\nG0X0Y0Z100.A-20.C0\nG1X1.A20.C180.F9999.\nX999.\nM30\n%\n";
    let report = object(&["check", &scratch.write("both.nc", program), "--machine", "mikron-ucp710"], 1);
    documented.assert_fits("check --machine", &report);
    kinds.extend(report["findings"].as_array().expect("a list").iter().map(|entry| entry["kind"].to_string()));
    println!("{kinds:?}");
    assert!(["pole", "branch-change"].iter().all(|kind| kinds.contains(&format!("\"{kind}\""))));
    assert!(
        ["singularity", "feed", "over-limit", "unreachable"].iter().all(|kind| kinds.contains(&format!("\"{kind}\"")))
    );
}

#[test]
fn what_simulate_and_stream_print_is_documented_and_the_same_in_every_run() {
    let documented = Documented::read();
    let job = format!("{EXAMPLE}/job.toml");
    for (title, command) in [("simulate", "simulate"), ("stream to sim:", "stream")] {
        let [one, other] = [(); 2].map(|()| {
            let mut report = object(&[command, &job], 0);
            documented.assert_fits(title, &report);
            report["real_time_factor"] = Value::Null;
            report
        });
        assert_eq!(one, other, "{title}");
    }
    let scratch = Scratch::new("json-reports");
    let reporting = changed(&scratch, EXAMPLE, &[("[serial]", "[dnc]\nreport_every = 10\n\n[serial]")], &[]);
    let report = object(&["stream", &reporting], 0);
    assert!(report["reports"].is_object(), "{report}");
    documented.assert_fits("stream to sim:", &report);
}

#[test]
fn left_out_blocks_and_target_deviation_are_in_the_json_schema() {
    let documented = Documented::read();
    let scratch = Scratch::new("json-cut");
    let head = "units = \"mm\"\nprogram = \"cut.nc\"\ntool = { kind = \"end-mill\", diameter = 4, teeth = 2, height = 9 }\n\
                spindle = { rev_per_min = 9000, max_power = \"1 W\", max_torque = \"0.001 Nm\" }\n\
                law = { kind = \"programmed\", feed_per_tooth = 0.05 }\n\
                [workpiece]\nblock = { from = [0, 0, -4], to = [12, 8, 0] }\nstep = 0.5\nmaterial = \"Ti-6Al-4V\"\n";
    scratch.write("cut.nc", "G21G90G94\nN1G0X-5.Y4.Z1.\nG1Z-2.F800.\nN2X6.\nN3G41D1X9.\nN4G0Z5.\nM30\n");
    let (plain, stl) = (scratch.write("plain.toml", head), scratch.path("left.stl"));
    object(&["simulate", &plain, "--surface", &stl], 0);
    let job = scratch.write("job.toml", format!("{head}target = \"left.stl\"\n"));
    let report = object(&["simulate", &job], 0);
    documented.assert_fits("simulate", &report);
    let material = &report["material"];
    assert!(material["deviation"].is_object() && material["left_out"][0]["cause"] == "contour", "{material}");
    let spindle = &report["spindle"];
    assert!(spindle["source"] == "estimate" && spindle["power"]["above"][0]["value"].is_f64(), "{spindle}");
    let cutting = "flexible = { block = { from = [0, 0, -4], to = [12, 8, 0], cells = [1, 1, 1], clamped = \"z-\" }, \
                   material = \"7075-T6\", modes = 2, damping = 0.02 }\n\
                   [cutting]\nkc11 = 800\nmc = 0.25\nradial = 0.4\naxial = 0.2\naxial_depth = 2\n";
    let job = scratch.write("cutting.toml", format!("{head}{cutting}"));
    let report = object(&["simulate", &job], 0);
    documented.assert_fits("simulate", &report);
    let loads = &report["loads"];
    assert!(
        loads["marks"]["largest"]["distance"].is_f64() && loads["vibration"]["workpiece_hz"][1].is_f64(),
        "{loads}"
    );
    assert!(report["spindle"]["torque"]["baseline_above"][0]["n"].is_i64(), "{}", report["spindle"]);
    assert!(loads["blocks"][0]["load"]["chips"][0].is_u64() && loads["left_out"][0]["cause"] == "contour", "{loads}");
}

#[test]
fn a_run_that_ends_in_an_alarm_is_documented_too() {
    let documented = Documented::read();
    let scratch = Scratch::new("json-alarm");
    // Without any F per minute: a control that remembers one would move, a fresh one stops at N128 on line 11.
    let job = changed(&scratch, EXAMPLE, &[], &[("F25.", "")]);
    for (title, command) in [("simulate", "simulate"), ("stream to sim:", "stream")] {
        let report = object(&[command, &job], 3);
        documented.assert_fits(title, &report);
        let alarms = report["alarms"].as_array().expect("a list");
        assert_eq!((alarms.len(), &alarms[0]["alarm"], &alarms[0]["line"]), (1, &json!(11), &json!(11)), "{title}");
    }
}

#[test]
fn a_restart_prints_what_is_documented() {
    let documented = Documented::read();
    let scratch = Scratch::new("json-resume");
    let (job, journal) = (format!("{EXAMPLE}/job.toml"), scratch.path("journal"));
    object(&["stream", &job, "--port", "fault://tx.flip=0.002,seed=5/sim:", "--journal", &journal], 3);
    let resume = ["stream", &job, "--resume", "--journal", &journal];
    documented.assert_fits("resume", &object(&resume, 4));
    let (code, both) = objects(&[&resume[..], &["--approve"]].concat());
    assert_eq!((code, both.len()), (Some(0), 2));
    documented.assert_fits("resume", &both[0]);
    documented.assert_fits("stream to sim:", &both[1]);
}

#[test]
fn both_ends_of_a_serial_line_print_what_is_documented() {
    let documented = Documented::read();
    let scratch = Scratch::new("json-serve");
    let job = format!("{EXAMPLE}/job.toml");
    let serve = ["serve", &job, "--pty", "--once", "--json", "--speed", "100", "--baudrate", "115200"];
    let mut server = Running::start(&scratch, "serve", &serve);
    let port = server.line("port: ");
    let journal = scratch.path("journal");
    let stream = ["stream", &job, "--port", &port, "--baudrate", "115200", "--journal", &journal];
    documented.assert_fits("stream to a serial port", &object(&stream, 0));
    let served = server.end();
    assert_eq!(served.code, Some(0), "{}", served.err);
    let lines: Vec<&str> = served.out.lines().collect();
    assert_eq!((lines.len(), lines[0]), (2, format!("port: {port}").as_str()));
    documented.assert_fits("serve", &serde_json::from_str(lines[1]).expect("one object a line"));
}

#[test]
fn what_a_program_read_back_is_found_to_be_is_documented() {
    let documented = Documented::read();
    let scratch = Scratch::new("json-verify");
    let job = format!("{EXAMPLE}/job.toml");
    let serve = ["serve", &job, "--tcp", "127.0.0.1:0", "--store", "--speed", "20"];
    let mut server = Running::start(&scratch, "serve", &serve);
    let port = server.line("port: ");
    let journal = scratch.path("journal");
    object(&["stream", &job, "--port", &port, "--journal", &journal], 0);
    server.line("stored: ");
    documented.assert_fits("verify", &object(&["verify", &job, "--port", &port], 0));
    let other = changed(&scratch, EXAMPLE, &[], &[("M9", "M8")]);
    let verdict = object(&["verify", &other, "--port", &port], 1);
    assert_eq!(verdict["difference"]["received"], "N206M9");
    documented.assert_fits("verify", &verdict);
}

#[cfg(target_os = "linux")]
#[test]
fn what_ports_prints_is_documented_and_the_command_prints_it() {
    let documented = Documented::read();
    let scratch = Scratch::new("json-ports");
    for folder in ["dev", "sys/devices/1-2/1-2:1.0", "sys/bus/usb", "sys/class/tty/ttyACM0"] {
        std::fs::create_dir_all(scratch.path(folder)).expect("a scratch folder");
    }
    scratch.write("dev/ttyACM0", "");
    scratch.write("dev/ttyS7", "");
    let link = |from: &str, to: &str| std::os::unix::fs::symlink(scratch.path(from), scratch.path(to)).expect("a link");
    link("sys/devices/1-2/1-2:1.0", "sys/class/tty/ttyACM0/device");
    link("sys/bus/usb", "sys/devices/1-2/1-2:1.0/subsystem");
    for (name, text) in [("idVendor", "2341"), ("idProduct", "0043"), ("serial", "7"), ("product", "Uno")] {
        scratch.write(&format!("sys/devices/1-2/{name}"), text);
    }
    let found = arcfeed::port::list::below(std::path::Path::new(&scratch.path("")), false);
    assert_eq!((found[0].vid, found[1].vid), (Some(0x2341), None));
    for port in found.iter() {
        documented.assert_fits("ports", &serde_json::to_value(port).expect("JSON"));
    }
    let (code, here) = objects(&["ports"]);
    assert_eq!(code, Some(0));
    here.iter().for_each(|port| documented.assert_fits("ports", port));
}

#[test]
fn output_of_a_board_is_documented() {
    let documented = Documented::read();
    let board = ServedBoard::start();
    for (title, arguments) in [("board info", &["info"][..]), ("board monitor", &["monitor", "--seconds", "1"])] {
        let (code, printed) = objects(&[&["board", &board.url], arguments].concat());
        assert!(code == Some(0) && !printed.is_empty(), "{title}: {code:?}");
        printed.iter().for_each(|object| documented.assert_fits(title, object));
    }
}

#[test]
fn every_field_of_a_schema_stands_in_a_table() {
    let document = file_text("docs/json.md");
    let first_cells = document.lines().filter_map(|line| line.strip_prefix('|')?.split('|').next());
    let named: BTreeSet<&str> = first_cells.flat_map(|cell| cell.split('`').skip(1).step_by(2)).collect();
    let mut fields = BTreeSet::new();
    for text in &Documented::read().texts {
        for pointer in objects_in(text, "").iter().filter(|pointer| pointer.ends_with("/properties")) {
            fields.extend(text.pointer(pointer).and_then(Value::as_object).expect("an object").keys().cloned());
        }
    }
    let is_named = |field: &String| named.iter().any(|name| name.rsplit('.').next() == Some(field.as_str()));
    let missing: Vec<&String> = fields.iter().filter(|field| !is_named(field)).collect();
    assert!(fields.len() > 60 && missing.is_empty(), "{} fields, not in a table: {missing:?}", fields.len());
}
