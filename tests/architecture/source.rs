//! Rust sources as the checks see them: code without comments and without what strings say.

use std::fs;
use std::path::{Path, PathBuf};

/// One source file.
#[derive(Clone, Debug)]
pub struct Source {
    /// From the root of the workspace, with `/`.
    pub path: String,
    /// The text, line for line: comments blank, characters of strings replaced by quotes.
    pub code: String,
}

impl Source {
    /// A file at `path` that reads `text`.
    pub fn new(path: &str, text: &str) -> Self {
        Source { path: path.to_owned(), code: blank(text) }
    }

    /// The code without the tests at its foot; nothing of a `tests.rs`. That nothing follows the tests is clippy's
    /// `items_after_test_module`, that `tests.rs` is compiled for tests only is checked with the order of the modules.
    pub fn production(&self) -> &str {
        if self.path.ends_with("/tests.rs") {
            return "";
        }
        let mut at = 0;
        for line in self.code.split_inclusive('\n') {
            let after = self.code[at..].strip_prefix(line).map_or("", str::trim_start);
            if line.trim() == "#[cfg(test)]" && after.starts_with("mod tests") {
                break;
            }
            at += line.len();
        }
        &self.code[..at]
    }
}

/// The root of the workspace.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A text file of the workspace.
pub fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Folders of sources of the crates that run on the chip too.
pub const CHIP: [&str; 11] = [
    "shared/units/src",
    "shared/nc/src",
    "shared/nc-macro/src",
    "shared/compensation/src",
    "shared/kinematics/src",
    "shared/model/src",
    "shared/link/src",
    "firmware/law/src",
    "firmware/src",
    "firmware/board-app/src",
    "firmware/c/src",
];
/// Folders of sources of the simulator.
pub const SIMULATOR: [&str; 7] = [
    "hil-sim/control/src",
    "hil-sim/dexel/src",
    "hil-sim/modal/src",
    "hil-sim/fe/src",
    "hil-sim/milling/src",
    "hil-sim/blades/src",
    "hil-sim/src",
];
/// Folders of sources of the host.
pub const HOST: [&str; 9] = [
    "host/src",
    "host/line-errors/src",
    "host/port/src",
    "host/program/src",
    "host/adapt/src",
    "host/dnc/src",
    "host/plan/src",
    "host/python/src",
    "host/wasm/src",
];

/// All Rust files below a folder of the workspace, sorted. There is at least one.
pub fn rust_files(folder: &str) -> Vec<Source> {
    let mut sources = Vec::new();
    collect(folder, &mut sources);
    assert!(!sources.is_empty(), "no Rust files in {folder}");
    sources
}

/// The files of several folders.
pub fn rust_files_of(folders: &[&str]) -> Vec<Source> {
    folders.iter().flat_map(|folder| rust_files(folder)).collect()
}

/// Names in a folder of the workspace, sorted; folders end with `/`.
pub fn names(folder: &str) -> Vec<String> {
    let entries = fs::read_dir(root().join(folder)).unwrap_or_else(|error| panic!("{folder}: {error}"));
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap_or_else(|error| panic!("{folder}: {error}")))
        .map(|entry| entry.file_name().to_string_lossy().into_owned() + if entry.path().is_dir() { "/" } else { "" })
        .collect();
    names.sort();
    names
}

fn collect(folder: &str, sources: &mut Vec<Source>) {
    for name in names(folder) {
        let path = format!("{folder}/{name}");
        if let Some(inner) = path.strip_suffix('/') {
            collect(inner, sources);
        } else if path.ends_with(".rs") {
            sources.push(Source::new(&path, &read(&path)));
        }
    }
}

/// Words, numbers, `::` and single signs of blanked code.
pub fn tokens(code: &str) -> Vec<&str> {
    let mut tokens: Vec<&str> = Vec::new();
    let mut rest = code.trim_start();
    while let Some(first) = rest.chars().next() {
        let length = match first {
            // After a point a digit is the index of a tuple, after two the end of a range.
            '0'..='9' if tokens.last() == Some(&".") && !tokens.ends_with(&[".", "."]) => word_length(rest),
            '0'..='9' => number_length(rest),
            _ if is_word(first) => word_length(rest),
            ':' if rest.starts_with("::") => 2,
            _ => first.len_utf8(),
        };
        tokens.push(&rest[..length]);
        rest = rest[length..].trim_start();
    }
    tokens
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn word_length(text: &str) -> usize {
    text.find(|c: char| !is_word(c)).unwrap_or(text.len())
}

/// Length of `25.4`, `1_000`, `6e-4f32`; of `0..9` and `0.max(x)` only the first number.
fn number_length(text: &str) -> usize {
    let mut length = word_length(text);
    let fraction = text[length..].strip_prefix('.');
    if let Some(fraction) =
        fraction.filter(|rest| !rest.starts_with(|c: char| c == '.' || c == '_' || c.is_alphabetic()))
    {
        length += 1 + word_length(fraction);
    }
    let has_open_exponent = text[..length].ends_with(['e', 'E']) && !text.starts_with("0x");
    if has_open_exponent && text[length..].starts_with(['-', '+']) {
        length += 1 + word_length(&text[length + 1..]);
    }
    length
}

/// Code with its comments blank and the characters in its strings replaced by quotes.
fn blank(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let after_word = code.ends_with(is_word);
        let (length, filler) = if rest.starts_with("//") {
            (rest.find('\n').unwrap_or(rest.len()), Some(' '))
        } else if rest.starts_with("/*") {
            (comment_length(rest), Some(' '))
        } else if let Some(length) = raw_string_length(rest).filter(|_| !after_word) {
            (length, Some('"'))
        } else if let Some(length) = quoted_length(rest) {
            (length, Some('"'))
        } else {
            (first.len_utf8(), None)
        };
        let (taken, left) = rest.split_at(length);
        code.extend(taken.chars().map(|c| filler.filter(|_| !c.is_whitespace()).unwrap_or(c)));
        rest = left;
    }
    code
}

/// Length of a block comment, which may hold others.
fn comment_length(text: &str) -> usize {
    let (mut depth, mut at) = (0, 0);
    loop {
        let step = &text.as_bytes()[at..];
        match step {
            [b'/', b'*', ..] => (depth, at) = (depth + 1, at + 2),
            [b'*', b'/', ..] => (depth, at) = (depth - 1, at + 2),
            [] => return at,
            _ => at += 1,
        }
        if depth == 0 {
            return at;
        }
    }
}

/// Length of `r"..."`, `br#"..."#`; `None` where none begins.
fn raw_string_length(text: &str) -> Option<usize> {
    let fenced = text.trim_start_matches(['b', 'c']).strip_prefix('r')?;
    let hashes = fenced.len() - fenced.trim_start_matches('#').len();
    let inner = fenced[hashes..].strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(hashes));
    let closed = inner.find(&end).map_or(inner.len(), |at| at + end.len());
    Some(text.len() - inner.len() + closed)
}

/// Length of `"..."` or `'c'`; `None` where neither begins, as at a lifetime.
fn quoted_length(text: &str) -> Option<usize> {
    let quote = text.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    let mut inner = text[1..].chars();
    let second = inner.next()?;
    if quote == '\'' && second != '\\' && inner.next() != Some('\'') {
        return None;
    }
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            _ if c == quote => return Some(at + 1),
            _ => {}
        }
    }
    Some(text.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_strings_are_no_code() {
        let text = "a /* x /* y */ z */ b // c\n\"d \\\" // e\" 'f' '\\'' r#\"g\"h\"# &'i j br\"k\" \"\u{e4}\" l";
        let code = blank(text);
        let words: Vec<&str> = tokens(&code).into_iter().filter(|token| token.starts_with(is_word)).collect();
        assert_eq!(words, ["a", "b", "i", "j", "l"]);
        assert_eq!(code.lines().count(), text.lines().count());
    }

    #[test]
    fn numbers_are_whole_tokens() {
        let numbers = "x.0.1 25.4 1_000.0f32 0..60 6e-4 5. 1.max(2) [7..8.5]";
        let found: Vec<&str> =
            tokens(numbers).into_iter().filter(|token| token.starts_with(|c: char| c.is_ascii_digit())).collect();
        assert_eq!(found, ["0", "1", "25.4", "1_000.0f32", "0", "60", "6e-4", "5.", "1", "2", "7", "8.5"]);
    }

    #[test]
    fn production_code_ends_where_the_tests_begin() {
        let text = "a\n#[cfg(test)]\nuse b;\n#[cfg(test)]\nmod tests {\n c\n}\n";
        assert_eq!(Source::new("x/y.rs", text).production(), "a\n#[cfg(test)]\nuse b;\n");
        assert_eq!(Source::new("x/tests.rs", text).production(), "");
    }
}
