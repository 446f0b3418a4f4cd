//! A contour as our reader and our compensation have it.

use arcfeed_compensation::compensator::{CenterMove, CompensationFault, Compensator};
use arcfeed_compensation::contour::ContourCommand;
use arcfeed_nc::alarm::Fault;
use arcfeed_nc::block::Reading;
use arcfeed_nc::reader::Reader;
use arcfeed_nc::segment::Segment;
use arcfeed_nc::settings::{Decimals, Preset, Scope, Settings, StartUp, Tables};
use arcfeed_nc::text::Lines;
use arcfeed_units::{LengthUnit, Nm};

/// Moves of a program.
#[derive(Clone, Debug, Default)]
pub struct Compensated {
    /// Moves as programmed.
    pub programmed: Vec<Segment>,
    /// Moves of the tool centre.
    pub centers: Vec<CenterMove>,
}

/// Fault of a program, at its line, counted from 1; of a held move, at the line where it came up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContourFault {
    pub line: usize,
    pub fault: Fault,
    pub is_held: bool,
}

/// Reads and compensates a program; the radius of D is half of its number in mm.
pub fn compensated(text: &str, start_up: StartUp) -> Result<Compensated, ContourFault> {
    let mut settings = Settings::preset(Preset::Fanuc31i, LengthUnit::Mm, Reading::Lenient);
    settings.scope = Scope::Everything;
    settings.decimals = Decimals::Calculator;
    settings.compensation.start_up = start_up;
    let mut tables = Tables::default();
    for (index, radius) in tables.radii.iter_mut().enumerate() {
        radius[0] = Nm::from_mm(0.5 * (index + 1) as f64);
    }
    let mut reader = Reader::with(settings, tables);
    let mut compensator = Compensator::new(settings.compensation);
    let mut moves = Compensated::default();
    for (index, line) in Lines::new(text.as_bytes()).enumerate() {
        let at = |fault, is_held| ContourFault { line: index + 1, fault, is_held };
        let understood = reader.read(line.text).map_err(|fault| at(fault, false))?;
        moves.programmed.extend(understood.segment);
        let command = ContourCommand::of(&understood, reader.modal(), reader.tables());
        let found = command.apply(understood.segment.as_ref(), &mut compensator);
        moves.centers.extend(found.map_err(|fault| match fault {
            CompensationFault::Held(fault) => at(fault, true),
            CompensationFault::Given(fault) => at(fault, false),
        })?);
    }
    Ok(moves)
}
