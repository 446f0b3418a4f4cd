//! Counts of a program's content, made line by line.

use arcfeed_nc::block::LineKind;
use arcfeed_nc::machining::ToolInSpindle;
use arcfeed_nc::modal::ProgramStop;

use super::{MoveCounts, ProgramLine};

/// Most tools in the list: one more than one is enough to ask which tool is meant.
const TOOLS_MAX: usize = 100;

/// Counts of a program's content.
#[derive(Clone, Debug, Default)]
pub struct ProgramSummary {
    /// Number of lines in the file.
    pub lines: usize,
    /// Number of blocks: all lines but `%` and empty ones.
    pub blocks: usize,
    /// Number of blocks with only a comment or a title.
    pub comments: usize,
    /// Numbers of the moves by kind.
    pub moves: MoveCounts,
    /// Numbers of the tools that the program loads, without T0, which puts one away; each with the first line with it in the
    /// spindle, counted from 1.
    pub tools: Vec<(i64, usize)>,
    /// At least one line can end the program (M02, M30, M99).
    pub may_end: bool,
}

impl ProgramSummary {
    /// Counts what these lines contain.
    pub fn new(lines: impl IntoIterator<Item = ProgramLine>) -> Self {
        let mut summary = ProgramSummary::default();
        lines.into_iter().for_each(|line| summary.add(&line));
        summary
    }

    /// Counts the next line.
    pub fn add(&mut self, line: &ProgramLine) {
        self.lines += 1;
        if line.is_block() {
            self.blocks += 1;
            self.comments += usize::from(is_comment(line));
        }
        self.may_end |= may_end(line);
        line.meaning.iter().for_each(|meaning| self.moves.add(meaning));
        if let ToolInSpindle::Number(number @ 1..) = line.machining.tool
            && self.tools.len() < TOOLS_MAX
            && !self.tools.iter().any(|(known, _)| *known == number)
        {
            self.tools.push((number, self.lines));
        }
    }
}

fn is_comment(line: &ProgramLine) -> bool {
    line.meaning.as_ref().is_some_and(|meaning| match meaning.parsed.line {
        LineKind::Block => meaning.parsed.block.is_empty() && meaning.parsed.block.program.is_none(),
        LineKind::Title => true,
        LineKind::ProgramMark => false,
    })
}

/// The program can end in this line. A line that could not be read may contain M30.
fn may_end(line: &ProgramLine) -> bool {
    match &line.meaning {
        Some(understood) => understood.step.stop == Some(ProgramStop::End),
        None => {
            let has = |code: &[u8]| line.text.windows(code.len()).any(|text| text.eq_ignore_ascii_case(code));
            [&b"M30"[..], b"M02", b"M2"].into_iter().any(has)
        }
    }
}
