//! Triangle meshes from the STL files that a job names.

use std::fs::File;
use std::io::BufReader;

use arcfeed_dexel::files::read_stl;
use arcfeed_dexel::mesh::Mesh;

use crate::job::stl::StlFile;

/// Reads the mesh of an STL file, in millimetres.
///
/// # Errors
/// Describes the fault, with the path.
pub fn mesh(file: &StlFile) -> Result<Mesh, String> {
    let StlFile { path, unit } = file;
    let wrong = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let opened = File::open(path).map_err(|error| wrong(&error))?;
    let mesh = read_stl(BufReader::new(opened)).map_err(|error| wrong(&error))?;
    let scaled = |corners: [[f64; 3]; 3]| corners.map(|corner| corner.map(|along| along * unit.mm()));
    Mesh::from_corners(mesh.corners_mm().map(scaled)).map_err(|error| wrong(&error))
}
