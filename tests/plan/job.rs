//! The job of a planned program: the host's own reader takes it, and `adapt` governs what the rules speak of.

use std::path::Path;

use arcfeed::job;
use arcfeed_model::cut::{Moves, Work};
use arcfeed_model::tool::Tool;
use arcfeed_plan::output::job::{JobFile, Law, Machine};
use arcfeed_plan::output::limits::{StockLimit, stock_limits};
use arcfeed_plan::output::nc::{Feeds, Indexing, Setup, write};
use arcfeed_plan::output::stl::to_stl;
use arcfeed_plan::output::workpiece::{StockShape, Workpiece};
use arcfeed_plan::vector::Point;
use arcfeed_tests::{Scratch, run};
use arcfeed_units::{LengthUnit, Nm};
use serde_json::Value;

use crate::limits::{CHIP_MM, blank, leaning, mill, path};

fn text(unit: LengthUnit, limits: &[StockLimit], workpiece: Option<Workpiece<'_>>) -> String {
    JobFile {
        unit,
        program: "slot \"1\".nc",
        mill: &mill(),
        tool: 14,
        cutting_mm_per_min: 600.0,
        rev_per_min: 1_000.0,
        feed_per_tooth_mm: CHIP_MM,
        limits,
        law: Law::Circumference,
        workpiece,
        control: "fanuc-16i",
        settings: None,
        machine: Some(Machine::Preset("mitsui-seiki-hu80a-5x")),
    }
    .text()
}

#[test]
fn the_hosts_reader_finds_what_was_written() {
    let scratch = Scratch::new("plan-mesh");
    let corner = |x: f64, y: f64, z: f64| Point::new(x, y, z);
    let (a, b, c, d) = (corner(0.0, 0.0, 0.0), corner(10.0, 0.0, 0.0), corner(0.0, 10.0, 0.0), corner(0.0, 0.0, 10.0));
    scratch.write("blank.stl", to_stl(&[[a, c, b], [a, b, d], [b, c, d], [c, a, d]]).expect("bytes"));
    for unit in [LengthUnit::Inch, LengthUnit::Mm] {
        let limits = stock_limits(&path(false), &mill(), &blank(6.0), &leaning(6.0)).expect("limits");
        let text =
            text(unit, &limits, Some(Workpiece { stock: StockShape::Mesh("blank.stl"), target: None, step_mm: 0.5 }));
        let file = job::JobFile::parse(Path::new(&scratch.path("job.toml")), &text)
            .unwrap_or_else(|error| panic!("{error}\n{text}"));
        let Tool::CupMill(tool) = file.job.tools.first().tool else { panic!("a cup mill") };
        let off = |found: Nm, wanted_mm: f64| (found.to_mm() - wanted_mm).abs();
        assert!(
            off(tool.outer_radius, mill().outer_radius_mm) < 2e-5
                && off(tool.inner_radius, mill().inner_radius_mm) < 2e-5
        );
        assert_eq!((file.job.unit, file.job.rules.len()), (unit, 4));
        for (rule, limit) in file.job.rules.iter().zip(&limits) {
            assert_eq!(rule.moves, Moves::Rotations(limit.rotation, limit.turn));
            let Work::Ring(edge, stock) = &rule.work else { panic!("a ring's rule") };
            let line = stock.line().expect("a line");
            assert_eq!(*edge, limit.edge);
            assert!((line.at_height(190.0).offset_mm - limit.offset_mm - 190.0 * limit.rise_ratio).abs() < 2e-5);
            let (low, high) = rule.level.expect("levels");
            assert!(off(low, limit.heights_mm[0]) < 2e-5 && off(high, limit.heights_mm[1]) < 2e-5);
        }
    }
}

#[test]
fn a_planned_program_is_governed_on_all_levels_but_the_way_back() {
    let scratch = Scratch::new("plan-job");
    let path = path(false);
    let limits = stock_limits(&path, &mill(), &blank(6.0), &leaning(6.0)).expect("limits");
    let setup = Setup {
        number: 19,
        title: vec!["slot".into()],
        unit: LengthUnit::Inch,
        tool: 14,
        rev_per_min: 1_000.0,
        coolant: true,
        tilt_deg: 6.0,
        slots_deg: vec![0.0, 360.0 / 19.0],
        feeds: Feeds {
            cutting_mm_per_min: 635.0,
            approach_mm_per_min: Some(254.0),
            axial_mm_per_min: Some(254.0),
            indexing_per_min: 50.0,
        },
        indexing: Indexing::AtClearance,
        labels: true,
        reports: false,
    };
    scratch.write("slot \"1\".nc", write(&path, &setup).expect("a program"));
    let job = scratch.write("job.toml", text(LengthUnit::Inch, &limits, None));
    let output = run(&["adapt", &job, "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let lines = String::from_utf8(output.stdout).expect("JSON is text");
    let blocks: Vec<Value> = lines.lines().map(|line| serde_json::from_str(line).expect("one object a line")).collect();
    let arcs: Vec<&Value> = blocks.iter().filter(|block| block["kind"] == "arc").collect();
    let free = arcs.iter().filter(|block| block["law"].is_null() || block["law"] == "programmed").count();
    println!("{} arcs, {free} of them free: {:?}", arcs.len(), arcs.first());
    let planned = path.steps().iter().filter(|step| step.about.is_some()).count();
    assert_eq!((arcs.len(), free), (2 * planned, 2));
    for block in arcs.iter().filter(|block| block["law"] == "circumference") {
        // No tooth takes less than its chip: 10 000 teeth a minute.
        let least = block["feed_min"].as_f64().expect("a feed");
        assert!(least >= 39.99, "{block}");
    }
}
