//! Material that a sweep removes from a ray, compared with brute force: for thousands of positions of the tool along its
//! path, the largest depth of each point of the ray inside the tool. It shares only the solid with the kernel.

use arcfeed_dexel::dexel::{Dexel, Interval};
use arcfeed_dexel::lattice::Lattice;
use arcfeed_dexel::profile::Profile;
use arcfeed_dexel::section::{Section, Sweep};
use arcfeed_dexel::sweep::passes;
use arcfeed_dexel::tool::{Slab, Tool};
use fastrand::Rng;

/// Places along the way.
const PLACES: u32 = 1_500;

/// Distance of a point outside the slab; negative inside. Where two faces meet it is a lower bound of the distance.
pub fn outside_mm(slab: &Slab, sweep: &Sweep, s: f64, point: [f64; 3]) -> f64 {
    let q = [0, 1, 2].map(|i| point[i] - sweep.from_mm[i] - s * (sweep.to_mm[i] - sweep.from_mm[i]));
    let z = (0..3).map(|i| q[i] * sweep.axis[i]).sum::<f64>();
    let radial = [0, 1, 2].map(|i| q[i] - z * sweep.axis[i]);
    let r = libm::sqrt(radial.iter().map(|part| part * part).sum());
    let [low, high] = slab.heights_mm;
    let at = |radii: [f64; 2]| radii[0] + (radii[1] - radii[0]) * (z - low) / (high - low);
    let slant = |radii: [f64; 2]| libm::hypot(1.0, (radii[1] - radii[0]) / (high - low));
    let outer = (r - at(slab.outer_mm)) / slant(slab.outer_mm);
    let inner = slab.inner_mm.map_or(f64::NEG_INFINITY, |inner| (at(inner) - r) / slant(inner));
    [low - z, z - high, outer, inner].into_iter().fold(f64::NEG_INFINITY, f64::max)
}

fn direction(rng: &mut Rng) -> [f64; 3] {
    loop {
        let v = [0; 3].map(|_| rng.f64() * 2.0 - 1.0);
        let length = libm::sqrt(v.iter().map(|part| part * part).sum());
        if (0.1..1.0).contains(&length) {
            return v.map(|part| part / length);
        }
    }
}

/// A slab of any of the shapes a tool may have.
fn slab(rng: &mut Rng) -> Slab {
    let radius = |rng: &mut Rng| 1.0 + 4.0 * rng.f64();
    let low = rng.f64() * 4.0 - 2.0;
    let heights_mm = [low, low + 0.3 + 5.0 * rng.f64()];
    let first = radius(rng);
    let outer_mm = match rng.u8(0..3) {
        0 => [first, first],
        1 => [0.0, first],
        _ => [first, radius(rng)],
    };
    let hole = |rng: &mut Rng| [rng.f64() * outer_mm[0], rng.f64() * outer_mm[1]];
    let inner_mm = match rng.u8(0..3) {
        0 => None,
        1 => Some(hole(rng)),
        _ => Some(outer_mm.map(|outer| 0.8 * outer)),
    };
    Slab { heights_mm, outer_mm, inner_mm }
}

/// Ways that occur: any, standing still, along the axis, square to it, along a ray.
fn sweep(rng: &mut Rng) -> Sweep {
    let axis = match rng.u8(0..3) {
        0 => [0.0, 0.0, 1.0],
        1 => [0.0, 0.6, 0.8],
        _ => direction(rng),
    };
    let way = match rng.u8(0..6) {
        0 => [0.0; 3],
        1 => axis.map(|part| part * 3.0),
        2 => [4.0, 0.0, 0.0],
        3 => [0.0, 3.0, -1.0],
        4 => [2.4, -3.1, 0.0],
        _ => direction(rng).map(|part| part * 6.0),
    };
    let from_mm = [0; 3].map(|_| rng.f64() * 6.0 - 3.0);
    Sweep { from_mm, to_mm: [0, 1, 2].map(|i| from_mm[i] + way[i]), axis }
}

/// The same cut, through the boxes and stretches that keep most rays from being asked.
fn assert_not_culled(slab: &Slab, sweep: &Sweep, (ray_axis, point): (usize, [f64; 3]), spans: &[Interval]) {
    let [low, high] = slab.heights_mm;
    let wall = |radii: [f64; 2]| Profile::from(radii[0], low, 1.0).unwrap().line(radii[1], high).unwrap();
    let tool = Tool::new(&wall(slab.outer_mm), slab.inner_mm.map(wall).as_ref()).unwrap();
    let pass = passes(&tool, &[*sweep], ray_axis)[0];
    let taken_mm: f64 = spans.iter().map(Interval::length_mm).sum();
    // The ray is in the middle of the cell at 60.
    let lattice = Lattice::new(point.map(|at| at - 60.5), point.map(|at| at + 60.5), 1.0).unwrap();
    let reach = pass
        .reach(&lattice, point[Lattice::across(ray_axis)[1]])
        .filter(|reach| reach.columns().any(|column| column == 60));
    let mut ray = Dexel::One(Interval::new(-60.0, 60.0));
    let removed_mm = reach.map_or(0.0, |reach| pass.cut(point, &reach, &mut ray));
    assert!((removed_mm - taken_mm).abs() < 1e-9, "{removed_mm} {taken_mm} {slab:?} {sweep:?} {point:?}");
    let corners = pass.box_mm().map(|corner| corner[ray_axis]);
    let way = sweep.motion_mm()[ray_axis];
    for span in spans {
        assert!(pass.may_cut(&point, &Dexel::One(*span)), "{slab:?} {sweep:?} {point:?}");
        assert!(corners[0] + way.min(0.0) <= span.from_mm && span.to_mm <= corners[1] + way.max(0.0));
    }
}

#[test]
fn a_ray_loses_what_the_tool_meets_on_its_way_and_nothing_else() {
    let mut rng = Rng::with_seed(8);
    let (mut inside, mut outside, mut split) = (0, 0, 0);
    for case in 0..1_500 {
        let (slab, sweep, ray_axis) = (slab(&mut rng), sweep(&mut rng), rng.usize(0..3));
        let (s, height_mm) = (rng.f64(), slab.heights_mm[0] + rng.f64() * (slab.heights_mm[1] - slab.heights_mm[0]));
        let middle = |i: usize| sweep.from_mm[i] + s * sweep.motion_mm()[i] + height_mm * sweep.axis[i];
        let point = [0, 1, 2].map(|i| middle(i) + rng.f64() * 8.0 - 4.0);
        let mut spans: Vec<Interval> = Vec::new();
        let anywhere = Interval::new(-1e9, 1e9);
        Section::new(&slab, &sweep, ray_axis).for_each_span(point, &anywhere, |span| spans.push(span));
        assert_not_culled(&slab, &sweep, (ray_axis, point), &spans);
        split += usize::from(spans.len() > 1);
        let way_mm = libm::sqrt((0..3).map(|i| (sweep.to_mm[i] - sweep.from_mm[i]).powi(2)).sum());
        for _ in 0..12 {
            let mut at = point;
            at[ray_axis] = point[ray_axis] + rng.f64() * 10.0 - 5.0;
            let places = (0..=PLACES).map(|place| f64::from(place) / f64::from(PLACES));
            let deepest = places.map(|s| outside_mm(&slab, &sweep, s, at)).fold(f64::INFINITY, f64::min);
            let is_taken = spans.iter().any(|span| span.from_mm < at[ray_axis] && at[ray_axis] < span.to_mm);
            if is_taken {
                // Between two places the tool may come deeper by half the way between them.
                assert!(
                    deepest <= way_mm / f64::from(PLACES) / 2.0 + 1e-9,
                    "{case}: {deepest} {slab:?} {sweep:?} {at:?}"
                );
                inside += 1;
            } else {
                assert!(deepest >= -1e-9, "{case}: {deepest} {slab:?} {sweep:?} {at:?} {spans:?}");
                outside += 1;
            }
        }
    }
    println!("points taken {inside}, left {outside}; rays with more than one piece {split}");
    assert!(inside > 1_500 && outside > 1_500 && split > 50, "{inside} {outside} {split}");
}
