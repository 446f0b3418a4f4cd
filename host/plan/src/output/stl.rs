//! Triangles as a binary STL file, millimetres.

use stl_io::{Normal, Triangle, Vertex};

use crate::vector::Point;

/// Content of a binary STL file. Triangles with two equal corners in the file's precision are left out: a closed mesh
/// stays closed.
///
/// # Errors
/// There are more triangles than the format can count.
pub fn to_stl(triangles: &[[Point; 3]]) -> std::io::Result<Vec<u8>> {
    let facets: Vec<Triangle> = triangles.iter().filter_map(facet).collect();
    let mut bytes = Vec::new();
    stl_io::write_stl(&mut bytes, facets.iter())?;
    Ok(bytes)
}

fn facet(corners: &[Point; 3]) -> Option<Triangle> {
    let [a, b, c] = corners;
    let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
    let places = corners.map(|point| [point.x as f32, point.y as f32, point.z as f32]);
    let is_open = places[0] != places[1] && places[1] != places[2] && places[2] != places[0];
    let normal = Normal::new([normal.x as f32, normal.y as f32, normal.z as f32]);
    is_open.then(|| Triangle { normal, vertices: places.map(Vertex::new) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_reader_finds_the_same_triangles() {
        let corner = |x: f64, y: f64, z: f64| Point::new(x, y, z);
        let (a, b, c, d) =
            (corner(0.0, 0.0, 0.0), corner(10.5, 0.0, 0.0), corner(0.0, 7.25, 0.0), corner(0.0, 0.0, -3.125));
        let flat = [a, b, corner(1e-60, 0.0, 0.0)];
        let bytes = to_stl(&[[a, c, b], [a, b, d], flat, [b, c, d], [c, a, d]]).unwrap();
        assert_eq!(bytes.len(), 84 + 4 * 50);
        let mesh = stl_io::read_stl(&mut std::io::Cursor::new(bytes)).unwrap();
        assert_eq!((mesh.vertices.len(), mesh.faces.len()), (4, 4));
        mesh.validate().unwrap();
        let [nx, ny, nz]: [f32; 3] = mesh.faces[0].normal.into();
        assert_eq!([nx, ny, nz], [0.0, 0.0, -1.0]);
    }
}
