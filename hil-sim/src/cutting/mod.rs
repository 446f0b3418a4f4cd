//! What measures the cut. Nothing here may know the feed law.

pub mod chip;

pub mod meter;

pub mod edges;

pub mod material;

pub mod force;

pub mod partial_heights;

pub mod layer;

pub mod rake;

pub mod layers;

pub mod end;

pub mod pose;

pub mod edge_engagement;

pub mod engaged;
