//! The linker's scripts, and the example jobs as the images carry them.
//!
//! The jobs are run on the simulated machine here, at build time: what the images measure is the examples as they are
//! today.

#[path = "build/example.rs"]
mod example;

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

/// What goes into the image does not depend on more than these.
const SOURCES: [&str; 5] = [EXAMPLES, "memory.x", "device.x", "recorded.x", "build"];
const EXAMPLES: &str = "../../../examples";
/// The name of an example in the images, and its job.
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
