//! Finishing passes: contact frames, tool axes, and plans.

mod contact;

mod axes;

mod rotary;

mod plans;

mod feed;

mod command;
