//! What a bladed rotor looks like.

pub mod face;

pub mod blisk;

pub mod blade;

mod naca65;

pub mod generate;
