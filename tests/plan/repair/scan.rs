//! Heights of measured points above the nominal surface.

use arcfeed_plan::geometry::blade::RotorAxis;
use arcfeed_plan::geometry::point_cloud::{from_ply, from_stl, from_table};
use arcfeed_plan::geometry::point_file::PointFileFrame;
use arcfeed_plan::geometry::surface::Surface;
use arcfeed_plan::repair::field::AllowanceField;
use arcfeed_plan::repair::scan::NominalSurface;
use arcfeed_plan::vector::Point;

use super::surfaces::Sheet;

const FRAME: PointFileFrame = PointFileFrame { axis: RotorAxis::Z, unit_mm: 1.0 };

/// Noise of standard deviation 1.
pub fn normal(random: &mut fastrand::Rng) -> f64 {
    (0..12).map(|_| random.f64()).sum::<f64>() - 6.0
}

/// Points at random places of the sheet, at heights above it.
pub fn cloud(seed: u64, count: usize, noise_mm: f64, height_mm: impl Fn([f64; 2]) -> f64) -> Vec<Point> {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut point = || {
        let at = [random.f64(), random.f64()];
        let (point, direction) = Sheet.point_and_normal(at);
        let noise = normal(&mut random) * noise_mm;
        point + direction * (height_mm(at) + noise)
    };
    (0..count).map(|_| point()).collect()
}

fn wave([u, v]: [f64; 2]) -> f64 {
    0.3 + 0.1 * libm::sin(6.0 * u) * libm::cos(5.0 * v)
}

#[test]
fn heights_and_distances_are_those_the_points_were_made_with() {
    let nominal = NominalSurface::new(Sheet);
    let clean = nominal.heights(&cloud(1, 20_000, 0.0, wave), 0.0);
    let off = clean.iter().map(|sample| (sample.height_mm - wave(sample.at)).abs()).fold(0.0, f64::max);
    println!("{} heights of 20000 points: off by {off:.1e} mm", clean.len());
    assert!(off < 1e-9 && clean.len() > 19_000);
    for (noise_mm, limit_mm) in [(0.0, 3e-4), (0.005, 0.025)] {
        let samples = nominal.heights(&cloud(1, 20_000, noise_mm, wave), 0.0);
        let heights = nominal.height_field(&samples, nominal.usual_hole_mm(samples.len()));
        let field = AllowanceField::new(&nominal, &heights, 1.0).unwrap();
        let (mut worst, mut steep, mut count): (f64, f64, usize) = (0.0, 0.0, 0);
        for node in field.nodes().filter(|node| node.at.iter().all(|t| (0.02..=0.98).contains(t))) {
            let (along_mm, nearest_mm) = (node.along_mm.unwrap(), node.nearest_mm.unwrap());
            worst = worst.max((along_mm - wave(node.at)).abs());
            assert!(nearest_mm <= along_mm + 1e-12);
            steep = steep.max((along_mm - nearest_mm) / along_mm);
            count += 1;
        }
        println!(
            "noise {noise_mm} mm: {count} nodes off by {worst:.4} mm; D_p below D_n by {:.3} % at most",
            steep * 100.0
        );
        assert!(worst < limit_mm, "{worst}");
        assert!(steep < 0.01);
    }
}

#[test]
fn the_surface_beside_a_weld_stays_between_the_measured_heights() {
    // A weld whose flank is as wide as the distance of the points.
    let weld = |[u, _]: [f64; 2]| 0.05 + 0.85 * ((u - 0.5) / 0.0125).clamp(0.0, 1.0);
    let nominal = NominalSurface::new(Sheet);
    let samples = nominal.heights(&cloud(6, 6_000, 0.0, weld), 0.0);
    let heights = nominal.height_field(&samples, nominal.usual_hole_mm(samples.len()));
    let at = |k: usize| [0.1 + 0.8 * (k % 400) as f64 / 400.0, 0.1 + 0.8 * (k / 400) as f64 / 50.0];
    let found = (0..20_000).filter_map(|k| heights.height_mm(at(k)));
    let (low, high) = found.fold((f64::INFINITY, 0.0_f64), |(low, high), mm| (low.min(mm), high.max(mm)));
    println!("20000 places between {low:.4} and {high:.4} mm");
    assert!(low >= 0.05 - 1e-9 && high <= 0.9 + 1e-9);
}

#[test]
fn ball_centres_are_corrected_by_the_stylus() {
    let nominal = NominalSurface::new(Sheet);
    let samples = nominal.heights(&cloud(2, 2_000, 0.0, |at| wave(at) + 1.5), 1.5);
    let off = samples.iter().map(|sample| (sample.height_mm - wave(sample.at)).abs()).fold(0.0, f64::max);
    println!("{} ball centres: off by {off:.1e} mm", samples.len());
    assert!(off < 1e-9);
}

#[test]
fn a_hole_of_the_measurement_has_no_height() {
    let nominal = NominalSurface::new(Sheet);
    let is_hole = |sample: &[f64; 2]| libm::hypot(sample[0] - 0.5, sample[1] - 0.5) < 0.15;
    let mut samples = nominal.heights(&cloud(3, 5_000, 0.0, wave), 0.0);
    samples.retain(|sample| !is_hole(&sample.at));
    let heights = nominal.height_field(&samples, nominal.usual_hole_mm(samples.len()));
    assert_eq!(heights.height_mm([0.5, 0.5]), None);
    assert!((heights.height_mm([0.2, 0.2]).unwrap() - wave([0.2, 0.2])).abs() < 1e-3);
    let field = AllowanceField::new(&nominal, &heights, 1.0).unwrap();
    let holes: Vec<_> = field.nodes().filter(|node| node.along_mm.is_none()).collect();
    assert!(holes.len() > 20 && holes.iter().all(|node| is_hole(&node.at) && node.nearest_mm.is_none()));
}

#[test]
fn the_same_points_come_from_tables_ply_and_stl() {
    let points = cloud(4, 60, 0.0, wave).iter().map(|p| p.map(|x| f64::from(x as f32))).collect::<Vec<_>>();
    let header = |format: &str, kind: &str| {
        format!(
            "ply\nformat {format} 1.0\ncomment a scanner's\nelement vertex 60\nproperty uchar red\nproperty {kind} x\nproperty {kind} y\nproperty {kind} z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    let rows =
        |gap: &str| points.iter().map(|p| format!("7{gap}{}{gap}{}{gap}{}\n", p.x, p.y, p.z)).collect::<String>();
    let table = format!("# probe\nside,x_mm,y_mm,z_mm\n{}", rows(","));
    assert_eq!(from_table(&table, &FRAME).unwrap(), points);
    let inches = table.replace("_mm", "_in");
    assert!((from_table(&inches, &FRAME).unwrap()[0] - points[0] * 25.4).norm() < 1e-9);
    assert_eq!(from_ply((header("ascii", "float") + &rows(" ")).as_bytes(), &FRAME).unwrap(), points);
    for (format, kind) in [
        ("binary_little_endian", "float"),
        ("binary_big_endian", "float"),
        ("binary_little_endian", "double"),
        ("binary_big_endian", "float64"),
    ] {
        let mut bytes = header(format, kind).into_bytes();
        for point in &points {
            bytes.push(7);
            for value in point.iter() {
                match (format, kind) {
                    ("binary_little_endian", "float") => bytes.extend((*value as f32).to_le_bytes()),
                    ("binary_big_endian", "float") => bytes.extend((*value as f32).to_be_bytes()),
                    ("binary_little_endian", _) => bytes.extend(value.to_le_bytes()),
                    _ => bytes.extend(value.to_be_bytes()),
                }
            }
        }
        assert_eq!(from_ply(&bytes, &FRAME).unwrap(), points);
        bytes.pop();
        assert!(from_ply(&bytes, &FRAME).is_err(), "an incomplete file");
    }
    let mut stl = String::from("solid s\n");
    for triangle in points.chunks_exact(3) {
        stl += "facet normal 0 0 1\nouter loop\n";
        triangle.iter().for_each(|p| stl += &format!("vertex {} {} {}\n", p.x, p.y, p.z));
        stl += "endloop\nendfacet\n";
    }
    stl += "endsolid s\n";
    assert_eq!(from_stl(stl.as_bytes(), &FRAME).unwrap(), points);
}

#[test]
fn faults_of_a_table_have_their_place() {
    let fault = |text: &str| from_table(text, &FRAME).unwrap_err().to_string();
    let row = "1.0,2.0,3.0\n".repeat(20);
    assert!(fault("x,y\n1,2\n").starts_with("1:1:"));
    assert!(fault("x_ft,y,z\n1,2,3\n").starts_with("1:1: `x_ft` has no unit"));
    assert!(fault(&format!("x,y,z\n{row}1.0,2.0\n")).starts_with("22:8:"));
    assert!(fault(&format!("x,y,z\n{row}1.0,nan,3.0\n")).starts_with("22:5:"));
    assert!(fault("x,y,z\n1.0,2.0,3.0\n").contains("20 at least"));
    assert!(from_ply(b"ply\nformat ascii 1.0\nelement face 3\nend_header\n", &FRAME).is_err());
    assert!(from_ply(b"", &FRAME).is_err());
}
