//! Heights of the material along one ray of a layer, after a tool has cut into the layer from above.
//!
//! Material that no edge has lowered is as high as its layer. A tool's end that stops inside the layer leaves a column:
//! an interval of the ray with its height, as a fraction between 0 and 1 of the layer's. The columns are stored beside
//! the ray's full material, and their ends are as exact. A ray without columns is a plain dexel. The removed volume is
//! length times height, to the last digit.
//!
//! Source: own.

use std::borrow::Cow;

use arcfeed_dexel::dexel::{Dexel, Interval};

/// Heights that differ by less than this fraction of a layer are the same: rounding.
const SAME_RATIO: f64 = 1e-9;

/// Intervals shorter than this remain between two sweeps by rounding.
const SLIVER_MM: f64 = 1e-9;

/// Columns that a search looks at, one after the other, before it halves the rest.
const NEAR: usize = 6;

/// Columns of one ray: intervals of its material that are lower than the layer, in ascending order, with their heights.
#[derive(Clone, Debug, Default)]
pub struct PartialHeights {
    lowered: Vec<Column>,
    /// Column that was found last: the next cut is mostly near.
    near: usize,
}

/// Interval of constant height.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Column {
    on: Interval,
    top_ratio: f64,
}

/// Depth band: the part of a layer's height that an edge cuts. Heights are fractions of the layer's height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthBand {
    /// Height at which the edge passes: material below it remains; if it is 0 or negative, nothing remains.
    pub foot_ratio: f64,
    /// Height that divides the material between both kinds of edges: side edges cut columns higher than this, end edges the lower ones.
    pub border_ratio: f64,
    /// Whether the edge is on the tool's end; otherwise it is on its side.
    pub is_end: bool,
}

impl DepthBand {
    /// Band over the whole height of the layer, of a side edge.
    pub const ALL: DepthBand = DepthBand { foot_ratio: 0.0, border_ratio: 0.0, is_end: false };

    /// Height that the edge removes from a column of the height `top_ratio`; 0 if it does not cut that column.
    pub fn cut_ratio(&self, top_ratio: f64) -> f64 {
        if self.cuts(top_ratio) { top_ratio - self.foot_ratio.max(0.0) } else { 0.0 }
    }

    fn cuts(&self, top_ratio: f64) -> bool {
        (top_ratio > self.border_ratio + SAME_RATIO) != self.is_end && top_ratio > self.foot_ratio + SAME_RATIO
    }
}

impl PartialHeights {
    /// Removes a depth band of the material in `span`; returns the removed length times the removed fraction of the layer's height, mm.
    pub fn remove(&mut self, material: &mut Dexel, span: Interval, depth_band: &DepthBand) -> f64 {
        if depth_band.foot_ratio <= 0.0 && !self.meets(&span) {
            return if depth_band.cuts(1.0) { material.subtract(span) } else { 0.0 };
        }
        if self.is_already_lowered(material, &span, depth_band) {
            return 0.0;
        }
        if let Some(taken_mm) = self.remove_beside(material, &span, depth_band) {
            return taken_mm;
        }
        let (foot_ratio, mut rest, mut taken_mm) = (depth_band.foot_ratio.max(0.0), span, 0.0);
        while rest.length_mm() > 0.0 {
            let found = self.columns(material, &rest).find(|column| depth_band.cuts(column.top_ratio));
            let Some(Column { on, top_ratio }) = found else { break };
            taken_mm += on.length_mm() * depth_band.cut_ratio(top_ratio);
            rest.from_mm = on.to_mm;
            if foot_ratio > 0.0 {
                self.set(on, Some(foot_ratio));
            } else {
                material.subtract(on);
                self.set(on, None);
            }
        }
        taken_mm
    }

    /// The common case: removes a chip beside a column that already has the final height; `None`, with nothing removed,
    /// in any other case.
    fn remove_beside(&mut self, material: &Dexel, span: &Interval, depth_band: &DepthBand) -> Option<f64> {
        let Dexel::One(piece) = material else { return None };
        let on = piece.common(span);
        let low = self.first_behind(span.from_mm);
        let Column { on: is_low, top_ratio } = *self.lowered.get(low)?;
        if top_ratio != depth_band.foot_ratio || !depth_band.cuts(1.0) {
            return None;
        }
        let chip = if is_low.from_mm <= on.from_mm {
            let is_last = self.lowered.get(low + 1).is_none_or(|next| next.on.from_mm > on.to_mm);
            is_last.then_some(Interval { from_mm: is_low.to_mm, ..on })
        } else {
            let is_first = low.checked_sub(1).is_none_or(|before| self.lowered[before].on.to_mm < on.from_mm);
            let is_at_end = is_low.from_mm <= on.to_mm && on.to_mm <= is_low.to_mm;
            (is_first && is_at_end).then_some(Interval { to_mm: is_low.from_mm, ..on })
        };
        let chip = chip.filter(|chip| chip.length_mm() > 0.0)?;
        let all = &mut self.lowered[low].on;
        *all = Interval::new(all.from_mm.min(chip.from_mm), all.to_mm.max(chip.to_mm));
        Some(chip.length_mm() * depth_band.cut_ratio(1.0))
    }

    /// Length of the material, mm, each interval multiplied by its height as a fraction of the layer's.
    pub fn length_mm(&self, material: &Dexel) -> f64 {
        let missing = |column: &Column| column.on.length_mm() * (1.0 - column.top_ratio);
        match material.extent().filter(|_| !self.lowered.is_empty()) {
            None => material.length_mm(),
            Some(all) => {
                material.length_mm() - self.columns(material, &all).map(|column| missing(&column)).sum::<f64>()
            }
        }
    }

    /// Intervals with material higher than `above_ratio` of the layer's height that overlap `span`. Lowered intervals that are as short as
    /// rounding errors are left out.
    pub fn section<'a>(&self, material: &'a Dexel, span: &Interval, above_ratio: f64) -> Cow<'a, [Interval]> {
        if !self.meets(span) {
            return Cow::Borrowed(if above_ratio + SAME_RATIO < 1.0 { material.intervals() } else { &[] });
        }
        Cow::Owned(Pieces { columns: self.columns(material, span), above_ratio, next: None }.collect())
    }

    /// Mean height of the material in `span`, as a fraction of the layer's height; 1 if there is none.
    pub fn mean_ratio(&self, material: &Dexel, span: &Interval) -> f64 {
        if !self.meets(span) {
            return 1.0;
        }
        let (length_mm, sum_mm) = self.columns(material, span).fold((0.0, 0.0), |(length_mm, sum_mm), column| {
            (length_mm + column.on.length_mm(), sum_mm + column.on.length_mm() * column.top_ratio)
        });
        if length_mm > 0.0 { sum_mm / length_mm } else { 1.0 }
    }

    /// Height of the material at a coordinate along the ray, as a fraction of the layer's height; `None` without material.
    pub fn top_ratio(&self, material: &Dexel, at_mm: f64) -> Option<f64> {
        let first = self.first_behind(at_mm);
        let column = self.lowered.get(first).filter(|column| column.on.from_mm <= at_mm);
        material.contains(at_mm).then(|| column.map_or(1.0, |column| column.top_ratio))
    }

    /// Whether all material in `span` is already so low that an edge with this depth band removes nothing.
    pub fn is_already_lowered(&mut self, material: &Dexel, span: &Interval, depth_band: &DepthBand) -> bool {
        let Interval { mut from_mm, to_mm } = match material {
            Dexel::One(piece) => piece.common(span),
            _ => *span,
        };
        let first = self.first_behind(from_mm);
        self.near = first;
        for Column { on, top_ratio } in &self.lowered[first..] {
            if from_mm >= to_mm || on.from_mm > from_mm || depth_band.cuts(*top_ratio) {
                break;
            }
            from_mm = on.to_mm;
        }
        from_mm >= to_mm
    }

    /// Whether the whole of `span` is one or several lowered intervals no higher than `above_ratio` of the layer's height.
    pub fn is_below(&self, span: &Interval, above_ratio: f64) -> bool {
        self.over(span).is_some_and(|column| column.top_ratio <= above_ratio + SAME_RATIO)
    }

    /// The column that contains a whole span.
    fn over(&self, span: &Interval) -> Option<&Column> {
        let first = self.first_behind(span.from_mm);
        self.lowered.get(first).filter(|column| column.on.from_mm <= span.from_mm && span.to_mm <= column.on.to_mm)
    }

    /// Whether any column overlaps a span.
    fn meets(&self, span: &Interval) -> bool {
        let first = self.first_behind(span.from_mm);
        self.lowered.get(first).is_some_and(|column| column.on.from_mm < span.to_mm)
    }

    /// First (or last) interval in `span` with material higher than `above_ratio` of the layer's height, cut off at the ends of `span`;
    /// `None` if there is none. Intervals as in [`PartialHeights::section`].
    pub fn end_piece(&self, material: &Dexel, span: &Interval, above_ratio: f64, is_first: bool) -> Option<Interval> {
        if !self.meets(span) {
            let mut met = material.met(span);
            let piece = if is_first { met.next() } else { met.next_back() };
            return piece.filter(|_| above_ratio + SAME_RATIO < 1.0).map(|piece| piece.common(span));
        }
        if self.is_below(span, above_ratio) {
            return None;
        }
        let mut pieces = Pieces { columns: self.columns(material, span), above_ratio, next: None };
        if is_first { pieces.next() } else { pieces.last() }
    }

    /// Material of a span as columns, in order.
    fn columns<'a>(&'a self, material: &'a Dexel, within: &'a Interval) -> Columns<'a> {
        let first = self.first_behind(within.from_mm);
        Columns { heights: &self.lowered[first..], pieces: material.intervals(), within, whole: None }
    }

    /// Index of the first column that ends behind a coordinate.
    fn first_behind(&self, at_mm: f64) -> usize {
        let ends_before = |column: &Column| column.on.to_mm <= at_mm;
        let (before, behind) = self.lowered.split_at(self.near.min(self.lowered.len()));
        if before.last().is_none_or(ends_before) {
            let (next, rest) = behind.split_at(NEAR.min(behind.len()));
            let found = next.iter().position(|column| !ends_before(column));
            return before.len() + found.unwrap_or_else(|| next.len() + rest.partition_point(ends_before));
        }
        let (rest, last) = before.split_at(before.len().saturating_sub(NEAR));
        let found = last.iter().rposition(ends_before).map(|index| rest.len() + index + 1);
        found.unwrap_or_else(|| rest.partition_point(ends_before))
    }

    /// Replaces the columns of an interval by one column, or by none; joins it to a neighbour of the same height.
    fn set(&mut self, on: Interval, top_ratio: Option<f64>) {
        let first = self.first_behind(on.from_mm);
        let end = first + self.lowered[first..].iter().take_while(|column| column.on.from_mm < on.to_mm).count();
        self.near = first;
        if first == end && top_ratio.is_none_or(|top_ratio| self.extend(first, on, top_ratio)) {
            return;
        }
        let before = self.lowered[first..end]
            .first()
            .map(|column| (Interval { to_mm: on.from_mm, ..column.on }, column.top_ratio));
        let after = self.lowered[first..end]
            .last()
            .map(|column| (Interval { from_mm: on.to_mm, ..column.on }, column.top_ratio));
        let rests = [before, top_ratio.map(|top_ratio| (on, top_ratio)), after].into_iter().flatten();
        let rests = rests.filter(|(on, _)| on.length_mm() > 0.0).map(|(on, top_ratio)| Column { on, top_ratio });
        self.lowered.splice(first..end, rests);
        let mut at = first.saturating_sub(1);
        while at < first + 3 && at + 1 < self.lowered.len() {
            let (one, next) = (self.lowered[at], self.lowered[at + 1]);
            if one.on.to_mm == next.on.from_mm && one.top_ratio == next.top_ratio {
                self.lowered[at].on.to_mm = next.on.to_mm;
                self.lowered.remove(at + 1);
            } else {
                at += 1;
            }
        }
    }

    /// Extends a neighbour of the same height over an interval without a column before column `next`; returns whether
    /// there was one.
    fn extend(&mut self, next: usize, on: Interval, top_ratio: f64) -> bool {
        let is_same = |column: &Column| column.top_ratio == top_ratio;
        let before = next
            .checked_sub(1)
            .filter(|last| self.lowered[*last].on.to_mm == on.from_mm && is_same(&self.lowered[*last]));
        let is_joined = self.lowered.get(next).is_some_and(|after| after.on.from_mm == on.to_mm && is_same(after));
        match before {
            Some(before) if is_joined => self.lowered[before].on.to_mm = self.lowered.remove(next).on.to_mm,
            Some(before) => self.lowered[before].on.to_mm = on.to_mm,
            None if is_joined => self.lowered[next].on.from_mm = on.from_mm,
            None => return false,
        }
        true
    }
}

/// Iterator over the material of a span, in order: full material before, between and after the columns.
struct Columns<'a> {
    /// Columns not passed yet.
    heights: &'a [Column],
    /// Intervals of material to come.
    pieces: &'a [Interval],
    within: &'a Interval,
    /// Rest of the present interval.
    whole: Option<Interval>,
}

impl Iterator for Columns<'_> {
    type Item = Column;

    fn next(&mut self) -> Option<Column> {
        loop {
            let Some(piece) = self.whole.take() else {
                let (first, rest) = self.pieces.split_first()?;
                self.pieces = rest;
                if first.from_mm >= self.within.to_mm {
                    return None;
                }
                self.whole = Some(first.common(self.within)).filter(|piece| piece.length_mm() > 0.0);
                continue;
            };
            let Some((column, rest)) = self.heights.split_first().filter(|(column, _)| column.on.from_mm < piece.to_mm)
            else {
                return Some(Column { on: piece, top_ratio: 1.0 });
            };
            if column.on.to_mm <= piece.from_mm {
                (self.heights, self.whole) = (rest, Some(piece));
            } else if column.on.from_mm > piece.from_mm {
                self.whole = Some(Interval { from_mm: column.on.from_mm, ..piece });
                return Some(Column { on: Interval { to_mm: column.on.from_mm, ..piece }, top_ratio: 1.0 });
            } else {
                let on = column.on.common(&piece);
                self.whole = Some(Interval { from_mm: on.to_mm, ..piece }).filter(|rest| rest.length_mm() > 0.0);
                return Some(Column { on, ..*column });
            }
        }
    }
}

/// Iterator over the intervals of columns that are higher than a fraction of the layer, and longer than rounding;
/// touching ones are joined.
struct Pieces<'a> {
    columns: Columns<'a>,
    above_ratio: f64,
    /// Beginning of the next one.
    next: Option<Interval>,
}

impl Iterator for Pieces<'_> {
    type Item = Interval;

    fn next(&mut self) -> Option<Interval> {
        let mut last = self.next.take();
        let is_high = |column: &Column| column.top_ratio > self.above_ratio + SAME_RATIO;
        for Column { on, .. } in self.columns.by_ref().filter(is_high) {
            match &mut last {
                Some(piece) if piece.to_mm == on.from_mm => piece.to_mm = on.to_mm,
                Some(piece) if piece.length_mm() > SLIVER_MM => {
                    self.next = Some(on);
                    return last;
                }
                _ => last = Some(on),
            }
        }
        last.filter(|piece| piece.length_mm() > SLIVER_MM)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const END: fn(f64, f64) -> DepthBand =
        |foot_ratio, border_ratio| DepthBand { foot_ratio, border_ratio, is_end: true };

    #[test]
    fn removed_and_remaining_material_add_up() {
        let mut material = Dexel::One(Interval::new(0.0, 10.0));
        let mut heights = PartialHeights::default();
        let mut left_mm = 10.0;
        let side = DepthBand { foot_ratio: 0.25, border_ratio: 0.5, is_end: false };
        for (from_mm, to_mm, depth_band, taken_mm) in [
            (2.0, 4.0, END(0.75, 1.0), 0.5),
            (3.0, 6.0, END(0.5, 1.0), 0.25 + 1.0),
            // Both are below the side's border but for 2 to 3, which is 0.75 high, and the plain material.
            (0.0, 6.0, side, 2.0 * 0.75 + 0.5),
            (0.0, 8.0, END(0.25, 0.5), 3.0 * 0.25),
            (0.0, 3.0, END(0.0, 0.5), 3.0 * 0.25),
            (0.0, 10.0, DepthBand::ALL, 3.0 * 0.25 + 4.0),
        ] {
            let taken = heights.remove(&mut material, Interval::new(from_mm, to_mm), &depth_band);
            left_mm -= taken;
            assert_eq!(taken, taken_mm, "{depth_band:?}");
            assert_eq!(heights.length_mm(&material), left_mm, "{depth_band:?}");
        }
        assert!(material == Dexel::Empty && heights.lowered.is_empty());
    }

    #[test]
    fn chips_beside_a_floor_become_part_of_it() {
        let mut material = Dexel::One(Interval::new(0.0, 10.0));
        let mut heights = PartialHeights::default();
        let side = DepthBand { foot_ratio: 0.25, border_ratio: 0.5, is_end: false };
        // In the middle, away from it, at the end of a floor, at its beginning, between two floors, beyond the
        // material, and without remaining material.
        for (from_mm, to_mm, taken_mm) in [
            (6.0, 7.0, 1.0),
            (2.0, 4.0, 2.0),
            (3.0, 5.0, 1.0),
            (1.0, 3.0, 1.0),
            (4.0, 6.5, 1.0),
            (6.0, 12.0, 3.0),
            (1.0, 11.0, 0.0),
        ] {
            assert_eq!(
                heights.remove(&mut material, Interval::new(from_mm, to_mm), &side),
                0.75 * taken_mm,
                "{from_mm}"
            );
        }
        assert_eq!(heights.lowered, [Column { on: Interval::new(1.0, 10.0), top_ratio: 0.25 }]);
        assert_eq!(material, Dexel::One(Interval::new(0.0, 10.0)));
    }

    #[test]
    fn a_section_is_the_material_above_a_height() {
        let mut material = Dexel::One(Interval::new(0.0, 10.0));
        let mut heights = PartialHeights::default();
        for (from_mm, to_mm, foot_ratio) in [(2.0, 4.0, 0.75), (4.0, 5.0, 0.5), (5.0, 6.0, 0.5)] {
            heights.remove(&mut material, Interval::new(from_mm, to_mm), &END(foot_ratio, 1.0));
        }
        assert_eq!(heights.lowered.len(), 2, "equal neighbours are one");
        let interval = |(from, to)| Interval::new(from, to);
        let all = Interval::new(-1.0, 11.0);
        assert_eq!(*heights.section(&material, &all, 0.5), [(0.0, 4.0), (6.0, 10.0)].map(interval));
        assert_eq!(*heights.section(&material, &all, 0.75), [(0.0, 2.0), (6.0, 10.0)].map(interval));
        assert_eq!(*heights.section(&material, &Interval::new(1.0, 3.0), 0.0), [(1.0, 3.0)].map(interval));
        assert!(PartialHeights::default().section(&material, &all, 1.0).is_empty());
        for (of_all, above_ratio) in [([(0.0, 4.0), (6.0, 10.0)], 0.5), ([(0.0, 10.0); 2], 0.0)] {
            let ends = [true, false].map(|is_first| heights.end_piece(&material, &all, above_ratio, is_first));
            assert_eq!(ends, of_all.map(|ends| Some(interval(ends))));
        }
        assert_eq!(
            PartialHeights::default().end_piece(&material, &Interval::new(9.0, 12.0), 0.0, false),
            Some(interval((9.0, 10.0)))
        );
        assert_eq!(heights.mean_ratio(&material, &Interval::new(3.0, 5.0)), 0.625);
        assert_eq!([1.0, 4.5, 11.0].map(|at| heights.top_ratio(&material, at)), [Some(1.0), Some(0.5), None]);
    }

    #[test]
    fn a_search_finds_the_same_column_wherever_the_last_one_was() {
        let column = |n: u32| Column { on: Interval::new(f64::from(n), f64::from(n) + 0.5), top_ratio: 0.5 };
        for count in [0, 1, 2, 7, 40] {
            let lowered: Vec<Column> = (0..count).map(column).collect();
            for near in 0..=count as usize + 1 {
                let heights = PartialHeights { lowered: lowered.clone(), near };
                for at_mm in (-1..2 * count as i32 + 3).map(|half| f64::from(half) / 2.0) {
                    let found = lowered.iter().filter(|column| column.on.to_mm <= at_mm).count();
                    assert_eq!(heights.first_behind(at_mm), found, "{count} {near} {at_mm}");
                }
            }
        }
    }
}
