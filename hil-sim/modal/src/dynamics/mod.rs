//! Displacement of tool and workpiece under cutting forces, and stability of the cut.
//!
//! Conventions, and the effect of step size on a verdict: docs/forces.md.

pub mod modal;

pub mod transition;

pub mod vibration;

pub mod chatter;
