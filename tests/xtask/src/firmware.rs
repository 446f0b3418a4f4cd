//! The firmware for the chip: it compiles, from the crates it may have, and needs nothing but `core`.
//!
//! It is checked against a copy of the target's library folder with only `core` and `compiler_builtins`, which proves that
//! nothing uses `std` or `alloc`: an `extern crate alloc` anywhere in the tree, in our crates or in theirs, cannot
//! be resolved there, and the compiler names the line. Machine code of it is in the images of the boards.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::command::{Failure, announce, build_dir, cargo, output, program, run};
use crate::target::{TARGET, build_folder};

/// Crates that may run on the chip. Before adding one, check: no heap, no panics on the tick, licence.
const CRATES: [&str; 30] = [
    "arcfeed-firmware",
    "arcfeed-board-app",
    "arcfeed-law",
    "arcfeed-link",
    "arcfeed-model",
    "arcfeed-nc",
    "arcfeed-units",
    "approx",
    "bitflags",
    "byteorder",
    "cobs",
    "crc",
    "crc-catalog",
    "defmt",
    "embedded-hal",
    "embedded-io",
    "hash32",
    "heapless",
    "libm",
    "memchr",
    "micromath",
    "nalgebra",
    "num-complex",
    "num-integer",
    "num-rational",
    "num-traits",
    "simba",
    "stable_deref_trait",
    "thiserror",
    "typenum",
];

/// The libraries every program has, heap or not.
const CORE_ONLY: [&str; 2] = ["libcompiler_builtins-", "libcore-"];

/// With all features: what is optional must run on the chip too.
const CHECK: [&str; 9] =
    ["check", "--package", CRATES[0], "--package", CRATES[1], "--target", TARGET, "--release", "--all-features"];
/// The boards' profile: crates that their lints have checked are not checked again.
const PROFILE: [(&str, &str); 5] = [
    ("CARGO_PROFILE_RELEASE_OPT_LEVEL", "3"),
    ("CARGO_PROFILE_RELEASE_LTO", "fat"),
    ("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "1"),
    ("CARGO_PROFILE_RELEASE_DEBUG", "line-tables-only"),
    ("CARGO_PROFILE_RELEASE_INCREMENTAL", "false"),
];

/// Checks what the firmware is made of, and that it compiles.
///
/// # Errors
/// The first of these that does not hold.
pub fn check() -> Result<(), Failure> {
    announce("crates of the firmware");
    check_crates()?;
    announce("firmware for the chip with core alone, neither std nor alloc");
    check_with_core_alone()
}

fn check_crates() -> Result<(), Failure> {
    // Procedural macros run on the host.
    let what = ["tree", "--package", CRATES[0], "--package", CRATES[1], "--target", TARGET, "--all-features"];
    let how = ["--edges", "normal,no-proc-macro", "--prefix", "none"];
    let listing = output(cargo(&what).args(how))?;
    let strangers = strangers(&listing);
    if strangers.is_empty() {
        return Ok(());
    }
    Err(Failure::new(format!("not on the firmware's list of crates (CRATES in xtask): {}", strangers.join(", "))))
}

/// Crates of a listing by `cargo tree` that may not run on the chip. A listing without the firmware is no listing.
fn strangers(tree: &str) -> Vec<&str> {
    let names: Vec<&str> = tree.lines().filter_map(|line| line.split_whitespace().next()).collect();
    if !names.contains(&CRATES[0]) {
        return vec!["(an empty tree)"];
    }
    names.into_iter().filter(|name| !CRATES.contains(name)).collect()
}

fn check_with_core_alone() -> Result<(), Failure> {
    let mut check = cargo(&CHECK);
    check.arg("--target-dir").arg(build_folder()?).envs(PROFILE);
    run(with_core_alone(&mut check)?).map_err(|failure| Failure {
        what: format!(
            "the firmware does not compile for the chip, or needs more than core, see the error above: {}",
            failure.what
        ),
        ..failure
    })
}

/// A cargo for the chip that knows nothing but `core`.
///
/// # Errors
/// The target's libraries are not there.
pub fn with_core_alone(cargo: &mut Command) -> Result<&mut Command, Failure> {
    let sysroot = build_dir()?.join("core-alone");
    copy_core(&sysroot)?;
    // Encoded: the path may hold blanks.
    Ok(cargo.env("CARGO_ENCODED_RUSTFLAGS", format!("--sysroot\u{1f}{}", sysroot.display())))
}

/// A sysroot with the libraries of [`CORE_ONLY`], anew each time: a new toolchain brings new files.
fn copy_core(sysroot: &Path) -> Result<(), Failure> {
    let from = output(&mut program("rustc", &["--print", "target-libdir", "--target", TARGET]))?;
    let to = sysroot.join("lib/rustlib").join(TARGET).join("lib");
    let copied = copy_libraries(Path::new(from.trim()), &to)
        .map_err(|error| Failure::new(format!("copying {} to {}: {error}", from.trim(), to.display())))?;
    if copied.iter().all(|&count| count > 0) {
        return Ok(());
    }
    Err(Failure::new(format!("no {} in {}", CORE_ONLY.join("* or no "), from.trim())))
}

/// Files copied of each of [`CORE_ONLY`].
fn copy_libraries(from: &Path, to: &Path) -> std::io::Result<[usize; CORE_ONLY.len()]> {
    if to.exists() {
        fs::remove_dir_all(to)?;
    }
    fs::create_dir_all(to)?;
    let mut copied = [0; CORE_ONLY.len()];
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let name = entry.file_name();
        let library = CORE_ONLY.iter().position(|prefix| name.to_string_lossy().starts_with(prefix));
        if let Some(library) = library {
            fs::copy(entry.path(), to.join(&name))?;
            copied[library] += 1;
        }
    }
    Ok(copied)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crate_that_is_not_listed_is_a_stranger() {
        let tree = "arcfeed-firmware v0.1.0 (/x)\nlibm v0.2.16\nserde v1.0.0 (*)\n\n";
        assert_eq!(strangers(tree), ["serde"]);
    }

    #[test]
    fn an_empty_listing_does_not_pass() {
        assert!(!strangers("").is_empty());
    }
}
