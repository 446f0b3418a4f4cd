//! A plane blade in dexels: what the balls of the finish take from it.

use arcfeed_dexel::deviation::HeightMap;
use arcfeed_dexel::lattice::Lattice;
use arcfeed_dexel::section::Sweep;
use arcfeed_dexel::solid::Block;
use arcfeed_dexel::tool::Tool;
use arcfeed_dexel::workpiece::Stock;
use arcfeed_plan::geometry::face::Jet;
use arcfeed_plan::geometry::surface::Surface;
use arcfeed_plan::repair::blend::{BlendShape, FinishAllowance};
use arcfeed_plan::repair::passes::{PassSettings, RepairContact, pass_lines};
use arcfeed_plan::vector::{Point, Vector};

use crate::plunge::table::{Worst, rows};

/// Extents along u and v.
const PLATE_MM: [f64; 2] = [40.0, 30.0];
const RAYS_MM: f64 = 0.1;
/// A small ball and low cusps, because the file's volumes have none.
const PASSES: PassSettings = PassSettings { ball_mm: 1.0, cusp_mm: 5e-5, chord_mm: 1e-4, step_mm: 1.0 };

struct Plate;

impl Surface for Plate {
    fn jet(&self, [u, v]: [f64; 2]) -> Jet {
        let [along, across] = [Vector::x() * PLATE_MM[0], Vector::y() * PLATE_MM[1]];
        let zero = Vector::zeros();
        Jet { point: Point::from(along * u + across * v), u: along, v: across, uu: zero, uv: zero, vv: zero }
    }

    fn ranges(&self) -> [[f64; 2]; 2] {
        [[0.0, 1.0]; 2]
    }

    fn outward(&self) -> f64 {
        1.0
    }
}

/// Heights along Z of a plate as high as the weld after the finish.
fn finished(allowance: &FinishAllowance, weld_mm: f64, border_v: impl Fn(f64) -> f64) -> (Lattice, HeightMap) {
    let block = Block { lowest_mm: [0.0, 0.0, -1.0], highest_mm: [PLATE_MM[0], PLATE_MM[1], weld_mm] };
    let mut stock = Stock::new(&block, RAYS_MM, 1 << 30).unwrap();
    let tool = Tool::ball(PASSES.ball_mm, 10.0, 1e-5).unwrap();
    let lines = pass_lines(&Plate, allowance.from_u, [0.0, 1.0], &PASSES).unwrap();
    let tip = |at: &RepairContact| (at.point + (at.normal - Vector::z()) * PASSES.ball_mm).coords.into();
    for line in lines.contacts(&Plate, |at, _| allowance.left_mm(at, border_v(at[0]))) {
        let sweep =
            |pair: &[RepairContact]| Sweep { from_mm: tip(&pair[0]), to_mm: tip(&pair[1]), axis: [0.0, 0.0, 1.0] };
        stock.cut(&tool, &line.windows(2).map(sweep).collect::<Vec<_>>()).unwrap();
    }
    (*stock.lattice(), HeightMap::new(&stock, 2))
}

#[test]
fn point_2_volumes_of_a_plane_blade_are_those_that_dexels_lose() {
    let mut worst = Worst::default();
    // Two of the six: the least and the largest transition.
    let cases = rows(include_str!("data/feng_plate_volume.csv")).into_iter();
    for row in cases.filter(|row| ["v1", "v11"].contains(&row.word("case"))) {
        let [from_u, leading_u, trailing_u] = row.numbers(["u1", "u2", "u3"]);
        let [old_mm, weld_mm] = row.numbers(["old_mm", "repaired_mm"]);
        let allowance =
            FinishAllowance { from_u, leading_u, trailing_u, old_mm, least_mm: 0.0, shape: BlendShape::Linear };
        let border_v = |u: f64| ((u - leading_u) / (trailing_u - leading_u)).clamp(0.0, 1.0);
        let (lattice, after) = finished(&allowance, weld_mm, border_v);
        let [width, _] = lattice.size(2);
        let mut removed = [0.0; 2];
        for (ray, after_mm) in after.heights_mm().iter().enumerate() {
            let [u, v] =
                [lattice.center_mm(0, ray % width) / PLATE_MM[0], lattice.center_mm(1, ray / width) / PLATE_MM[1]];
            let is_weld = u > leading_u + (trailing_u - leading_u) * v;
            // What stood above the old surface beside the weld is no part of the blade.
            let before_mm = if is_weld { weld_mm } else { old_mm };
            removed[usize::from(!is_weld)] += (before_mm - after_mm.unwrap()).max(0.0) * RAYS_MM * RAYS_MM;
        }
        worst.absolute("repaired, ratio", removed[0] / row.number("removed_repaired_mm3"), 1.0);
        worst.absolute("transition, ratio", removed[1] / row.number("removed_transition_mm3"), 1.0);
    }
    worst.within("feng_plate_volume, dexels", &[("repaired, ratio", 1e-3), ("transition, ratio", 1e-3)]);
}
