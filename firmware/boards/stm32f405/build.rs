//! Puts the linker's scripts where it finds them.

use std::env;
use std::fs;
use std::path::PathBuf;

/// The scripts with their folders; the other board has the section of the job.
const SCRIPTS: [(&str, &str); 2] = [(".", "memory.x"), ("../qemu-mps2", "recorded.x")];

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo names the folder"));
    for (folder, script) in SCRIPTS {
        let path = PathBuf::from(folder).join(script);
        fs::copy(&path, out.join(script)).expect("the linker's scripts are there");
        println!("cargo:rerun-if-changed={}", path.display());
    }
    println!("cargo:rustc-link-search={}", out.display());
    for argument in ["-Tlink.x", "-Trecorded.x", "--nmagic"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
}
