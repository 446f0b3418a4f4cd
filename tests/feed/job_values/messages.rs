//! Tables and keys as docs and messages name them.

use std::path::Path;

use arcfeed_tests::{root, texts_below};

use crate::job_values::files::refusal;

/// Keys of each table, as docs/job.md lists them.
fn documented() -> Vec<(String, Vec<String>)> {
    let page = std::fs::read_to_string(root().join("docs/job.md")).expect("the page");
    let quoted = |cell: &str| cell.split('`').skip(1).step_by(2).map(str::to_owned).collect::<Vec<String>>();
    let mut tables: Vec<(String, Vec<String>)> = Vec::new();
    for row in page.lines().filter(|row| row.starts_with("| ")) {
        let cells: Vec<&str> = row.split('|').collect();
        match quoted(cells[1]).first() {
            Some(table) => tables.push((table.trim_matches(['[', ']']).to_owned(), quoted(cells[2]))),
            None => {
                if let Some((_, keys)) = tables.last_mut() {
                    keys.extend(quoted(cells[2]));
                }
            }
        }
    }
    tables
}

#[test]
fn documented_keys_are_in_the_tables_that_docs_and_messages_name() {
    let tables = documented();
    let has =
        |table: &str, key: &str| tables.iter().any(|(name, keys)| name == table && keys.iter().any(|own| own == key));
    let is_key = |word: &str| tables.iter().any(|(name, _)| has(name, word));
    assert!(has("dnc", "xoff_timeout") && has("serial", "write_timeout") && tables.len() > 12, "{tables:?}");
    for (table, keys) in &tables {
        for key in keys {
            let text = if table == "cut" { format!("[[cut]]\n{key} = []") } else { format!("[{table}]\n{key} = []") };
            let complaint = refusal(Path::new("job.toml"), &text).expect("half a job");
            assert!(!complaint.contains("unknown field"), "docs/job.md: [{table}] {key}: {complaint}");
        }
    }
    let mut checked = 0;
    for (path, text) in ["host/src", "host/adapt/src"].into_iter().flat_map(texts_below) {
        // A message that names one table speaks of its keys.
        for line in text.lines().filter(|line| !line.trim_start().starts_with("//") && !line.contains("\\n")) {
            let mut named = tables.iter().filter(|(table, _)| line.contains(&format!("[{table}]")));
            let (Some((table, _)), None) = (named.next(), named.next()) else { continue };
            let words = line.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
            for word in words.filter(|word| word.contains('_') && is_key(word)) {
                assert!(has(table, word), "{}: {word} is not in [{table}]: {line}", path.display());
                checked += 1;
            }
        }
    }
    assert!(checked >= 4, "{checked}");
}
