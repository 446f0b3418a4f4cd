//! Words that say nothing to an engineer of the field, in names, comments, messages and documents.

use arcfeed_tests::{root, texts_below};

use crate::complaints::assert_none;

/// Words of a private language that the project has left behind.
const BANNED: [&str; 16] = [
    "bite", "bites", "clerk", "decider", "desk", "desks", "fate", "giving", "knobs", "patience", "rig", "shelves",
    "spoilt", "told", "wish", "wishes",
];
/// Folders and files that people read.
const FOLDERS: [&str; 7] = ["docs", "examples", "firmware", "hil-sim", "host", "shared", "tests"];
const FILES: [&str; 4] = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "SECURITY.md"];
const ENDINGS: [&str; 4] = ["rs", "md", "toml", "py"];
const THIS_FILE: &str = "tests/architecture/words.rs";

/// The words of a text in lower case: `BoardIo` and `board_io` are two each.
fn words(text: &str) -> Vec<String> {
    let (mut words, mut word, mut last) = (Vec::new(), String::new(), ' ');
    for letter in text.chars() {
        let begins = letter.is_uppercase() && last.is_lowercase();
        if (begins || !letter.is_alphabetic()) && !word.is_empty() {
            words.push(std::mem::take(&mut word));
        }
        if letter.is_alphabetic() {
            word.extend(letter.to_lowercase());
        }
        last = letter;
    }
    words.extend((!word.is_empty()).then_some(word));
    words
}

#[test]
fn no_banned_word_is_used() {
    let below = FOLDERS.iter().flat_map(|folder| texts_below(folder));
    let files = FILES.iter().map(|file| (root().join(file), std::fs::read_to_string(root().join(file)).expect("text")));
    let mut seen = 0;
    let mut found = Vec::new();
    for (path, text) in below.chain(files) {
        let is_read = path.extension().is_some_and(|ending| ENDINGS.iter().any(|known| ending == *known));
        if !is_read || path.ends_with(THIS_FILE) {
            continue;
        }
        seen += 1;
        let in_lower_case = text.to_lowercase();
        if !BANNED.iter().any(|word| in_lower_case.contains(word)) {
            continue;
        }
        for (line, text) in (1..).zip(text.lines()) {
            let banned = words(text).into_iter().filter(|word| BANNED.contains(&word.as_str()));
            found.extend(
                banned.map(|word| format!("{}:{line}: `{word}`: docs/glossary.md has the terms", path.display())),
            );
        }
    }
    assert!(seen > 700, "{seen} files are not all there are");
    assert_none(&found);
}

#[test]
fn names_are_taken_apart() {
    assert_eq!(words("BoardIo::board_io2, it's 5mm"), ["board", "io", "board", "io", "it", "s", "mm"]);
}
