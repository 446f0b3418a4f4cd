//! `docs/protocol.md` and `docs/board-safety.md` against the code.

use arcfeed_link::message::schema::{Entry, FieldType, Optional};
use arcfeed_link::message::{SCHEMA, SCHEMA_HASH};
use arcfeed_tests::root;

fn section(file: &str, heading: &str) -> String {
    let text = std::fs::read_to_string(root().join("docs").join(file)).expect("the document");
    let marks = ["## ", "### "].map(|mark| format!("\n{mark}{heading}\n"));
    let found = marks.iter().find_map(|mark| text.split_once(mark.as_str()));
    let section = found.unwrap_or_else(|| panic!("{file} has no {heading}")).1;
    section.split("\n## ").next().expect("a part").split("\n### ").next().expect("a part").to_owned()
}

/// The cells of the table under a heading, without its head; code marks are left out.
pub fn rows(file: &str, heading: &str) -> Vec<Vec<String>> {
    let text = section(file, heading);
    let rows = text.lines().filter(|line| line.starts_with('|')).skip(2);
    let cells =
        |line: &str| line.trim_matches('|').split('|').map(|cell| cell.replace('`', "").trim().to_owned()).collect();
    let rows: Vec<Vec<String>> = rows.map(cells).collect();
    assert!(!rows.is_empty(), "no table under {heading}");
    rows
}

/// Notation of a field's type in the document; a code by its name alone.
fn spelled(field: &FieldType) -> String {
    let name = field.name.split(' ').next().expect("a name");
    match (field.count, field.optional) {
        (1, Optional::Never) => name.to_owned(),
        (1, _) => format!("{name}?"),
        (count, Optional::Never) => format!("[{name}; {count}]"),
        (count, Optional::Whole) => format!("[{name}; {count}]?"),
        (count, Optional::Each) => format!("[{name}?; {count}]"),
    }
}

fn message_rows(entry: &Entry) -> Vec<String> {
    let head =
        format!("| {:02X} | **{}** | {} | {} |", entry.kind, entry.name, entry.class.label(), entry.meaning.trim());
    let field = |field: &arcfeed_link::message::schema::FieldEntry| {
        format!("| | `{}` | `{}` | {} |", field.name, spelled(&field.field_type), field.meaning.trim())
    };
    [head].into_iter().chain(entry.fields.iter().map(field)).collect()
}

/// Codes in the order in which messages name them: name, and each byte with its meaning.
fn code_rows() -> Vec<String> {
    let mut rows: Vec<String> = Vec::new();
    for field in SCHEMA.iter().flat_map(|entry| entry.fields) {
        let Some((name, values)) = field.field_type.name.split_once(' ') else { continue };
        let words: Vec<&str> = values.split(' ').collect();
        let values: Vec<String> = words.chunks(2).map(|value| format!("{} {}", value[0], value[1])).collect();
        let row = format!("| `{name}` | {} |", values.join(", "));
        if !rows.contains(&row) {
            rows.push(row);
        }
    }
    rows
}

fn assert_rows(heading: &str, expected: &[String]) {
    let text = section("protocol.md", heading);
    let found: Vec<&str> = text.lines().filter(|line| line.starts_with('|')).skip(2).collect();
    let expected: Vec<&str> = expected.iter().map(String::as_str).collect();
    if found != expected {
        println!("\n{}", expected.join("\n"));
    }
    assert!(found == expected, "docs/protocol.md, {heading}: the rows above are those of the code");
}

#[test]
fn the_document_lists_every_message_with_every_field() {
    assert_rows("Messages", &SCHEMA.iter().flat_map(message_rows).collect::<Vec<_>>());
}

#[test]
fn the_document_lists_every_code() {
    assert_rows("Codes", &code_rows());
}

#[test]
fn the_document_has_the_hash() {
    let hash = format!("`{SCHEMA_HASH:08X}`");
    assert!(section("protocol.md", "Messages").contains(&hash), "the hash of these messages is {hash}");
}
