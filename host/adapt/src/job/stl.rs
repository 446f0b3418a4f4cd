//! STL files that a job names.

use std::path::{Path, PathBuf};

use arcfeed_units::LengthUnit;
use toml::Spanned;

use super::{Complaint, at};
use crate::files;

/// STL file that a job names, with its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct StlFile {
    /// Path of the file.
    pub path: PathBuf,
    /// Unit of its coordinates.
    pub unit: LengthUnit,
}

impl StlFile {
    /// Resolves a file name relative to a folder; the file must exist.
    pub(super) fn named(file: &Spanned<String>, folder: &Path, unit: LengthUnit) -> Result<Self, Complaint> {
        let path = folder.join(file.as_ref());
        match files::is_file(&path) {
            Ok(true) => Ok(StlFile { path, unit }),
            Ok(false) => Err(at(file, &format!("{}: no file", path.display()))),
            Err(error) => Err(at(file, &format!("{}: {error}", path.display()))),
        }
    }
}
