//! From what a board counts and measures to what the controller takes.
//!
//! Pure: the board hands in raw readings and the time, and learns what they mean and when they mean nothing.
//! [`encoder`] counts one axis, [`position`] keeps three of them and their zero, [`tacho`] times the spindle, [`dial`]
//! reads the operator's potentiometer, [`contacts`] waits until switches have settled.

pub mod encoder;

pub mod position;

pub mod tacho;

pub mod dial;

pub mod contacts;
