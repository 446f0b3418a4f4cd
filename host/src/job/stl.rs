//! Meshes that a job names.

use std::path::{Path, PathBuf};

use arcfeed_shared::units::LengthUnit;
use toml::Spanned;

use super::{Complaint, at};

/// A mesh in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct StlFile {
    /// Where it is.
    pub path: PathBuf,
    /// Of its coordinates.
    pub unit: LengthUnit,
}

impl StlFile {
    /// Relative to a folder; it must be there.
    pub(super) fn told(file: &Spanned<String>, folder: &Path, unit: LengthUnit) -> Result<Self, Complaint> {
        let path = folder.join(file.as_ref());
        match std::fs::metadata(&path) {
            Ok(found) if found.is_file() => Ok(StlFile { path, unit }),
            Ok(_) => Err(at(file, &format!("{}: no file", path.display()))),
            Err(error) => Err(at(file, &format!("{}: {error}", path.display()))),
        }
    }
}
