//! The Rust target of the chip: present, or installed for the pinned toolchain.

use crate::command::{Failure, announce, output, program, run};

/// Cortex-M4F and M7F, hard float.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// Installs the target where it is missing.
///
/// # Errors
/// No rustup, or it could not install; says what was tried and what to do.
pub fn install() -> Result<(), Failure> {
    announce("target of the chip");
    let installed = output(&mut program("rustup", &["target", "list", "--installed"])).map_err(explain)?;
    if installed.lines().any(|line| line.trim() == TARGET) {
        return Ok(());
    }
    announce(&format!("installing {TARGET}"));
    run(&mut program("rustup", &["target", "add", TARGET])).map_err(explain)
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
