//! What a bladed rotor looks like.

pub mod face;

pub mod blisk;
