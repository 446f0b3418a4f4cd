//! Engaged arcs of circles, compared with calculation by hand or with the swept area: no part of a true arc is missing,
//! and little is added.

use std::f64::consts::FRAC_PI_2;

use crate::engage::cut_job::{CHIP_MM, Cut, MILL, RING, Row, STEP_MM, read};

/// Largest error of 16 knots on a curved path, degrees.
const KNOTS_DEG: f64 = 1.0;
/// Rounding between program, map and test, degrees.
const ROUNDING_DEG: f64 = 0.02;

/// The true beginning of an arc is where the map says, or later by what the resolution costs: half of the rays' distance along
/// the circle, and two samples of path.
#[track_caller]
fn assert_from(rows: &[Row], circle: usize, radius_mm: f64, paths_mm: [f64; 2], from_deg: impl Fn(f64) -> f64) {
    let cells_deg = (STEP_MM / radius_mm).to_degrees();
    let mut worst = 0.0_f64;
    for step in 0..=200 {
        let path_mm = paths_mm[0] + (paths_mm[1] - paths_mm[0]) * f64::from(step) / 200.0;
        let [found, _] = read(rows, circle, path_mm);
        let near = [-3.0, 0.0, 3.0].map(|samples| from_deg(path_mm + samples * STEP_MM));
        assert!(found <= near[1] + ROUNDING_DEG, "{path_mm}: {found} cuts off {}", near[1]);
        let least = near.into_iter().fold(f64::INFINITY, f64::min);
        worst = worst.max(least - found);
        assert!(found >= least - 2.0 * cells_deg - KNOTS_DEG, "{path_mm}: {found} for {least}");
    }
    println!("at most {worst:.2} degrees more than within three cells of path");
}

#[test]
fn a_slot_is_engaged_from_side_to_side_and_a_shoulder_from_its_edge_on() {
    for (name, edge_mm, from_deg) in [
        ("slot", 20.0, 0.0),
        ("shoulder-2", 2.0, libm::acos(0.4).to_degrees()),
        ("shoulder-minus-2", -2.0, libm::acos(-0.4).to_degrees()),
    ] {
        let workpiece = format!("block = {{ from = [0, -20, -2], to = [60, {edge_mm}, 0] }}");
        let cut = Cut {
            name,
            tool: MILL,
            workpiece: &workpiece,
            rule: "moves = \"lines\"\nside = \"outer\"\nn = [3, 3]",
            program: "%\nG21G17G90G94\nN1G0X-10.Y0.\nN2Z-2.\nN3G1X70.F600.\nN4M30\n%\n",
        };
        let map = cut.map();
        // In full after 15 mm, the end of the block in front after 65.
        assert_from(&map[0], 0, 5.0, [17.0, 60.0], |_| from_deg);
        assert!((0..50).all(|at| read(&map[0], 0, 17.0 + f64::from(at))[1] >= 180.0 - ROUNDING_DEG));
        // Before the tool touches nothing is engaged; then what is nearer than its radius, straight ahead first.
        let [from, to] = read(&map[0], 0, 3.0);
        assert!(from >= to, "{from} {to}");
        if name == "slot" {
            assert_from(&map[0], 0, 5.0, [6.0, 9.0], |path_mm| {
                let short_mm = (10.0 - path_mm).clamp(0.0, 5.0);
                90.0 - libm::acos((short_mm / (5.0 + CHIP_MM)).min(1.0)).to_degrees()
            });
        }
    }
}

#[test]
fn material_only_at_the_very_end_of_a_move_is_engaged() {
    // The block begins 4.8 mm in front of where the axis stops: less than a sample of path inside the circle.
    let cut = Cut {
        name: "end",
        tool: MILL,
        workpiece: "block = { from = [0, -20, -2], to = [60, 20, 0] }",
        rule: "moves = \"lines\"\nside = \"outer\"\nn = [3, 3]",
        program: "%\nG21G17G90G94\nN1G0X-10.Y0.\nN2Z-2.\nN3G1X-4.8F600.\nN4M30\n%\n",
    };
    let short_deg = libm::acos(4.8 / (5.0 + CHIP_MM)).to_degrees();
    let [from, to] = read(&cut.map()[0], 0, 5.2);
    println!("{from:.2} to {to:.2} degrees, by hand {:.2} to {:.2}", 90.0 - short_deg, 90.0 + short_deg);
    assert!(from <= 90.0 - short_deg + ROUNDING_DEG && to >= 90.0 + short_deg - ROUNDING_DEG);
    assert!(to - from <= 2.0 * short_deg + 4.0 * (STEP_MM / 5.0).to_degrees());
}

#[test]
fn return_pass_is_engaged_in_the_partial_layer_that_a_ramp_left() {
    // From 0 to -2 mm in 20 mm. A layer is 0.25 mm high: all but the last 2.5 mm of the ramp leaves the lowest one, half of these half of it.
    let cut = Cut {
        name: "ramp",
        tool: MILL,
        workpiece: "block = { from = [-10, -20, -2], to = [60, 20, 0] }",
        rule: "moves = \"lines\"\nside = \"outer\"\nn = [4, 4]",
        program: "%\nG21G17G90G94\nN1G0X0.Y0.\nN2Z0.\nN3G1X20.Z-2.F600.\nN4G1X0.F600.\nN5M30\n%\n",
    };
    let map = cut.map();
    // On the way back the circle is abeam of the ramp's end first: a fiftieth of a layer is left 0.05 mm further on.
    let near_deg = libm::asin(0.05 / 5.0).to_degrees() + ROUNDING_DEG;
    for at in 0..72 {
        let [from, to] = read(&map[0], 0, 0.25 * f64::from(at));
        assert!(from <= near_deg && to >= 180.0 - near_deg, "{at}: {from} to {to}");
    }
}

#[test]
fn second_pass_is_engaged_in_the_remaining_material_at_any_level_of_the_layer() {
    for (name, z) in
        [("level-on", "-1.75"), ("level-within", "-1.9"), ("level-above", "-1.749"), ("level-below", "-1.751")]
    {
        let program = format!(
            "%\nG21G17G90G94\nN1G0X-10.Y0.\nN2Z{z}\nN3G1X70.F600.\nN4G0X-10.\nN5G1Y3.F600.\nN6X70.F600.\nN7M30\n%\n"
        );
        let cut = Cut {
            name,
            tool: MILL,
            workpiece: "block = { from = [0, -20, -2], to = [60, 20, 0] }",
            rule: "moves = \"lines\"\nside = \"outer\"\nn = [6, 6]",
            program: &program,
        };
        let map = cut.map();
        // The pass before has left what is 2 mm and more to the left of the axis.
        let to_deg = libm::acos(0.4).to_degrees();
        for at in 0..40 {
            let [from, to] = read(&map[0], 0, 17.0 + f64::from(at));
            assert!(from <= ROUNDING_DEG, "{name} {at}: {from}");
            assert!((to_deg - ROUNDING_DEG..to_deg + 6.0).contains(&to), "{name} {at}: {to} for {to_deg}");
        }
    }
}

#[test]
fn an_inside_arc_is_engaged_from_where_the_wall_begins() {
    // Centre on 10 mm, wall from 12 mm on: (10^2 + 5^2 - 12^2) / (2 x 10 x 5) = -0.19.
    let from_deg = libm::acos(-0.19).to_degrees();
    for (name, code, to_y) in [("inside-ccw", "G3", 10), ("inside-cw", "G2", -10)] {
        let program =
            format!("%\nG21G17G90G94\nN1G0X10.Y0.\nN2Z2.\nN3G1Z-2.F300.\nN4{code}X0.Y{to_y}.I-10.J0.F600.\nN5M30\n%\n");
        let turn = if code == "G2" { "cw" } else { "ccw" };
        let cut = Cut {
            name,
            tool: MILL,
            workpiece: "round = { from = [0, 0, -2], to = [0, 0, 0], radius = 40, bore = 12 }",
            rule: &format!("moves = \"arcs\"\ndirection = \"{turn}\"\nside = \"outer\""),
            program: &program,
        };
        let map = cut.map();
        assert_from(&map[0], 0, 5.0, [2.0, 15.0], |_| from_deg);
        assert!(read(&map[0], 0, 8.0)[1] >= 180.0 - ROUNDING_DEG, "{map:?}");
    }
}

#[test]
fn both_circles_of_a_ring_are_engaged_behind_the_edge_of_the_stock() {
    // About a point on the outer circle; material where x > 5.
    let cut = Cut {
        name: "ring",
        tool: RING,
        workpiece: "block = { from = [5, -100, -2], to = [100, 100, 0] }",
        rule: "rotation = \"exterior\"\ndirection = \"ccw\"\nside = \"outer\"",
        program: "%\nG21G17G90G94\nN1G0X20.Y0.\nN2Z2.\nN3G1Z-2.F300.\nN4G3X0.Y20.I-20.J0.F600.\nN5M30\n%\n",
    };
    let map = cut.map();
    for (circle, radius_mm, paths_mm) in [(0, 20.0, [1.0, 28.0]), (1, 15.0, [4.0, 26.0])] {
        assert_from(&map[0], circle, radius_mm, paths_mm, |path_mm| Looking::new(circle, path_mm).first_deg());
        for at in 0..20 {
            let path_mm = paths_mm[0] + 1.25 * f64::from(at);
            let ([_, found], to) = (read(&map[0], circle, path_mm), Looking::new(circle, path_mm).last_deg());
            assert!((to - ROUNDING_DEG..to + 10.0).contains(&found), "{circle} at {path_mm}: {found} for {to}");
        }
    }
}

/// Directions in which the ring's circle has something in front of it: by looking, place by place, at what the ring has swept on
/// its way.
struct Looking {
    k: f64,
    reach_mm: f64,
    turned_rad: f64,
    /// Centres on the way; the last one is the present one.
    centers_mm: Vec<[f64; 2]>,
}

impl Looking {
    fn new(circle: usize, path_mm: f64) -> Self {
        let turned_rad = (path_mm / 20.0).clamp(0.0, FRAC_PI_2);
        let center_mm = |turned_rad: f64| [20.0 * libm::cos(turned_rad), 20.0 * libm::sin(turned_rad)];
        let centers_mm = (0..=400).map(|part| center_mm(turned_rad * f64::from(part) / 400.0)).collect();
        let (k, reach_mm) = if circle == 0 { (1.0, 20.0 + CHIP_MM) } else { (-1.0, 15.0 - CHIP_MM) };
        Looking { k, reach_mm, turned_rad, centers_mm }
    }

    fn is_engaged(&self, deg: f64) -> bool {
        let (k, reach_mm) = (self.k, self.reach_mm);
        let (sin, cos) = libm::sincos(self.turned_rad);
        let (ahead, towards) = libm::sincos(deg.to_radians());
        let [x, y] = self.centers_mm[400];
        let [x, y] =
            [x + reach_mm * (-towards * cos - k * ahead * sin), y + reach_mm * (-towards * sin + k * ahead * cos)];
        let is_swept = |[at_x, at_y]: &[f64; 2]| (15.0..=20.0).contains(&libm::hypot(x - at_x, y - at_y));
        x > 5.0 && !self.centers_mm.iter().any(is_swept)
    }

    fn first_deg(&self) -> f64 {
        hundredths_deg().find(|deg| self.is_engaged(*deg)).unwrap_or(180.0)
    }

    fn last_deg(&self) -> f64 {
        hundredths_deg().rfind(|deg| self.is_engaged(*deg)).unwrap_or(180.0)
    }
}

fn hundredths_deg() -> impl DoubleEndedIterator<Item = f64> {
    (0..=18_000).map(|step| f64::from(step) / 100.0)
}
