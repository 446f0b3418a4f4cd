//! Generates the linker scripts and the example job of the image.

#[path = "../qemu-mps2/build/example.rs"]
mod example;

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

/// All sources of the image's generated parts.
const SOURCES: [&str; 4] = ["../../../examples/ibr-slot", "memory.x", "../qemu-mps2/recorded.x", "../qemu-mps2/build"];

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo names the folder"));
    fs::copy("memory.x", out.join("memory.x")).expect("the memory lies beside this file");
    fs::copy("../qemu-mps2/recorded.x", out.join("recorded.x")).expect("the other board has the job's section");
    println!("cargo:rustc-link-search={}", out.display());
    for argument in ["-Tlink.x", "-Trecorded.x", "--nmagic"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
    for source in SOURCES {
        println!("cargo:rerun-if-changed={source}");
    }
    let module = example::module("ibr_slot", Path::new("../../../examples/ibr-slot/job.toml"), &out);
    fs::write(out.join("example.rs"), module).expect("the example is written");
}
