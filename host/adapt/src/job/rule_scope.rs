//! Scope of a cut rule: restriction to lines of the program's file, or to a plane of arcs. Only the host can check it.
//!
//! A board knows no lines of a file. The host decides which rule governs a move, and sends the index of that rule with it.

use arcfeed_nc::modal::Plane;
use arcfeed_nc::segment::Segment;
use toml::Spanned;

use super::cut_table::{CutTable, MovesWord, PlaneWord};
use super::schema::JobTable;
use super::{Complaint, at, rules};

/// Scope of one cut rule; by default it admits every move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RuleScope {
    /// First and last line of the program's file, counted from 1, to which the rule is restricted; `None`: no such restriction.
    pub lines: Option<[usize; 2]>,
    /// Plane (G17 to G19) of the arcs to which the rule is restricted; `None`: no such restriction.
    pub plane: Option<Plane>,
}

impl RuleScope {
    /// Whether the rule may govern the move `segment` of this line; `line` is `None` if the move is on no line of the program's file.
    pub fn admits(&self, line: Option<usize>, segment: &Segment) -> bool {
        let in_lines = self.lines.is_none_or(|[first, last]| line.is_some_and(|line| (first..=last).contains(&line)));
        in_lines && self.plane.is_none_or(|plane| segment.arc().is_some_and(|arc| arc.plane == plane))
    }

    /// Whether this scope admits every move that `other` admits.
    pub fn covers(&self, other: &RuleScope) -> bool {
        let covers_lines = match (self.lines, other.lines) {
            (None, _) => true,
            (Some(_), None) => false,
            (Some(own), Some(others)) => own[0] <= others[0] && others[1] <= own[1],
        };
        covers_lines && (self.plane.is_none() || self.plane == other.plane)
    }

    /// Key of the job file that restricts the scope (`lines` or `plane`); `None` without a restriction.
    pub fn key(&self) -> Option<&'static str> {
        match self {
            RuleScope { lines: Some(_), .. } => Some("lines"),
            RuleScope { plane: Some(_), .. } => Some("plane"),
            RuleScope { lines: None, plane: None } => None,
        }
    }
}

/// Whether the scope of the rule with this index admits a move.
pub fn admits(scopes: &[RuleScope], rule: usize, line: Option<usize>, segment: &Segment) -> bool {
    scopes.get(rule).is_none_or(|scope| scope.admits(line, segment))
}

/// Scopes of all cut rules of a job, in their order; fails at the first faulty value.
pub fn build(job: &JobTable) -> Result<Vec<RuleScope>, Complaint> {
    let has_map = rules::map(job)?.is_some();
    let scope = |(_, cut): (u8, &Spanned<CutTable>)| {
        let table = cut.as_ref();
        if let Some(plane) = table.plane.as_ref().filter(|_| matches!(table.moves, Some(MovesWord::Lines))) {
            return Err(at(plane, "plane is that of arcs: give it to a rule for arcs"));
        }
        let lines = table.lines.as_ref().map(lines).transpose()?;
        let scope = RuleScope { lines, plane: table.plane.as_ref().map(|word| plane(*word.as_ref())) };
        match scope.key().filter(|_| has_map) {
            Some(key) => Err(at(
                cut,
                &format!("{key} does not go with an engagement map, whose moves are found by their shape: use n or z"),
            )),
            None => Ok(scope),
        }
    };
    rules::tables(job).map(scope).collect()
}

fn lines(text: &Spanned<String>) -> Result<[usize; 2], Complaint> {
    let number = |part: &str| part.trim().parse::<usize>().ok();
    let (first, last) = text.as_ref().split_once('-').unwrap_or((text.as_ref(), text.as_ref()));
    match (number(first), number(last)) {
        (Some(first), Some(last)) if 0 < first && first <= last => Ok([first, last]),
        _ => Err(at(text, "lines are the first and the last line of the program's file, for example \"10-40\"")),
    }
}

fn plane(word: PlaneWord) -> Plane {
    match word {
        PlaneWord::G17 => Plane::Xy,
        PlaneWord::G18 => Plane::Zx,
        PlaneWord::G19 => Plane::Yz,
    }
}

#[cfg(test)]
mod tests {
    use arcfeed_nc::modal::{Feed, Pose, Turn};
    use arcfeed_nc::segment::{Arc, Path};
    use arcfeed_units::Nm;

    use super::*;

    fn arc(plane: Plane) -> Segment {
        let (from, to) = ([Nm(10), Nm(0)], [Nm(0), Nm(10)]);
        let path = Path::Arc(Arc { plane, turn: Turn::Ccw, center: [Nm(0); 2], from, to });
        Segment { sequence: None, start: Pose::ORIGIN, end: Pose::ORIGIN, feed: Feed::Missing, path }
    }

    #[test]
    fn a_scope_admits_its_lines_and_the_arcs_of_its_plane() {
        let scope = RuleScope { lines: Some([10, 40]), plane: Some(Plane::Xy) };
        for (line, plane, is_admitted) in [
            (Some(9), Plane::Xy, false),
            (Some(10), Plane::Xy, true),
            (Some(40), Plane::Xy, true),
            (Some(41), Plane::Xy, false),
            (None, Plane::Xy, false),
            (Some(10), Plane::Zx, false),
        ] {
            assert_eq!(scope.admits(line, &arc(plane)), is_admitted, "{line:?} {plane:?}");
        }
        assert!(!scope.admits(Some(20), &Segment { path: Path::Line, ..arc(Plane::Xy) }));
        assert!(RuleScope::default().admits(None, &arc(Plane::Yz)));
    }

    #[test]
    fn a_scope_covers_a_narrower_one() {
        let of = |lines, plane| RuleScope { lines, plane };
        let (all, some, xy) = (RuleScope::default(), of(Some([1, 9]), None), of(None, Some(Plane::Xy)));
        assert!(all.covers(&some) && all.covers(&xy) && some.covers(&of(Some([2, 9]), Some(Plane::Xy))));
        assert!(!some.covers(&all) && !xy.covers(&all) && !xy.covers(&of(None, Some(Plane::Zx))));
        assert!(!some.covers(&of(Some([2, 10]), None)));
    }
}
