use super::*;
use arcfeed_model::cut::Work;
use arcfeed_model::job::{FeedPolicy, OverrideLimits, PieceSettings};
use arcfeed_model::machine::ArcClamp;
use arcfeed_model::stock::{Stock, StockLine};
use arcfeed_model::tool::CupMill;
use arcfeed_units::{DegPerMin, Mm, MmPerMin};

const JOB: &str = r#"
units = "inch"
program = "slot.nc"
tool = { kind = "cup-mill", outer_radius = 5.06205, inner_radius = "112.701324 mm", active_teeth = 10 }
spindle = { rev_per_min = 1000 }
limits = { max_feed = "90000 mm", max_raise = 100 }
law = { kind = "circumference", feed_per_tooth = "0.1016 mm" }
[[cut]]
rotation = "interior"
direction = "ccw"
side = "outer"
stock = { normal_deg = 90.0, offset = 1 }
"#;

fn parse(text: &str) -> Result<JobFile, String> {
    JobFile::parse(Path::new("shop/job.toml"), text).map_err(|error| error.to_string())
}

fn stock_line(file: &JobFile) -> StockLine {
    match &file.job.rules[0].work {
        Work::Ring(_, stock) => *stock.line().expect("one line"),
        Work::Mill { .. } => panic!("a cup mill's rule"),
    }
}

#[test]
fn units_may_be_mixed() {
    let file = parse(JOB).unwrap();
    let (outer_radius, inner_radius) = (Nm(128_576_070), Nm(112_701_324));
    assert_eq!(file.job.tools.first().tool, Tool::CupMill(CupMill { outer_radius, inner_radius, active_teeth: 10 }));
    assert_eq!(file.job.tools.first().feed_per_tooth, MmPerTooth(0.1016));
    assert!((stock_line(&file).offset_mm - 25.4).abs() < 1e-12);
}

#[test]
fn the_program_lies_beside_the_job() {
    assert_eq!(parse(JOB).unwrap().program, Path::new("shop/slot.nc"));
}

#[test]
fn what_is_not_given_takes_the_defaults() {
    let file = parse(JOB).unwrap();
    assert_eq!(file.job.policy, FeedPolicy::SafeBase);
    assert_eq!(file.job.limits, OverrideLimits::default());
    let bits = file.serial.bits_per_char();
    assert_eq!((file.serial.baudrate, bits), (9_600, 10));
}

#[test]
fn a_machine_says_what_it_can_follow_in_the_files_units_and_degrees() {
    let machine = "machine = { max_feed = { x = 100, z = \"500 mm\", b = 3600 } }\n";
    let clamp = "control = { arc_clamp = { feed = 200, radius = \"5 mm\" } }\n[[cut]]";
    let text = JOB.replacen("[[cut]]", &format!("{machine}{clamp}"), 1);
    let found = parse(&text).unwrap().job.machine;
    assert_eq!(found.linear, [Some(MmPerMin(2_540.0)), None, Some(MmPerMin(500.0))]);
    assert_eq!(found.rotary, [None, Some(DegPerMin(3_600.0)), None]);
    assert_eq!(found.arc_clamp, Some(ArcClamp { feed: MmPerMin(5_080.0), radius: Mm(5.0), floor: MmPerMin(0.0) }));
    assert!(parse(&text.replace("b = 3600", "b = -1")).unwrap_err().contains("must be positive"));
}

#[test]
fn a_named_machine_gives_its_feeds_and_the_jobs_own_count_before_them() {
    let with = |machine: &str| parse(&JOB.replacen("[[cut]]", &format!("[machine]\n{machine}\n[[cut]]"), 1));
    let file = with("preset = \"mitsui-seiki-hu80a-5x\"\nmax_feed = { y = 100, b = 1800 }").unwrap();
    let MachineLimits { linear, rotary, .. } = file.job.machine;
    assert_eq!(linear, [Some(MmPerMin(12_000.0)), Some(MmPerMin(2_540.0)), Some(MmPerMin(24_000.0))]);
    assert_eq!(rotary, [Some(DegPerMin(2_160.0)), Some(DegPerMin(1_800.0)), None]);
    let machine = file.machine.expect("a machine").machine;
    assert_eq!(machine.linear().map(|axis| axis.speed_mm_per_min), [Some(12_000.0), Some(2_540.0), Some(24_000.0)]);
    assert_eq!(machine.rotary().map(|axis| axis.speed_deg_per_min), [Some(1_800.0), Some(2_160.0)]);
    for (machine, said) in [
        ("preset = \"mikron\"", "shop/job.toml:9:10: no such machine; write \"ferrari-rtttr\", "),
        ("file = \"none.toml\"", "shop/job.toml:9:8: shop/none.toml: "),
        ("file = \"m.toml\"\npreset = \"mikron-ucp710\"", "shop/job.toml:10:10: a machine is a `file` or a `preset`"),
    ] {
        let error = with(machine).unwrap_err();
        assert!(error.starts_with(said), "{error}");
    }
}

#[test]
fn rewrite_only_has_settings_of_its_own() {
    let policy = |lines: &str| {
        let text = format!("{JOB}[override]\nmode = \"rewrite-only\"\n{lines}");
        parse(&text).unwrap().job.policy
    };
    assert_eq!(policy(""), FeedPolicy::RewriteOnly(PieceSettings::default()));
    let given = "piece_step = 5\npiece_hysteresis = 7.5\npiece_length = \"3 mm\"\npieces_max = 8";
    let wanted = PieceSettings { step_percent: 5.0, hysteresis_percent: 7.5, least_length: Nm(3_000_000), most: 8 };
    assert_eq!(policy(given), FeedPolicy::RewriteOnly(wanted));
}

#[test]
fn a_line_through_two_points_has_the_material_on_its_left() {
    let text = JOB.replace("normal_deg = 90.0, offset = 1", "from = [0, 1], to = [-5, 1]");
    let stock = stock_line(&parse(&text).unwrap());
    assert!((stock.normal[1] - 1.0).abs() < 1e-15 && (stock.offset_mm - 25.4).abs() < 1e-12);
    assert!(stock.distance_mm([0.0, 0.0]) > 0.0);
}

#[test]
fn only_a_line_rises() {
    let text = JOB.replace("offset = 1", "offset = 1, rise = -0.25");
    let stock = stock_line(&parse(&text).unwrap());
    assert_eq!(stock.rise_ratio, -0.25);
    assert!((stock.at_height(8.0).offset_mm - 23.4).abs() < 1e-12);
    let through = JOB.replace("normal_deg = 90.0, offset = 1", "from = [0, 1], to = [-5, 1], rise = 0.5");
    assert_eq!(stock_line(&parse(&through).unwrap()).rise_ratio, 0.5);
    let lines = JOB.replace("normal_deg = 90.0, offset = 1", "lines = [[90.0, 1, 0.25], [180.0, \"3 mm\", 0.0]]");
    let Work::Ring(_, Stock::Convex(lines)) = &parse(&lines).unwrap().job.rules[0].work else { panic!("two lines") };
    assert_eq!((lines.len(), lines[0].rise_ratio), (2, 0.25));
    assert!((lines[0].offset_mm - 25.4).abs() < 1e-12 && (lines[1].offset_mm - 3.0).abs() < 1e-12);
    for stock in ["disc = [0, 0, 1], rise = 0.1", "polygon = [[0, 0], [1, 0], [0, 1]], rise = 0"] {
        let message = parse(&JOB.replace("normal_deg = 90.0, offset = 1", stock)).unwrap_err();
        assert!(message.starts_with("shop/job.toml:12:") && message.contains("`rise`"), "{message}");
    }
}

#[test]
fn complaints_name_file_line_column_and_the_way_out() {
    for (from, to, start, hint) in [
        ("active_teeth = 10", "active_teeth = 0", "shop/job.toml:4:", "at least one"),
        ("\"112.701324 mm\"", "\"112 furlongs\"", "shop/job.toml:4:", "is no length"),
        ("\"112.701324 mm\"", "6", "shop/job.toml:4:", "less than outer_radius"),
        ("rev_per_min = 1000", "rev_per_min = -5", "shop/job.toml:5:", "must be positive"),
        ("\"circumference\"", "\"contuor\"", "shop/job.toml:7:", "\"circumference\""),
        ("\"circumference\"", "\"contour\"", "shop/job.toml:7:", "needs an end-mill"),
        ("side = \"outer\"", "side = \"left\"", "shop/job.toml:", "outer"),
        ("offset = 1", "ofset = 1", "shop/job.toml:12:", "ofset"),
        ("normal_deg = 90.0, ", "", "shop/job.toml:12:", "give the stock as"),
        ("normal_deg = 90.0, offset = 1", "polygon = [[0, 0], [1, 0]]", "shop/job.toml:12:", "3 to 8 corners"),
        ("program = \"slot.nc\"", "", "shop/job.toml:", "program"),
    ] {
        let error = parse(&JOB.replace(from, to)).unwrap_err();
        assert!(error.starts_with(start) && error.contains(hint), "{error}");
    }
}

/// The job with this law and these lines in its rule.
fn with_tables(law: &str, rule: &str) -> Result<JobFile, String> {
    let text = JOB.replace("kind = \"circumference\"", law);
    parse(&text.replace("stock = { normal_deg = 90.0, offset = 1 }", rule))
}

#[test]
fn engaged_arcs_are_those_of_the_rules_side_and_then_of_the_other_circle() {
    let side = "kind = \"engaged-arc\", edges = \"side\"";
    let one = with_tables(side, "stock = { engaged = [[0, -10, 45.5], [\"25.4 mm\", 0, 60]] }").unwrap();
    let both = "stock = { engaged = [[0, -10, 45.5, 150, 210], [1, 0, 60, 0, 0]] }";
    let both = with_tables("kind = \"engaged-arc\"", both).unwrap();
    let knots = |file: &JobFile| match &file.job.rules[0].work {
        Work::Ring(_, Stock::Engaged(table)) => table.knots().to_vec(),
        other => panic!("{other:?}"),
    };
    for file in [&one, &both] {
        let paths: Vec<f32> = knots(file).iter().map(|knot| knot.travelled.0).collect();
        let outer: Vec<[f64; 2]> = knots(file).iter().map(|knot| knot.outer.degrees()).collect();
        assert_eq!((paths, outer), (vec![0.0, 25.4], vec![[-10.0, 45.5], [0.0, 60.0]]));
    }
    assert_eq!([&one, &both].map(|file| knots(file)[0].inner.degrees()), [[0.0, 0.0], [150.0, 210.0]]);
}

#[test]
fn each_rule_finds_its_own_feeds() {
    let rule = |n: u32, feed: f64| {
        format!(
            "n = [{n}, {n}]\ntable = [[0, {feed}], [1, \"0.2 mm\"]]\n[[cut]]\nrotation = \"interior\"\ndirection = \"cw\"\n\
             side = \"inner\"\ntable = [[0.5, {n}]]"
        )
    };
    let job = with_tables("kind = \"table\"", &rule(7, 0.01)).unwrap().job;
    let feeds = |rule: usize| {
        let table = job.knots.table(job.rules[rule].table.unwrap());
        table.iter().map(|(path, feed)| (path.0, feed.0)).collect::<Vec<_>>()
    };
    assert_eq!(feeds(0), [(0.0, 0.254), (25.4, 0.2)]);
    assert_eq!(feeds(1), [(12.7, 7.0 * 25.4)]);
    assert_eq!(job.rules[0].work, Work::Ring(arcfeed_model::tool::Edge::Outer, Stock::everywhere()));
}

#[test]
fn tables_that_make_no_sense_are_refused_at_their_row() {
    let engaged = |law: &str, rows: &str| with_tables(law, &format!("stock = {{ engaged = [\n{rows}] }}")).unwrap_err();
    let (both, side) = ("kind = \"engaged-arc\"", "kind = \"engaged-arc\", edges = \"side\"");
    let many: String = (0..17).map(|i| format!("[{i}, 0, 90],\n")).collect();
    for (law, rows, place, hint) in [
        (both, "[0, 0, 90]", ":13:1: ", "[path, from, to, from, to]"),
        (side, "[0, 0, 90],\n[0, 0, 90]", ":14:1: ", "must grow"),
        (side, "[0, 0, 90],\n  [1, -300, 90]", ":14:3: ", "between -360 and 360"),
        (side, "[0, 0, \"1 mm\"]", ":13:1: ", "without a unit"),
        (side, "[0, nan, 1]", ":13:5: ", "a number"),
        (side, "[0, 90]", ":13:1: ", "[path, from, to]"),
        (side, "", ":12:21: ", "1 to 16 knots"),
        (side, &many, ":12:21: ", "1 to 16 knots"),
        ("kind = \"circumference\"", "[0, 0, 90]", ":12:21: ", "engaged-arc"),
    ] {
        let error = engaged(law, rows);
        assert!(error.contains(place) && error.contains(hint), "{rows}: {error}");
    }
    let feeds = |law: &str, rows: &str| with_tables(law, &format!("table = [\n{rows}]")).unwrap_err();
    let many: String = (0..33).map(|i| format!("[{i}, 1], ")).collect();
    for (rows, place, hint) in [
        ("[1, 0.1],\n[1, 0.1]", ":14:1: ", "must grow"),
        ("[0, 0.1], [1, 0]", ":13:11: ", "must be positive"),
        (&many, ":12:9: ", "1 to 32 knots"),
    ] {
        let error = feeds("kind = \"table\"", rows);
        assert!(error.contains(place) && error.contains(hint), "{rows}: {error}");
    }
    let unused = with_tables("kind = \"circumference\"", "stock = { disc = [0, 0, 1] }\ntable = [[0, 1]]").unwrap_err();
    assert!(unused.contains(":13:9: `table` is for the table law"), "{unused}");
    let missing = with_tables("kind = \"table\"", "").unwrap_err();
    assert!(missing.contains("in every rule"), "{missing}");
    let full = many.trim_end_matches("[32, 1], ");
    let rule = |n: u32| {
        format!(
            "table = [{full}]\n[[cut]]\nrotation = \"interior\"\ndirection = \"cw\"\nside = \"inner\"\nn = [{n}, {n}]\n"
        )
    };
    let crowded = with_tables("kind = \"table\"", &format!("{}{}table = [[0, 1]]", rule(1), rule(2))).unwrap_err();
    assert!(crowded.contains("at most 64 knots"), "{crowded}");
}

#[test]
fn limits_that_make_no_sense_are_refused_where_they_stand() {
    let with = |line: &str| parse(&format!("{JOB}\n[override]\n{line}\n")).unwrap_err();
    assert!(with("min = 120").contains(":15:7: min must"));
    assert!(with("max = 255").contains(":15:7: max must"));
    assert!(with("mode = \"rewrite\"").contains(":15:8: no such mode"));
    assert!(
        with("mode = \"rewrite-only\"\npiece_step = 0").contains(":16:14: piece_step must lie between 0.1 and 50 %")
    );
    assert!(with("mode = \"rewrite-only\"\npiece_hysteresis = 51").contains(":16:20: piece_hysteresis must"));
    assert!(with("mode = \"rewrite-only\"\npiece_length = 0").contains(":16:16: piece_length must be a positive"));
    assert!(with("mode = \"rewrite-only\"\npieces_max = 0").contains(":16:14: pieces_max must lie between 1 and 250"));
    assert!(with("piece_length = 1").contains(":15:16: this mode cuts no arc"));
}

#[test]
fn the_control_is_one_of_three() {
    let with = |preset: &str| parse(&format!("{}\n[control]\npreset = \"{preset}\"", JOB));
    for (preset, control) in
        [("fanuc-16i", ControlKind::Fanuc16i), ("fanuc-0i", ControlKind::Fanuc0i), ("fanuc-31i", ControlKind::Fanuc31i)]
    {
        assert_eq!(with(preset).unwrap().control, control);
    }
    assert_eq!(parse(JOB).unwrap().control, ControlKind::Fanuc16i);
    assert!(with("fanuc-6").unwrap_err().contains("fanuc-31i"));
}

#[test]
fn the_line_has_pyserials_names_and_refuses_what_a_sender_cannot_mean() {
    let with = |line: &str| parse(&format!("{JOB}[serial]\n{line}\n"));
    let timeout = |line: &str| with(line).unwrap().serial.write_timeout();
    let ms = |ms| Some(arcfeed_units::Micros::from_ms(ms));
    assert_eq!((timeout(""), timeout("rtscts = true")), (ms(5_000), None));
    assert_eq!((timeout("write_timeout = 0.25"), timeout("rtscts = true\nwrite_timeout = 60")), (ms(250), ms(60_000)));
    assert!(with("").unwrap().serial.exclusive && !with("exclusive = false").unwrap().serial.exclusive);
    let flow = |line: &str| with(line).map(|file| (file.serial.xonxoff, file.serial.rtscts)).unwrap();
    assert_eq!(
        (flow(""), flow("rtscts = true"), flow("xonxoff = false")),
        ((true, false), (false, true), (false, false))
    );
    for (line, hint) in [
        ("rtscts = true\nxonxoff = true", "keep the one"),
        ("dsrdtr = true", "rtscts = true"),
        ("timeout = 1", "remove it"),
        ("inter_byte_timeout = 0.1", "remove it"),
        ("write_timeout = 0", "more than 0"),
        ("parity = \"M\"", "\"E\""),
        ("stopbits = 3", "1 to 2"),
    ] {
        let error = with(line).unwrap_err();
        assert!(error.contains(hint) && error.contains("job.toml:"), "{line}: {error}");
    }
}

const TWO_TOOLS: &str = r#"
units = "mm"
program = "two.nc"
spindle = { rev_per_min = 8000 }
law = { kind = "contour", feed_per_tooth = 0.05 }
limits = { max_feed = 3000 }
[[tool]]
number = 1
kind = "end-mill"
diameter = 10
teeth = 4
[[tool.cut]]
moves = "arcs"
direction = "ccw"
side = "inside"
radial_depth = 0.5
[[tool]]
number = 7
kind = "cup-mill"
outer_radius = 50
inner_radius = 40
active_teeth = 5
spindle = { rev_per_min = 900, set_by = "operator" }
law = { kind = "circumference", feed_per_tooth = 0.1 }
[[tool.cut]]
rotation = "interior"
direction = "cw"
side = "outer"
stock = { normal_deg = 90, offset = 3 }
"#;

#[test]
fn several_tools_have_laws_speeds_and_rules_of_their_own_or_the_jobs() {
    let file = parse(TWO_TOOLS).unwrap();
    let tools: Vec<_> = file.job.tools.iter().map(|setup| (setup.number, setup.law, setup.spindle.0)).collect();
    let contour = LawKind::Contour { inside_only: true, floor_ratio: 0.2 };
    assert_eq!(tools, [(Some(1), contour, 8_000.0), (Some(7), LawKind::Circumference, 900.0)]);
    let rules: Vec<_> = file.job.rules.iter().map(|rule| (rule.tool, file.job.feed_per_tooth_of(rule).0)).collect();
    assert_eq!(rules, [(0, 0.05), (1, 0.1)]);
    assert_eq!(file.rule_places, [[12, 1], [25, 1]]);
}

#[test]
fn several_tools_that_cannot_be_distinguished_are_refused() {
    let many =
        (0..9).map(|number| format!("[[tool]]\nnumber = {number}\nkind = \"end-mill\"\ndiameter = 9\nteeth = 2\n"));
    let [before, _] = [0, 1].map(|part| TWO_TOOLS.split("[[tool]]").nth(part).expect("its tables"));
    for (text, place, message) in [
        (TWO_TOOLS.replace("number = 7\n", ""), ":18:8: ", "of several tools each needs `number`"),
        (TWO_TOOLS.replace("number = 7", "number = 1"), ":18:10: ", "another [[tool]] has this number"),
        (TWO_TOOLS.to_owned() + "[[cut]]\nmoves = \"lines\"\nside = \"slot\"\n", ":30:1: ", "write [[tool.cut]]"),
        (TWO_TOOLS.replace("spindle = { rev_per_min = 8000 }\n", ""), ":8:8: ", "the tool has no [spindle]"),
        (
            TWO_TOOLS.replace("law = { kind = \"contour\", feed_per_tooth = 0.05 }\n", ""),
            ":8:8: ",
            "the tool has no [law]",
        ),
        (TWO_TOOLS.replace("limits = { max_feed = 3000 }\n", ""), ":5:16: ", "no fastest feed"),
        (before.to_owned() + &many.collect::<String>(), ":49:8: ", "at most 8 tools"),
    ] {
        let complaint = parse(&text).expect_err(message);
        assert!(complaint.contains(place) && complaint.contains(message), "{place}{message}: {complaint}");
    }
}

#[test]
fn the_programmed_feed_is_a_target_of_the_contour_law_in_pieces_alone() {
    let job = "units = \"mm\"\nprogram = \"p.nc\"\ntool = { kind = \"end-mill\", diameter = 10, height = 9 }\n\
               spindle = { rev_per_min = 900 }\nlaw = { kind = \"contour\", feed_per_tooth = \"programmed\" }\n\
               override = { mode = \"rewrite-only\" }\n";
    let setup = *parse(job).unwrap().job.tools.first();
    assert!(setup.follows_program && setup.tool.active_teeth() == 1);
    let cut = "workpiece = { block = { from = [0, 0, 0], to = [9, 9, 9] }, step = 1 }\n\
               cutting = { kc11 = 700, mc = 0.2, radial = 0.3, axial = 0.1, axial_depth = 1 }\n";
    let power = "workpiece = { block = { from = [0, 0, 0], to = [9, 9, 9] }, step = 1, material = \"Ti-6Al-4V\" }\n";
    for (text, message) in [
        (job.replace("\"contour\"", "\"engagement\""), "only the contour law"),
        (job.replace("rewrite-only", "safe-base"), "needs [override] mode"),
        (job.to_owned() + cut, "[cutting] needs a feed per tooth"),
        (job.to_owned() + power, "the estimate of the power needs the feed per tooth"),
    ] {
        let complaint = parse(&text).expect_err(message);
        assert!(complaint.contains(message), "{complaint}");
    }
}
