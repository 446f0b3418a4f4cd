//! The linker's scripts, and the example job as the images carry it.
//!
//! The job is run on the simulated machine here, at build time: what the images measure is the example as it is today.

#[path = "build/example.rs"]
mod example;

use std::env;
use std::fs;
use std::path::PathBuf;

/// What goes into the image does not depend on more than these.
const SOURCES: [&str; 4] = ["../../../examples/ibr-slot", "memory.x", "device.x", "build"];

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo names the folder"));
    for script in ["memory.x", "device.x"] {
        fs::copy(script, out.join(script)).expect("the linker's scripts lie beside this file");
    }
    println!("cargo:rustc-link-search={}", out.display());
    for argument in ["-Tlink.x", "--nmagic"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
    for source in SOURCES {
        println!("cargo:rerun-if-changed={source}");
    }
    example::write("../../../examples/ibr-slot/job.toml".as_ref(), &out);
}
