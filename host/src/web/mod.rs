//! Pages that arcfeed serves to browsers: an HTTP server for a few of them, and the live page of a transmission.
//!
//! A page shows what a [snapshot] has; the sender only puts a new one in the place of the last.

pub mod snapshot;

#[cfg(feature = "web")]
pub mod reply;

#[cfg(all(feature = "web", not(target_family = "wasm")))]
pub mod request;

#[cfg(all(feature = "web", not(target_family = "wasm")))]
pub mod server;

#[cfg(all(feature = "web", not(target_family = "wasm")))]
mod live_page;

#[cfg(any(not(feature = "web"), target_family = "wasm"))]
mod no_page;

#[cfg(all(feature = "web", not(target_family = "wasm")))]
pub use live_page::LivePage;
#[cfg(any(not(feature = "web"), target_family = "wasm"))]
pub use no_page::LivePage;
