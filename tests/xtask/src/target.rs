//! Rust targets: present, or installed for the pinned toolchain.

use std::path::PathBuf;

use crate::command::{Failure, announce, build_dir, output, program, run};

/// Cortex-M4F and M7F, hard float.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// A page in a browser.
pub const PAGE: &str = "wasm32-unknown-unknown";

/// Installs the target of the chip where it is missing.
///
/// # Errors
/// No rustup, or it could not install; says what was tried and what to do.
pub fn install() -> Result<(), Failure> {
    announce("target of the chip");
    add(TARGET).map_err(explain)
}

/// The folder of all builds for the chip: what they share is built once.
///
/// # Errors
/// As [`build_dir`].
pub fn build_folder() -> Result<PathBuf, Failure> {
    Ok(build_dir()?.join("boards"))
}

/// Installs a target where it is missing.
///
/// # Errors
/// No rustup, or it could not install.
pub fn add(target: &str) -> Result<(), Failure> {
    let installed = output(&mut program("rustup", &["target", "list", "--installed"]))?;
    if installed.lines().any(|line| line.trim() == target) {
        return Ok(());
    }
    announce(&format!("installing {target}"));
    run(&mut program("rustup", &["target", "add", target]))
}

fn explain(failure: Failure) -> Failure {
    let what = format!(
        "the firmware was not checked: Rust target {TARGET} missing ({}). With rustup and the network, run \
         `rustup target add {TARGET}` in the root of the workspace, where rust-toolchain.toml names the toolchain it \
         is for; without, install that toolchain's rust-std for {TARGET} by hand.",
        failure.what
    );
    Failure { what, ..failure }
}
