//! What measures the cut. Nothing here may know the feed law.

pub mod chip;

pub mod meter;

pub mod edges;

pub mod material;

pub mod force;

pub mod shelves;

pub mod layer;

pub mod rake;

pub mod layers;

pub mod end;

pub mod pose;

pub mod bite;

pub mod engaged;
