//! Finishing passes: contact frames, tool axes, and plans.

mod contact;

mod axes;

mod plans;

mod feed;

mod command;
