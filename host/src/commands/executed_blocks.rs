//! Programs with macro statements or calls: checks, and the program to run in their place.

use std::path::Path;

use super::outcome::Failure;
use crate::adapt::Adapted;
use crate::adapt::write_back::{WrittenProgram, write_back};
use crate::console::note;
use crate::job::JobFile;
use crate::program::{ExecutedPlaces, Program, Source};

/// Checks that the executed blocks can replace a program with macro statements. If the program prints text (DPRNT), which plain blocks
/// cannot do, a warning goes to stderr. `places` is `None` for a program without macro statements, which needs no check.
///
/// # Errors
/// The program makes the control ignore feed hold or override, which no plain block does.
pub fn check_expanded(path: &Path, places: Option<&ExecutedPlaces>) -> Result<(), Failure> {
    let Some(places) = places else { return Ok(()) };
    let path = path.display();
    if let Some(place) = places.ignores_feed {
        let library = place.library.map_or(String::new(), |number| format!(" in O{number} of the library"));
        return Err(Failure::Input(format!(
            "{path}: #3004 is set{library}, line {}: its blocks as executed cannot do that; remove the statement, or adapt without \
             --expand and run the program from the control's memory",
            place.line
        )));
    }
    if places.outputs > 0 {
        note(format_args!(
            "{path}: warning: {} statements punch text (DPRNT and the like), and the blocks as executed do not",
            places.outputs
        ));
    }
    Ok(())
}

/// Adapted program for a control's memory: the program's own macros with the feeds written into them or, where that
/// is impossible, the blocks as executed.
///
/// # Errors
/// See [`check_expanded`].
pub fn for_memory(program: &Program, adapted: &Adapted, file: &JobFile) -> Result<WrittenProgram, Failure> {
    let Some(places) = &program.places else { return Ok(adapted.into()) };
    let source = Source {
        path: program.path.clone(),
        bytes: program.bytes().to_vec(),
        settings: file.nc,
        tables: file.tables,
        macro_line: None,
        places: Some(places.clone()),
    };
    write_back(&source, &adapted.text, &adapted.line_ends).or_else(|refusal| {
        check_expanded(&program.path, Some(places))?;
        let path = program.path.display();
        note(format_args!(
            "{path}: the adapted program is run as the {} lines of `arcfeed adapt --expand`: {}",
            places.len(),
            refusal.replace("error: ", "")
        ));
        Ok(adapted.into())
    })
}
