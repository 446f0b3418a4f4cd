//! How the tap is set: what the line, the control and the machine are, none of which it can see.

use arcfeed_shared::nc::settings::{Preset, Reading, Scope, Settings};
use arcfeed_shared::nc::tape_code::Code;
use arcfeed_shared::units::{LengthUnit, Nm, Span};
use arcfeed_shared::wire::message::page::Tapped;

/// Most characters of a block, comments and blanks apart.
pub const LINE_MAX: usize = 256;

/// The settings of a tap; config.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TapSettings {
    /// The code of the line as the board's receiver hands it on; `None`: ISO or EIA, as the first end of block of each
    /// program says.
    pub code: Option<Code>,
    /// How the control reads a program: its unit at power-on, decimals, block-delete switches.
    pub nc: Settings,
    /// Whether a program begins in the modal state of power-on: the control clears its codes at reset and program end
    /// (parameter 3402, bit 6). Where it does not, nothing is adapted before the program has said unit, plane, G90 or G91
    /// and how F counts.
    pub begins_afresh: bool,
    /// How far from its path the tool may be; more, and the control does something else than the tap has read.
    pub off_path: Nm,
    /// For how many positions in a row it may be further away.
    pub off_path_count: u8,
    /// After so long without a character either way a new program may come, and a control that asks (DC1) may have been
    /// reset.
    pub silence: Span,
}

/// Settings that make no sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TapSettingsError {
    /// The distance from the path must be positive: any position would be off its path.
    OffPath(Nm),
    /// Nothing would ever be off its path.
    OffPathCount(u8),
}

impl TapSettings {
    /// For a 16i in its standard settings.
    pub const fn new(unit: LengthUnit) -> Self {
        let nc = Settings::preset(Preset::Fanuc16i, unit, Reading::Lenient);
        TapSettings {
            code: None,
            nc,
            begins_afresh: true,
            off_path: Nm(500_000),
            off_path_count: 5,
            silence: Span::from_ms(2_000),
        }
    }

    /// For a line as the parameters in flash describe it.
    pub const fn of_line(line: Tapped, unit: LengthUnit) -> Self {
        let mut settings = TapSettings::new(unit);
        settings.code = line.code;
        settings.nc.decimals = line.decimals;
        settings
    }

    /// # Errors
    /// What makes no sense.
    pub(super) fn checked(mut self) -> Result<Self, TapSettingsError> {
        if self.off_path.0 <= 0 {
            return Err(TapSettingsError::OffPath(self.off_path));
        }
        if self.off_path_count == 0 || self.off_path_count == u8::MAX {
            return Err(TapSettingsError::OffPathCount(self.off_path_count));
        }
        // What cannot be followed is passed over, but has to be understood.
        self.nc.scope = Scope::Everything;
        Ok(self)
    }
}
