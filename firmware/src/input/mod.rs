//! Conversion of a board's raw readings into inputs of the controller.
//!
//! Pure functions of readings and time. [`encoder`] counts one axis, [`position`] combines three axes and their zero,
//! [`tacho`] measures the spindle speed, [`dial`] reads the operator's potentiometer, [`contacts`] debounces switches.

pub mod encoder;

pub mod position;

pub mod tacho;

pub mod dial;

pub mod contacts;
