//! Reports of large programs: their size, and the pictures a second of the viewer beside those of a small one.

use std::fmt::Write as _;

use arcfeed_tests::{Scratch, of_full_set, run};

use super::{has_browser, has_node, node};

/// Job of [`rows`], without its program.
pub const JOB: &str = "units = \"mm\"\n[tool]\nkind = \"end-mill\"\ndiameter = 6\nteeth = 2\n[spindle]\nrev_per_min = 8000\n\
                   [law]\nkind = \"contour\"\nfeed_per_tooth = 0.075\n[limits]\nmax_feed = 3000\n[override]\nmode = \"rewrite-only\"\n[[cut]]\nmoves = \"arcs\"\nside = \"inside\"\ndirection = \"ccw\"\n";
/// Lines of a row, before the arc to the next one.
const ROW: usize = 200;
/// Most bytes of the report of a program of 100 000 blocks.
const BYTES_MAX: u64 = 10_000_000;
/// Most time of a picture of 100 000 blocks over that of 1 000.
const FRAME_RATIO_MAX: f64 = 3.0;

/// Rows of lines of 0.5 mm on a wavy surface, joined by arcs that a rule governs.
pub fn rows(blocks: usize) -> String {
    let mut text = String::from("%\nG21G17G90G94\nS8000M3\nG0X0.Y0.Z5.\nG1Z0.F1200.\n");
    for block in 0..blocks {
        let (row, place) = (block / ROW, block % ROW);
        let ahead = row % 2 == 0;
        let x = 0.5 * if ahead { place as f64 } else { (ROW - 1 - place) as f64 };
        let y = 0.6 * row as f64;
        let z = libm::sin(x / 7.0) * libm::cos(y / 5.0);
        let _ = if place == 0 && row > 0 {
            writeln!(text, "{}X{x:.3}Y{y:.3}R.3", if ahead { "G2" } else { "G3" })
        } else {
            writeln!(text, "G1X{x:.3}Z{z:.3}")
        };
    }
    text + "G0Z5.\nM30\n%\n"
}

#[test]
fn the_report_of_a_large_program_is_small_and_stays_fluid() {
    let test = "page-scale";
    if !(has_node(test) && has_browser(test)) {
        return;
    }
    let scratch = Scratch::new(test);
    let sizes: &[usize] = of_full_set(&[1_000, 100_000, 10_000, 1_000_000], &[1_000, 100_000]);
    let reports: Vec<String> = sizes
        .iter()
        .map(|blocks| {
            scratch.write("program.nc", rows(*blocks));
            let job = scratch.write("job.toml", format!("program = \"program.nc\"\n{JOB}"));
            let page = scratch.path(&format!("{blocks}.html"));
            let output = run(&["simulate", &job, "--json", "--report", &page]);
            assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
            println!("{blocks} blocks: {} bytes", std::fs::metadata(&page).expect("a report").len());
            page
        })
        .collect();
    assert!(std::fs::metadata(&reports[1]).expect("a report").len() <= BYTES_MAX);
    let arguments: Vec<&str> = std::iter::once("test/scale.mjs").chain(reports.iter().map(String::as_str)).collect();
    let figures = node(&arguments);
    println!("{figures}");
    let ratios: Vec<f64> = serde_json::from_str(figures.lines().last().expect("a line")).expect("ratios");
    assert!(ratios[1] <= FRAME_RATIO_MAX, "{figures}");
}
