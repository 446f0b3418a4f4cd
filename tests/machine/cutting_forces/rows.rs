//! Tables of reference values: comments, a line of names, rows.

use std::collections::HashMap;

pub struct Row<'a>(HashMap<&'a str, &'a str>);

impl<'a> Row<'a> {
    #[track_caller]
    pub fn text(&self, name: &str) -> &'a str {
        self.0.get(name).unwrap_or_else(|| panic!("no column {name}"))
    }

    #[track_caller]
    pub fn number(&self, name: &str) -> f64 {
        self.text(name).parse().unwrap_or_else(|_| panic!("{name}: no number"))
    }
}

/// The rows of a table without quoted commas.
pub fn rows(table: &str) -> Vec<Row<'_>> {
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = lines.next().expect("a line of names").split(',').collect();
    lines.map(|line| Row(names.iter().copied().zip(line.split(',')).collect())).collect()
}
