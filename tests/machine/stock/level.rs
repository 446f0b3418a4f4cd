//! What level moves of whole tools take, against brute force: tools whose outline goes in and out, with steps and holes, their
//! axis along any of the lattice's, either way up.

use arcfeed_dexel::lattice::Lattice;
use arcfeed_dexel::profile::Profile;
use arcfeed_dexel::section::Sweep;
use arcfeed_dexel::solid::Block;
use arcfeed_dexel::tool::Tool;
use arcfeed_dexel::workpiece::Stock;
use fastrand::Rng;

use super::figures::MEMORY_MAX;
use super::kernel::outside_mm;

/// Places along the way.
const PLACES: u32 = 600;

/// A tool of a few slabs; half of them have a hole.
fn tool(rng: &mut Rng) -> Tool {
    let mut knots = vec![[0.5 + 2.5 * rng.f64(), 0.0]];
    for _ in 0..5 {
        let [radius_mm, height_mm] = knots[knots.len() - 1];
        let radius_mm = if rng.u8(0..3) == 0 { radius_mm } else { 0.5 + 2.5 * rng.f64() };
        let rise_mm = if rng.u8(0..4) == 0 { 0.0 } else { 0.2 + rng.f64() };
        knots.push([radius_mm, height_mm + rise_mm]);
    }
    let last = knots[knots.len() - 1];
    knots.push([last[0], last[1] + 0.5]);
    let wall = |part: f64| {
        let mut lines = knots.iter();
        let [radius_mm, height_mm] = lines.next().unwrap();
        let first = Profile::from(part * radius_mm, *height_mm, 1.0).unwrap();
        lines.fold(first, |wall, [radius_mm, height_mm]| wall.line(part * radius_mm, *height_mm).unwrap())
    };
    let inside = rng.bool().then(|| wall(0.6));
    Tool::new(&wall(1.0), inside.as_ref()).unwrap()
}

/// A move square to the axis: any, standing still, along a ray.
fn sweep(rng: &mut Rng) -> Sweep {
    let along = rng.usize(0..3);
    let mut axis = [0.0; 3];
    axis[along] = if rng.bool() { 1.0 } else { -1.0 };
    let from_mm = [0; 3].map(|_| rng.f64() * 4.0 - 2.0);
    let kind = rng.u8(0..6);
    let way = [0, 1, 2].map(|i| match kind {
        _ if i == along => 0.0,
        0 => 0.0,
        1 if i == (along + 1) % 3 => 0.0,
        _ => rng.f64() * 6.0 - 3.0,
    });
    Sweep { from_mm, to_mm: [0, 1, 2].map(|i| from_mm[i] + way[i]), axis }
}

#[test]
fn whole_tools_on_a_level_take_what_they_meet_and_nothing_else() {
    let mut rng = Rng::with_seed(31);
    let (mut taken, mut left, mut parts) = (0, 0, 0);
    for case in 0..120 {
        let (tool, sweep) = (tool(&mut rng), sweep(&mut rng));
        parts += tool.parts().len();
        // Away from the places of the tool, by numbers that are not round.
        let block = Block { lowest_mm: [-3.013, -3.027, -3.041], highest_mm: [2.987, 2.973, 2.959] };
        let mut stock = Stock::new(&block, 0.4, MEMORY_MAX).unwrap();
        stock.cut(&tool, &[sweep]).unwrap();
        let lattice = *stock.lattice();
        let way_mm = libm::sqrt(sweep.motion_mm().iter().map(|part| part * part).sum());
        for ray_axis in (0..3).cycle().take(60) {
            let cells = [0; 3].map(|_| rng.usize(1..14));
            let mut at = [0, 1, 2].map(|axis| lattice.center_mm(axis, cells[axis]));
            at[ray_axis] += 0.4 * rng.f64() - 0.2;
            let [column, row] = Lattice::across(ray_axis).map(|axis| cells[axis]);
            let is_left = stock.grids()[ray_axis].dexel(column, row).unwrap().contains(at[ray_axis]);
            let places = (0..=PLACES).map(|place| f64::from(place) / f64::from(PLACES));
            let outside = |s: f64| tool.slabs().iter().map(move |slab| outside_mm(slab, &sweep, s, at));
            let deepest = places.flat_map(outside).fold(f64::INFINITY, f64::min);
            if is_left {
                assert!(deepest >= -1e-9, "{case}: {deepest} {tool:?} {sweep:?} {at:?} axis {ray_axis}");
                left += 1;
            } else {
                // Between two places the tool may come deeper by half the way between them.
                let between_mm = way_mm / f64::from(PLACES) / 2.0;
                assert!(deepest <= between_mm + 1e-9, "{case}: {deepest} {tool:?} {sweep:?} {at:?} axis {ray_axis}");
                taken += 1;
            }
        }
    }
    println!("points taken {taken}, left {left}; parts {parts}");
    assert!(taken > 1_000 && left > 1_000 && parts > 240, "{taken} {left} {parts}");
}
