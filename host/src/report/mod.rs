//! Results of a run: the figures as data (and JSON), and as a summary for a person.

pub mod material;

pub mod marks;

pub mod loads;

pub mod spindle;

pub mod chip_load;

pub mod figures;

pub mod print_output;

pub mod summary;

pub mod page;
