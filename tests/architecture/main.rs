//! The rules of the design that the compiler does not know, read from the sources.
//!
//! A check reads text, so it sees what is written, not what it expands to. Each looks at something or fails: a folder
//! without sources is an error in [`source::rust_files`].

mod complaints;

mod source;

mod manifest;

mod crates;

mod packages;

mod modules;

mod documents;

mod files;

mod units;

mod laws;

mod names;

mod words;
