//! Files of commands, by their paths: on the disk, or in memory where arcfeed runs inside a page (`wasm32`, `host/wasm`).
//!
//! All that `check`, `init`, `adapt` and `simulate` read goes through here.

#[cfg(not(target_family = "wasm"))]
mod disk;

#[cfg(target_family = "wasm")]
mod memory;

#[cfg(not(target_family = "wasm"))]
pub use disk::*;
#[cfg(target_family = "wasm")]
pub use memory::*;
