//! The linker's scripts, and the example job as the images carry it.
//!
//! The job is run on the simulated machine here, at build time: what the images measure is the example as it is today.

#[path = "build/example.rs"]
mod example;

use std::env;
use std::fs;
use std::path::PathBuf;

/// What goes into the image does not depend on more than these.
const SOURCES: [&str; 5] = ["../../../examples/ibr-slot", "memory.x", "device.x", "recorded.x", "build"];

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
    example::write("../../../examples/ibr-slot/job.toml".as_ref(), &out);
}
