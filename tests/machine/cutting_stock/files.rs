//! The page and the surface that a run leaves behind.

use std::fs::File;
use std::io::BufReader;

use arcfeed_dexel::files::read_stl;

use crate::cutting_stock::scratch_job::{MILL, SLOT, ScratchJob};

#[test]
fn a_page_needs_nothing_but_itself() {
    let job = ScratchJob::new("page", MILL, SLOT);
    let page = job.scratch.path("run.html");
    let first = job.run(&["--report", &page]);
    let html = std::fs::read_to_string(&page).expect("the page is there");
    let pictures = html.matches("data:image/png;base64,").count();
    println!("{} bytes, {pictures} pictures", html.len());
    let (viewer, figures) = html.split_once("<h2>Summary</h2>").expect("the figures are below the viewer");
    assert!(
        pictures == 1
            && figures.matches("<svg").count() == 2
            && figures.matches("<svg").count() == figures.matches("</svg>").count()
    );
    for part in ["<h2>Material</h2>", "removal rate, cm3/min", "override, %"] {
        assert!(figures.contains(part), "{part}");
    }
    let outside = figures.replace("http://www.w3.org/2000/svg", "");
    assert!(!outside.contains("http") && !outside.contains("<script") && !outside.contains("<link"));
    assert!(!outside.contains("NaN") && !outside.contains("inf"), "a number is none");
    // The viewer must not load anything either; `tests/line/report_page` looks at the requests of a browser.
    assert!(viewer.contains("default-src 'none'") && !viewer.contains("<link") && !viewer.contains("<script src"));
    let again = job.run(&["--report", &page]);
    assert_eq!(first.report["material"], again.report["material"]);
    assert!(!job.scratch.files().iter().any(|name| name.ends_with(".part")), "{:?}", job.scratch.files());
}

#[test]
fn a_job_without_a_workpiece_has_a_page_too_but_no_surface() {
    let job = MILL.split_once("[workpiece]").expect("its last table").0;
    let job = ScratchJob::new("without", job, SLOT);
    let page = job.scratch.path("run.html");
    assert!(job.run(&["--report", &page]).report["material"].is_null());
    assert!(std::fs::read_to_string(&page).expect("the page is there").contains("override, %"));
    let (code, words) = job.failed(&["--surface", &job.scratch.path("left.stl")]);
    assert!(code == Some(2) && words.contains("no [workpiece]"), "{code:?} {words}");
}

#[test]
fn a_surface_encloses_what_is_left_and_is_a_target_for_another_run() {
    let job = ScratchJob::new("surface", MILL, SLOT);
    let stl = job.scratch.path("left.stl");
    let left_cm3 = job.run(&["--surface", &stl]).material("/left");
    let mesh = read_stl(BufReader::new(File::open(&stl).expect("it is there"))).expect("a closed mesh");
    let off = mesh.volume_mm3() / 1e3 / left_cm3 - 1.0;
    println!("{left_cm3} cm3 left, the surface's off by {off:+.1e}");
    assert!(off.abs() < 1e-3);
    let ply = job.scratch.path("left.ply");
    job.run(&["--surface", &ply]);
    assert!(std::fs::read(&ply).expect("it is there").starts_with(b"ply\nformat binary_little_endian 1.0\n"));
    let (code, words) = job.failed(&["--surface", "left.obj"]);
    assert!(code == Some(2) && words.contains(".stl or .ply"), "{words}");

    let deeper = ScratchJob::new("deeper", &format!("{MILL}target = \"left.stl\"\n"), &SLOT.replace("Z-4.", "Z-4.5"));
    std::fs::copy(&stl, deeper.scratch.path("left.stl")).expect("a copy");
    let page = deeper.scratch.path("run.html");
    let output = deeper.run(&["--report", &page]);
    let [largest, x, y] = ["largest", "x", "y"].map(|field| output.material(&format!("/deviation/{field}")));
    println!("{largest} at {x}, {y}");
    let html = std::fs::read_to_string(&page).expect("the page is there");
    assert!(html.matches("data:image/png;base64,").count() == 2 && html.contains("<circle"));
    // A surface cuts edges off by up to a step, so on the slot's edge the first run's may be lower than the block.
    let from_edge = libm::hypot(x - x.clamp(0.013, 40.013), y - 0.021) - 5.0;
    assert!((largest + 0.5).abs() < 1e-6 || from_edge.abs() < 0.25, "{largest} at {x}, {y}: {from_edge}");
    assert!(output.material("/deviation/rms") > 0.5 * libm::sqrt(478.5 / 1200.0) * 0.98);
}
