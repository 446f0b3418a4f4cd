//! Stocks from and as triangles, and heights.

use std::f64::consts::PI;
use std::io::Cursor;

use arcfeed_dexel::deviation::HeightMap;
use arcfeed_dexel::files::{FileError, read_stl, write_ply, write_stl};
use arcfeed_dexel::mesh::{Mesh, MeshError};
use arcfeed_dexel::motion::{Move, Pose};
use arcfeed_dexel::solid::Block;
use arcfeed_dexel::surface::surface;
use arcfeed_dexel::tool::Tool;
use arcfeed_dexel::workpiece::Stock;

use crate::stock::figures::{MEMORY_MAX, UP, order};

/// A tetrahedron with corners at 0 and 6 on each axis, as text; a sixth of a cube of 6 mm.
const TETRAHEDRON: &str = "solid t
facet normal 0 0 -1
outer loop\nvertex 0 0 0\nvertex 0 6 0\nvertex 6 0 0\nendloop
endfacet
facet normal 0 -1 0
outer loop\nvertex 0 0 0\nvertex 6 0 0\nvertex 0 0 6\nendloop
endfacet
facet normal -1 0 0
outer loop\nvertex 0 -0 0\nvertex 0 0 6\nvertex 0 6 0\nendloop
endfacet
facet normal 1 1 1
outer loop\nvertex 6 0 0\nvertex 0 6 0\nvertex 0 0 6\nendloop
endfacet
endsolid t
";

fn block(highest_mm: [f64; 3]) -> Block {
    Block { lowest_mm: [0.0; 3], highest_mm }
}

fn straight(from: [f64; 3], to: [f64; 3]) -> Move {
    let pose = |tip_mm| Pose { tip_mm, axis: UP };
    Move::Straight { from: pose(from), to: pose(to) }
}

fn cut(stock: &mut Stock, tool: &Tool, moved: &Move) -> [f64; 3] {
    stock.cut(tool, &moved.sweeps(tool, 1e-4).unwrap()).unwrap().by_axis
}

/// A ball of chords, its poles on x.
fn ball(radius_mm: f64, rings: usize) -> Mesh {
    let point = |ring: usize, side: usize| {
        let (sin, cos) = libm::sincos(PI * ring as f64 / rings as f64);
        let (side_sin, side_cos) = libm::sincos(PI * (side % (2 * rings)) as f64 / rings as f64);
        // Poles are one point, whatever the rounding of sine.
        let across = if ring == 0 || ring == rings { 0.0 } else { radius_mm * sin };
        [radius_mm * cos, across * side_cos, across * side_sin]
    };
    let quads = (0..rings).flat_map(|ring| (0..2 * rings).map(move |side| (ring, side)));
    let corners = quads.flat_map(|(ring, side)| {
        let [a, b, c, d] = [point(ring, side), point(ring + 1, side), point(ring + 1, side + 1), point(ring, side + 1)];
        [[a, b, c], [a, c, d]]
    });
    Mesh::from_corners(corners).unwrap()
}

#[test]
fn an_stl_file_becomes_a_stock() {
    let mesh = read_stl(Cursor::new(TETRAHEDRON)).unwrap();
    assert_eq!(mesh.volume_mm3(), 36.0);
    for step_mm in [0.5, 0.1] {
        let volume = Stock::new(&mesh, step_mm, MEMORY_MAX).unwrap().volume();
        println!("step {step_mm}: {:?}", volume.by_axis);
        // Rays in the middle of their cells see a flat face exactly, up to the cells that the slanting edges divide.
        assert!((volume.mean_mm3() - 36.0).abs() <= 0.1 * step_mm * step_mm * 36.0 && volume.spread_mm3() < 1e-5);
    }
}

#[test]
fn a_mesh_with_holes_or_inside_out_is_refused_and_says_where() {
    let holed =
        TETRAHEDRON.replacen("vertex 6 0 0\nvertex 0 6 0\nvertex 0 0 6", "vertex 6 0 0\nvertex 0 6 0\nvertex 0 0 5", 1);
    let refused = read_stl(Cursor::new(holed)).unwrap_err();
    let FileError::Mesh(MeshError::Open { edges: 4, .. }) = refused else { panic!("{refused}") };
    println!("{refused}");
    assert!(refused.to_string().contains("4 edges have no triangle on their other side"));
    let corners: Vec<_> = ball(3.0, 8).corners_mm().map(|[a, b, c]| [a, c, b]).collect();
    assert_eq!(Mesh::from_corners(corners.into_iter()), Err(MeshError::InsideOut));
    assert!(matches!(read_stl(Cursor::new("nothing of the kind")), Err(FileError::Read(_))));
    assert_eq!(
        Mesh::from_corners([[[0.0; 3], [f64::NAN; 3], UP]].into_iter()),
        Err(MeshError::NotANumber { triangle: 0 })
    );
}

#[test]
fn a_meshed_ball_has_its_own_volume_along_every_axis() {
    let mesh = ball(6.0, 40);
    let exact_mm3 = mesh.volume_mm3();
    let errors = [0.8, 0.4, 0.2, 0.1].map(|step_mm| {
        let volume = Stock::new(&mesh, step_mm, MEMORY_MAX).unwrap().volume();
        println!("step {step_mm}: {:?} of {exact_mm3}", volume.by_axis);
        (volume.mean_mm3() / exact_mm3 - 1.0).abs()
    });
    assert!(errors[3] < 1e-4, "{errors:?}");
}

#[test]
fn the_surface_of_a_stock_is_closed_and_encloses_what_is_left() {
    // A ring-shaped cavity, its flat faces off the nodes, and a tunnel through the core that is left in it.
    let ring = Tool::ring([5.0, 3.0], 0.0, 3.1, 1e-3).unwrap();
    let drill = Tool::cylinder(1.5, 30.0).unwrap();
    let exact_mm3 = (25.0 - 9.0) * PI * 3.1 + 2.25 * PI * 10.0;
    // A sharp edge is cut off by a b / 2 + (a + b) h / 8, a and b its distances from the last nodes inside, at most 3/4 h^2.
    let edges_mm = 4.0 * PI * (5.0 + 3.0) + 4.0 * PI * 1.5;
    let mut errors = Vec::new();
    for step_mm in [0.8, 0.4, 0.2] {
        let mut stock = Stock::new(&block([16.0, 16.0, 10.0]), step_mm, MEMORY_MAX).unwrap();
        let whole_mm3 = surface(&stock).unwrap().volume_mm3();
        cut(&mut stock, &ring, &straight([8.0, 8.0, 3.33], [8.0, 8.0, 3.33]));
        let by_grids = cut(&mut stock, &drill, &straight([8.0, 8.0, -1.0], [8.0, 8.0, -1.0]));
        let mesh = surface(&stock).unwrap();
        let off = (whole_mm3 - mesh.volume_mm3()) / exact_mm3 - 1.0;
        println!("step {step_mm}: surface {off:+.1e}, drilled {by_grids:?}, {} triangles", mesh.triangles().len());
        assert!(off.abs() * exact_mm3 <= 0.75 * step_mm * step_mm * edges_mm, "{off}");
        errors.push(off.abs());
    }
    println!("order {:.2}", order(&errors));
    assert!(order(&errors) >= 1.5, "{errors:?}");
}

#[test]
fn walls_and_floors_right_on_the_nodes_leave_no_hole_in_the_surface() {
    // Every face of these slots passes through nodes: the rays of the three families need not agree on them.
    let tool = Tool::cylinder(1.0, 4.0).unwrap();
    for eighths in 0..16 {
        let at = f64::from(eighths) / 8.0;
        let mut stock = Stock::new(&block([8.0, 8.0, 8.0]), 0.25, MEMORY_MAX).unwrap();
        cut(&mut stock, &tool, &straight([2.0 + at, 2.0, 2.125], [2.0 + at, 5.0, 2.125]));
        cut(&mut stock, &tool, &straight([1.0, 4.0 + at, 3.0 + at], [7.0, 4.0 + at, 3.0 + at]));
        let left_mm3 = surface(&stock).expect("a closed surface").volume_mm3();
        assert!((left_mm3 / stock.volume().mean_mm3() - 1.0).abs() < 0.02, "{at}: {left_mm3}");
    }
}

#[test]
fn a_surface_goes_through_a_file_and_back() {
    let mut stock = Stock::new(&block([10.0, 8.0, 6.0]), 0.5, MEMORY_MAX).unwrap();
    cut(&mut stock, &Tool::ball(2.0, 9.0, 1e-3).unwrap(), &straight([2.0, 3.0, 4.0], [8.0, 5.0, 3.0]));
    let mesh = surface(&stock).unwrap();
    let (mut stl, mut ply) = (Vec::new(), Vec::new());
    write_stl(&mesh, &mut stl).unwrap();
    write_ply(&mesh, &mut ply).unwrap();
    let back = read_stl(Cursor::new(&stl)).unwrap();
    assert_eq!(back.triangles().len(), mesh.triangles().len());
    assert!((back.volume_mm3() / mesh.volume_mm3() - 1.0).abs() < 1e-6);
    let header_end = ply.windows(11).position(|bytes| bytes == b"end_header\n").unwrap() + 11;
    assert_eq!(ply.len(), header_end + 12 * mesh.vertices_mm().len() + 13 * mesh.triangles().len());
    let again = Stock::on(stock.lattice(), &back, MEMORY_MAX).unwrap();
    let off = HeightMap::new(&again, 2).above(&HeightMap::new(&stock, 2)).unwrap().figures().unwrap();
    println!("heights after export and import: {off:?}");
    assert!(off.rms_mm < 0.1);
}

#[test]
fn scallops_between_two_passes_are_as_high_as_the_circles_say() {
    // R 5 mm, 0.01 mm high: 0.632139 mm from pass to pass (circle with circle, computed outside of this project).
    let tool = Tool::ball(5.0, 20.0, 1e-6).unwrap();
    let step_mm = 0.632_139 / 8.0;
    let mut stock = Stock::new(&block([1.0, 20.0 * step_mm, 2.0]), step_mm, MEMORY_MAX).unwrap();
    for pass in 0..3 {
        // Every eighth row of rays lies under a pass, and the fourth after it halfway to the next.
        let y_mm = step_mm * (2.5 + 8.0 * f64::from(pass));
        cut(&mut stock, &tool, &straight([-9.0, y_mm, 1.0], [9.0, y_mm, 1.0]));
    }
    let flat = Stock::on(stock.lattice(), &block([1.0, 20.0 * step_mm, 1.0]), MEMORY_MAX).unwrap();
    let above = HeightMap::new(&stock, 2).above(&HeightMap::new(&flat, 2)).unwrap();
    let figures = above.figures().unwrap();
    println!("{figures:?}");
    assert!((figures.max_mm - 0.01).abs() < 2e-6 && (-1e-12..1.1e-6).contains(&figures.min_mm));
    let mut csv = Vec::new();
    above.write_csv(&mut csv).unwrap();
    assert_eq!(csv.split(|byte| *byte == b'\n').count(), figures.rays + 2);
    assert!(above.above(&HeightMap::new(&stock, 1)).is_err());
}
