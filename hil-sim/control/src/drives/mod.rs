//! Behaviour of the axes between the control's command and the tool: limits of speed, acceleration and jerk, and the lag of
//! the actual position.
//!
//! [`limits`] of the axes become limits along the path; `brake` is the shortest braking to a speed under them,
//! `profile` the fastest speed, period by period, from which the axes can still brake. [`servo`] models how the axes
//! follow, [`spindle`] how the spindle does. `bisection` finds the largest safe acceleration of a period.

pub mod limits;

pub(crate) mod brake;

pub(crate) mod profile;

mod bisection;

pub mod servo;

pub mod spindle;
