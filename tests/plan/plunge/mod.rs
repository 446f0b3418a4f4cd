//! Planning of plunge milling, held to closed forms and to an independent program's figures (data/README.md).

pub mod table;

mod measures;

mod lines;

mod sections;

mod passage;

mod plans;

mod stock;

mod executed;

mod families;

pub mod free_line;

mod both_faces;

mod nasa;

mod governed;

mod command;
