//! Counts with their noun, for messages.

/// A count and its noun: `1 block`, `2 blocks`; the plural of the noun ends in `s`.
pub fn counted(count: usize, noun: &str) -> String {
    let ending = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{ending}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_one_is_no_plural() {
        assert_eq!([0, 1, 2].map(|count| counted(count, "arc")), ["0 arcs", "1 arc", "2 arcs"]);
    }
}
