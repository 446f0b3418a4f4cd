//! `docs/safety.md` as the tests read it.

use arcfeed_tests::root;

/// The cells of the table under a heading, without its head; code marks are left out.
pub fn table(heading: &str) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(root().join("docs/safety.md")).expect("docs/safety.md");
    let section = text.split_once(&format!("\n## {heading}\n")).expect("the heading").1;
    let section = section.split("\n## ").next().expect("a part");
    let rows = section.lines().filter(|line| line.starts_with('|')).skip(2);
    let cells =
        |line: &str| line.trim_matches('|').split('|').map(|cell| cell.replace('`', "").trim().to_owned()).collect();
    let rows: Vec<Vec<String>> = rows.map(cells).collect();
    assert!(!rows.is_empty(), "no table under {heading}");
    rows
}

#[test]
fn every_arrow_of_the_document_has_its_test_and_every_test_its_arrow() {
    let named: Vec<String> = table("Arrows").into_iter().map(|row| format!("{}_to_{}", row[0], row[1])).collect();
    let source = include_str!("arrows.rs");
    let tests: Vec<&str> =
        source.split("#[test]\nfn ").skip(1).map(|rest| rest.split('(').next().expect("a name")).collect();
    assert_eq!(tests, named);
}
