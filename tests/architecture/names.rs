//! Names of public types, and first words of comments.

use std::collections::BTreeMap;

use crate::complaints::assert_none;
use crate::source::{CHIP, HOST, SIMULATOR, Source, read, rust_files, rust_files_of, tokens};

/// Types with two definitions, of which a feature or the operating system selects one.
const ALTERNATIVES: [&str; 7] = ["LivePage", "NativePort", "Pattern", "PendingFile", "Pty", "Runner", "Screen"];

/// First words of comments that do not say what an item is.
const FIRST_WORDS: [&str; 5] = ["What", "How", "Where", "Its", "Of"];

/// Names of the public types of a file.
fn public_types(source: &Source) -> Vec<&str> {
    let kinds = ["struct", "enum", "trait", "type", "union"];
    let tokens = tokens(source.production());
    let is_name = |token: &str| token.starts_with(char::is_alphabetic);
    let is_type = |w: &&[&str]| w[0] == "pub" && kinds.contains(&w[1]) && is_name(w[2]);
    tokens.windows(3).filter(is_type).map(|w| w[2]).collect()
}

/// Names that several files of a crate give to a public type.
fn doubles(sources: &[Source]) -> Vec<String> {
    let mut files: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for source in sources {
        for name in public_types(source) {
            files.entry(name).or_default().push(&source.path);
        }
    }
    let doubles = files.into_iter().filter(|(name, files)| files.len() > 1 && !ALTERNATIVES.contains(name));
    doubles.map(|(name, files)| format!("{name}: {}", files.join(", "))).collect()
}

/// Doc comments of a text whose first word says nothing, with their lines.
fn vague(text: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    let mut is_first = true;
    for (at, line) in (1..).zip(text.lines()) {
        let comment = line.trim_start().strip_prefix("///").or_else(|| line.trim_start().strip_prefix("//!"));
        let words = comment.unwrap_or_default();
        let first = words.split_whitespace().next().unwrap_or_default();
        if is_first && FIRST_WORDS.contains(&first) {
            found.push((at, line.trim()));
        }
        is_first = words.trim().is_empty();
    }
    found
}

#[test]
fn no_two_public_types_of_a_crate_share_a_name() {
    let folders = [&CHIP[..], &SIMULATOR, &HOST].concat();
    let found: Vec<String> = folders.iter().flat_map(|folder| doubles(&rust_files(folder))).collect();
    assert_none(&found);
    let seen: usize = rust_files_of(&folders).iter().map(|source| public_types(source).len()).sum();
    assert!(seen > 900, "{seen} public types are not all there are");
}

#[test]
fn doc_comments_begin_with_what_the_item_is_or_does() {
    let sources = rust_files_of(&[&CHIP[..], &SIMULATOR, &HOST].concat());
    let mut found = Vec::new();
    for source in &sources {
        let text = read(&source.path);
        found.extend(vague(&text).into_iter().map(|(line, comment)| format!("{}:{line}: {comment}", source.path)));
    }
    assert_none(&found);
}

#[test]
fn a_double_name_and_a_vague_comment_are_found() {
    let sources = [Source::new("a.rs", "pub struct Line(u8);"), Source::new("b.rs", "pub enum Line {}\nstruct X;")];
    assert_eq!(doubles(&sources), ["Line: a.rs, b.rs"]);
    let text = "/// What it leaves.\n/// Of these the first.\nfn f() {}\n/// Remaining height.\n///\n/// Its unit is mm.\nfn g() {}";
    assert_eq!(vague(text), [(1, "/// What it leaves."), (6, "/// Its unit is mm.")]);
}
