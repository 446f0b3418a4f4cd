//! Planning of plunge milling, held to closed forms and to an independent program's figures (data/README.md).

pub mod table;

mod measures;

mod lines;

mod sections;

mod passage;

mod plans;

mod steps;

mod stock;

mod rotor37;

mod executed;

mod families;

mod both_faces;

mod governed;

pub mod command;
