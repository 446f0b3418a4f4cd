//! Pages that arcfeed serves to browsers: an HTTP server for a few of them, and the live page of a transmission.
//!
//! A page shows what a [snapshot] has; the sender only puts a new one in the place of the last.

pub mod snapshot;

#[cfg(feature = "web")]
pub mod reply;

#[cfg(feature = "web")]
pub mod request;

#[cfg(feature = "web")]
pub mod server;

#[cfg(feature = "web")]
mod live_page;

#[cfg(not(feature = "web"))]
mod no_page;

#[cfg(feature = "web")]
pub use live_page::LivePage;
#[cfg(not(feature = "web"))]
pub use no_page::LivePage;
