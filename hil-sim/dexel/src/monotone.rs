//! Part of a tool whose walls are monotone: going up, its outside and its hole each only widen or only narrow, without a step.
//!
//! So the heights at which the tool is as wide as a distance d, and those at which its hole is as narrow, are one stretch each:
//!
//! ```text
//! outside as wide as d:   from the first height with R >= d to the wide end        (1)
//! hole as narrow as d:    from the first height with r <= d to the narrow end      (2)
//! ```
//!
//! (2) is (1) for radii with the opposite sign. Flat, ball and bull-nose end mills and rings are one part.
//!
//! Source: own derivation.

use super::dexel::Interval;
use super::slab::Slab;

/// Cells of a wall's table.
const CELLS: usize = 64;

/// A piece of a wall between two slab ends, in the direction in which its measure grows.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    /// Measure at its ends: the radius, for a hole its negative.
    from_mm: f64,
    to_mm: f64,
    /// Height at its beginning.
    height_mm: f64,
    /// Height by measure; 0 where the measure stays.
    slope: f64,
}

/// Radius of a part's outside or hole as a function of the height, in pieces ordered by increasing radius (of a hole: decreasing).
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    pieces: Vec<Piece>,
    /// Height of the last end.
    end_mm: f64,
    /// By equal cells of the measure: the first piece that may be it.
    first_pieces: Vec<usize>,
    cells_per_mm: f64,
}

/// Consecutive slabs of a tool, over whose height the outside and the hole each only widen or only narrow.
#[derive(Clone, Debug, PartialEq)]
pub struct MonotonePart {
    slabs: Vec<Slab>,
    outer: Wall,
    inner: Option<Wall>,
}

/// Radii of a part of a tool at one height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radii {
    /// Radius of the outside.
    pub outer_mm: f64,
    /// Radius of the hole, if there is one.
    pub inner_mm: Option<f64>,
}

impl Wall {
    /// From the measures of the slabs at their ends.
    fn new(slabs: &[Slab], measure_mm: impl Fn(&Slab) -> [f64; 2]) -> Self {
        let piece = |slab: &Slab, ends: [usize; 2]| {
            let [[from_mm, to_mm], [height_mm, end_mm]] =
                [measure_mm(slab), slab.heights_mm].map(|pair| ends.map(|end| pair[end]));
            let slope = if to_mm > from_mm { (end_mm - height_mm) / (to_mm - from_mm) } else { 0.0 };
            (Piece { from_mm, to_mm, height_mm, slope }, end_mm)
        };
        let is_growing = slabs.iter().all(|slab| measure_mm(slab)[0] <= measure_mm(slab)[1]);
        let pieces: Vec<(Piece, f64)> = if is_growing {
            slabs.iter().map(|slab| piece(slab, [0, 1])).collect()
        } else {
            slabs.iter().rev().map(|slab| piece(slab, [1, 0])).collect()
        };
        let end_mm = pieces.last().map_or(0.0, |(_, end_mm)| *end_mm);
        let pieces: Vec<Piece> = pieces.into_iter().map(|(piece, _)| piece).collect();
        let [from_mm, to_mm] =
            [pieces.first().map_or(0.0, |piece| piece.from_mm), pieces.last().map_or(0.0, |piece| piece.to_mm)];
        let cells_per_mm = if to_mm > from_mm { CELLS as f64 / (to_mm - from_mm) } else { 0.0 };
        // A little before the cell begins, for rounding.
        let begins_mm = |cell: usize| from_mm + (cell as f64 - 0.01) / CELLS as f64 * (to_mm - from_mm);
        let first_piece = |cell: usize| pieces.partition_point(|piece| piece.to_mm < begins_mm(cell));
        let first_pieces = (0..=CELLS).map(first_piece).collect();
        Wall { pieces, end_mm, first_pieces, cells_per_mm }
    }

    /// (1)
    #[inline]
    fn stretch(&self, at_least_mm: f64) -> Option<Interval> {
        let pieces = self.pieces.as_slice();
        // A cast from float to whole number saturates.
        let cell = ((at_least_mm - pieces.first()?.from_mm) * self.cells_per_mm) as u32 as usize;
        let mut at = *self.first_pieces.get(cell)?;
        while at < pieces.len() && pieces[at].to_mm < at_least_mm {
            at += 1;
        }
        let piece = pieces.get(at)?;
        let more_mm = at_least_mm - piece.from_mm;
        let from_mm = if more_mm > 0.0 { piece.height_mm + more_mm * piece.slope } else { piece.height_mm };
        Some(Interval::between(from_mm, self.end_mm))
    }
}

impl MonotonePart {
    /// Divides the slabs of a tool, from bottom to top, into as few monotone parts as follow each other.
    pub fn all(slabs: &[Slab]) -> Vec<Self> {
        let mut parts = Vec::new();
        let mut first = 0;
        for end in 1..=slabs.len() {
            if end == slabs.len() || !is_monotone(&slabs[first..=end]) {
                parts.push(MonotonePart::of(&slabs[first..end]));
                first = end;
            }
        }
        parts
    }

    fn of(slabs: &[Slab]) -> Self {
        let hole = |slab: &Slab| slab.inner_mm.map_or([0.0; 2], |inner| inner.map(|radius_mm| -radius_mm));
        let inner = slabs.iter().any(|slab| slab.inner_mm.is_some()).then(|| Wall::new(slabs, hole));
        MonotonePart { slabs: slabs.to_vec(), outer: Wall::new(slabs, |slab| slab.outer_mm), inner }
    }

    /// Lowest and highest height of the part above the tool's tip, mm.
    pub fn heights_mm(&self) -> [f64; 2] {
        let end = |slab: Option<&Slab>, end: usize| slab.map_or(0.0, |slab| slab.heights_mm[end]);
        [end(self.slabs.first(), 0), end(self.slabs.last(), 1)]
    }

    /// Largest radius of the outside, and smallest radius of the hole, over the whole part.
    pub fn extreme_radii(&self) -> Radii {
        let outer_mm = self.outer.pieces.last().map_or(0.0, |piece| piece.to_mm);
        Radii { outer_mm, inner_mm: self.inner.as_ref().and_then(|wall| wall.pieces.last()).map(|piece| -piece.to_mm) }
    }

    /// Smallest radius of the outside over the whole part.
    pub fn narrowest_mm(&self) -> f64 {
        self.outer.pieces.first().map_or(0.0, |piece| piece.from_mm)
    }

    /// Radii of the part if they are the same at all heights; `None` otherwise.
    pub fn upright(&self) -> Option<Radii> {
        let Slab { outer_mm: [outer_mm, _], inner_mm, .. } = *self.slabs.first()?;
        let radii = Radii { outer_mm, inner_mm: inner_mm.map(|[inner_mm, _]| inner_mm) };
        let is_alike = |slab: &Slab| {
            slab.outer_mm == [radii.outer_mm; 2] && slab.inner_mm == radii.inner_mm.map(|inner_mm| [inner_mm; 2])
        };
        self.slabs.iter().all(is_alike).then_some(radii)
    }

    /// Whether the part has a hole about its axis.
    pub fn is_hollow(&self) -> bool {
        self.inner.is_some()
    }

    /// Heights at which the outside's radius is at least `distance_mm`; `None` if it is so nowhere. (1)
    #[inline]
    pub fn wide(&self, distance_mm: f64) -> Option<Interval> {
        self.outer.stretch(distance_mm)
    }

    /// Heights at which the hole's radius is at most `distance_mm`; `None` if it is so nowhere, or without a hole. (2)
    #[inline]
    pub fn narrow(&self, distance_mm: f64) -> Option<Interval> {
        self.inner.as_ref()?.stretch(-distance_mm)
    }

    /// Radii at a height; `None` above and below the part. The search begins at the slab with the index `near`, and stores there
    /// the index of the slab found, so that a search at a neighbouring height is fast.
    #[inline]
    pub fn radii(&self, height_mm: f64, near: &mut usize) -> Option<Radii> {
        let slabs = self.slabs.as_slice();
        let mut at = (*near).min(slabs.len());
        while at > 0 && slabs[at - 1].heights_mm[1] >= height_mm {
            at -= 1;
        }
        while at < slabs.len() && slabs[at].heights_mm[1] < height_mm {
            at += 1;
        }
        *near = at;
        let slab = slabs.get(at).filter(|slab| slab.heights_mm[0] <= height_mm)?;
        let [low_mm, high_mm] = slab.heights_mm;
        let at = |[low, high]: [f64; 2]| match high - low {
            0.0 => low,
            more => low + more * ((height_mm - low_mm) / (high_mm - low_mm)),
        };
        Some(Radii { outer_mm: at(slab.outer_mm), inner_mm: slab.inner_mm.map(at) })
    }

    /// Heights of the slab with this index if all of its radii are constant; `None` otherwise.
    pub fn same_radii(&self, slab: usize) -> Option<Interval> {
        let is_upright = |radii: [f64; 2]| radii[0] == radii[1];
        let slab = self.slabs.get(slab)?;
        let [low_mm, high_mm] = slab.heights_mm;
        let both = is_upright(slab.outer_mm) && slab.inner_mm.is_none_or(is_upright);
        both.then_some(Interval::new(low_mm, high_mm))
    }
}

/// Whether both walls of neighbouring slabs go one way, and on where the one below ends.
fn is_monotone(slabs: &[Slab]) -> bool {
    let goes_on = |wall: &dyn Fn(&Slab) -> Option<[f64; 2]>| {
        let meets = slabs.windows(2).all(|pair| match (wall(&pair[0]), wall(&pair[1])) {
            (Some(below), Some(above)) => below[1] == above[0],
            (below, above) => below == above,
        });
        let mut ends = slabs.iter().filter_map(wall);
        let mut again = ends.clone();
        meets && (ends.all(|ends| ends[0] <= ends[1]) || again.all(|ends| ends[0] >= ends[1]))
    };
    goes_on(&|slab| Some(slab.outer_mm)) && goes_on(&|slab| slab.inner_mm)
}
