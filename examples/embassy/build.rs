//! Puts the linker's scripts where it finds them.

use std::path::PathBuf;
use std::{env, fs};

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets the folder"));
    fs::copy("memory.x", out.join("memory.x")).expect("memory.x lies beside this file");
    // The vector table in src/time.rs names its handlers itself.
    fs::write(out.join("device.x"), "").expect("the folder is cargo's");
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rerun-if-changed=memory.x");
    for argument in ["-Tlink.x", "--nmagic"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
}
