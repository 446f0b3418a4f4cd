//! Random programs of macro statements, adapted at their blocks as executed, with the feeds written back.

use arcfeed::adapt::adapt;
use arcfeed::adapt::write_back::write_back;
use arcfeed::job::JobFile;
use arcfeed::program::{RunBounds, Source};
use arcfeed_nc::text::Lines;
use arcfeed_nc_macro::program::first_macro;

use super::macros::programs;

/// A job for arcs of both senses.
const JOB: &str = "units = \"mm\"\nprogram = \"p.nc\"\ntool = { kind = \"end-mill\", diameter = 1, teeth = 4 }\n\
                   spindle = { rev_per_min = 8000, set_by = \"operator\" }\nlimits = { max_feed = 6000 }\n\
                   law = { kind = \"contour\", inside_only = false, feed_per_tooth = 0.05 }\n\
                   [[cut]]\nmoves = \"arcs\"\ndirection = \"ccw\"\nside = \"inside\"\nradial_depth = 0.5\n\
                   [[cut]]\nmoves = \"arcs\"\ndirection = \"cw\"\nside = \"outside\"\nradial_depth = 0.5\n";

/// The blocks as executed, adapted and written back: each is refused with a place in the text, or only F words change.
pub fn written_back(input: &[u8], seed: u64) {
    let (mut main, library) = programs(input, seed);
    library.values().for_each(|text| main.extend(text));
    // Most variables are set, so that more than the first statements are executed.
    let set: String = [100, 199, 500, 999].iter().map(|number| format!("#{number}=1.\n")).collect();
    let bytes = [b"%\nG21G17G90G94\nS8000M3\nG0X0.Y0.Z0.\n".as_slice(), set.as_bytes(), &main].concat();
    let file = JobFile::parse("job.toml".as_ref(), JOB).expect("a job");
    let (path, macro_line, lines) = ("p.nc".into(), first_macro(&bytes), Lines::new(&bytes).count());
    let source =
        Source { path, bytes: bytes.clone(), settings: file.nc, tables: file.tables, macro_line, places: None };
    let bounds = RunBounds { blocks: 500, ..RunBounds::default() };
    let source = match source.expanded(None, bounds) {
        Ok(source) => source,
        Err(found) => return assert!(found.iter().all(|found| (1..=lines).contains(&found.line)), "{found:?}"),
    };
    let program = source.whole().expect("a short program");
    if program.has_errors() || program.places.is_none() {
        return;
    }
    (1..=program.texts().count()).for_each(|line| assert!((1..=lines).contains(&program.line_in_file(line))));
    let adapted = adapt(&program, &file.job);
    let Ok(written) = write_back(&source, &adapted.text, &adapted.line_ends) else { return };
    let written = written.text;
    let code = |text: &[u8]| Lines::new(text).map(|line| line.text.len()).collect::<Vec<_>>();
    let changed = code(&bytes).iter().zip(&code(&written)).filter(|(old, new)| old != new).count();
    assert_eq!(Lines::new(&written).count(), lines);
    assert!(changed == 0 || adapted.blocks.iter().any(|block| block.demand.is_some()), "{}", written.escape_ascii());
}
