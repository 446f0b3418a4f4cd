//! Every feed law says where it comes from, and the page it names is there.

use crate::documents::Document;
use crate::source::{names, read};

const FOLDER: &str = "firmware/law/src";

/// The book of the laws.
const BOOK: &str = "docs/laws.md";

/// The anchor in the line `//! Source: ... docs/laws.md#anchor ...` of a file.
fn source_anchor(text: &str) -> Option<&str> {
    let line = text.lines().find(|line| line.starts_with("//! Source:"))?;
    let (_, anchor) = line.split_once(BOOK)?.1.split_once('#').filter(|(between, _)| between.is_empty())?;
    anchor.split(|c: char| !c.is_alphanumeric() && c != '-' && c != '_').next().filter(|anchor| !anchor.is_empty())
}

#[test]
fn every_law_names_its_source_and_the_page_exists() {
    let laws: Vec<String> =
        names(FOLDER).into_iter().filter(|name| name.ends_with(".rs") && name != "lib.rs").collect();
    assert!(!laws.is_empty(), "no laws in {FOLDER}");
    let anchors = Document::read(&read(BOOK)).headings;
    for law in laws {
        let text = read(&format!("{FOLDER}/{law}"));
        let anchor = source_anchor(&text).unwrap_or_else(|| panic!("{law}: no line `//! Source: ... {BOOK}#anchor`"));
        assert!(anchors.contains(anchor), "{law}: no heading for #{anchor} in {BOOK}, only {anchors:?}");
    }
}

#[test]
fn a_law_without_a_page_is_found() {
    assert_eq!(source_anchor("//! Source: a book; docs/laws.md#full-slot, eq. 3.\n"), Some("full-slot"));
    assert_eq!(source_anchor("//! Source: a book; docs/laws.md.\n// docs/laws.md#x\n"), None);
    assert_eq!(source_anchor("//! Says docs/laws.md#x.\n"), None);
}
