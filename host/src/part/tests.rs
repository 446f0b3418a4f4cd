use super::*;

const EXAMPLE: &str = include_str!("../../../examples/blisk-19/PART.toml");

fn parse(text: &str) -> Result<PartFile, FileError> {
    PartFile::parse(Path::new("shop/PART.toml"), text)
}

/// Message for the example with `old` replaced by `new`.
#[track_caller]
fn refused(old: &str, new: &str) -> String {
    assert!(EXAMPLE.contains(old), "{old}");
    parse(&EXAMPLE.replacen(old, new, 1)).expect_err(new).to_string()
}

/// Line of the example that begins with a word, counted from 1.
fn line_of(word: &str) -> usize {
    EXAMPLE.lines().position(|line| line.starts_with(word)).unwrap() + 1
}

#[test]
fn the_example_is_a_part() {
    let part = parse(EXAMPLE).unwrap();
    assert_eq!((part.name.as_str(), part.unit, part.blisk.blades), ("blisk-19", LengthUnit::Inch, 19));
    assert!((part.cutter.outer_radius_mm - 5.06205 * 25.4).abs() < 1e-9 && part.cutter.active_teeth == 10);
    assert!((part.roughing.allowance_mm - 0.889).abs() < 1e-9 && part.axis.is_none());
    assert!((part.roughing.clearance_mm, part.roughing.interior_contact) == (CLEARANCE_MM, INTERIOR_CONTACT));
    assert_eq!(part.feeds.axial_mm_per_min, Some(50.8));
    let [from, to] = part.blisk.blank.faces_mm;
    assert_eq!(part.blisk.hub.profile_mm, [[from, 70.0], [to, 70.0]]);
    assert!(part.machine.is_some() && part.baseline.is_some_and(|baseline| baseline.teeth == 3));
    assert_eq!(part.output, Output { unit: LengthUnit::Inch, number: 1546, tool: 1, coolant: true, dprnt: false });
}

#[test]
fn what_is_wrong_is_reported_with_its_place() {
    let message = refused("inner_radius = 4.43706", "inner_radius = 5.1");
    let line = line_of("inner_radius");
    assert_eq!(
        message,
        format!(
            "shop/PART.toml:{line}:16: inner_radius must be less than outer_radius (found `cutter.inner_radius = 5.1`)"
        )
    );
    let message = refused("insert_radius = 0.03", "insert_radius = 0.4");
    assert!(message.contains(":17: insert_radius must be 0 to half"), "{message}");
    assert!(refused("cavity_depth = 1.5", "cavity_depth = 2").contains("cavity_depth must be less than height"));
    assert!(refused("active_teeth = 10", "active_teeth = 0").contains("at least one tooth"));
    assert!(refused("[[2.0, 4.0]]", "[[2.0, 0]]").contains("[radius, length], both positive"));
    assert!(refused("to = \"14 mm\"", "to = \"-20 mm\"").contains("`to` must lie above `from`"));
    assert!(refused("allowance = 0.035", "allowance = -1").contains("allowance must be a positive length"));
    assert!(refused("axial_feed = 2", "axial_fed = 2").contains("unknown field `axial_fed`"));
    assert!(refused("blades = 19", "blades = 1").contains("a rotor has 2 to 1000 blades"));
    assert!(refused("camber_deg = [14, 10]", "camber_deg = [14, 0]").contains("camber_deg must be positive"));
    assert!(refused("number = 1546", "number = 12345").contains("number must be 1 to 9999"));
    assert!(refused("hu80a-5x\"", "hu80a\"").contains("no such machine"));
    let boxed = format!("{EXAMPLE}\n[[fixture]]\nfrom = [0, 0, 0]\nto = [1, 1, -1]\n");
    assert!(parse(&boxed).unwrap_err().to_string().contains("a fixture's `to` must lie above its `from`"));
}

#[test]
fn a_rotor_comes_from_exactly_one_place() {
    let both = refused("[blank]", "sections = { file = \"a.csv\", blades = 19, hub_radius = 3 }\n[blank]");
    assert!(both.contains("exactly one of `generate`, `curves`, `sections`, `stl` or `step`"), "{both}");
}

/// The example with its rotor from files in a folder.
fn with_files(folder: &Path, geometry: &str) -> Result<PartFile, FileError> {
    let lines = EXAMPLE.lines().map(|line| if line.starts_with("generate") { geometry } else { line });
    PartFile::parse(&folder.join("PART.toml"), &lines.collect::<Vec<_>>().join("\n"))
}

#[test]
fn files_are_read_beside_the_part_and_their_faults_are_reported_there() {
    let folder = tempfile::tempdir().unwrap();
    let table = include_str!("../../../tests/plan/blisk_sections.csv");
    std::fs::write(folder.path().join("rotor.csv"), table).unwrap();
    let geometry =
        "sections = { file = \"rotor.csv\", blades = 19, axis = \"y\", units = \"mm\", hub_radius = \"70 mm\" }";
    let part = with_files(folder.path(), geometry).unwrap();
    let example = parse(EXAMPLE).unwrap();
    let off_mm = (part.blisk.pressure.point(0.3, 0.7) - example.blisk.pressure.point(0.3, 0.7)).norm();
    assert!(off_mm < 1e-5, "{off_mm}");
    std::fs::write(folder.path().join("rotor.csv"), table.replacen("PS,3,-5.907565", "PS,3,no", 1)).unwrap();
    let message = with_files(folder.path(), geometry).unwrap_err().to_string();
    assert!(message.ends_with("rotor.csv:5:21: `no` is no number"), "{message}");
    let message = with_files(folder.path(), &geometry.replace("rotor.csv", "other.csv")).unwrap_err().to_string();
    assert!(
        message.contains(&format!("PART.toml:{}:21: ", line_of("generate"))) && message.contains("other.csv"),
        "{message}"
    );
}

#[test]
fn too_many_levels_are_refused_before_the_files_of_the_rotor_are_read() {
    let missing = "sections = { file = \"none.csv\", blades = 19, hub_radius = \"70 mm\" }";
    let lines = EXAMPLE.lines().map(|line| if line.starts_with("generate") { missing } else { line });
    let text = lines.collect::<Vec<_>>().join("\n");
    assert!(parse(&text).unwrap_err().to_string().contains("none.csv"));
    let message = parse(&text.replace("axial_depth_max = 0.1", "axial_depth_max = 0.0001")).unwrap_err().to_string();
    assert!(message.contains("with levels of 0.0025 mm") && message.contains("0.099 mm at least"), "{message}");
}
