//! Steps between planes of plunges: each plane is computed once, none is too far from the one before, and jumps are refused.

use core::sync::atomic::{AtomicUsize, Ordering};

use arcfeed_plan::plunge::assembly::ball_mm;
use arcfeed_plan::plunge::field::Field;
use arcfeed_plan::plunge::infeasibility::PlungeInfeasible;
use arcfeed_plan::plunge::line::Fit;
use arcfeed_plan::plunge::mill::PlungeMill;
use arcfeed_plan::plunge::passage::{Passage, PlungeRequirements};
use arcfeed_plan::plunge::rows::{Row, Rows};
use arcfeed_plan::plunge::section::{PlungeSection, SectionFamily, SectionPlane};

use super::passage::rotor_b;

const RANGE_MM: [f64; 2] = [-20.0, 20.0];
/// Planes of the grid, 2 mm apart.
const GRID: usize = 21;
/// Place of the jump.
const JUMP_Z_MM: f64 = 3.3;

/// Planes across the rotor's axis, counted, whose axes jump along the circumference at one place.
struct Jumping<'p> {
    passage: &'p Passage<'p>,
    jump_mm: f64,
    count: AtomicUsize,
}

impl SectionFamily for Jumping<'_> {
    fn at(&self, at_mm: f64) -> Result<PlungeSection, PlungeInfeasible> {
        self.count.fetch_add(1, Ordering::Relaxed);
        let mut boundary = self.passage.boundary(at_mm).ok_or(PlungeInfeasible::NoBoundary { z_mm: at_mm })?;
        if at_mm > JUMP_Z_MM {
            boundary.roof.iter_mut().chain(&mut boundary.floor).for_each(|place| place.x += self.jump_mm);
        }
        Ok(PlungeSection { plane: SectionPlane::radial(at_mm, boundary.middle_rad), boundary })
    }

    fn too_narrow(&self, _: &PlungeSection) -> PlungeInfeasible {
        unreachable!("steps do not ask for the room")
    }
}

/// Planes of the 13-blade rotor for a mill of 12 mm, and how often one was computed.
fn places(cusp_mm: f64, jump_mm: f64) -> (Result<Vec<Row>, PlungeInfeasible>, usize) {
    let blisk = rotor_b();
    let field = Field::new(&blisk);
    let mill = PlungeMill {
        radius_mm: 6.0,
        corner_radius_mm: 0.4,
        core_radius_mm: 0.0,
        width_max_mm: 5.0,
        length_mm: 40.0,
        neck_mm: Vec::new(),
        holder_mm: Vec::new(),
        teeth: 3,
    };
    let needs = PlungeRequirements { allowance_mm: 0.8, cusp_mm, fit: Fit::Gap, clearance_mm: 5.0, relief_mm: 0.2 };
    let (turning_mm, turning_ball_mm) = (blisk.blank.radius_mm, ball_mm(&blisk.blank));
    let passage = Passage { blisk: &blisk, field: &field, mill: &mill, needs: &needs, turning_mm, turning_ball_mm };
    let family = Jumping { passage: &passage, jump_mm, count: AtomicUsize::new(0) };
    let found = Rows { passage: &passage, family: &family, range_mm: RANGE_MM }.places();
    (found, family.count.load(Ordering::Relaxed))
}

#[test]
fn the_planes_that_are_computed_are_as_many_as_those_of_the_plan_and_the_grid() {
    for cusp_mm in [0.2, 0.0125] {
        let (rows, computed) = places(cusp_mm, 0.0);
        let rows = rows.unwrap();
        let steepest = rows.iter().map(|row| row.step_ratio).fold(0.0, f64::max);
        println!("cusp {cusp_mm} mm: {} planes, {computed} computed, steps up to {steepest:.3}", rows.len());
        assert_eq!(computed, GRID + rows.len());
        assert!(steepest <= 1.0);
    }
}

#[test]
fn a_jump_of_the_axes_that_the_cusp_does_not_allow_is_refused_with_its_place() {
    // Two circles of 6 mm, 0.2 mm high between them on a flat wall: 3.07 mm apart.
    let (rows, _) = places(0.2, 1.0);
    assert!(rows.unwrap().iter().all(|row| row.step_ratio <= 1.0));
    let refused = places(0.2, 5.0).0.unwrap_err();
    println!("{refused}");
    // Square to a leaning axis it is shorter than along the circumference.
    let PlungeInfeasible::Jump { z_mm, moved_mm, .. } = refused else { panic!("{refused:?}") };
    assert!((z_mm - JUMP_Z_MM).abs() < 2e-3 && (4.0..5.01).contains(&moved_mm), "{z_mm} {moved_mm}");
}
