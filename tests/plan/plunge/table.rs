//! Tables of an independent program: comma-separated, with a remark above the names of the columns.

use std::collections::HashMap;

/// Row of a table by the names of its columns.
pub struct Row<'t> {
    words: HashMap<&'t str, &'t str>,
}

impl<'t> Row<'t> {
    pub fn word(&self, name: &str) -> &'t str {
        self.words[name]
    }

    pub fn number(&self, name: &str) -> f64 {
        self.words[name].parse().unwrap_or_else(|_| panic!("{name}: {}", self.words[name]))
    }

    pub fn numbers<const N: usize>(&self, names: [&str; N]) -> [f64; N] {
        names.map(|name| self.number(name))
    }
}

pub fn rows(text: &str) -> Vec<Row<'_>> {
    let mut lines = text.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    lines.map(|line| Row { words: names.iter().copied().zip(line.split(',')).collect() }).collect()
}

/// Largest difference of each kind of figure.
#[derive(Default)]
pub struct Worst {
    kinds: Vec<(&'static str, f64, usize)>,
}

impl Worst {
    /// Difference relative to the expected value, or to 1 if that is smaller.
    pub fn relative(&mut self, kind: &'static str, found: f64, expected: f64) {
        self.absolute(kind, (found - expected) / expected.abs().max(1.0), 0.0);
    }

    pub fn absolute(&mut self, kind: &'static str, found: f64, expected: f64) {
        let off = (found - expected).abs();
        let off = if off.is_nan() { f64::INFINITY } else { off };
        match self.kinds.iter_mut().find(|known| known.0 == kind) {
            Some(known) => *known = (kind, known.1.max(off), known.2 + 1),
            None => self.kinds.push((kind, off, 1)),
        }
    }

    /// Prints the differences and holds each to its limit.
    pub fn within(&self, file: &str, limits: &[(&str, f64)]) {
        for (kind, off, count) in &self.kinds {
            println!("{file}: {kind}: {count} values, off by {off:.2e} at most");
        }
        for (kind, off, _) in &self.kinds {
            let limit = limits.iter().find(|limit| limit.0 == *kind).unwrap_or_else(|| panic!("no limit for {kind}")).1;
            assert!(*off <= limit, "{file}: {kind}: {off:.3e} above {limit:.1e}");
        }
        assert_eq!(self.kinds.len(), limits.len(), "{file}: a kind of figure was not compared");
    }
}
