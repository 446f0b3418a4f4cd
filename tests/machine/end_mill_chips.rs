//! Measured chip loads of end mills: the command's figures against closed forms, and the thickest chip against the area that
//! two circles and a wall leave.

use arcfeed_milling::cutting::measured_move::{GoverningRule, MeasuredMove};
use arcfeed_model::cut::{ContourSide, CutRule, Moves, Work};
use arcfeed_model::job::{LawKind, ToolSetup};
use arcfeed_model::stock::{Stock, StockLine};
use arcfeed_model::tool::{Edge, EndMill, Tool};
use arcfeed_nc::modal::{Feed, Plane, Pose, Turn};
use arcfeed_nc::segment::{Arc, Path, Segment};
use arcfeed_tests::{Scratch, run};
use arcfeed_units::{MmPerTooth, Nm, RevPerMin};
use nalgebra::Vector2;
use serde_json::Value;

/// Positions are whole nanometres: largest error of the distance of two contact points, mm.
const ROUNDING_MM: f64 = 2e-6;
/// Tool radius, mm.
const R_MM: f64 = 5.0;

/// A tool of 10 mm with four teeth at 3000 rev/min: F1200 is 0.1 mm a tooth.
fn job(law: &str, rules: &str) -> String {
    format!(
        "units = \"mm\"\nprogram = \"program.nc\"\n[tool]\nkind = \"end-mill\"\ndiameter = 10\nteeth = 4\n\
         [spindle]\nrev_per_min = 3000\n[limits]\nmax_feed = 6000\n\
         [law]\n{law}\nfeed_per_tooth = 0.1\n[override]\nmode = \"safe-base\"\n{rules}"
    )
}

fn simulate(name: &str, job: &str, program: &str) -> Value {
    let scratch = Scratch::new(&format!("end-mill-{name}"));
    scratch.write("program.nc", program);
    let output = run(&["simulate", &scratch.write("job.toml", job), "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one object")
}

#[track_caller]
fn number(value: &Value, pointer: &str) -> f64 {
    value.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("no {pointer} in {value}"))
}

/// Least and largest of the original program under a rule, mm.
fn before(report: &Value, rule: usize) -> [f64; 2] {
    ["min", "max"].map(|field| number(report, &format!("/movements/{rule}/baseline_chip_load/{field}")))
}

const CONTOUR_RULES: &str = "[[cut]]\nmoves = \"arcs\"\ndirection = \"ccw\"\nside = \"inside\"\nradial_depth = 1\nn = [10, 19]\n\
    [[cut]]\nmoves = \"arcs\"\ndirection = \"cw\"\nside = \"outside\"\nradial_depth = 1\n\
    [[cut]]\nmoves = \"arcs\"\ndirection = \"ccw\"\nside = \"slot\"\nn = [30, 39]\n\
    [[cut]]\nmoves = \"lines\"\nside = \"inside\"\nradial_depth = 1\n";

#[test]
fn the_feed_at_the_contour_is_that_of_the_radii() {
    // Paths of 7, 20 and 12 mm at a constant F1200: 0.1 mm a tooth at the centre.
    let program = "%\nG21G17G90G94\nS3000M3\nG0X0Y0Z0\nN5G1X50.F1200.\nN10G3I-7.\nN20G2I-20.\nN30G3I-12.\nM30\n%\n";
    let law = "kind = \"contour\"\ninside_only = false";
    for (plane, letters) in [("G17", "XYZIJK"), ("G18", "ZXYKIJ"), ("G19", "YZXJKI")] {
        let axis = ["z", "y", "x"][["G17", "G18", "G19"].iter().position(|name| *name == plane).expect("a plane")];
        let job = job(law, CONTOUR_RULES).replace("teeth = 4\n", &format!("teeth = 4\naxis = \"{axis}\"\n"));
        let report = simulate(&format!("contour-{plane}"), &job, &arcfeed_tests::in_plane(program, plane, letters));
        let contours = [(7.0 + R_MM) / 7.0, (20.0 - R_MM) / 20.0, (12.0 + R_MM) / 12.0, 1.0].map(|ratio| 0.1 * ratio);
        for (rule, (contour_mm, path_mm)) in contours.into_iter().zip([7.0, 20.0, 12.0, f64::INFINITY]).enumerate() {
            let [least, most] = before(&report, rule);
            // A tooth's step is the chord of its arc, s^2 / 24 q^2 shorter.
            let chord = 0.01 / 24.0 / (path_mm * path_mm);
            println!("{plane} rule {}: {least:.6} .. {most:.6}, closed form {contour_mm:.6}", rule + 1);
            assert!(most <= contour_mm + ROUNDING_MM && least >= contour_mm * (1.0 - chord - 5.1e-3), "{report}");
            let error = number(&report, &format!("/movements/{rule}/chip_load/error_ratio_max_all"));
            assert!((-0.02..=0.005).contains(&error), "rule {}: {error}", rule + 1);
            assert_eq!(report["movements"][rule]["measure"], "contour");
        }
        let error = number(&report, "/baseline_chip_load/error_ratio_max");
        assert!((error - R_MM / 7.0).abs() < 1e-3, "without the law the meter notices: {error}");
    }
}

#[test]
fn each_of_two_tools_is_measured_by_its_own_rules_and_target() {
    let tool = |number: u8, diameter: u8, teeth: u8, feed: f64| {
        format!(
            "[[tool]]\nnumber = {number}\nkind = \"end-mill\"\ndiameter = {diameter}\nteeth = {teeth}\n\
             [tool.law]\nkind = \"contour\"\nfeed_per_tooth = {feed}\n[[tool.cut]]\nmoves = \"arcs\"\ndirection = \"ccw\"\n\
             side = \"inside\"\nradial_depth = 1\n"
        )
    };
    let head = "units = \"mm\"\nprogram = \"program.nc\"\n[spindle]\nrev_per_min = 3000\n[limits]\nmax_feed = 6000\n";
    let job = format!("{head}{}{}", tool(1, 10, 4, 0.1), tool(2, 6, 2, 0.05));
    let circle = "G0X20.Y0Z5.\nG1Z0F600.\nG3I-10.F1200.\nG0Z50.\n";
    let program = format!("%\nG21G17G90G94\nT1M6\nS3000M3\n{circle}M5\nT2M6\nS3000M3\n{circle}M30\n%\n");
    let report = simulate("two", &job, &program);
    // Both paths have a radius of 10 mm.
    let wanted = [(1, 0.1, 0.1 * 15.0 / 10.0), (2, 0.05, 0.2 * 13.0 / 10.0)];
    for (place, (tool, target, before_mm)) in wanted.into_iter().enumerate() {
        let figures = &report["tools"][place];
        assert_eq!(
            (&figures["tool"], number(figures, "/chip_load/target")),
            (&Value::from(tool), f64::from(target as f32))
        );
        let [before, after] = ["baseline_chip_load", "chip_load"].map(|run| number(figures, &format!("/{run}/max")));
        println!("T{tool}: {before:.5} before, {after:.5} after, target {target}");
        assert!((before / before_mm - 1.0).abs() < 1e-3 && (after / target - 1.0).abs() < 5e-3, "{figures}");
    }
    assert!(report["chip_load"]["target"].is_null() && report["chip_load"]["max"].is_null());
    assert!(number(&report, "/chip_load/error_ratio_max_all") < 5e-3);
}

#[test]
fn the_engagement_law_keeps_every_chip_below_its_target() {
    let program = "%\nG21G17G90G94\nS3000M3\nG0X0Y0Z0\nN5G1X50.F1200.\nN10G3I-7.\nN20G2I-20.\nN30G3I-12.\nM30\n%\n";
    let report = simulate("engagement", &job("kind = \"engagement\"", CONTOUR_RULES), program);
    for movement in report["movements"].as_array().expect("a list") {
        let [least, most] =
            ["min", "error_ratio_max_all"].map(|field| number(movement, &format!("/chip_load/{field}")));
        println!("{}: {least:.4}, at most {:+.2} %", movement["side"], 1e2 * most);
        assert!(most < 5e-3 && movement["measure"] == "thickest-chip", "{movement}");
    }
}

#[test]
fn on_lines_the_stock_is_that_of_their_level_and_plane() {
    let rules = |stock: &str| format!("[[cut]]\nmoves = \"lines\"\nside = \"outer\"\nstock = {stock}\n");
    // 5 mm below zero, a face with this rise is 3 mm further out: at -1.5 mm in place of -4.5 mm.
    let program = "%\nG21G17G90G94\nS3000M3\nG0X0Y0Z5.\nN4G1Z-5.F500.\nN5G1X40.F1200.\nM30\n%\n";
    let stock = rules("{ normal_deg = 90, offset = -4.5, rise = -0.6 }");
    let report = simulate("rise", &job("kind = \"engaged-arc\"", &stock), program);
    let [target, most] = ["target", "max"].map(|field| number(&report, &format!("/chip_load/{field}")));
    println!("at its level: {most:.5} mm, target {target:.5}");
    assert!(most < target * 1.005 && most > target * 0.98, "{most} {target}");
    // In G18 the plane is (Z, X): a line along X, its stock on the side of negative X.
    let program = "%\nG21G18G90G94\nS3000M3\nG0X0Z0Y0\nN5G1X-40.F1200.\nM30\n%\n";
    let stock = rules("{ normal_deg = 90, offset = -4.9 }");
    let job = job("kind = \"engaged-arc\"", &stock).replace("teeth = 4\n", "teeth = 4\naxis = \"y\"\n");
    let report = simulate("along-y", &job, program);
    let times = ["cycle_time_s", "baseline_cycle_time_s"].map(|time| number(&report, &format!("/{time}")));
    assert!(times[0] == times[1] && report["movements"][0]["arcs"] == 0, "it keeps its own feed: {report}");
}

fn mill_move(path: Path, end_mm: [f64; 2], work: Work, law: LawKind) -> (Segment, CutRule, ToolSetup) {
    let pose = |[x, y]: [f64; 2]| Pose { linear: [x, y, 0.0].map(Nm::from_mm), ..Pose::default() };
    let segment = Segment { sequence: None, start: pose([0.0; 2]), end: pose(end_mm), feed: Feed::Missing, path };
    let moves = if path == Path::Line { Moves::Lines } else { Moves::Arcs(Turn::Ccw) };
    let rule = CutRule { tool: 0, moves, work, feed_per_tooth: None, table: None, sequence: None, level: None };
    let tool = Tool::EndMill(EndMill { radius: Nm::from_mm(R_MM), teeth: 4 });
    (segment, rule, ToolSetup::new(tool, RevPerMin(3000.0), law, MmPerTooth(1.0)))
}

/// Measured thickest chip at a place on a move, mm.
fn measured(of: &(Segment, CutRule, ToolSetup), at_mm: Vector2<f64>, delta_mm: Vector2<f64>) -> f64 {
    let (segment, rule, setup) = of;
    let governing = GoverningRule { index: 0, rule, setup, along: None, target: None };
    MeasuredMove::new(segment, &governing).expect("it is measured").ratio(&at_mm, &delta_mm).expect("it cuts")
}

/// Thickest chip along the radius of the tooth that cuts, about the centre one tooth later: the length of material between
/// the surface that the tooth before left and the tooth's own circle, by steps of a micrometre.
fn thickest_by_rays(at_mm: Vector2<f64>, delta_mm: Vector2<f64>, is_material: &dyn Fn(&Vector2<f64>) -> bool) -> f64 {
    let center_mm = at_mm + delta_mm;
    let forward_rad = libm::atan2(delta_mm.y, delta_mm.x);
    let depths_mm =
        |u: Vector2<f64>| (0..2_000).map(move |step| center_mm + u * (R_MM - (f64::from(step) + 0.5) * 1e-4));
    let thickness_mm = |turn: i32| {
        let (sin, cos) = libm::sincos(forward_rad + f64::from(turn) * 5e-4);
        let chip = depths_mm(Vector2::new(cos, sin)).take_while(|point| (point - at_mm).norm() > R_MM);
        chip.filter(|point| is_material(point)).count() as f64 * 1e-4
    };
    (-3_141..=3_141).map(thickness_mm).fold(0.0, f64::max)
}

type IsMaterial = dyn Fn(&Vector2<f64>) -> bool;

/// A move at a place with the material around it.
struct Case<'a> {
    name: &'a str,
    of: (Segment, CutRule, ToolSetup),
    /// Position, and travel of a tooth.
    tooth_mm: (Vector2<f64>, Vector2<f64>),
    is_material: Box<IsMaterial>,
}

fn assert_near(cases: &[Case<'_>]) {
    for Case { name, of, tooth_mm: (at_mm, delta_mm), is_material } in cases {
        let [found, wanted] = [measured(of, *at_mm, *delta_mm), thickest_by_rays(*at_mm, *delta_mm, is_material)];
        println!("{name}: {found:.5} mm, by rays {wanted:.5} mm");
        assert!((found - wanted).abs() < 3e-4, "{name}: {found} {wanted}");
    }
}

#[test]
fn the_thickest_chip_in_a_shape_is_the_one_between_two_circles_and_its_boundary() {
    let case = |name, stock, is_material| {
        let law = LawKind::EngagedArc { both_edges: false };
        let of = mill_move(Path::Line, [50.0, 0.0], Work::Ring(Edge::Outer, stock), law);
        Case { name, of, tooth_mm: (Vector2::zeros(), Vector2::new(0.1, 0.0)), is_material }
    };
    let below = |y_mm: f64| Stock::half_plane(StockLine::from_angle(90.0, y_mm));
    let polygon = Stock::polygon(&[[2.0, -9.0], [30.0, -9.0], [30.0, -3.0], [2.0, -3.0]]).expect("convex");
    let disc = Stock::Disc { center_mm: [6.0, -7.0], radius_mm: 5.0 };
    assert_near(&[
        case("half plane", below(-3.0), Box::new(|p| p.y <= -3.0)),
        case("more than half", below(2.0), Box::new(|p| p.y <= 2.0)),
        case("polygon", polygon, Box::new(|p| (2.0..=30.0).contains(&p.x) && (-9.0..=-3.0).contains(&p.y))),
        case("disc", disc, Box::new(|p| (p - Vector2::new(6.0, -7.0)).norm() <= 5.0)),
    ]);
}

/// Quarter of a circle about (0, radius), counter-clockwise from the origin.
fn quarter(radius_mm: f64) -> Path {
    let points = [[0.0, radius_mm], [0.0, -radius_mm], [radius_mm, 0.0]];
    let [center, from, to] = points.map(|point| point.map(Nm::from_mm));
    Path::Arc(Arc { plane: Plane::Xy, turn: Turn::Ccw, center, from, to })
}

#[test]
fn the_thickest_chip_at_a_wall_is_the_one_between_two_circles_and_the_wall() {
    let work = |side, depth_mm: f64| Work::Mill { side, radial_depth: Nm::from_mm(depth_mm) };
    let on_arc = |name, radius_mm: f64, work, from_rad: f64, is_material| {
        let at = |rad: f64| Vector2::new(radius_mm * libm::sin(rad), radius_mm * (1.0 - libm::cos(rad)));
        let of = mill_move(quarter(radius_mm), [radius_mm; 2], work, LawKind::Engagement);
        let tooth_mm = (at(from_rad), at(from_rad + 0.1 / radius_mm) - at(from_rad));
        Case { name, of, tooth_mm, is_material }
    };
    // Inside: material beyond 6 + 5 - 1 from (0, 6) and, behind the quarter, beyond x = 10. Outside: within 12 - 5 + 2.
    let pocket = |p: &Vector2<f64>| if p.y > 6.0 { p.x >= 10.0 } else { (p - Vector2::new(0.0, 6.0)).norm() >= 10.0 };
    let island = |p: &Vector2<f64>| if p.y > 12.0 { p.x <= 9.0 } else { (p - Vector2::new(0.0, 12.0)).norm() <= 9.0 };
    let inside = || work(ContourSide::Inside, 1.0);
    let outside = || work(ContourSide::Outside, 2.0);
    let line = Case {
        name: "line",
        of: mill_move(Path::Line, [50.0, 0.0], inside(), LawKind::Engagement),
        tooth_mm: (Vector2::zeros(), Vector2::new(0.1, 0.0)),
        is_material: Box::new(|p| p.y >= 4.0),
    };
    assert_near(&[
        line,
        on_arc("slot", 6.0, work(ContourSide::Slot, 0.0), 0.5, Box::new(|_| true)),
        on_arc("inside, start", 6.0, inside(), 0.0, Box::new(pocket)),
        on_arc("inside, near the end", 6.0, inside(), 1.4, Box::new(pocket)),
        on_arc("outside", 12.0, outside(), 0.2, Box::new(island)),
        on_arc("outside, near the end", 12.0, outside(), 1.5, Box::new(island)),
    ]);
}
