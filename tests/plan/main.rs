//! The planning of cup-mill paths: the rotor's geometry.

mod published_rotor;

mod generator;

mod files;

mod slots;

mod meshes;

mod flaws;

mod rotor37;
