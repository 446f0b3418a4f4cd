//! How tool and workpiece give way to the forces of the cut, and whether the cut is stable.
//!
//! Conventions, and what steps do to a verdict: docs/forces.md.

pub mod modal;

pub mod transition;

pub mod vibration;

pub mod chatter;
