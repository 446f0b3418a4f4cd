//! Places in a text file, as line and column.

/// Line and column of a byte offset, counted from 1.
pub fn place(text: &str, offset: usize) -> [usize; 2] {
    let before = text.get(..offset).unwrap_or(text);
    let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
    [before.matches('\n').count() + 1, column]
}
