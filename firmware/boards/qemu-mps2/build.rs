//! Generates the linker scripts and the example jobs of the images.
//!
//! The jobs run on the simulated machine here, at build time, so that the images always measure the current examples.

#[path = "build/example.rs"]
mod example;

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

/// All sources of the image's generated parts.
const SOURCES: [&str; 5] = [EXAMPLES, "memory.x", "device.x", "recorded.x", "build"];
const EXAMPLES: &str = "../../../examples";
/// Names of the examples in the images, and their jobs.
const JOBS: [(&str, &str); 3] = [
    ("ibr_slot", "ibr-slot/job.toml"),
    ("pocket_contour", "pocket/job-contour.toml"),
    ("pocket_engagement", "pocket/job-engagement.toml"),
];

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo names the folder"));
    for script in ["memory.x", "device.x", "recorded.x"] {
        fs::copy(script, out.join(script)).expect("the linker's scripts lie beside this file");
    }
    println!("cargo:rustc-link-search={}", out.display());
    for argument in ["-Tlink.x", "-Tdefmt.x", "-Trecorded.x", "--nmagic"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
    // Read when the log's macros expand; errors only, if unset.
    println!("cargo:rustc-env=DEFMT_LOG=info");
    for source in SOURCES {
        println!("cargo:rerun-if-changed={source}");
    }
    let modules = JOBS.map(|(name, job)| example::module(name, &Path::new(EXAMPLES).join(job), &out));
    fs::write(out.join("examples.rs"), modules.concat()).expect("the examples are written");
}
