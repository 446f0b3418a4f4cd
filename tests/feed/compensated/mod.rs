//! Laws along contours under G41 and G42: the feed at the contour, from the simulated control's own path, and the feeds of the
//! same path written without compensation.

mod executed;

mod written;

#[path = "../../rs274/compensated.rs"]
mod compensated_path;

#[path = "../../rs274/contours.rs"]
mod contours;

use arcfeed::adapt::{Adapted, Known, adapt_with};
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_tests::Scratch;
use arcfeed_units::Nm;

use contours::ContourProgram;

/// Programmed feed of all contours, mm/min.
const FEED: f64 = 500.0;
/// A contour with its job.
struct Case {
    scratch: Scratch,
    contour: ContourProgram,
}

impl Case {
    fn of_seed(name: &str, seed: u64) -> Self {
        Case { scratch: Scratch::new(&format!("{name}-{seed}")), contour: ContourProgram::of_seed(seed) }
    }

    /// Program with an N in each of these blocks.
    fn program(&self, blocks: &str) -> String {
        let blocks: String =
            blocks.lines().enumerate().map(|(index, block)| format!("N{}{block}\n", index + 1)).collect();
        format!("%\nO1\nG21G17G90G94\nS5000M3\n{blocks}M30\n%\n")
    }

    /// The job: the sides of counter-clockwise and clockwise arcs, and the lines of the settings file.
    fn job(&self, program: &str, [ccw, cw]: [&str; 2], mode: &str, settings: &str) -> (JobFile, Program, Adapted) {
        self.scratch.write("p.nc", program);
        self.scratch.write("machine.toml", format!("unit = 'mm'\n{settings}"));
        let target = if mode == "rewrite-only" { "'programmed'" } else { "0.05" };
        let text = format!(
            "units = 'mm'\nprogram = 'p.nc'\n[tool]\nkind = 'end-mill'\ndiameter = {}\nteeth = 2\n[spindle]\nrev_per_min = 5000\n\
             [law]\nkind = 'contour'\nfeed_per_tooth = {target}\ninside_only = false\n[limits]\nmax_feed = 5000\n\
             [override]\nmode = '{mode}'\n[control]\nsettings = 'machine.toml'\n\
             [[cut]]\nmoves = 'arcs'\ndirection = 'ccw'\nside = '{ccw}'\n[[cut]]\nmoves = 'arcs'\ndirection = 'cw'\nside = '{cw}'\n",
            2.0 * self.contour.radius_mm()
        );
        let file = JobFile::load(self.scratch.write("job.toml", text).as_ref()).expect("a job");
        let program = Program::parse_with(&file.program, program.as_bytes(), file.nc, file.tables);
        assert!(!program.has_errors(), "{:?}", program.diagnostics);
        let adapted = adapt_with(&program, &file.job, Known::of(&file));
        (file, program, adapted)
    }

    /// The tool's radius as that of the contour's D, whose number is twice the radius.
    fn radius(&self) -> String {
        format!("[radius]\n{} = {:?}\n", self.contour.d, self.contour.radius_mm())
    }

    fn is_left(&self) -> bool {
        self.contour.text.contains("G41")
    }

    /// Sides of counter-clockwise and clockwise arcs.
    fn sides(&self) -> [&'static str; 2] {
        if self.is_left() { ["inside", "outside"] } else { ["outside", "inside"] }
    }
}

fn point(pose: &[Nm; 3]) -> [f64; 2] {
    [pose[0], pose[1]].map(Nm::to_mm)
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}
