//! Comments about tools, collected along a program and assigned to their T numbers.
//!
//! A comment belongs to the T number that it names; without one, to the comment right before it that names one (a list over
//! several lines), or to a tool change in its own block or close by. Comments that contradict each other leave
//! that value open.

use std::collections::BTreeSet;

use arcfeed_units::LengthUnit;

use super::tool_comment::{CommentedKind, ToolComment};

/// Farthest a comment without a number may stand before its tool change, in lines.
const REACH_BEFORE: usize = 4;
/// And behind it: there it has to name a kind of tool, for most comments there are about the cut.
const REACH_BEHIND: usize = 2;
/// Most lines with comments about other things that are kept.
const SILENT_MAX: usize = 1_000;
/// Most tools with comments.
const NOTES_MAX: usize = 500;

/// Comments about one tool, and the tool data that they state together.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolNote {
    /// T number.
    pub tool: i64,
    /// First line with such a comment, counted from 1.
    pub line: usize,
    /// Text of that comment.
    pub text: String,
    /// Data from all comments about the tool.
    pub data: ToolComment,
    /// A comment with a word of another tool that is no end mill, but without a number or a size: it may as well name the
    /// part or the operation.
    pub operation: Option<Operation>,
}

/// Comment that may name an operation or a tool.
#[derive(Clone, Debug, PartialEq)]
pub struct Operation {
    /// Line, counted from 1.
    pub line: usize,
    /// Text of the comment.
    pub text: String,
}

/// Collector of the comments about tools in a program.
#[derive(Clone, Debug)]
pub struct ToolNotes {
    unit: LengthUnit,
    notes: Vec<ToolNote>,
    /// Comments that begin with a T number, without data.
    names: Vec<(i64, String)>,
    /// Tools whose comments contradict each other about the diameter.
    contradicted: Vec<i64>,
    /// Tool that the last comment named, and its line.
    named: Option<(i64, usize)>,
    /// Last tool change and its line.
    change: Option<(i64, usize)>,
    /// Lines whose comments say nothing about a tool: each is read once.
    silent: BTreeSet<Vec<u8>>,
    /// Comment that waits for its tool change.
    pending: Option<(usize, String, ToolComment)>,
}

impl ToolNotes {
    /// Empty notes, for a program in this unit.
    pub fn new(unit: LengthUnit) -> Self {
        let (notes, contradicted) = (Vec::new(), Vec::new());
        ToolNotes {
            unit,
            notes,
            names: Vec::new(),
            contradicted,
            named: None,
            change: None,
            silent: BTreeSet::new(),
            pending: None,
        }
    }

    /// Reads the comments of the next line; `change` is the tool that its block selects or loads.
    pub fn read(&mut self, line: usize, text: &[u8], change: Option<i64>) {
        let text = if text.contains(&b'(') { text } else { b"" };
        if change.is_none() && (text.is_empty() || self.silent.contains(text)) {
            return;
        }
        let mut is_silent = true;
        if let Some(tool) = change {
            self.change = Some((tool, line));
            if let Some((place, comment, data)) = self.pending.take().filter(|(place, ..)| place + REACH_BEFORE >= line)
            {
                self.add(tool, (place, &comment), data, false);
            }
        }
        for comment in comments(text) {
            let data = ToolComment::read(&comment, self.unit);
            is_silent &= data.number.is_none() && !data.has_data();
            let near = |(tool, place): (i64, usize), reach: usize| (place + reach >= line).then_some(tool);
            let followed = || self.named.and_then(|named| near(named, 1));
            let reach = if data.kind.is_some() { REACH_BEHIND } else { 0 };
            let changed = || self.change.and_then(|change| near(change, reach));
            let Some(tool) = data.number.or_else(|| if data.has_data() { followed().or_else(changed) } else { None })
            else {
                if data.has_data() {
                    self.pending = Some((line, comment, data));
                }
                continue;
            };
            let is_listed = data.number.is_some() || followed().is_some();
            if is_listed {
                self.named = Some((tool, line));
            }
            self.add(tool, (line, &comment), data, is_listed);
        }
        if is_silent && self.silent.len() < SILENT_MAX {
            self.silent.insert(text.to_vec());
        }
    }

    /// All notes.
    pub fn finish(self) -> Vec<ToolNote> {
        self.notes
    }

    /// Text of the first comment about a tool, if there is one.
    pub fn text_of(&self, tool: i64) -> Option<&str> {
        let described = self.notes.iter().find(|note| note.tool == tool && note.data.has_data());
        let named = || self.names.iter().find(|(number, _)| *number == tool).map(|(_, text)| text.as_str());
        described.map(|note| note.text.as_str()).or_else(named)
    }

    fn add(&mut self, tool: i64, (line, text): (usize, &str), data: ToolComment, is_listed: bool) {
        if !data.has_data() {
            let is_named = data.number.is_some() && text.starts_with(['T', 't']);
            if is_named && self.names.len() < NOTES_MAX {
                self.names.push((tool, text.to_owned()));
            }
            return;
        }
        let has_kind = self.notes.iter().any(|note| note.tool == tool && note.data.kind.is_some());
        let is_description = data.number.is_some() || data.has_size() || (is_listed && !has_kind);
        let may_be_operation = data.kind == Some(CommentedKind::Other) && !is_description;
        let operation = may_be_operation.then(|| Operation { line, text: text.to_owned() });
        let data = if operation.is_some() { ToolComment::default() } else { data };
        let Some(note) = self.notes.iter_mut().find(|note| note.tool == tool) else {
            if self.notes.len() == NOTES_MAX {
                return;
            }
            self.notes.push(ToolNote { tool, line, text: text.to_owned(), data, operation });
            return;
        };
        if !note.data.has_data() {
            (note.line, note.text) = (line, text.to_owned());
        }
        note.operation = note.operation.take().or(operation);
        let known = &mut note.data;
        if let (Some(a), Some(b)) = (known.diameter_mm, data.diameter_mm)
            && libm::fabs(a - b) > 1e-3 * a
        {
            self.contradicted.push(tool);
        }
        let is_contradicted = self.contradicted.contains(&tool);
        known.diameter_mm = known.diameter_mm.or(data.diameter_mm).filter(|_| !is_contradicted);
        known.corner_radius_mm = known.corner_radius_mm.or(data.corner_radius_mm);
        known.teeth = known.teeth.or(data.teeth);
        known.kind = match (known.kind, data.kind) {
            (Some(CommentedKind::Other), _) | (_, Some(CommentedKind::Other)) => Some(CommentedKind::Other),
            (one, other) => one.or(other),
        };
    }
}

/// Texts of the comments of a line, without blanks around them; those without letters and digits are left out. A list of
/// several tools, each with its T number, is several texts.
pub(super) fn comments(text: &[u8]) -> impl Iterator<Item = String> {
    let comments = text.split(|byte| *byte == b'(').skip(1);
    let inner = comments.map(|rest| rest.split(|byte| *byte == b')').next().unwrap_or(rest));
    let texts = inner.flat_map(|comment| of_each_tool(&String::from_utf8_lossy(comment)));
    texts.map(|text| text.trim().to_owned()).filter(|text| text.contains(|c: char| c.is_alphanumeric()))
}

fn of_each_tool(comment: &str) -> Vec<String> {
    let bytes = comment.as_bytes();
    let is_tool = |at: &usize| {
        let starts = *at == 0 || !bytes[at - 1].is_ascii_alphanumeric();
        starts && bytes[*at].eq_ignore_ascii_case(&b'T') && bytes.get(at + 1).is_some_and(u8::is_ascii_digit)
    };
    let mut starts: Vec<usize> = (0..bytes.len()).filter(is_tool).collect();
    if starts.len() < 2 {
        return vec![comment.to_owned()];
    }
    starts.push(bytes.len());
    starts.windows(2).map(|ends| comment[ends[0]..ends[1]].to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    type Found = (i64, Option<f64>, Option<u16>, Option<CommentedKind>);

    fn notes(lines: &[(&str, Option<i64>)]) -> Vec<Found> {
        let mut notes = ToolNotes::new(LengthUnit::Mm);
        for (index, (text, change)) in lines.iter().enumerate() {
            notes.read(index + 1, text.as_bytes(), *change);
        }
        let data = |note: ToolNote| (note.tool, note.data.diameter_mm, note.data.teeth, note.data.kind);
        notes.finish().into_iter().map(data).collect()
    }

    const MILL: Option<CommentedKind> = Some(CommentedKind::EndMill);

    #[test]
    fn a_comment_belongs_to_its_number_or_to_the_tool_change_beside_it() {
        assert_eq!(notes(&[("(T3 D=10. CR=0. - FLAT END MILL)", None)]), [(3, Some(10.0), None, MILL)]);
        assert_eq!(notes(&[("T3M6 (10MM ENDMILL 4FL)", Some(3))]), [(3, Some(10.0), Some(4), MILL)]);
        assert_eq!(notes(&[("(10MM ENDMILL)", None), ("T3M6", Some(3))]), [(3, Some(10.0), None, MILL)]);
        assert_eq!(notes(&[("T3M6", Some(3)), ("(10MM ENDMILL)", None)]), [(3, Some(10.0), None, MILL)]);
        assert_eq!(notes(&[("T3M6", Some(3)), ("G0", None), ("X1", None), ("(10MM ENDMILL)", None)]), []);
        assert_eq!(
            notes(&[("(D12)", None), ("T3M6", Some(3)), ("(D50 BOHRUNG)", None)]),
            [(3, Some(12.0), None, None)]
        );
        let list = notes(&[("(T1 D16 WSP  T2 D8 ENDMILL  T4 BOHRER 8.5)", None)]);
        assert_eq!(
            list.iter().map(|note| (note.0, note.1)).collect::<Vec<_>>(),
            [(1, Some(16.0)), (2, Some(8.0)), (4, None)]
        );
    }

    #[test]
    fn a_list_over_several_lines_is_one_tools() {
        let list = [("(TOOL NUMBER : 2)", None), ("(TOOL TYPE : ENDMILL)", None), ("(TOOL DIA. 8.0)", None)];
        assert_eq!(notes(&list), [(2, Some(8.0), None, MILL)]);
    }

    #[test]
    fn a_word_without_number_and_size_may_be_the_operations() {
        let program = [("O1 (FACE PLATE)", None), ("(T2 D=10. CR=0. - FLAT END MILL)", None), ("(BORE1)", None)];
        for text in ["T2M6 (CHAMFER)", "T2 M6"] {
            let lines = [&program[..], &[(text, Some(2))]].concat();
            assert_eq!(notes(&lines), [(2, Some(10.0), None, MILL)], "{text}");
        }
        let mut notes = ToolNotes::new(LengthUnit::Mm);
        notes.read(1, b"O1 (FACE PLATE)", None);
        notes.read(2, b"T2M6", Some(2));
        let [note] = &notes.finish()[..] else { panic!("one note") };
        assert_eq!(note.operation, Some(Operation { line: 1, text: "FACE PLATE".into() }));
        assert_eq!(note.data, ToolComment::default());
    }

    #[test]
    fn two_diameters_leave_the_diameter_open() {
        let lines = [("(T1 8MM ENDMILL)", None), ("(T1 10MM ENDMILL)", None), ("(T1 8MM ENDMILL)", None)];
        assert_eq!(notes(&lines), [(1, None, None, MILL)]);
        assert_eq!(notes(&[("(T1 8MM ENDMILL)", None), ("(T1 BALL)", None)])[0].3, Some(CommentedKind::Other));
    }
}
