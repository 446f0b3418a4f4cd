//! Programs with macro statements and calls, adapted at their blocks as executed and with the feeds written back.
//!
//! Reference: an interpreter's run of its own over the program as it is, as it is written back, and over the blocks as
//! executed; and the simulated control with the program in its memory.

mod programs;

mod reference;

mod random;

mod shop;
mod switched;

mod refusals;

use arcfeed::adapt::{Adapted, adapt};
use arcfeed::job::JobFile;
use arcfeed::program::{RunBounds, Source};
use arcfeed_tests::Scratch;

/// Job of an end mill that cuts arcs of both senses.
pub const JOB: &str = "units = \"mm\"\nprogram = \"program.nc\"\n[tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = 4\n\
                       number = 1\n[spindle]\nrev_per_min = 8000\n[limits]\nmax_feed = 6000\n[law]\nkind = \"contour\"\n\
                       inside_only = false\nfeed_per_tooth = 0.05\n[[cut]]\nmoves = \"arcs\"\ndirection = \"ccw\"\n\
                       side = \"inside\"\nradial_depth = 0.5\n[[cut]]\nmoves = \"arcs\"\ndirection = \"cw\"\nside = \"outside\"\n\
                       radial_depth = 0.5\n";
/// The rule for arcs of the second sense.
pub const CLOCKWISE: &str = "[[cut]]\nmoves = \"arcs\"\ndirection = \"cw\"\nside = \"outside\"\nradial_depth = 0.5\n";

/// A program with its job, adapted.
pub struct Case {
    pub file: JobFile,
    /// The program's text.
    pub text: String,
    /// The blocks as executed.
    pub source: Source,
    pub adapted: Adapted,
    pub written: Result<String, String>,
}

impl Case {
    /// Adapts a program; `library` are the called programs that are not in it, by file name.
    pub fn new(scratch: &Scratch, text: &str, library: &[(String, String)], job: &str) -> Result<Self, String> {
        scratch.write("program.nc", text);
        library.iter().for_each(|(name, text)| drop(scratch.write(name, text)));
        let job = format!("{job}[control]\nlibrary = \".\"\n");
        let file = JobFile::load(scratch.write("job.toml", job).as_ref()).map_err(|error| error.to_string())?;
        let source = Source::read(&file.program, file.nc, file.tables)?;
        let source = source
            .expanded(file.library.as_deref(), RunBounds::default())
            .map_err(|found| found.iter().map(|found| format!("program.nc:{found}")).collect::<Vec<_>>().join("\n"))?;
        let program = source.whole()?;
        assert!(!program.has_errors(), "{:?}\n{text}", program.diagnostics);
        let adapted = adapt(&program, &file.job);
        let written = arcfeed::adapt::write_back::write_back(&source, &adapted.text, &adapted.line_ends)
            .map(|written| String::from_utf8(written.text).expect("ASCII"));
        Ok(Case { file, text: text.to_owned(), source, adapted, written })
    }

    /// The blocks as executed, before and after.
    pub fn expanded(&self) -> [String; 2] {
        [&self.source.bytes, &self.adapted.text].map(|text| String::from_utf8(text.clone()).expect("ASCII"))
    }
}
