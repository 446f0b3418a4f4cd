//! How tools and workpieces vibrate: natural frequencies, shapes, and what they do at a point.
//!
//! Tools are beams, workpieces bodies of ten-node tetrahedra, disks one sector of them. What comes out is the same for all: a
//! [`modal_point::ModalPoint`] at a point, through which forces reach the modes and the modes move the point. Damping and steps in time are for others.
//! Lengths in mm, forces in N, time in s and masses in t are one set of units: 1 N = 1 t mm/s2, 1 MPa = 1 N/mm2. Accuracy, cost and limits: docs/fe.md.

pub mod material;

pub mod tetrahedron;

pub mod element;

pub mod mesh;

pub mod blade;

pub mod slab;

pub mod sides;

pub mod sheet;

pub mod disk;

pub mod order;

pub mod sparse;

pub mod eigen;

pub mod unknowns;

pub mod body;

pub mod modal_point;

pub mod locate;

pub mod field;

pub mod cyclic;

pub mod disk_field;

pub mod beam;
