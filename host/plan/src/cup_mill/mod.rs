//! Planning method, one step per file: from the blades about a slot to the path of a cup mill's centre through it.

pub mod patch;

pub mod side;

pub mod neighbours;

pub mod axis;

pub mod free_width;

pub mod base;

pub mod depth;

pub mod turn;

pub mod interior;

pub mod level;

pub mod link;

pub mod turns;

pub mod normal_form;

pub mod infeasibility;

pub mod roughing;

pub mod levels;

pub mod plan;
