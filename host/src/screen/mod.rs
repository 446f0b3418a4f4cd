//! A person's view of a program on its way: `stream --tui`.
//!
//! [`view`] is what is shown, without I/O; a thread of its own draws it and reads the keys, so that a terminal that takes
//! nothing holds up nobody else.

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
