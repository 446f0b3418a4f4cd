//! Finishing of a blade's side with a ball end mill, and the resulting marks.

pub mod side;

pub mod pass;

pub mod marks;
