//! Reader of the data.

use std::collections::HashMap;

/// Row of a file, by column.
pub struct Row(HashMap<String, String>);

/// Rows of a file.
pub fn rows(text: &str) -> Vec<Row> {
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let row =
        |line: &str| Row(names.iter().map(|name| (*name).to_owned()).zip(line.split(',').map(str::to_owned)).collect());
    lines.map(row).collect()
}

impl Row {
    pub fn text(&self, column: &str) -> &str {
        self.0.get(column).unwrap_or_else(|| panic!("no column {column}"))
    }

    pub fn number(&self, column: &str) -> f64 {
        self.text(column).parse().unwrap_or_else(|_| panic!("{column}: no number"))
    }

    /// Numbers between blanks, in groups between semicolons.
    pub fn groups(&self, column: &str) -> Vec<Vec<f64>> {
        let numbers = |group: &str| group.split_whitespace().map(|number| number.parse().expect("a number")).collect();
        self.text(column).split(';').map(numbers).filter(|group: &Vec<f64>| !group.is_empty()).collect()
    }
}
