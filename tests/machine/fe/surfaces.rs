//! Closed surfaces as files have them: a cube's, put where a function says.

use arcfeed_blades::blade::Blade;
use arcfeed_dexel::mesh::Mesh;

/// Twisted by half a radian, cambered, tapered both ways, leaning.
pub const TWISTED: Blade = Blade {
    span_mm: 40.0,
    chord_mm: [30.0, 24.0],
    thickness_mm: [3.0, 1.5],
    edge_ratio: 0.5,
    camber_rad: [0.6, 0.4],
    stagger_rad: [0.3, 0.8],
    lean_rad: 0.1,
};

/// The six faces of a cube from 0 to 1, so many squares along its edges, each corner put where `place` says. `place` must not mirror; where it
/// puts a face into a line the others must meet.
pub fn closed(squares: [usize; 3], place: impl Fn([f64; 3]) -> [f64; 3]) -> Mesh {
    let mut triangles = Vec::new();
    for axis in 0..3 {
        let across = [(axis + 1) % 3, (axis + 2) % 3];
        for end in [0, squares[axis]] {
            for (a, b) in (0..squares[across[0]]).flat_map(|a| (0..squares[across[1]]).map(move |b| (a, b))) {
                let corner = |a: usize, b: usize| {
                    let mut at = [end; 3];
                    (at[across[0]], at[across[1]]) = (a, b);
                    place([0, 1, 2].map(|axis| at[axis] as f64 / squares[axis] as f64))
                };
                let [p, q, r, s] = [corner(a, b), corner(a + 1, b), corner(a + 1, b + 1), corner(a, b + 1)];
                // From above the corners of an upper face go round as a right hand does.
                triangles.extend(if end > 0 { [[p, q, r], [p, r, s]] } else { [[p, r, q], [p, s, r]] });
            }
        }
    }
    Mesh::from_corners(triangles.into_iter()).expect("a closed surface")
}

/// One without the other.
pub fn hollow(outer: &Mesh, inner: &Mesh) -> Mesh {
    let turned = inner.corners_mm().map(|[a, b, c]| [a, c, b]);
    Mesh::from_corners(outer.corners_mm().chain(turned).collect::<Vec<_>>().into_iter()).expect("a closed surface")
}
