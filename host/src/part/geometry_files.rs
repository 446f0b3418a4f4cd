//! Files that the geometry of a part names, and their faults.

use std::io::Cursor;
use std::path::Path;

use arcfeed_plan::geometry::blisk::Blank;
use arcfeed_plan::geometry::point_file::{PointFileFrame, ReadError};
use arcfeed_plan::geometry::surface_mesh::SurfaceMesh;
use arcfeed_units::LengthUnit;
use toml::Spanned;

use super::PartError;
use crate::file_error::FileError;
use crate::job::at;

/// Refusal of IGES, with what to export in its place.
pub(super) const IGES: &str = "IGES is not read; export the blade and the hub from the CAD system as STEP (AP203, AP214, AP242) for `step`, or as STL \
                               for `stl`";

/// Environment of a rotor's files.
#[derive(Clone, Copy)]
pub(super) struct FileContext<'a> {
    /// Unit of the part file.
    pub(super) unit: LengthUnit,
    /// Blank.
    pub(super) blank: &'a Blank,
    /// Folder of the part file.
    pub(super) folder: &'a Path,
}

/// Text of a file that the part names.
pub(super) fn read(file: &Spanned<String>, folder: &Path) -> Result<String, PartError> {
    let bytes = bytes(file, folder)?;
    String::from_utf8(bytes)
        .map_err(|_| whole(file, folder, "this is no UTF-8 text; export or save it as plain text (UTF-8 or ASCII)"))
}

/// Fault of a file without lines.
pub(super) fn whole(file: &Spanned<String>, folder: &Path, message: &str) -> PartError {
    PartError::There(FileError::Whole { path: folder.join(file.as_ref()), message: message.to_owned() })
}

pub(super) fn in_file(file: &Spanned<String>, folder: &Path, error: &ReadError) -> PartError {
    let ReadError { line, column, fault } = error;
    let path = folder.join(file.as_ref());
    PartError::There(FileError::Content { path, line: *line, column: *column, message: fault.to_string() })
}

pub(super) fn bytes(file: &Spanned<String>, folder: &Path) -> Result<Vec<u8>, PartError> {
    let path = folder.join(file.as_ref());
    if path.extension().is_some_and(|ending| ["igs", "iges"].iter().any(|iges| ending.eq_ignore_ascii_case(iges))) {
        return Err(at(file, IGES).into());
    }
    std::fs::read(&path).map_err(|error| at(file, &format!("{}: {error}", path.display())).into())
}

/// Mesh of an STL file.
pub(super) fn read_mesh(
    file: &Spanned<String>,
    frame: &PointFileFrame,
    folder: &Path,
) -> Result<SurfaceMesh, PartError> {
    SurfaceMesh::from_stl(&mut Cursor::new(bytes(file, folder)?), frame).map_err(|error| {
        let message = format!("this is no complete STL file, binary or ASCII ({error}); export it anew as STL");
        whole(file, folder, &message)
    })
}
