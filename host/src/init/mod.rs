//! A first job from a program that somebody already has: what is found in it, what that makes likely, what is to be asked.

pub mod survey;

pub mod groups;

pub mod propose;

pub mod wording;

pub mod write;
