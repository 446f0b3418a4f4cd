//! LinuxCNC as a control: its dialect of NC text.

mod codes;

mod comment;

mod block_editor;

pub mod dialect;
