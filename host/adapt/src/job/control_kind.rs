//! Controls that a program can run on.

use std::path::Path;

use arcfeed_nc::settings::{Preset, Reading, Scope, Settings, Tables};
use arcfeed_units::LengthUnit;

use crate::control::{self, Conventions, LoadedSettings};

/// Supported controls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControlKind {
    /// Series 16i.
    Fanuc16i,
    /// Series 0i.
    Fanuc0i,
    /// Series 31i.
    Fanuc31i,
}

impl ControlKind {
    /// Name in job files.
    pub const fn name(self) -> &'static str {
        match self {
            ControlKind::Fanuc16i => "fanuc-16i",
            ControlKind::Fanuc0i => "fanuc-0i",
            ControlKind::Fanuc31i => "fanuc-31i",
        }
    }

    /// Standard settings of this control.
    pub const fn preset(self) -> Preset {
        match self {
            ControlKind::Fanuc16i => Preset::Fanuc16i,
            ControlKind::Fanuc0i => Preset::Fanuc0i,
            ControlKind::Fanuc31i => Preset::Fanuc31i,
        }
    }

    /// Settings and offsets of this control at power-on in `unit`, with the changes of a settings file and of these
    /// conventions.
    ///
    /// # Errors
    /// Describes the fault in the settings file.
    pub fn settings(
        self,
        unit: LengthUnit,
        file: Option<&Path>,
        conventions: Conventions,
    ) -> Result<(Settings, Tables), String> {
        let LoadedSettings { mut settings, tables, .. } = control::load(self.preset(), Reading::Lenient, file)?;
        conventions.apply(&mut settings);
        Ok((Settings { unit, scope: Scope::Everything, ..settings }, tables))
    }

    /// The control of this name.
    ///
    /// # Errors
    /// The name is unknown.
    pub fn named(name: &str) -> Result<Self, &'static str> {
        match name {
            "fanuc-16i" => Ok(ControlKind::Fanuc16i),
            "fanuc-0i" => Ok(ControlKind::Fanuc0i),
            "fanuc-31i" => Ok(ControlKind::Fanuc31i),
            _ => Err("no such control; write \"fanuc-16i\", \"fanuc-0i\" or \"fanuc-31i\""),
        }
    }
}
