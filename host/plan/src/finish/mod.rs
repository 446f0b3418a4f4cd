//! Finishing passes from contact points: contact frame, tool axis, cutter location, admissible axes, feed, and their proof.

pub mod contact;

pub mod mill;

pub mod axis;

pub mod obstacles;

pub mod reach;

pub mod rows;

pub mod passes;

pub mod rotary;

pub mod course;

pub mod needs;

pub mod access;

pub mod feed;

pub mod plan;

pub mod proof;
