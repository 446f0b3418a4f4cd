//! What the axes do between the control's command and the tool: limits of speed, acceleration and jerk, and how the position
//! follows.
//!
//! [`limits`] of the axes become limits along the path; `brake` is the shortest way down to a speed under them, `profile`
//! the fastest speed, period by period, that leaves this way open. [`servo`] is how the axes follow, [`spindle`] how the
//! spindle does. `bisection` finds the largest safe acceleration of a period.

pub mod limits;

pub(crate) mod brake;

pub(crate) mod profile;

mod bisection;

pub mod servo;

pub mod spindle;
