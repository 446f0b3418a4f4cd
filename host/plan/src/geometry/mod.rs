//! Geometry of a bladed rotor.

mod spline;

pub mod face;

pub mod blisk;

pub mod blade;

mod naca65;

pub mod generate;

pub mod reading;

mod resample;

pub mod sections;

mod closed;

pub mod curves;

pub mod slot;

pub mod mesh;

pub mod flaws;
