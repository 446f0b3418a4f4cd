//! Index of a file of programs: their ranges of lines, sequence numbers, and pairs of DO and END.
//!
//! A file may hold several programs, each from its O word to the next. The first one may have no O word.

use alloc::collections::BTreeMap;
use alloc::vec::Vec;

use super::code::{Head, MacroCode, is_keyword, is_short_keyword};
use super::offsets;
use super::plain_bytes::{first_odd_byte, has_plain_bytes};
use arcfeed_nc::block::is_title;
use arcfeed_nc::text::Lines;

/// Source of subprograms that are not in the file of the main program.
pub trait Library: core::fmt::Debug + Send {
    /// The text of the file that holds program O`number`; `None` if there is no such program.
    fn load(&mut self, number: u32) -> Option<Vec<u8>>;
}

/// The empty library.
impl Library for () {
    fn load(&mut self, _number: u32) -> Option<Vec<u8>> {
        None
    }
}

/// Library of texts by program number.
impl Library for BTreeMap<u32, Vec<u8>> {
    fn load(&mut self, number: u32) -> Option<Vec<u8>> {
        self.get(&number).cloned()
    }
}

/// Lines of one program in its file: `first` up to, but not including, `end`, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineRange {
    /// Program number (O); `None` if the program has none.
    pub number: Option<u32>,
    /// First line.
    pub first: u32,
    /// Line after the last one.
    pub end: u32,
}

/// A line of a program, and whether the macro interpreter has to execute it.
#[derive(Clone, Debug)]
pub struct ProgramLine {
    /// Text as written, without line end.
    pub text: Vec<u8>,
    /// Whether the line has only plain words and comments, so that it can be passed on as it is.
    pub is_plain: bool,
}

/// Text of a program file, indexed by programs, sequence numbers and loops.
#[derive(Clone, Debug, Default)]
pub struct File {
    lines: Vec<ProgramLine>,
    spans: Vec<LineRange>,
    /// Sequence numbers with their lines, sorted.
    sequence: Vec<(u32, u32)>,
    /// Lines of DO to lines of END, and vice versa.
    loops: BTreeMap<u32, u32>,
}

impl File {
    /// Indexes a text. It ends at its second `%` if it begins with one, otherwise at its first.
    pub fn new(text: &[u8]) -> Self {
        let mut file = File::default();
        let mut open: Vec<(u32, u32)> = Vec::new();
        let (mut first, mut number) = (0, None);
        for (index, raw) in (0_u32..).zip(Lines::new(text).map(|line| line.text)) {
            let code = MacroCode::new(raw);
            let is_mark = code.bytes().starts_with(b"%");
            if is_mark && file.lines.iter().any(|line| !line.text.is_empty()) {
                break;
            }
            let mut cursor = code.cursor();
            let head = Head::read(&mut cursor);
            if head.program.is_some() {
                if number.is_some() {
                    file.spans.push(LineRange { number, first, end: index });
                    first = index;
                    open.clear();
                }
                number = head.program;
            }
            file.sequence.extend(head.sequence.map(|sequence| (sequence, index)));
            file.pair(loop_word(cursor.rest()), index, &mut open);
            let text = if is_mark { &[] } else { raw };
            file.lines.push(ProgramLine { text: text.to_vec(), is_plain: is_title(raw) || is_plain(cursor.rest()) });
        }
        let end = u32::try_from(file.lines.len()).unwrap_or(u32::MAX);
        file.spans.push(LineRange { number, first, end });
        file.sequence.sort_unstable();
        file
    }

    /// Pairs an END with the last open DO if their numbers agree.
    fn pair(&mut self, word: Option<LoopWord>, line: u32, open: &mut Vec<(u32, u32)>) {
        match word {
            Some(LoopWord::Do(number)) => open.push((number, line)),
            Some(LoopWord::End(number)) => {
                let Some((of, begin)) = open.pop() else { return };
                let is_nested_in_itself = open.iter().any(|(outer, _)| *outer == number);
                if of == number && !is_nested_in_itself {
                    self.loops.insert(begin, line);
                    self.loops.insert(line, begin);
                }
            }
            None => {}
        }
    }

    /// The line with this index, from 0; `None` after the last one.
    pub fn line(&self, index: u32) -> Option<&ProgramLine> {
        self.lines.get(usize::try_from(index).ok()?)
    }

    /// Lines of the first program of the file; `None` if no text was read.
    pub fn main(&self) -> Option<LineRange> {
        self.spans.first().copied()
    }

    /// Lines of the program with this O number; `None` if the file does not have it.
    pub fn program(&self, number: u32) -> Option<LineRange> {
        self.spans.iter().find(|span| span.number == Some(number)).copied()
    }

    /// Index of the line with this sequence number in the program `span`. It is searched after line `from` first, then
    /// from the program's start.
    pub fn find(&self, number: u32, span: LineRange, from: u32) -> Option<u32> {
        let begin = self.sequence.partition_point(|entry| *entry < (number, span.first));
        let same = self.sequence.get(begin..).unwrap_or_default();
        let lines =
            || same.iter().take_while(|(other, line)| *other == number && *line < span.end).map(|(_, line)| *line);
        lines().find(|line| *line > from).or_else(|| lines().next())
    }

    /// Index of the line with the END that belongs to a DO, or with the DO that belongs to an END.
    pub fn other_end(&self, line: u32) -> Option<u32> {
        self.loops.get(&line).copied()
    }

    /// Whether a jump from one line to another would enter a loop from outside.
    pub fn enters_loop(&self, from: u32, to: u32) -> bool {
        let bodies = self.loops.iter().filter(|(begin, end)| begin < end);
        bodies.into_iter().any(|(begin, end)| {
            let has = |line: u32| *begin < line && line <= *end;
            has(to) && !has(from)
        })
    }
}

enum LoopWord {
    Do(u32),
    End(u32),
}

/// The loop that a statement begins or ends.
fn loop_word(rest: &[u8]) -> Option<LoopWord> {
    let number = |text: &[u8]| {
        let value = |value: u32, digit: &u8| value.saturating_mul(10).saturating_add(u32::from(digit - b'0'));
        (!text.is_empty() && text.iter().all(u8::is_ascii_digit)).then(|| text.iter().fold(0, value))
    };
    if let Some(end) = rest.strip_prefix(b"END").or_else(|| rest.strip_prefix(b"EN")) {
        return number(end).map(LoopWord::End);
    }
    if rest.starts_with(b"DO") || rest.starts_with(b"WH") {
        let at = rest.windows(2).rposition(|pair| pair == b"DO")?;
        return number(rest.get(at + 2..)?).map(LoopWord::Do);
    }
    None
}

/// Whether a block, without its head, has only words with plain numbers and no call.
fn is_plain(rest: &[u8]) -> bool {
    is_plain_but(rest, is_call)
}

fn is_plain_but(rest: &[u8], is_call: impl Fn(u8, &[u8]) -> bool) -> bool {
    let has_macro = rest.iter().any(|byte| matches!(byte, b'#' | b'[' | b']' | b'='));
    let mut runs = rest.split(|byte| !byte.is_ascii_uppercase());
    let is_statement = runs.clone().next().is_some_and(is_short_keyword);
    let has_keyword = runs.any(is_keyword);
    !has_macro && !is_statement && !has_keyword && !words(rest).any(|(letter, value)| is_call(letter, value))
}

/// Whether a line is a macro statement or a call, that is, not only words with plain numbers.
pub fn is_statement(line: &[u8]) -> bool {
    let code = MacroCode::new(line);
    let mut cursor = code.cursor();
    Head::read(&mut cursor);
    !is_title(line) && !is_plain(cursor.rest())
}

/// Letters and the digits after them, without leading zeros.
fn words(rest: &[u8]) -> impl Iterator<Item = (u8, &[u8])> {
    rest.iter().enumerate().filter(|(_, byte)| byte.is_ascii_uppercase()).map(|(at, letter)| {
        let value = rest.get(at + 1..).unwrap_or_default();
        let len = value.iter().position(|byte| !byte.is_ascii_digit() && *byte != b'.').unwrap_or(value.len());
        let value = value.get(..len).unwrap_or_default();
        let zeros = value.iter().take_while(|byte| **byte == b'0').count();
        (*letter, value.get(zeros..).unwrap_or_default())
    })
}

fn is_call(letter: u8, value: &[u8]) -> bool {
    match letter {
        b'M' => matches!(value, b"98" | b"99" | b"198"),
        b'G' => value.starts_with(b"65") || value.starts_with(b"66") || value == b"67",
        _ => false,
    }
}

/// Number of the line, from 1, of the program's first macro statement or call; `None` if it has none. A G67 (cancels a
/// modal call) before any call does not count.
pub fn first_macro(text: &[u8]) -> Option<usize> {
    let is_end = |byte: &u8| *byte == b'\n';
    if !text.iter().any(is_end) {
        // CR ends its lines.
        return Lines::new(text).position(|line| is_macro(line.text)).map(|index| index + 1);
    }
    let mut begin = 0;
    loop {
        let (before, from_odd) = text.split_at_checked(begin + first_odd_byte(text.get(begin..)?)?)?;
        let start = before.iter().rposition(is_end).map_or(0, |end| end + 1);
        let end = before.len() + from_odd.iter().position(is_end).unwrap_or(from_odd.len());
        // CR behind LF belongs to its line end.
        let returns = text.iter().skip(start).take_while(|byte| start > 0 && **byte == b'\r').count();
        if is_macro(text.get(start + returns..end)?) {
            return Some(1 + before.iter().filter(|byte| is_end(byte)).count());
        }
        begin = end;
    }
}

fn is_macro(line: &[u8]) -> bool {
    needs_interpreter(line) && !only_cancels(line)
}

/// Whether G67 is all that the macro interpreter would execute of a line.
fn only_cancels(line: &[u8]) -> bool {
    let code = MacroCode::new(line);
    let mut cursor = code.cursor();
    Head::read(&mut cursor);
    is_plain_but(cursor.rest(), |letter, value| is_call(letter, value) && !(letter == b'G' && value == b"67"))
}

/// Whether a line has to be executed by the macro interpreter. It need not be if it has only words with plain numbers,
/// or sets a variable to a number (`#variable=number`) without further effect.
pub fn needs_interpreter(line: &[u8]) -> bool {
    !has_plain_bytes(line) && has_effect(line)
}

/// Full test of any line.
fn has_effect(line: &[u8]) -> bool {
    let code = MacroCode::new(line);
    let mut cursor = code.cursor();
    Head::read(&mut cursor);
    if is_title(line) || is_plain(cursor.rest()) {
        return false;
    }
    let variable = if cursor.accept(b"#") { cursor.digits().ok().flatten() } else { None };
    let value = if cursor.accept(b"=") { cursor.number().ok() } else { None };
    let (Some(variable), Some(value), None) = (variable, value, cursor.peek()) else { return true };
    // Alarms, messages, switches and offsets have side effects, except setting the external origin to zero, its usual
    // value.
    let is_zeroed = offsets::is_external(variable) && value.to_f64() == 0.0;
    (3_000..4_000).contains(&variable) || (offsets::is_offset(variable) && !is_zeroed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_may_hold_several_programs() {
        let file = File::new(b"%\nO1000\nN1M98P2000\nM30\nO2000(SUB)\nN1X1.\nM99\n%\nN1\n");
        assert_eq!(file.main(), Some(LineRange { number: Some(1000), first: 0, end: 4 }));
        let sub = file.program(2000).unwrap();
        assert_eq!(sub, LineRange { number: Some(2000), first: 4, end: 7 });
        assert_eq!(file.find(1, sub, 6), Some(5));
        assert_eq!(file.line(7).map(|line| line.text.clone()), None);
    }

    #[test]
    fn a_sequence_number_is_searched_forward_and_then_from_the_start() {
        let file = File::new(b"N1\nN2\nN1\nN3\n");
        let span = file.main().unwrap();
        assert_eq!((file.find(1, span, 0), file.find(1, span, 2), file.find(9, span, 0)), (Some(2), Some(0), None));
    }

    #[test]
    fn loops_belong_together_when_they_are_nested() {
        let file = File::new(b"WHILE[#1LT3]DO1\nDO2\nEND2\nEND1\nDO1\nEND1");
        let ends: Vec<_> = (0..6).map(|line| file.other_end(line)).collect();
        assert_eq!(ends, [Some(3), Some(2), Some(1), Some(0), Some(5), Some(4)]);
        assert!(file.enters_loop(5, 1) && !file.enters_loop(1, 4) && !file.enters_loop(1, 3));
        let crossed = File::new(b"DO1\nDO2\nEND1\nEND2\n");
        assert!((0..4).all(|line| crossed.other_end(line).is_none()));
        let twice = File::new(b"DO1\nDO1\nEND1\nEND1\n");
        assert_eq!(twice.other_end(1), None);
    }

    #[test]
    fn only_what_a_plain_reader_cannot_read_needs_the_interpreter() {
        for line in
            ["N1G1X1.F5.", "#5204=0", "(#1=#2)", "OTITLE #1=2", "%", "", "M30", "G98", "M9", "G165", "g1x1.", "m9"]
        {
            assert!(!needs_interpreter(line.as_bytes()), "{line}");
        }
        for line in [
            "X#1",
            "x#1",
            "g65p1",
            "m 98 p1",
            "while[1eq1]do1",
            "goto5",
            "#1=#2",
            "IF[1EQ1]GOTO1",
            "M98P1",
            "M99",
            "G65P1",
            "G66.1P1",
            "END1",
            "GOTO 5",
            "#1=1+1",
            "#3000=1",
            "#5201=1.",
            "#5221=0",
            "#11001=5.",
        ] {
            assert!(needs_interpreter(line.as_bytes()), "{line}");
        }
    }

    #[test]
    fn a_cancelled_call_that_never_began_makes_no_macro_program() {
        assert_eq!(first_macro(b"%\nG17G40G67G80\nG0X1.\nM30"), None);
        assert_eq!(first_macro(b"G67\nG66P1\nG67"), Some(2));
        assert_eq!(first_macro(b"G67X#1"), Some(1));
    }

    const PARTS: [&str; 30] = [
        "G", "M", "X", "O", "N", "D", "I", "F", "0", "1", "5", "6", "7", "8", "9", ".", "-", " ", "\t", "/", ":", "#",
        "=", "[", "]", "(", ")", "%", "g", "GOTO",
    ];

    /// Numbers below a bound, the same in each run.
    fn numbers() -> impl FnMut(usize) -> usize {
        let mut seed = 1_u32;
        move |below| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 16) as usize % below
        }
    }

    #[test]
    fn the_first_macro_of_a_text_is_that_of_its_lines() {
        const ENDS: [&str; 6] = ["\n", "\n", "\r\n", "\n\r\r", "\r", "\n\n"];
        let (mut next, mut found) = (numbers(), [0, 0]);
        for _ in 0..100_000 {
            let mut text = Vec::new();
            for _ in 0..next(6) {
                for _ in 0..next(6) {
                    text.extend_from_slice(PARTS[next(PARTS.len())].as_bytes());
                }
                text.extend_from_slice(ENDS[next(ENDS.len())].as_bytes());
            }
            let line = Lines::new(&text).position(|line| is_macro(line.text)).map(|index| index + 1);
            assert_eq!(first_macro(&text), line, "{}", text.escape_ascii());
            found[usize::from(line.is_some_and(|line| line > 1))] += 1;
        }
        assert!(found[1] > 20_000, "{found:?}");
    }

    #[test]
    fn no_line_of_plain_bytes_has_an_effect() {
        let (mut next, mut plain) = (numbers(), 0);
        for _ in 0..500_000 {
            let mut line = Vec::new();
            for _ in 0..next(9) {
                line.extend_from_slice(PARTS[next(PARTS.len())].as_bytes());
            }
            if has_plain_bytes(&line) {
                plain += 1;
                assert!(!has_effect(&line), "{}", line.escape_ascii());
            }
        }
        assert!(plain > 50_000, "{plain}");
        assert!(
            has_plain_bytes(b"N146G2X-2.5752Y11.5549I4.0398J-3.0504") && has_plain_bytes(b"N1 G01 X1. F5.(#1=2)\t")
        );
    }
}
