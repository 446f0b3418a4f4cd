//! Triangle meshes as files: STL is read and written, PLY only written. Numbers in these files are f32, millimetres.

use std::fmt;
use std::io::{self, Read, Seek, Write};

use arcfeed_kinematics::vector::{Vector, cross, difference, unit};
use stl_io::{Normal, Triangle, Vertex};

use super::mesh::{Mesh, MeshError};

/// Reason why an STL file contains no valid solid.
#[derive(Debug)]
pub enum FileError {
    /// The file cannot be read, or it is not an STL file.
    Read(io::Error),
    /// The file's triangles do not enclose a volume.
    Mesh(MeshError),
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FileError::Read(error) => write!(f, "no STL can be read: {error}"),
            FileError::Mesh(error) => write!(f, "{error}"),
        }
    }
}

impl std::error::Error for FileError {}

/// Reads an STL file, text or binary.
///
/// # Errors
/// The file is not an STL file, or its triangles do not enclose a volume.
pub fn read_stl<R: Read + Seek>(mut file: R) -> Result<Mesh, FileError> {
    let triangles = stl_io::create_stl_reader(&mut file).map_err(FileError::Read)?;
    let triangles: Vec<Triangle> = triangles.collect::<io::Result<_>>().map_err(FileError::Read)?;
    let corners = triangles.iter().map(|triangle| triangle.vertices.map(|vertex| vertex.0.map(f64::from)));
    Mesh::from_corners(corners).map_err(FileError::Mesh)
}

/// Writes a binary STL file.
///
/// # Errors
/// Writing to `file` fails.
pub fn write_stl<W: Write>(mesh: &Mesh, mut file: W) -> io::Result<()> {
    let triangle = |corners: [Vector; 3]| Triangle {
        normal: Normal::new(single(normal(&corners))),
        vertices: corners.map(|corner| Vertex::new(single(corner))),
    };
    stl_io::write_stl(&mut file, mesh.corners_mm().map(triangle))
}

/// Writes a binary little-endian PLY file.
///
/// # Errors
/// Writing to `file` fails, or there are more vertices than the format's 32-bit indices can count.
pub fn write_ply<W: Write>(mesh: &Mesh, file: W) -> io::Result<()> {
    let mut file = io::BufWriter::new(file);
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\ncomment millimetres\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nelement face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        mesh.vertices_mm().len(),
        mesh.triangles().len()
    )?;
    for coordinate in mesh.vertices_mm().iter().flat_map(|vertex| single(*vertex)) {
        file.write_all(&coordinate.to_le_bytes())?;
    }
    for triangle in mesh.triangles() {
        file.write_all(&[3])?;
        for vertex in triangle {
            let number = u32::try_from(*vertex).map_err(io::Error::other)?;
            file.write_all(&number.to_le_bytes())?;
        }
    }
    file.flush()
}

fn normal([a, b, c]: &[Vector; 3]) -> Vector {
    unit(cross(difference(*b, *a), difference(*c, *a))).unwrap_or_default()
}

fn single(vector: Vector) -> [f32; 3] {
    vector.map(|x| x as f32)
}
