//! Properties of every cut.

use arcfeed_dexel::motion::{Move, Pose};
use arcfeed_dexel::section::Sweep;
use arcfeed_dexel::solid::{Block, Revolved};
use arcfeed_dexel::tool::Tool;
use arcfeed_dexel::workpiece::{Stock, StockError};
use fastrand::Rng;

use crate::stock::figures::{MEMORY_MAX, UP};

/// Tools, each with the sweeps of a move: some of all kinds, all over a block of 20 mm.
fn cuts() -> Vec<(Tool, Vec<Sweep>)> {
    let mut rng = Rng::with_seed(20);
    let mut place = || [0; 3].map(|_| rng.f64() * 20.0);
    let tools = [
        Tool::cylinder(2.0, 15.0).unwrap(),
        Tool::ball(1.5, 12.0, 1e-3).unwrap(),
        Tool::bull_nose([3.0, 0.8], 10.0, 1e-3).unwrap(),
        Tool::ring([4.0, 2.5], 0.6, 9.0, 1e-3).unwrap(),
    ];
    let mut cuts = Vec::new();
    for (number, tool) in tools.iter().cycle().take(16).enumerate() {
        let axis = if number % 3 == 0 { UP } else { [0.3, -0.1 * number as f64, 2.0] };
        let from = Pose { tip_mm: place(), axis };
        let moved = match number % 4 {
            0 => Move::Straight { from, to: Pose { tip_mm: place(), axis } },
            1 => Move::Turn { from, center_mm: place(), normal: place(), angle_rad: 0.7, rise_mm: 2.0 },
            2 => Move::Straight { from, to: Pose { tip_mm: place(), axis: [-0.2, 0.3, 1.0] } },
            _ => Move::Turn { from, center_mm: place(), normal: UP, angle_rad: -1.1, rise_mm: 0.0 },
        };
        cuts.push((tool.clone(), moved.sweeps(tool, 0.05).unwrap()));
    }
    cuts
}

fn block() -> Stock {
    Stock::new(&Block { lowest_mm: [0.0; 3], highest_mm: [20.0; 3] }, 0.25, MEMORY_MAX).unwrap()
}

/// All cuts in this order; what each removed.
fn cut_all(stock: &mut Stock, cuts: &[(Tool, Vec<Sweep>)]) -> Vec<[f64; 3]> {
    cuts.iter().map(|(tool, sweeps)| stock.cut(tool, sweeps).unwrap().by_axis).collect()
}

/// The ends of every piece of every ray, to the bit.
fn bits(stock: &Stock) -> Vec<Vec<[u64; 2]>> {
    let rays = stock.grids().iter().flat_map(|grid| grid.dexels());
    let ends = |dexel: &arcfeed_dexel::dexel::Dexel| {
        dexel.intervals().iter().map(|piece| [piece.from_mm.to_bits(), piece.to_mm.to_bits()]).collect()
    };
    rays.map(ends).collect()
}

/// Bytes of a stock, counted ray by ray, and 24 for sixteen neighbouring ones.
fn counted_bytes(stock: &Stock) -> usize {
    let rays = stock.grids().iter().flat_map(|grid| grid.dexels());
    let rays: usize = rays.map(|ray| size_of_val(ray) + ray.heap_bytes()).sum();
    let groups = stock.grids().iter().map(|grid| stock.lattice().size(grid.axis()));
    rays + groups.map(|[width, height]| width.div_ceil(16) * height * 24).sum::<usize>()
}

#[test]
fn removed_and_remaining_material_make_the_initial_stock() {
    let mut stock = block();
    let before = stock.volume().by_axis;
    let removed = cut_all(&mut stock, &cuts());
    let left = stock.volume().by_axis;
    for axis in 0..3 {
        let gone: f64 = removed.iter().map(|removed| removed[axis]).sum();
        let off = (gone + left[axis]) / before[axis] - 1.0;
        println!("axis {axis}: removed {gone:.3} left {:.3} of {:.3} mm3, off by {off:.1e}", left[axis], before[axis]);
        assert!(gone > 0.2 * before[axis] && left[axis] > 0.1 * before[axis]);
        assert!(off.abs() <= 1e-12, "{off}");
    }
}

#[test]
fn the_order_of_cuts_does_not_show_in_a_single_bit() {
    let mut cuts = cuts();
    let mut stock = block();
    cut_all(&mut stock, &cuts);
    let forwards = bits(&stock);
    cuts.reverse();
    cuts.iter_mut().for_each(|(_, sweeps)| sweeps.reverse());
    let mut stock = block();
    cut_all(&mut stock, &cuts);
    assert_eq!(bits(&stock), forwards);
    let again = cut_all(&mut stock, &cuts);
    assert!(again.iter().all(|removed| *removed == [0.0; 3]), "what is gone is removed again: {again:?}");
}

#[test]
fn sweeps_cut_together_leave_what_they_leave_one_by_one() {
    let cuts = cuts();
    let (mut together, mut one_by_one) = (block(), block());
    cut_all(&mut together, &cuts);
    for (tool, sweeps) in &cuts {
        for sweep in sweeps {
            one_by_one.cut(tool, &[*sweep]).unwrap();
        }
    }
    assert_eq!(bits(&one_by_one), bits(&together));
    assert_eq!(one_by_one.memory_bytes(), counted_bytes(&one_by_one));
    assert_eq!(together.memory_bytes(), counted_bytes(&together));
}

#[test]
fn the_number_of_threads_does_not_show_in_a_single_bit() {
    let cuts = cuts();
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut stock = block();
            let removed = cut_all(&mut stock, &cuts);
            (bits(&stock), removed.iter().flatten().map(|volume_mm3| volume_mm3.to_bits()).collect::<Vec<_>>())
        })
    };
    let alone = with(1);
    assert!(with(2) == alone && with(5) == alone);
}

#[test]
fn the_three_families_of_rays_agree_on_what_is_there() {
    let mut stock = block();
    cut_all(&mut stock, &cuts());
    let lattice = *stock.lattice();
    let (mut there, mut gone) = (0, 0);
    for node in (0..80 * 80 * 80).map(|n: usize| [n % 80, n / 80 % 80, n / 6_400]) {
        let says = [0, 1, 2].map(|axis| {
            let [column, row] = arcfeed_dexel::lattice::Lattice::across(axis).map(|across| node[across]);
            let dexel = stock.grids()[axis].dexel(column, row).unwrap();
            dexel.contains(lattice.center_mm(axis, node[axis]))
        });
        assert!(says == [says[0]; 3], "{node:?} {says:?}");
        if says[0] { there += 1 } else { gone += 1 }
    }
    println!("nodes with material {there}, without {gone}");
}

#[test]
fn a_stock_never_takes_more_memory_than_it_may() {
    let cube = Block { lowest_mm: [0.0; 3], highest_mm: [20.0; 3] };
    // Three families of 80 rows, each with 80 rays in 5 groups of sixteen.
    let needed_bytes = 3 * 80 * (80 + 5) * 24;
    let refused = Stock::new(&cube, 0.25, 400_000).unwrap_err();
    assert_eq!(refused, StockError::Memory { needed_bytes, allowed_bytes: 400_000 });
    let mut stock = Stock::new(&cube, 0.25, 500_000).unwrap();
    assert_eq!(stock.memory_bytes(), needed_bytes);
    let stopped = cuts().iter().try_for_each(|(tool, sweeps)| stock.cut(tool, sweeps).map(drop));
    assert!(matches!(stopped, Err(StockError::Memory { .. })), "{stopped:?}");
}

#[test]
fn round_stock_has_the_volume_of_its_solid() {
    let tube = Tool::ring([9.0, 6.0], 0.0, 12.0, 1e-3).unwrap();
    let exact_mm3 = tube.volume_mm3();
    let tilted = Revolved::new(tube, &Pose { tip_mm: [1.0, 2.0, 3.0], axis: [0.6, 0.0, 0.8] }).unwrap();
    let volume = Stock::new(&tilted, 0.1, MEMORY_MAX).unwrap().volume();
    println!("{:?} of {exact_mm3}", volume.by_axis);
    assert!((volume.mean_mm3() / exact_mm3 - 1.0).abs() < 2e-4 && volume.spread_mm3() < 1e-3 * exact_mm3);
}
