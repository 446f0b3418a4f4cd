//! NC text of a Fanuc as LinuxCNC reads it: the same moves, or a refusal with a remedy.
//!
//! The text begins with the state of a Fanuc at power-on and with a tolerance of the path. What LinuxCNC executes
//! otherwise is spelled so that it executes the same; what it cannot execute is refused. Everything else keeps its bytes.

use arcfeed_nc::block::LineKind;
use arcfeed_nc::settings::{ArcCenters, Settings};
use arcfeed_nc::word::{Token, Words};
use arcfeed_units::LengthUnit;

use super::block_editor::{BlockEditor, LinuxCncState, RefusedWord, path_control};
use super::codes::FeedSource;
use super::comment::comment;
use crate::program::{Diagnostic, ProgramLine, Severity, Source};

/// Most bytes of a line that LinuxCNC reads.
const LINE_MAX: usize = 254;

/// Translated program for LinuxCNC.
#[derive(Clone, Debug, Default)]
pub struct Translation {
    /// The text.
    pub text: Vec<u8>,
    /// For each line of the program, the line of the translated text at which its translation begins, counted from 1.
    pub first_lines: Vec<usize>,
}

/// Translates a program without errors, macro statements and calls.
///
/// # Errors
/// Every line that LinuxCNC cannot execute, with the remedy.
pub fn translate(source: &Source, feed: FeedSource) -> Result<Translation, Vec<Diagnostic>> {
    let (mut translation, mut refusals) = (Translation::default(), Vec::new());
    let (mut lines, mut count, mut theirs, mut has_state, mut has_ended) =
        (source.lines(), 1, LinuxCncState::default(), false, false);
    let mut number = 0;
    while lines.read_line() {
        number += 1;
        let (line, modal) = (lines.line(), *lines.control().modal());
        let kind = line.meaning.as_ref().map(|meaning| meaning.parsed.line);
        let is_mark = kind == Some(LineKind::ProgramMark);
        if has_ended {
            translation.first_lines.push(count);
            continue;
        }
        let mut texts: Vec<Vec<u8>> = Vec::new();
        if !has_state && !is_mark && !line.text.is_empty() {
            texts.push(state(&source.settings).into_bytes());
            texts.extend((feed == FeedSource::Component).then(|| b"M52 P1".to_vec()));
            has_state = true;
        }
        translation.first_lines.push(count + texts.len());
        match (kind, &line.meaning) {
            (Some(LineKind::ProgramMark), _) => {
                has_ended = has_state;
                texts.push(b"%".to_vec());
            }
            (Some(LineKind::Title), _) => texts.push(comment(&line.text)),
            (_, Some(meaning)) => {
                let editor = BlockEditor::new(meaning, &modal, source.settings.decimals, &mut theirs);
                match editor.and_then(|editor| editor.check(feed).and_then(|()| block(line, &editor))) {
                    Ok(blocks) => texts.extend(blocks),
                    Err(refused) => refusals.push(refusal(number, line, refused)),
                }
            }
            (_, None) => {}
        }
        let ending: &[u8] = if line.ending.is_empty() { b"\n" } else { &line.ending };
        for text in texts {
            count += 1;
            translation.text.extend(text);
            translation.text.extend_from_slice(ending);
        }
    }
    if refusals.is_empty() { Ok(translation) } else { Err(refusals) }
}

/// State of a Fanuc at power-on.
fn state(settings: &Settings) -> String {
    let unit = if settings.unit == LengthUnit::Mm { "G21" } else { "G20" };
    let centers = if settings.arc_centers == ArcCenters::Absolute { "G90.1" } else { "G91.1" };
    format!("{unit} G17 G40 G49 G54 G80 G90 {centers} G94 G98 {}", path_control(settings.unit))
}

/// Text of a block, and that of the words that follow in a block of their own.
fn block(line: &ProgramLine, editor: &BlockEditor<'_>) -> Result<Vec<Vec<u8>>, RefusedWord> {
    let (mut text, mut last, mut has_word, mut is_deleted) = (Vec::new(), 0, false, false);
    let mut insert = Some(editor.insert.as_str());
    for piece in Words::tolerant(&line.text, true).flatten() {
        text.extend_from_slice(line.text.get(last..piece.start).unwrap_or_default());
        last = piece.end;
        let raw = line.text.get(piece.start..piece.end).unwrap_or_default();
        let column = (piece.start + 1) as u16;
        match piece.token {
            Token::Word(word) if word.letter == b'O' => text.extend(comment(raw)),
            Token::Word(word) => {
                has_word = true;
                if word.letter != b'N' {
                    text.extend(insert.take().unwrap_or_default().bytes());
                }
                match editor.edits.get(&word.column) {
                    Some(edit) => text.extend(edit.bytes()),
                    None => text.extend_from_slice(raw),
                }
            }
            Token::BlockDelete(1) if !has_word => {
                is_deleted = true;
                text.push(b'/');
            }
            Token::BlockDelete(1) => {
                return Err((column, "LinuxCNC has / at the beginning of a line only; write it there"));
            }
            Token::BlockDelete(_) => {
                return Err((column, "LinuxCNC has one block-delete switch; write / without a number"));
            }
            Token::Comment { text: words, .. } => text.extend(comment(words)),
            Token::Assignment { .. } => return Err((column, "a macro statement; adapt the program with --expand")),
            Token::ProgramMark => {}
        }
    }
    // A `;` behind the code begins a comment there, too.
    text.extend_from_slice(line.text.get(last..).unwrap_or_default());
    if text.len() > LINE_MAX {
        return Err((1, "LinuxCNC reads 254 characters of a line; write it as several blocks"));
    }
    let mut texts = vec![text];
    let slash = if is_deleted { "/" } else { "" };
    texts.extend(editor.behind.iter().map(|behind| format!("{slash}{behind}").into_bytes()));
    Ok(texts)
}

fn refusal(number: usize, line: &ProgramLine, (column, remedy): RefusedWord) -> Diagnostic {
    let start = usize::from(column).saturating_sub(1);
    let rest = line.text.get(start..).unwrap_or_default();
    let is_end = |(at, byte): (usize, &u8)| at > 0 && !byte.is_ascii_digit() && !b".+-".contains(byte);
    let len = rest.iter().enumerate().position(is_end).unwrap_or(rest.len()).max(1);
    Diagnostic {
        severity: Severity::Error,
        line: number,
        column: usize::from(column),
        end_column: usize::from(column) + len,
        alarm: None,
        message: format!("not for LinuxCNC: {remedy}"),
        found: rest.get(..len).unwrap_or_default().escape_ascii().to_string(),
    }
}
