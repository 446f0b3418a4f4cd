//! Geometry of a bladed rotor.

mod spline;

pub mod face;

pub mod surface;

pub mod edge_strip;

pub mod blisk;

pub mod turning_height;

pub mod blade;

mod naca65;

pub mod generator;

pub mod point_file;

pub mod point_cloud;

mod resampling;

pub mod sections;

mod closed_loop;

pub mod curves;

pub mod surface_mesh;

pub mod solid_fault;

mod generatrix;

mod slices;

pub mod solid;

mod step_text;

mod step_spline;

pub mod step_file;

pub mod slot;

pub mod flaws;

pub mod splitter;

pub mod mesh;
