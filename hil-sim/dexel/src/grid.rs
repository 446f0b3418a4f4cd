//! All parallel rays of one direction, with their material, and how passes of a tool cut them.
//!
//! Rows of rays are cut in parallel on all cores where that takes less time. Each ray belongs to one row, and volumes are summed row by row and then in the
//! order of the rows, so no result depends on the number of threads.

use std::ops::Range;

use arcfeed_kinematics::vector::Vector;
use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};
use rayon::slice::ParallelSliceMut;

use super::band::Losses;
use super::dexel::{Dexel, Interval, NOWHERE, Taken};
use super::lattice::Lattice;
use super::sweep::{LayersCut, Pass, Reach, RowCut};

/// All rays along one axis of a lattice, each with its material.
#[derive(Clone, Debug)]
pub struct Grid {
    axis: usize,
    lattice: Lattice,
    dexels: Vec<Dexel>,
    /// Tiles of each row, row by row.
    tiles: Vec<Tile>,
    /// Heap memory of the dexels.
    heap_bytes: usize,
}

/// All of a ray.
const EVERYWHERE: Interval = Interval { from_mm: f64::NEG_INFINITY, to_mm: f64::INFINITY };

/// Rays of a row that are left out together where none of them has material for a pass.
const TILE: usize = 16;

/// Work that is worth a task of its own, in rays times passes of an upright tool: some 0.1 ms.
const TASK: usize = 16_384;

/// Work of a pass of a tilted tool, in that of an upright one.
const TILTED: usize = 16;

/// Whether the rays of some columns may lose material, all of which lies in an interval.
type MayCut<'m> = dyn Fn(Range<usize>, &Interval) -> bool + 'm;

/// The rays of one row while passes cut it.
struct RowRays<'a> {
    dexels: &'a mut [Dexel],
    tiles: &'a mut [Tile],
    /// Columns whose rays have all lost an interval, and that interval.
    alike: (Range<usize>, Interval),
    taken: Taken,
}

/// Neighbouring rays.
#[derive(Clone, Copy, Debug)]
struct Tile {
    /// From the first to the last material of them all, or beyond.
    extent: Interval,
    /// Whether they have been cut since this was found.
    is_stale: bool,
}

impl Tile {
    /// Tile whose rays have not been looked at.
    const UNKNOWN: Tile = Tile { extent: EVERYWHERE, is_stale: true };

    /// Finds the extent of its rays again, if they have been cut.
    fn refresh(&mut self, dexels: &[Dexel]) {
        if self.is_stale {
            *self = Tile { extent: extent_of(dexels), is_stale: false };
        }
    }
}

impl Grid {
    /// Builds the grid by calling `on_ray` once for every ray: it gets a point of the ray, whose coordinate along the ray is 0,
    /// and returns the material of the ray.
    pub fn new(lattice: &Lattice, axis: usize, on_ray: impl Fn(Vector) -> Dexel + Sync) -> Self {
        let [width, height] = lattice.size(axis);
        let ray = |index: usize| on_ray(point_mm(lattice, axis, [index % width, index / width]));
        Grid::of(lattice, axis, (0..width * height).into_par_iter().map(ray).collect())
    }

    /// Builds the grid from the material of existing rays, row by row; rays missing at the end of the list are empty.
    pub fn of(lattice: &Lattice, axis: usize, mut dexels: Vec<Dexel>) -> Self {
        let [width, height] = lattice.size(axis);
        dexels.resize(width * height, Dexel::Empty);
        let tiles = vec![Tile::UNKNOWN; tile_count(width) * height];
        let heap_bytes = dexels.iter().map(Dexel::heap_bytes).sum();
        Grid { axis, lattice: *lattice, dexels, tiles, heap_bytes }
    }

    /// Direction of the rays: 0, 1, 2 for x, y, z.
    pub fn axis(&self) -> usize {
        self.axis
    }

    /// Material of all rays, row by row.
    pub fn dexels(&self) -> &[Dexel] {
        &self.dexels
    }

    /// Material of the ray at a column and a row; `None` outside of the grid.
    pub fn dexel(&self, column: usize, row: usize) -> Option<&Dexel> {
        let [width, _] = self.lattice.size(self.axis);
        self.dexels.get(row * width + column).filter(|_| column < width)
    }

    /// Volume of the material, mm3: its length on all rays times the area that one ray represents.
    pub fn volume_mm3(&self) -> f64 {
        let [width, _] = self.lattice.size(self.axis);
        let rows = self.dexels.chunks(width).map(|row| row.iter().map(Dexel::length_mm).sum::<f64>());
        rows.sum::<f64>() * self.lattice.area_mm2()
    }

    /// Memory of the rays along an axis of a lattice, bytes, each with at most one interval.
    pub fn bytes_uncut(lattice: &Lattice, axis: usize) -> usize {
        let [width, height] = lattice.size(axis);
        let row = width * size_of::<Dexel>() + tile_count(width) * size_of::<Tile>();
        row.saturating_mul(height)
    }

    /// Memory of all rays, bytes, including their heap memory.
    pub fn memory_bytes(&self) -> usize {
        Grid::bytes_uncut(&self.lattice, self.axis) + self.heap_bytes
    }

    /// Removes the material that the passes (parts of a tool on straight sweeps) sweep; returns its volume, mm3.
    pub fn cut(&mut self, passes: &[Pass<'_>]) -> f64 {
        let (axis, lattice) = (self.axis, self.lattice);
        let [width, _] = lattice.size(axis);
        let [column_axis, row_axis] = Lattice::across(axis);
        let touched = united(passes.iter().map(|pass| pass.cells(&lattice, row_axis)));
        let columns = united(passes.iter().map(|pass| pass.cells(&lattice, column_axis)));
        let column_mm = lattice.centers_mm(column_axis);
        let (layers, passes) = layers_and_others(passes, &lattice);
        let rows: Vec<Range<usize>> = passes.iter().map(|pass| pass.cells(&lattice, row_axis)).collect();
        let cut_row = |index: usize, mut rays: RowRays<'_>| {
            let row = touched.start + index;
            let row_mm = lattice.center_mm(row_axis, row);
            for layers in layers.iter().filter(|layers| layers.rows.contains(&row)) {
                rays.lose_each(layers.first, &layers.losses);
            }
            for (pass, _) in passes.iter().zip(&rows).filter(|(_, rows)| rows.contains(&row)) {
                let Some(reach) = pass.reach(&lattice, row_mm) else { continue };
                let alike = |(columns_mm, loss): (Interval, Interval)| {
                    (lattice.cells_between(column_axis, columns_mm.from_mm, columns_mm.to_mm), loss)
                };
                match pass.row_cut(row_mm) {
                    RowCut::Axial(row) => {
                        let reach = rays.lose_alike(&reach, alike(row.alike()));
                        rays.cut(&reach, |column, dexel| dexel.take(row.loss(column_mm(column))));
                    }
                    RowCut::Layer(row) => rays.lose(&reach, |column| row.losses(column_mm(column))),
                    RowCut::Ball(row) => rays.cut(&reach, |column, dexel| dexel.take(row.loss(column_mm(column)))),
                    RowCut::Upright(mut row) => {
                        let reach = rays.lose_alike(&reach, alike(row.alike()));
                        rays.lose(&reach, |column| row.losses(column_mm(column)));
                    }
                    RowCut::Rays(pass) => {
                        let point_mm = |column: usize| point_mm(&lattice, axis, [column, row]);
                        let cut = |column: usize, dexel: &mut Dexel| {
                            let point_mm = point_mm(column);
                            if !pass.may_cut(&point_mm, dexel) {
                                return Taken::default();
                            }
                            let before = dexel.heap_bytes() as isize;
                            let length_mm = pass.cut(point_mm, &reach, dexel);
                            Taken { length_mm, heap_bytes: dexel.heap_bytes() as isize - before }
                        };
                        let may_cut: &MayCut<'_> = &|columns, extent| {
                            pass.may_cut_between([point_mm(columns.start), point_mm(columns.end - 1)], extent)
                        };
                        let may_cut = pass.is_tilted().then_some(may_cut);
                        reach.parts().into_iter().for_each(|part| rays.cut_tiles(part, &reach.along, may_cut, cut));
                    }
                }
            }
            rays.taken
        };
        let of_rows = |per_row: usize| touched.start * per_row..touched.end * per_row;
        let (dexels, tiles) = (&mut self.dexels[of_rows(width)], &mut self.tiles[of_rows(tile_count(width))]);
        let taken = cut_rows(width, columns.len() * work(&layers, &passes), dexels, tiles, cut_row);
        let heap_bytes: isize = taken.iter().map(|row| row.heap_bytes).sum();
        self.heap_bytes = self.heap_bytes.saturating_add_signed(heap_bytes);
        taken.iter().map(|row| row.length_mm).sum::<f64>() * lattice.area_mm2()
    }
}

/// Number of tiles in a row.
fn tile_count(width: usize) -> usize {
    width.div_ceil(TILE)
}

/// Cuts rows of `width` rays, which are `work` each, by `cut_row`, which gets a row's index and rays; returns what it takes from each.
fn cut_rows(
    width: usize,
    work: usize,
    dexels: &mut [Dexel],
    tiles: &mut [Tile],
    cut_row: impl Fn(usize, RowRays<'_>) -> Taken + Sync,
) -> Vec<Taken> {
    let (count, tile_count) = (dexels.len() / width, tile_count(width));
    let cut = |(index, (dexels, tiles)): (usize, (&mut [Dexel], &mut [Tile]))| {
        cut_row(index, RowRays { dexels, tiles, alike: (0..0, NOWHERE), taken: Taken::default() })
    };
    if work * count > TASK {
        let rows = dexels.par_chunks_mut(width).zip(tiles.par_chunks_mut(tile_count)).enumerate();
        rows.with_min_len((TASK / work).max(1)).map(cut).collect()
    } else {
        // Rayon would let a thread that is not its own wait until one of its threads wakes.
        dexels.chunks_mut(width).zip(tiles.chunks_mut(tile_count)).enumerate().map(cut).collect()
    }
}

/// Work on a ray, in passes of an upright tool.
fn work(layers: &[LayersCut], passes: &[&Pass<'_>]) -> usize {
    layers.len() + passes.iter().map(|pass| if pass.is_tilted() { TILTED } else { 1 }).sum::<usize>()
}

/// Cuts that are the same in many rows, as few as they can be put into, and the passes that make no such cut.
fn layers_and_others<'p, 'a>(passes: &'p [Pass<'a>], lattice: &Lattice) -> (Vec<LayersCut>, Vec<&'p Pass<'a>>) {
    let (mut layers, mut others) = (Vec::<LayersCut>::new(), Vec::new());
    for pass in passes {
        match pass.layers_cut(lattice) {
            Some(cut) if layers.last_mut().is_some_and(|last| last.add(&cut)) => {}
            Some(cut) => layers.push(cut),
            None => others.push(pass),
        }
    }
    (layers, others)
}

/// From the first to the last of some ranges.
fn united(ranges: impl Iterator<Item = Range<usize>>) -> Range<usize> {
    let all = ranges.filter(|range| !range.is_empty());
    all.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end)).unwrap_or(0..0)
}

impl<'a> RowRays<'a> {
    /// Takes one interval from each ray, from a column on.
    fn lose_each(&mut self, first: usize, losses: &[Interval]) {
        let columns = first..first + losses.len();
        self.cut_tiles(columns, &EVERYWHERE, None, |column, dexel| dexel.take(losses[column - first]));
    }

    /// Takes the same interval from the rays of some columns in reach, as far as they may still have it; returns the reach
    /// without these columns.
    fn lose_alike(&mut self, reach: &Reach, (columns, loss): (Range<usize>, Interval)) -> Reach {
        if columns.is_empty() {
            return reach.clone();
        }
        let (known, lost) = self.alike.clone();
        let is_lost = lost.from_mm <= loss.from_mm && loss.to_mm <= lost.to_mm;
        if !(is_lost && known.start <= columns.start && columns.end <= known.end) {
            let goes_on = lost == loss && known.start <= columns.end && columns.start <= known.end;
            let known = if goes_on { known } else { columns.start..columns.start };
            for part in [columns.start..known.start.max(columns.start), known.end.min(columns.end)..columns.end] {
                self.cut_tiles(part, &loss, None, |_, dexel| dexel.take(loss));
            }
            self.alike = (known.start.min(columns.start)..known.end.max(columns.end), loss);
        }
        reach.without(&columns)
    }

    /// Takes what rays lose, by their columns.
    #[inline]
    fn lose(&mut self, reach: &Reach, mut losses: impl FnMut(usize) -> Losses) {
        self.cut(reach, |column, dexel| {
            let [one, other] = losses(column);
            let mut taken = dexel.take(one);
            if other.from_mm < other.to_mm {
                taken.add(&dexel.take(other));
            }
            taken
        });
    }

    /// Cuts the rays that have material in reach; `cut` returns what it takes from a ray.
    #[inline]
    fn cut(&mut self, reach: &Reach, mut cut: impl FnMut(usize, &mut Dexel) -> Taken) {
        for columns in reach.parts() {
            self.cut_tiles(columns, &reach.along, None, &mut cut);
        }
    }

    /// Cuts the rays of some columns that have material in a stretch. Where `cut` takes long, `may_cut` is asked first, for each tile.
    #[inline]
    fn cut_tiles(
        &mut self,
        columns: Range<usize>,
        along: &Interval,
        may_cut: Option<&MayCut<'_>>,
        mut cut: impl FnMut(usize, &mut Dexel) -> Taken,
    ) {
        let mut start = columns.start;
        while start < columns.end {
            let number = start / TILE;
            let end = columns.end.min((number + 1) * TILE);
            let all = number * TILE..self.dexels.len().min((number + 1) * TILE);
            let tile = &mut self.tiles[number];
            if may_cut.is_some() {
                tile.refresh(&self.dexels[all.clone()]);
            }
            let extent = tile.extent.common(along);
            if extent.from_mm < extent.to_mm && may_cut.is_none_or(|may_cut| may_cut(start..end, &extent)) {
                let has_cut = cut_all(start, &mut self.dexels[start..end], along, &mut self.taken, &mut cut);
                // Looked at again where that was in vain.
                if !has_cut {
                    tile.refresh(&self.dexels[all]);
                }
                tile.is_stale = has_cut;
            }
            start = end;
        }
    }
}

/// Cuts neighbouring rays, from a column on, where they have material in a stretch; returns whether any of them has lost anything.
#[inline]
fn cut_all(
    first: usize,
    dexels: &mut [Dexel],
    along: &Interval,
    all: &mut Taken,
    mut cut: impl FnMut(usize, &mut Dexel) -> Taken,
) -> bool {
    let mut has_cut = false;
    for (column, dexel) in (first..).zip(dexels) {
        if dexel.meets(along) {
            let taken = cut(column, dexel);
            has_cut |= taken.length_mm > 0.0;
            all.add(&taken);
        }
    }
    has_cut
}

/// From the first to the last material of some rays.
fn extent_of(dexels: &[Dexel]) -> Interval {
    dexels.iter().filter_map(Dexel::extent).fold(NOWHERE, |all, one| Interval {
        from_mm: if one.from_mm < all.from_mm { one.from_mm } else { all.from_mm },
        to_mm: if one.to_mm > all.to_mm { one.to_mm } else { all.to_mm },
    })
}

/// A point of the ray at a column and a row, 0 along it.
fn point_mm(lattice: &Lattice, axis: usize, at: [usize; 2]) -> Vector {
    let mut point_mm = [0.0; 3];
    for (across, cell) in Lattice::across(axis).into_iter().zip(at) {
        point_mm[across] = lattice.center_mm(across, cell);
    }
    point_mm
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_kinematics::vector::unit;

    use crate::section::Sweep;
    use crate::solid::Block;
    use crate::sweep::passes;
    use crate::tool::Tool;
    use crate::workpiece::Stock;

    const UP: Vector = [0.0, 0.0, 1.0];

    /// Straight moves one after the other, on levels of which some follow one another.
    fn zigzag(count: u32) -> Vec<Sweep> {
        let mut seed = 1_u32;
        let mut next = |below: u32| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 16) % below
        };
        let mut at = [0.0, 0.0, 4.0];
        let mut sweeps = Vec::new();
        for _ in 0..count {
            let from_mm = at;
            // Multiples of half a step, so that borders of the tool are often on rays.
            at = match next(4) {
                0 => [at[0] + 0.125 * f64::from(next(9)), at[1], at[2]],
                1 => [at[0], at[1] + 0.125 * f64::from(next(9)), at[2]],
                2 => [f64::from(next(80)) * 0.125, f64::from(next(80)) * 0.125, at[2]],
                _ => [at[0] - 0.37, at[1] + 0.21, at[2]],
            };
            sweeps.push(Sweep { from_mm, to_mm: at, axis: UP });
            if next(10) == 0 {
                at[2] = 1.0 + 0.125 * f64::from(next(24));
            }
        }
        sweeps
    }

    #[test]
    fn sweeps_of_one_call_leave_to_the_bit_what_they_leave_one_by_one() {
        let block = Block { lowest_mm: [0.0; 3], highest_mm: [10.0, 9.0, 5.0] };
        let tools = [
            Tool::cylinder(2.0, 3.0).unwrap(),
            Tool::ball(1.5, 4.0, 0.01).unwrap(),
            Tool::ring([2.0, 1.25], 0.25, 3.0, 0.01).unwrap(),
        ];
        let sweeps = zigzag(400);
        for tool in &tools {
            for axis in 0..3 {
                let whole = Stock::new(&block, 0.25, 1 << 24).unwrap().grids()[axis].clone();
                let mut one_by_one = whole.clone();
                let single: f64 = sweeps.iter().map(|sweep| one_by_one.cut(&passes(tool, &[*sweep], axis))).sum();
                for size in [2, 7, 50] {
                    let mut together = whole.clone();
                    let mm3: f64 = sweeps.chunks(size).map(|some| together.cut(&passes(tool, some, axis))).sum();
                    assert_eq!(together.dexels(), one_by_one.dexels(), "{axis} {size}");
                    assert!((mm3 - single).abs() < 1e-9 * single && single > 10.0, "{mm3} {single}");
                }
                // Each ray by itself, as the way that takes any pass has it.
                let mut ray_by_ray = whole.clone();
                let [width, _] = whole.lattice.size(axis);
                let [_, row_axis] = Lattice::across(axis);
                for pass in passes(tool, &sweeps, axis) {
                    for row in pass.rows(&whole.lattice) {
                        let Some(reach) = pass.reach(&whole.lattice, whole.lattice.center_mm(row_axis, row)) else {
                            continue;
                        };
                        for column in reach.columns() {
                            let point_mm = point_mm(&whole.lattice, axis, [column, row]);
                            pass.cut(point_mm, &reach, &mut ray_by_ray.dexels[row * width + column]);
                        }
                    }
                }
                assert_eq!(ray_by_ray.dexels(), one_by_one.dexels(), "{axis}");
            }
        }
    }

    #[test]
    fn rays_without_material_are_known_after_one_cut_in_vain() {
        let block = Block { lowest_mm: [0.0; 3], highest_mm: [10.0, 9.0, 5.0] };
        let tool = Tool::cylinder(20.0, 7.0).unwrap();
        let sweep = Sweep { from_mm: [4.0, 4.0, -1.0], to_mm: [5.0, 4.0, -1.0], axis: UP };
        for axis in 0..3 {
            let mut grid = Stock::new(&block, 0.25, 1 << 24).unwrap().grids()[axis].clone();
            let removed_mm3 = [0, 1].map(|_| grid.cut(&passes(&tool, &[sweep], axis)));
            assert!((removed_mm3[0] - 450.0).abs() < 1e-9 && removed_mm3[1] == 0.0, "{axis}: {removed_mm3:?}");
            assert!(grid.tiles.iter().all(|tile| tile.extent == NOWHERE), "{axis}");
        }
    }

    #[test]
    fn tilted_sweeps_leave_what_each_ray_loses_by_itself() {
        let block = Block { lowest_mm: [0.0; 3], highest_mm: [20.0, 9.0, 6.0] };
        let ring = Tool::ring([14.0, 11.5], 0.5, 20.0, 0.01).unwrap();
        let ball = Tool::ball(3.0, 20.0, 0.01).unwrap();
        let tilts = [[0.3, 0.2, 0.93], [0.0, 0.3, 0.95], [-0.8, 0.1, 0.6]];
        for (tool, axis_mm) in [&ring, &ball].into_iter().flat_map(|tool| tilts.map(|axis_mm| (tool, axis_mm))) {
            let axis = unit(axis_mm).unwrap();
            // The ring's wall passes through the block, whose middle is first outside of it and then in the hole, on two levels.
            let at =
                |part: f64, deep: f64| [0, 1, 2].map(|k| [27.0 - 22.0 * part, 4.5, 3.0][k] + (2.0 - deep) * axis[k]);
            let sweeps: Vec<Sweep> = (0..40)
                .map(|k| {
                    let (part, deep) = (f64::from(k % 20) / 20.0, f64::from(k / 20 * 3));
                    Sweep { from_mm: at(part, deep), to_mm: at(part + 0.05, deep), axis }
                })
                .collect();
            for ray_axis in 0..3 {
                let whole = Stock::new(&block, 0.25, 1 << 26).unwrap().grids()[ray_axis].clone();
                let [width, height] = whole.lattice.size(ray_axis);
                let mut expected = whole.clone();
                for pass in passes(tool, &sweeps, ray_axis) {
                    for (column, row) in (0..height).flat_map(|row| (0..width).map(move |column| (column, row))) {
                        for span in pass.spans(point_mm(&whole.lattice, ray_axis, [column, row])) {
                            expected.dexels[row * width + column].subtract(span);
                        }
                    }
                }
                assert!(expected.volume_mm3() < 0.8 * whole.volume_mm3(), "{}", expected.volume_mm3());
                for size in [1, 40] {
                    let mut together = whole.clone();
                    for some in sweeps.chunks(size) {
                        together.cut(&passes(tool, some, ray_axis));
                    }
                    let pairs = together.dexels().iter().zip(expected.dexels());
                    let most_mm =
                        pairs.map(|(one, other)| (one.length_mm() - other.length_mm()).abs()).fold(0.0, f64::max);
                    assert!(most_mm < 1e-6, "{axis:?} {ray_axis} {size}: {most_mm}");
                }
            }
        }
    }
}
