//! Settings of the tap, which reads the program on the line between sender and control: properties of the line, the control and the
//! machine that it cannot detect.

use arcfeed_link::message::page::TappedLine;
use arcfeed_nc::settings::{Preset, Reading, Scope, Settings};
use arcfeed_nc::tape_code::TapeCode;
use arcfeed_units::{LengthUnit, Nm, Span};

/// Largest number of characters of a block, without comments and blanks, that the tap can read.
pub const LINE_MAX: usize = 256;

/// Properties of the tapped line, its control and its machine, which the tap cannot find out itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TapSettings {
    /// Character code on the line; `None`: ISO or EIA, detected from the first end of block of each program.
    pub code: Option<TapeCode>,
    /// Properties of the control that decide how it reads a program: unit at power-on, decimals, block-delete
    /// switches.
    pub nc: Settings,
    /// Whether each program begins in the modal state of power-on, because the control clears its codes at reset and
    /// at the end of a program (parameter 3402, bit 6). If not, no feed is adapted before the program has stated unit,
    /// plane, G90 or G91, and feed mode.
    pub resets_codes: bool,
    /// Largest distance of the axes from the path of the move in execution. If they are farther, the control does not
    /// execute the program that the tap has read.
    pub off_path: Nm,
    /// Number of consecutive positions beyond this distance after which the tap stops the adaptation.
    pub off_path_count: u8,
    /// Time without a character in either direction after which a new program may start, and a DC1 may mean a reset of
    /// the control.
    pub silence: Span,
}

/// Reason why settings of a tap are rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TapSettingsError {
    /// The distance from the path is not positive, so that every position would be off the path.
    OffPath(Nm),
    /// The number of consecutive positions off the path, [`TapSettings::off_path_count`], is 0 or 255.
    OffPathCount(u8),
}

impl TapSettings {
    /// Settings for a Series 16i control with its standard settings.
    pub const fn new(unit: LengthUnit) -> Self {
        let nc = Settings::preset(Preset::Fanuc16i, unit, Reading::Lenient);
        TapSettings {
            code: None,
            nc,
            resets_codes: true,
            off_path: Nm(500_000),
            off_path_count: 5,
            silence: Span::from_ms(2_000),
        }
    }

    /// Settings for a line and a control as a flash page describes them.
    pub const fn of_line(line: TappedLine, unit: LengthUnit) -> Self {
        let mut settings = TapSettings::new(unit);
        settings.code = line.code;
        settings.nc.decimals = line.decimals;
        settings
    }

    /// # Errors
    /// Invalid settings.
    pub(super) fn checked(mut self) -> Result<Self, TapSettingsError> {
        if self.off_path.0 <= 0 {
            return Err(TapSettingsError::OffPath(self.off_path));
        }
        if self.off_path_count == 0 || self.off_path_count == u8::MAX {
            return Err(TapSettingsError::OffPathCount(self.off_path_count));
        }
        // Blocks that cannot be followed are skipped, but must be interpreted.
        self.nc.scope = Scope::Everything;
        Ok(self)
    }
}
