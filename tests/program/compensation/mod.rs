//! Cutter radius compensation (G41, G42): against LinuxCNC's interpreter, against the distance from the contour, and
//! contours that no tool can follow.

mod clearance;

mod cli;

mod geometry;

mod impossible;

mod rs274;

#[path = "../../rs274/compensated.rs"]
mod compensated;

#[path = "../../rs274/contours.rs"]
mod contours;
