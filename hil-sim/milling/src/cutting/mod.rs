//! Measurement of the cut: chips, edges, engagement and forces, from positions and material. No code here may use the feed laws.

pub mod chip;

pub mod boundary;

pub mod measured_move;

pub mod meter;

pub mod edges;

pub mod material;

pub mod force;

pub mod partial_heights;

pub mod layer;

pub mod edge_element;

pub mod layers;

pub mod end;

pub mod pose;

pub mod edge_engagement;

pub mod engaged_arcs;

pub mod engaged_section;
