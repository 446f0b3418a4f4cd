//! Geometry of a bladed rotor.

mod spline;

pub mod face;

pub mod blisk;

pub mod turning_height;

pub mod blade;

mod naca65;

pub mod generator;

pub mod point_file;

mod resampling;

pub mod sections;

mod closed_loop;

pub mod curves;

pub mod slot;

pub mod mesh;

pub mod flaws;
