//! The files whose values are corrupted, and what is found in them.

use std::ops::Range;
use std::path::{Path, PathBuf};

use arcfeed::job::JobFile;
use arcfeed::machine_file::MachineFile;
use arcfeed::part::PartFile;
use arcfeed::part::finish::FinishPart;
use arcfeed::part::plunge::PlungePart;
use arcfeed_tests::root;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Keys that no example has, of cup mills and of end mills.
pub const JOBS: [&str; 3] = [
    r#"units = "mm"
program = "p.nc"
tool = { kind = "cup-mill", outer_radius = "5 in", inner_radius = 110.5, active_teeth = 10, corner_radius = 0.5, height = 40, number = 3, axis = "x" }
workpiece = { round = { from = [0, 0, -40], to = [0, 0, -1], radius = 250, bore = 20 }, step = 1, memory_mib = 100 }
cutting = { kc11 = 1500, mc = 0.25, radial = 0.4, axial = 0.2, axial_depth = 2, layers = 3, runout = { eccentricity = 0.01, direction = 30 }, offsets = [0, 0.01, 0, 0.01, 0, 0.01, 0, 0.01, 0, 0.01], pitch = [36, 36, 36, 36, 36, 36, 36, 36, 36, 36], modes = [{ frequency = 400, damping = 0.03, stiffness = 20000, direction = [1, 0, 0] }] }
spindle = { rev_per_min = 1000, set_by = "operator", max_power = "11 kW", max_torque = "40 Nm" }
limits = { max_feed = 5000, max_raise = 3 }
law = { kind = "table", feed_per_tooth = 0.1 }
override = { mode = "rewrite-only", min = 10, max = 200, step = 1, slew_up = 50, slew_down = 200, piece_step = 1, piece_hysteresis = 2, piece_length = 2, pieces_max = 24 }
machine = { preset = "mikron-ucp710", max_feed = { x = 9000, y = 9000, z = 9000, a = 3600, b = 3600, c = 3600 } }
control = { preset = "fanuc-31i", arc_clamp = { feed = 5000, radius = 5, floor = 100 } }
serial = { baudrate = 19200, bytesize = 7, parity = "E", stopbits = 2, rtscts = true, write_timeout = 30 }
dnc = { reaction = 0.01, start_timeout = 60, xoff_timeout = 600, report_every = 20, read_ahead = 100 }
cut = [
    { rotation = "interior", direction = "cw", side = "outer", table = [[0, 0.1], [5, 0.2]], stock = { normal_deg = 90, offset = 3, rise = 0.5 }, n = [1, 9], z = [-5, 3] },
    { rotation = "interior", direction = "cw", side = "inner", table = [[0, 0.1]], stock = { from = [0, 1], to = [5, 1] }, feed_per_tooth = 0.2 },
    { rotation = "exterior", direction = "cw", side = "inner", table = [[0, 0.1]], stock = { lines = [[90, 3, 0.5]] } },
    { rotation = "exterior", direction = "ccw", side = "inner", table = [[0, 0.1]], stock = { polygon = [[0, 0], [9, 0], [0, 9]] } },
]
"#,
    r#"units = "inch"
program = "p.nc"
tool = { kind = "end-mill", diameter = 0.5, teeth = 4, corner_radius = 0.1, height = 2 }
spindle = { rev_per_min = 8000 }
limits = { max_feed = 200 }
law = { kind = "engaged-arc", feed_per_tooth = 0.004 }
[workpiece]
block = { from = [0, 0, -2], to = [5, 4, 0] }
step = 0.05
[workpiece.flexible]
block = { from = [0, 0, -2], to = [5, 4, 0], cells = [4, 5, 6], clamped = "z-" }
young = 210000
poisson = 0.3
density = 7850
modes = 5
damping = 0.02
[cutting]
cutting = [2000, 800, 200]
edge = [20, 10, 1]
axial_depth = 0.1
helix = 30
[[cut]]
moves = "arcs"
direction = "cw"
side = "outer"
stock = { disc = [0, 0, 3] }
n = [5, 90]
[[cut]]
moves = "lines"
side = "outer"
stock = { engaged = [[0, -10, 45.5], [1, 0, 60]] }
"#,
    r#"units = "mm"
program = "p.nc"
limits = { max_feed = 3000 }
law = { kind = "contour", feed_per_tooth = 0.05, floor = 20 }
[[tool]]
number = 1
kind = "end-mill"
diameter = 10
teeth = 4
spindle = { rev_per_min = 8000 }
[[tool.cut]]
moves = "lines"
side = "inside"
radial_depth = 0.5
n = [1, 9]
z = [-5, 3]
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
stock = { normal_deg = 90, offset = 3, rise = 0.5 }
feed_per_tooth = 0.2
"#,
];

/// Job, machine and part files of the examples, and the jobs above. The firmware there has none; files of repairs are tested in
/// `tests/plan/repair`, those of campaigns in `tests/line/campaigns.rs`.
pub fn files() -> Vec<(PathBuf, String)> {
    let mut folders = vec![root().join("examples"), root().join("host/adapt/machines")];
    let mut files = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("the examples can be read") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                let is_of_others = ["embassy", "campaigns"].iter().any(|name| path.ends_with(name));
                folders.extend((!is_of_others).then_some(path));
                continue;
            }
            let is_of_repairs = ["REPAIR.toml", "EDGE.toml", "TRAILING.toml"].iter().any(|name| path.ends_with(name));
            if !is_of_repairs && path.extension().is_some_and(|extension| extension == "toml") {
                files.push((path.clone(), std::fs::read_to_string(path).expect("text")));
            }
        }
    }
    assert!(files.len() >= 9, "{} files", files.len());
    files.extend(JOBS.iter().map(|job| (PathBuf::from("job.toml"), (*job).to_owned())));
    for (path, text) in &files {
        assert_eq!(refusal(path, text), None);
    }
    files
}

/// `line:column: ...`, if the file is refused.
pub fn refusal(path: &Path, text: &str) -> Option<String> {
    let stripped = |message: String| {
        let start = format!("{}:", path.display());
        message.strip_prefix(&start).unwrap_or_else(|| panic!("{message}")).to_owned()
    };
    if text.contains("[[rotary]]") {
        MachineFile::parse(text).err()
    } else if text.contains("[geometry") {
        // One file may have the tools of all planners.
        let for_cup_mill = text.contains("[cutter").then(|| PartFile::parse(path, text).err()).flatten();
        let for_plunges = || text.contains("[plunge").then(|| PlungePart::parse(path, text).err()).flatten();
        let for_finishing = || text.contains("[finish").then(|| FinishPart::parse(path, text).err()).flatten();
        for_cup_mill.or_else(for_plunges).or_else(for_finishing).map(|error| stripped(error.to_string()))
    } else {
        JobFile::parse(path, text).err().map(|error| stripped(error.to_string()))
    }
}

/// A value or the name of a key.
pub struct Item {
    pub key: String,
    pub span: Range<usize>,
    pub is_number: bool,
    /// Range of its key, if it has its own.
    pub name: Option<Range<usize>>,
}

pub fn items(text: &str) -> Vec<Item> {
    let mut found = Vec::new();
    collect_table("", DeTable::parse(text).expect("TOML").get_ref(), &mut found);
    found
}

fn collect_table(prefix: &str, table: &DeTable<'_>, found: &mut Vec<Item>) {
    for (name, value) in table {
        collect(format!("{prefix}{}", name.get_ref()), Some(name.span()), value, found);
    }
}

fn collect(key: String, name: Option<Range<usize>>, value: &Spanned<DeValue<'_>>, found: &mut Vec<Item>) {
    let inside = format!("{key}.");
    let is_number = matches!(value.get_ref(), DeValue::Integer(_) | DeValue::Float(_));
    found.push(Item { key, span: value.span(), is_number, name });
    match value.get_ref() {
        DeValue::Table(table) => collect_table(&inside, table, found),
        DeValue::Array(values) => {
            for (index, value) in values.iter().enumerate() {
                collect(format!("{inside}{}", index + 1), None, value, found);
            }
        }
        _ => {}
    }
}

pub fn replaced(text: &str, span: &Range<usize>, by: &str) -> String {
    format!("{}{by}{}", &text[..span.start], &text[span.end..])
}

pub fn line(text: &str, offset: usize) -> usize {
    text[..offset].matches('\n').count() + 1
}

/// Whether an error message names the key, or the table or list that contains it.
pub fn names(complaint: &str, key: &str) -> bool {
    let parts: Vec<&str> = key.split('.').collect();
    (1..=parts.len()).any(|count| {
        let key = parts[..count].join(".");
        complaint.contains(&format!("`{key}`")) || complaint.contains(&format!("`{key} ="))
    })
}
