#![doc = include_str!("../README.md")]
//!
//! Vibration of workpieces: natural frequencies, mode shapes, and their effect at a point.
//!
//! Workpieces are bodies of ten-node tetrahedra. They give a [`ModalPoint`](arcfeed_modal::modal_point::ModalPoint) at a point, through which forces act on the
//! modes and the modes move the point. Damping and time steps are in `arcfeed-modal`.
//! Lengths in mm, forces in N, time in s and masses in t form one consistent set of units: 1 N = 1 t mm/s2, 1 MPa = 1
//! N/mm2. Accuracy, cost and limits: docs/fe.md.

pub mod material;

pub mod tetrahedron;

pub mod element;

pub mod mesh;

pub mod clamped_block;

pub mod sides;

pub mod sheet;

pub mod order;

pub mod sparse;

pub mod eigen;

pub mod unknowns;

pub mod body;

pub mod locate;

pub mod field;
