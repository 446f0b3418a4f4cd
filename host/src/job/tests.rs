use super::*;
use arcfeed_shared::cut::Work;
use arcfeed_shared::stock::StockLine;

const JOB: &str = r#"
units = "inch"
program = "slot.nc"
tool = { kind = "cup-mill", outer_radius = 5.06205, inner_radius = "112.701324 mm", active_teeth = 10 }
spindle = { rev_per_min = 1000 }
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
    assert_eq!(file.job.tool, Tool::CupMill(CupMill { outer_radius, inner_radius, active_teeth: 10 }));
    assert_eq!(file.job.feed_per_tooth, MmPerTooth(0.1016));
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
fn a_line_through_two_points_has_the_material_on_its_left() {
    let text = JOB.replace("normal_deg = 90.0, offset = 1", "from = [0, 1], to = [-5, 1]");
    let stock = stock_line(&parse(&text).unwrap());
    assert!((stock.normal[1] - 1.0).abs() < 1e-15 && (stock.offset_mm - 25.4).abs() < 1e-12);
    assert!(stock.distance_mm([0.0, 0.0]) > 0.0);
}

#[test]
fn complaints_name_file_line_column_and_the_way_out() {
    for (from, to, start, hint) in [
        ("active_teeth = 10", "active_teeth = 0", "shop/job.toml:4:", "at least one"),
        ("\"112.701324 mm\"", "\"112 furlongs\"", "shop/job.toml:4:", "is no length"),
        ("\"112.701324 mm\"", "6", "shop/job.toml:4:", "less than outer_radius"),
        ("rev_per_min = 1000", "rev_per_min = -5", "shop/job.toml:5:", "must be positive"),
        ("\"circumference\"", "\"contuor\"", "shop/job.toml:6:", "\"circumference\""),
        ("\"circumference\"", "\"contour\"", "shop/job.toml:6:", "needs an end-mill"),
        ("side = \"outer\"", "side = \"left\"", "shop/job.toml:", "outer"),
        ("offset = 1", "ofset = 1", "shop/job.toml:11:", "ofset"),
        ("normal_deg = 90.0, ", "", "shop/job.toml:11:", "give the stock as"),
        ("normal_deg = 90.0, offset = 1", "polygon = [[0, 0], [1, 0]]", "shop/job.toml:11:", "3 to 8 corners"),
        ("program = \"slot.nc\"", "", "shop/job.toml:", "program"),
    ] {
        let error = parse(&JOB.replace(from, to)).unwrap_err();
        assert!(error.starts_with(start) && error.contains(hint), "{error}");
    }
}

#[test]
fn limits_that_make_no_sense_are_refused_where_they_stand() {
    let with = |line: &str| parse(&format!("{JOB}\n[override]\n{line}\n")).unwrap_err();
    assert!(with("min = 120").contains(":14:7: min must"));
    assert!(with("max = 255").contains(":14:7: max must"));
    assert!(with("mode = \"rewrite-only\"").contains(":14:8: "));
}
