//! The boards, and the example firmware, are workspaces of their own: what `.ci/run` checks of the others is checked of each here. Their images are
//! built too: one in which a panic can be reached does not link.

use std::fs;
use std::path::PathBuf;

use crate::command::{Failure, announce, cargo, run};
use crate::firmware;
use crate::target::{TARGET, build_folder};

const FOLDER: &str = "firmware/boards";
/// Firmware for a board that is an example.
const EXAMPLE: &str = "examples/embassy";

/// Formatting, lints and images of each board. The lints see `core` alone, neither std nor alloc.
///
/// # Errors
/// The first board that fails, or no board at all.
pub fn check() -> Result<(), Failure> {
    let boards = manifests()?;
    if boards.is_empty() {
        return Err(Failure::new(format!("no boards in {FOLDER}")));
    }
    let target_dir = build_folder()?;
    for manifest in boards {
        let path = manifest.to_string_lossy();
        announce(&format!("format, lints and images of {path}"));
        run(&mut cargo(&["fmt", "--manifest-path", &path, "--check"]))?;
        let for_the_chip = ["--locked", "--quiet", "--release", "--target", TARGET, "--manifest-path", &path];
        let mut clippy = cargo(&["clippy"]);
        clippy.args(for_the_chip).arg("--target-dir").arg(&target_dir);
        run(firmware::with_core_alone(clippy.args(["--", "-D", "warnings"]))?)?;
        run(cargo(&["build", "--bins"]).args(for_the_chip).arg("--target-dir").arg(&target_dir))?;
    }
    Ok(())
}

/// `Cargo.toml` of each board and of the example, as seen from the workspace's root.
fn manifests() -> Result<Vec<PathBuf>, Failure> {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join(FOLDER);
    let unreadable = |error: std::io::Error| Failure::new(format!("{FOLDER}: {error}"));
    let mut manifests = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        if entry.path().join("Cargo.toml").exists() {
            manifests.push(PathBuf::from(FOLDER).join(entry.file_name()).join("Cargo.toml"));
        }
    }
    manifests.sort();
    manifests.push(PathBuf::from(EXAMPLE).join("Cargo.toml"));
    Ok(manifests)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_boards_are_among_those_checked() {
        for board in ["qemu-mps2", "stm32f405"] {
            assert!(manifests().unwrap().contains(&PathBuf::from(FOLDER).join(board).join("Cargo.toml")), "{board}");
        }
    }
}
