//! The planning of cup-mill paths: the rotor's geometry.

mod published_rotor;

mod generator;

mod slots;

mod meshes;
