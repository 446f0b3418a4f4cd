//! One ray's material: sorted intervals that neither touch nor overlap.
//!
//! Nothing is rounded here: an end that a cut leaves is one of the numbers that the cut was told, so that the order of the
//! cuts does not show in the result, not in its last bit.

use std::mem;

/// A stretch of a ray, by the coordinate along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Where it begins.
    pub from_mm: f64,
    /// Where it ends, beyond its beginning.
    pub to_mm: f64,
}

impl Interval {
    /// From one coordinate to the other.
    pub fn new(from_mm: f64, to_mm: f64) -> Self {
        Interval { from_mm, to_mm }
    }

    /// Its length; negative where nothing lies between its ends.
    pub fn length_mm(&self) -> f64 {
        self.to_mm - self.from_mm
    }

    /// What both have in common; empty intervals end before they begin.
    pub fn common(&self, other: &Interval) -> Interval {
        Interval { from_mm: self.from_mm.max(other.from_mm), to_mm: self.to_mm.min(other.to_mm) }
    }
}

/// The material along one ray. Most rays pass through one piece, which then needs no memory of its own.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Dexel {
    /// None.
    #[default]
    Empty,
    /// One piece.
    One(Interval),
    /// Two or more.
    Many(Vec<Interval>),
}

impl Dexel {
    /// The material of these pieces, sorted and apart.
    pub fn new(mut pieces: Vec<Interval>) -> Self {
        pieces.retain(|piece| piece.length_mm() > 0.0);
        match pieces.as_slice() {
            [] => Dexel::Empty,
            [one] => Dexel::One(*one),
            _ => Dexel::Many(pieces),
        }
    }

    /// The pieces, in order.
    pub fn intervals(&self) -> &[Interval] {
        match self {
            Dexel::Empty => &[],
            Dexel::One(one) => std::slice::from_ref(one),
            Dexel::Many(pieces) => pieces,
        }
    }

    /// From the first piece's beginning to the last one's end.
    pub fn extent(&self) -> Option<Interval> {
        let pieces = self.intervals();
        Some(Interval { from_mm: pieces.first()?.from_mm, to_mm: pieces.last()?.to_mm })
    }

    /// Length of all pieces.
    pub fn length_mm(&self) -> f64 {
        self.intervals().iter().map(Interval::length_mm).sum()
    }

    /// Whether there is material at a coordinate.
    pub fn contains(&self, at_mm: f64) -> bool {
        self.intervals().iter().any(|piece| piece.from_mm <= at_mm && at_mm < piece.to_mm)
    }

    /// The pieces that are partly in a stretch, in order.
    pub fn met(&self, stretch: &Interval) -> impl DoubleEndedIterator<Item = &Interval> {
        self.intervals().iter().filter(|piece| piece.from_mm < stretch.to_mm && stretch.from_mm < piece.to_mm)
    }

    /// Whether there is material in a stretch.
    pub fn meets(&self, stretch: &Interval) -> bool {
        self.met(stretch).next().is_some()
    }

    /// What it has allocated beside itself.
    pub fn heap_bytes(&self) -> usize {
        match self {
            Dexel::Empty | Dexel::One(_) => 0,
            Dexel::Many(pieces) => pieces.capacity() * size_of::<Interval>(),
        }
    }

    /// Takes the material of `cut` away; answers the length that was there.
    pub fn subtract(&mut self, cut: Interval) -> f64 {
        let removed = |piece: &Interval| piece.common(&cut).length_mm().max(0.0);
        match self {
            Dexel::Empty => 0.0,
            Dexel::One(one) => {
                let removed_mm = removed(one);
                if removed_mm > 0.0 {
                    *self = Dexel::left_of_one(*one, cut);
                }
                removed_mm
            }
            Dexel::Many(pieces) => {
                let removed_mm: f64 = pieces.iter().map(removed).sum();
                if removed_mm > 0.0 {
                    *self = Dexel::left_of_many(mem::take(pieces), cut);
                }
                removed_mm
            }
        }
    }

    fn left_of_one(one: Interval, cut: Interval) -> Self {
        let before = Interval { to_mm: cut.from_mm, ..one };
        let after = Interval { from_mm: cut.to_mm, ..one };
        match (before.length_mm() > 0.0, after.length_mm() > 0.0) {
            (false, false) => Dexel::Empty,
            (true, false) => Dexel::One(before),
            (false, true) => Dexel::One(after),
            (true, true) => Dexel::Many(vec![before, after]),
        }
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
