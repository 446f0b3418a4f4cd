//! Finishing passes from contact points: contact frame, tool axis, cutter location, admissible axes, and their proof.

pub mod contact;

pub mod mill;

pub mod axis;

pub mod obstacles;

pub mod reach;
