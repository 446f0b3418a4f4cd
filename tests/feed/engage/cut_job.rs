//! A job with an engagement map, made of its parts.

use arcfeed_tests::{Scratch, run};

/// Between the rays of the workpieces here.
pub const STEP_MM: f64 = 0.25;
/// Wanted feed per tooth.
pub const CHIP_MM: f64 = 0.05;

/// One cut.
pub struct Cut<'a> {
    pub name: &'a str,
    pub tool: &'a str,
    pub workpiece: &'a str,
    pub rule: &'a str,
    pub program: &'a str,
}

/// A row of a map: path, mm; from and to of the outer and the inner circle, degrees.
pub type Row = [f64; 5];

pub const MILL: &str = "kind = \"end-mill\"\ndiameter = 10\nteeth = 4\nheight = 8";
pub const RING: &str = "kind = \"cup-mill\"\nouter_radius = 20\ninner_radius = 15\nactive_teeth = 4\nheight = 8";

impl Cut<'_> {
    /// Writes job and program, and makes the map.
    pub fn engaged(&self) -> (Scratch, String) {
        let scratch = Scratch::new(&format!("engage-{}", self.name));
        scratch.write("program.nc", self.program);
        let Cut { tool, workpiece, rule, .. } = self;
        let job = scratch.write(
            "job.toml",
            format!(
                "units = \"mm\"\nprogram = \"program.nc\"\n[tool]\n{tool}\n[workpiece]\n{workpiece}\nstep = {STEP_MM}\n\
                 [spindle]\nrev_per_min = 3000\nset_by = \"operator\"\n[limits]\nmax_feed = \"90000 mm\"\nmax_raise = 100\n[law]\nkind = \"engaged-arc\"\nfeed_per_tooth = {CHIP_MM}\n\
                 [[cut]]\n{rule}\nstock = {{ map = \"map.toml\" }}\n"
            ),
        );
        let output = run(&["engage", &job]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        (scratch, job)
    }

    /// The rows of each move.
    pub fn map(&self) -> Vec<Vec<Row>> {
        let (scratch, _) = self.engaged();
        rows(&std::fs::read_to_string(scratch.path("map.toml")).expect("a map"))
    }
}

/// The rows of each move of a map.
pub fn rows(map: &str) -> Vec<Vec<Row>> {
    let row = |line: &str| -> Row {
        let numbers = line.trim().trim_start_matches('[').trim_end_matches("],").split(", ");
        let numbers: Vec<f64> = numbers.map(|number| number.parse().expect("a number")).collect();
        numbers.try_into().expect("five of them")
    };
    let rows_of = |part: &str| part.lines().filter(|line| line.starts_with("    [")).map(row).collect();
    map.split("[[move]]").skip(1).map(rows_of).collect()
}

/// From and to of a circle (0 the outer one) after a path, as a law reads them.
pub fn read(rows: &[Row], circle: usize, path_mm: f64) -> [f64; 2] {
    let next = rows.partition_point(|row| row[0] <= path_mm).clamp(1, rows.len() - 1);
    let (a, b) = (rows[next - 1], rows[next]);
    let part = ((path_mm - a[0]) / (b[0] - a[0])).clamp(0.0, 1.0);
    [1, 2].map(|end: usize| a[end + 2 * circle] + (b[end + 2 * circle] - a[end + 2 * circle]) * part)
}
