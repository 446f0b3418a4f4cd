//! NASA's rotor 37: its largest plunge mill by a search that knows no walls and no lines, a mill below it, and one above.

use arcfeed_plan::plunge::assembly::ball_mm;
use arcfeed_plan::plunge::field::Field;
use arcfeed_plan::plunge::infeasibility::PlungeInfeasible;
use arcfeed_plan::plunge::line::Fit;
use arcfeed_plan::plunge::mill::PlungeMill;
use arcfeed_plan::plunge::passage::{Passage, PlungeRequirements};
use arcfeed_plan::plunge::proof::prove;

use super::free_line::widest_mm;
use super::plans::{least_mm, samples};

const NEEDS: PlungeRequirements =
    PlungeRequirements { allowance_mm: 0.5, cusp_mm: 0.2, fit: Fit::Gap, clearance_mm: 5.0, relief_mm: 0.2 };

fn mill(radius_mm: f64) -> PlungeMill {
    PlungeMill {
        radius_mm,
        corner_radius_mm: 0.2,
        core_radius_mm: 0.0,
        width_max_mm: radius_mm,
        length_mm: 12.0,
        neck_mm: vec![[radius_mm - 0.3, 90.0]],
        holder_mm: vec![[20.0, 60.0]],
        teeth: 2,
    }
}

#[test]
fn the_largest_mill_of_rotor_37_is_that_of_a_search_and_a_smaller_one_is_planned() {
    let Some(blisk) = crate::rotor37::blisk() else { return };
    let field = Field::new(&blisk);
    let passage = |mill: &PlungeMill| {
        let (turning_mm, turning_ball_mm) = (blisk.blank.radius_mm, ball_mm(&blisk.blank));
        Passage { blisk: &blisk, field: &field, mill, needs: &NEEDS, turning_mm, turning_ball_mm }.plan()
    };
    let probe = mill(1.0);
    let probe = Passage {
        blisk: &blisk,
        field: &field,
        mill: &probe,
        needs: &NEEDS,
        turning_mm: blisk.blank.radius_mm,
        turning_ball_mm: ball_mm(&blisk.blank),
    };
    let largest = probe.largest();
    for found in &largest {
        let circles = probe.circles(found.z_mm);
        let angles = found.touching.map(|at| libm::atan2(at.y, at.x));
        let searched_mm =
            widest_mm(&blisk, found.z_mm, [circles.floor_mm, circles.roof_mm], angles[0].midpoint(angles[1]));
        println!(
            "z {:.2} mm: R {:.3} mm, by search {:.3} mm",
            found.z_mm,
            found.radius_mm,
            searched_mm - NEEDS.allowance_mm
        );
        assert!(searched_mm - NEEDS.allowance_mm >= found.radius_mm - 0.03);
    }
    let least_mm_radius = largest.iter().map(|found| found.radius_mm).fold(f64::INFINITY, f64::min);
    let refused = passage(&mill(least_mm_radius + 0.1)).unwrap_err();
    println!("{refused}");
    assert!(matches!(refused, PlungeInfeasible::TooNarrow { .. } | PlungeInfeasible::FaceTooNarrow { .. }));
    let small = mill(least_mm_radius - 0.1);
    let plan = passage(&small).unwrap();
    let proof = prove(&blisk, &small, &plan.plunges, NEEDS.allowance_mm, &[]);
    println!("{} planes, {} plunges: {:?}", plan.planes.len(), plan.plunges.len(), proof.clearances);
    assert!(proof.holds());
    let samples = samples(&blisk);
    let places = plan.plunges.iter().flat_map(|plunge| (0..=8).map(|k| plunge.tip + plunge.axis * f64::from(k) * 9.0));
    let nearest_mm = places.map(|place| least_mm(&samples, &place)).fold(f64::INFINITY, f64::min);
    assert!(nearest_mm >= small.radius_mm + NEEDS.allowance_mm - 0.01, "{nearest_mm}");
}
