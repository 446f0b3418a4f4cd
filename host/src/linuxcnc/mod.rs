//! LinuxCNC as a control: its dialect of NC text, and the moves for the component `arcfeed` in its servo thread.

pub mod codes;

mod comment;

mod block_editor;

pub mod dialect;

pub mod prepared;

pub mod session;
