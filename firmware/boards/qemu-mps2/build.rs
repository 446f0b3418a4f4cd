//! Puts the linker's scripts where it finds them.

use std::env;
use std::fs;
use std::path::PathBuf;

const SCRIPTS: [&str; 3] = ["memory.x", "device.x", "recorded.x"];

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo names the folder"));
    for script in SCRIPTS {
        fs::copy(script, out.join(script)).expect("the linker's scripts lie beside this file");
        println!("cargo:rerun-if-changed={script}");
    }
    println!("cargo:rustc-link-search={}", out.display());
    for argument in ["-Tlink.x", "-Tdefmt.x", "-Trecorded.x", "--nmagic"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
    // Read when the log's macros expand; errors only, if unset.
    println!("cargo:rustc-env=DEFMT_LOG=info");
}
