//! Finishing the side of a blade with a ball end mill, and the marks that this leaves.

pub mod side;

pub mod pass;

pub mod marks;
