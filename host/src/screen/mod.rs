//! Terminal screen for a program that is being sent: `stream --tui`.
//!
//! [`view`] is the content, without I/O. A thread of its own draws it and reads the keys, so that a blocked terminal
//! does not delay the sender.

pub mod view;

#[cfg(feature = "tui")]
pub mod render;

#[cfg(feature = "tui")]
mod terminal;

#[cfg(not(feature = "tui"))]
mod no_screen;

#[cfg(not(feature = "tui"))]
pub use no_screen::Screen;
#[cfg(feature = "tui")]
pub use terminal::Screen;
