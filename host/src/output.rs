//! Output files of commands: written completely or not at all, and never over an input file of the command.

#[cfg(not(target_family = "wasm"))]
mod disk;

#[cfg(target_family = "wasm")]
mod memory;

#[cfg(not(target_family = "wasm"))]
pub use disk::*;
#[cfg(target_family = "wasm")]
pub use memory::*;
