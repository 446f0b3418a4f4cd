//! Material of one ray: sorted intervals that neither touch nor overlap.
//!
//! Nothing is rounded: a new end of the material is exactly an end of the cut, so the result does not depend on the
//! order of the cuts, not even in its last bit.

use std::mem;

/// Interval of a ray between two coordinates along the ray, mm. It is empty if the upper end is not above the lower one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Coordinate of the lower end.
    pub from_mm: f64,
    /// Coordinate of the upper end.
    pub to_mm: f64,
}

impl Interval {
    /// Interval from the lower coordinate to the higher one.
    #[inline]
    pub fn new(from_mm: f64, to_mm: f64) -> Self {
        Interval { from_mm, to_mm }
    }

    /// Interval between two coordinates given in any order.
    #[inline]
    pub fn between(one_mm: f64, other_mm: f64) -> Self {
        if one_mm < other_mm { Interval::new(one_mm, other_mm) } else { Interval::new(other_mm, one_mm) }
    }

    /// Length, mm; negative if the interval ends before it begins.
    #[inline]
    pub fn length_mm(&self) -> f64 {
        self.to_mm - self.from_mm
    }

    /// Intersection of both intervals; if they do not overlap, the result ends before it begins.
    #[inline]
    pub fn common(&self, other: &Interval) -> Interval {
        // Comparisons, each an instruction: ends are numbers.
        Interval {
            from_mm: if self.from_mm > other.from_mm { self.from_mm } else { other.from_mm },
            to_mm: if self.to_mm < other.to_mm { self.to_mm } else { other.to_mm },
        }
    }

    /// Whether two intervals have more than one point in common.
    #[inline]
    pub fn meets(&self, other: &Interval) -> bool {
        self.from_mm < other.to_mm && other.from_mm < self.to_mm
    }
}

/// Empty interval: it ends before it begins.
pub const NOWHERE: Interval = Interval { from_mm: f64::INFINITY, to_mm: f64::NEG_INFINITY };

/// Material that a cut has removed from a ray, and what that did to the ray's memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Taken {
    /// Length of the removed material, mm.
    pub length_mm: f64,
    /// Change of the ray's heap memory, bytes; a ray with one interval or none has no heap memory.
    pub heap_bytes: isize,
}

/// The material along one ray, as intervals. A single interval, the usual case, needs no heap memory.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Dexel {
    /// No material.
    #[default]
    Empty,
    /// One interval.
    One(Interval),
    /// Two or more intervals.
    Many(Vec<Interval>),
}

impl Taken {
    /// Adds the effect of another cut.
    #[inline]
    pub fn add(&mut self, other: &Taken) {
        self.length_mm += other.length_mm;
        self.heap_bytes += other.heap_bytes;
    }
}

impl Dexel {
    /// Dexel with these intervals, which must be in ascending order and must not touch or overlap; empty ones are dropped.
    pub fn new(mut pieces: Vec<Interval>) -> Self {
        pieces.retain(|piece| piece.length_mm() > 0.0);
        match pieces.as_slice() {
            [] => Dexel::Empty,
            [one] => Dexel::One(*one),
            _ => Dexel::Many(pieces),
        }
    }

    /// The intervals of material, in ascending order.
    pub fn intervals(&self) -> &[Interval] {
        match self {
            Dexel::Empty => &[],
            Dexel::One(one) => std::slice::from_ref(one),
            Dexel::Many(pieces) => pieces,
        }
    }

    /// Interval from the beginning of the first interval of material to the end of the last one; `None` without material.
    #[inline]
    pub fn extent(&self) -> Option<Interval> {
        if let Dexel::One(one) = self {
            return Some(*one);
        }
        let pieces = self.intervals();
        Some(Interval { from_mm: pieces.first()?.from_mm, to_mm: pieces.last()?.to_mm })
    }

    /// Total length of the material, mm.
    pub fn length_mm(&self) -> f64 {
        self.intervals().iter().map(Interval::length_mm).sum()
    }

    /// Whether there is material at a coordinate along the ray; the upper end of an interval does not count.
    pub fn contains(&self, at_mm: f64) -> bool {
        self.intervals().iter().any(|piece| piece.from_mm <= at_mm && at_mm < piece.to_mm)
    }

    /// The intervals of material that overlap `stretch`, in ascending order, at their full length.
    pub fn met(&self, stretch: &Interval) -> impl DoubleEndedIterator<Item = &Interval> {
        self.intervals().iter().filter(|piece| piece.meets(stretch))
    }

    /// Whether there is material inside `stretch`.
    #[inline]
    pub fn meets(&self, stretch: &Interval) -> bool {
        match self {
            Dexel::Empty => false,
            Dexel::One(one) => one.meets(stretch),
            Dexel::Many(pieces) => pieces.iter().any(|piece| piece.meets(stretch)),
        }
    }

    /// Heap memory of the ray, bytes: 0 for at most one interval.
    pub fn heap_bytes(&self) -> usize {
        match self {
            Dexel::Empty | Dexel::One(_) => 0,
            Dexel::Many(pieces) => pieces.capacity() * size_of::<Interval>(),
        }
    }

    /// Removes the material inside `cut`; returns the removed length, mm.
    pub fn subtract(&mut self, cut: Interval) -> f64 {
        self.take(cut).length_mm
    }

    /// Removes the material inside `cut`; returns the removed length, and the change of the ray's heap memory.
    #[inline]
    pub fn take(&mut self, cut: Interval) -> Taken {
        match self {
            Dexel::Empty => Taken::default(),
            Dexel::One(one) => {
                let common = one.common(&cut);
                if common.from_mm >= common.to_mm {
                    return Taken::default();
                }
                let length_mm = common.length_mm();
                match (one.from_mm < cut.from_mm, cut.to_mm < one.to_mm) {
                    (false, true) => one.from_mm = cut.to_mm,
                    (true, false) => one.to_mm = cut.from_mm,
                    (false, false) => *self = Dexel::Empty,
                    (true, true) => return self.part(cut),
                }
                Taken { length_mm, heap_bytes: 0 }
            }
            Dexel::Many(_) => self.take_of_many(cut),
        }
    }

    /// Takes a cut from the middle of one piece.
    fn part(&mut self, cut: Interval) -> Taken {
        if let Dexel::One(one) = *self {
            *self = Dexel::Many(vec![Interval { to_mm: cut.from_mm, ..one }, Interval { from_mm: cut.to_mm, ..one }]);
        }
        Taken { length_mm: cut.length_mm(), heap_bytes: self.heap_bytes() as isize }
    }

    fn take_of_many(&mut self, cut: Interval) -> Taken {
        let before = self.heap_bytes() as isize;
        let Dexel::Many(pieces) = self else { return Taken::default() };
        let length_mm: f64 = pieces.iter().map(|piece| piece.common(&cut).length_mm().max(0.0)).sum();
        if length_mm > 0.0 {
            *self = Dexel::left_of_many(mem::take(pieces), cut);
        }
        Taken { length_mm, heap_bytes: self.heap_bytes() as isize - before }
    }

    fn left_of_many(mut pieces: Vec<Interval>, cut: Interval) -> Self {
        let first = pieces.partition_point(|piece| piece.to_mm <= cut.from_mm);
        let end = pieces.partition_point(|piece| piece.from_mm < cut.to_mm);
        let (Some(begins), Some(ends)) = (pieces.get(first).copied(), pieces[..end].last().copied()) else {
            return Dexel::new(pieces);
        };
        let rests = [Interval { to_mm: cut.from_mm, ..begins }, Interval { from_mm: cut.to_mm, ..ends }].into_iter();
        pieces.splice(first..end, rests.filter(|rest| rest.length_mm() > 0.0));
        Dexel::new(pieces)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dexel(pieces: &[(f64, f64)]) -> Dexel {
        Dexel::new(pieces.iter().map(|(from, to)| Interval::new(*from, *to)).collect())
    }

    #[test]
    fn a_cut_leaves_what_is_outside_of_it() {
        let material = [(0.0, 2.0), (3.0, 5.0), (6.0, 9.0)];
        for (cut, left, removed_mm) in [
            ((-1.0, 0.0), &[(0.0, 2.0), (3.0, 5.0), (6.0, 9.0)][..], 0.0),
            ((2.0, 3.0), &[(0.0, 2.0), (3.0, 5.0), (6.0, 9.0)], 0.0),
            ((1.0, 4.0), &[(0.0, 1.0), (4.0, 5.0), (6.0, 9.0)], 2.0),
            ((3.5, 4.0), &[(0.0, 2.0), (3.0, 3.5), (4.0, 5.0), (6.0, 9.0)], 0.5),
            ((1.0, 8.0), &[(0.0, 1.0), (8.0, 9.0)], 5.0),
            ((0.0, 6.0), &[(6.0, 9.0)], 4.0),
            ((-1.0, 10.0), &[], 7.0),
        ] {
            let mut cut_dexel = dexel(&material);
            assert_eq!(cut_dexel.subtract(Interval::new(cut.0, cut.1)), removed_mm, "{cut:?}");
            assert_eq!(cut_dexel, dexel(left), "{cut:?}");
        }
    }

    #[test]
    fn one_piece_is_cut_at_either_end_and_in_the_middle() {
        for (cut, left) in
            [((-1.0, 1.0), &[(1.0, 4.0)][..]), ((3.0, 5.0), &[(0.0, 3.0)]), ((1.0, 2.0), &[(0.0, 1.0), (2.0, 4.0)])]
        {
            let mut one = dexel(&[(0.0, 4.0)]);
            assert_eq!(one.subtract(Interval::new(cut.0, cut.1)), 1.0);
            assert_eq!(one, dexel(left));
        }
    }

    #[test]
    fn cuts_commute_to_the_bit() {
        let mut cuts: Vec<Interval> =
            (0..40).map(|n| f64::from(n * 37 % 101) * 0.1).map(|from| Interval::new(from, from + 0.173)).collect();
        let all = |cuts: &[Interval]| {
            let mut ray = dexel(&[(0.0, 10.3)]);
            for cut in cuts {
                ray.subtract(*cut);
            }
            ray
        };
        let forwards = all(&cuts);
        cuts.reverse();
        assert_eq!(all(&cuts), forwards);
        cuts.rotate_left(17);
        assert_eq!(all(&cuts), forwards);
    }

    #[test]
    fn a_ray_takes_no_more_than_three_words() {
        assert_eq!(size_of::<Dexel>(), 24);
    }
}
