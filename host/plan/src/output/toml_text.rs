//! Numbers and strings of TOML.

/// Number to a millionth, without trailing zeros.
pub(super) fn number(value: f64) -> String {
    let text = format!("{value:.6}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".into() } else { short.into() }
}

/// Basic string of TOML.
pub(super) fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => quoted += &format!("\\u{:04X}", u32::from(c)),
            c => quoted.push(c),
        }
    }
    quoted + "\""
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_names_are_toml() {
        assert_eq!([128.576_07, 90.0, -0.000_000_1, -691.5].map(number), ["128.57607", "90", "0", "-691.5"]);
        assert_eq!(quoted("a \"b\"\\c\n"), "\"a \\\"b\\\"\\\\c\\u000A\"");
    }
}
