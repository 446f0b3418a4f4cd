//! Keys and values of a TOML file with their places: the range of numbers, and the key that a complaint is about.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Largest absolute value of a number in a file. All real lengths, feeds, counts and coefficients lie far below;
/// lengths in nanometres still fit into the integers.
pub const NUMBER_MAX: f64 = 1e9;

/// Longest value that a message repeats, in bytes.
const SHOWN_MAX: usize = 60;

/// Visitor: gets a dotted key, the offset of the key if it has one of its own, and the value.
pub type Visit<'v> = dyn FnMut(&str, Option<usize>, &Spanned<DeValue<'_>>) + 'v;

/// Visits every value with its dotted key (`cut.2.stock.offset`, items counted from 1) and the offset of the key if it
/// has one of its own; tables and arrays before their contents. Visits nothing if the text is no TOML.
pub fn walk(text: &str, visit: &mut Visit<'_>) {
    if let Ok(table) = DeTable::parse(text) {
        walk_table("", table.get_ref(), visit);
    }
}

fn walk_table(prefix: &str, table: &DeTable<'_>, visit: &mut Visit<'_>) {
    for (name, value) in table {
        walk_value(&format!("{prefix}{}", name.get_ref()), Some(name.span().start), value, visit);
    }
}

fn walk_value(key: &str, key_offset: Option<usize>, value: &Spanned<DeValue<'_>>, visit: &mut Visit<'_>) {
    visit(key, key_offset, value);
    match value.get_ref() {
        DeValue::Table(table) => walk_table(&format!("{key}."), table, visit),
        DeValue::Array(values) => {
            for (number, value) in (1..).zip(values.iter()) {
                walk_value(&format!("{key}.{number}"), None, value, visit);
            }
        }
        _ => {}
    }
}

/// Parses a file, and rejects the first number that is not finite or larger than [`NUMBER_MAX`].
///
/// # Errors
/// Byte offset and description of the fault.
pub fn parse(text: &str) -> Result<Spanned<DeTable<'_>>, (usize, String)> {
    let file = DeTable::parse(text)
        .map_err(|error| (error.span().map_or(0, |span| span.start), error.message().to_owned()))?;
    match file.get_ref().values().filter_map(impossible).min() {
        None => Ok(file),
        Some(offset) => Err((
            offset,
            format!("a number between -{NUMBER_MAX:e} and {NUMBER_MAX:e} is needed; write one, or remove the key"),
        )),
    }
}

/// Offset of the first number in a value that a file must not have.
fn impossible(value: &Spanned<DeValue<'_>>) -> Option<usize> {
    let number = match value.get_ref() {
        DeValue::Table(table) => return table.values().filter_map(impossible).min(),
        DeValue::Array(values) => return values.iter().filter_map(impossible).min(),
        DeValue::Float(float) => float.as_str().parse().unwrap_or(f64::NAN),
        DeValue::Integer(integer) => {
            i64::from_str_radix(integer.as_str(), integer.radix()).map_or(f64::INFINITY, |number| number as f64)
        }
        _ => return None,
    };
    (!is_possible(number)).then(|| value.span().start)
}

/// Whether a number is finite and not larger than [`NUMBER_MAX`].
pub fn is_possible(number: f64) -> bool {
    (-NUMBER_MAX..=NUMBER_MAX).contains(&number)
}

/// Error message with the key and the value that it is about.
pub fn with_key(text: &str, offset: usize, message: &str) -> String {
    let mut found = None;
    walk(text, &mut |key, key_offset, value| {
        let span = value.span();
        let shown = text.get(span.clone()).filter(|shown| shown.len() <= SHOWN_MAX && !shown.contains('\n'));
        if span.start == offset {
            let is_table = matches!(value.get_ref(), DeValue::Table(_));
            found = Some(match shown.filter(|_| !is_table) {
                Some(shown) => format!("found `{key} = {shown}`"),
                None => format!("in `{key}`"),
            });
        } else if key_offset == Some(offset) {
            found = Some(format!("found `{key}`"));
        }
    });
    // A complaint about the whole file is at its start.
    match found.filter(|_| offset > 0) {
        Some(found) => format!("{message} ({found})"),
        None => message.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_no_file_may_hold_are_found_wherever_they_stand() {
        for (text, refused) in [
            ("a = 1e9\nb = [-1e9, 0x10, 1_000]\nc = \"nan\"", None),
            ("a = 1\n[t]\nb = { c = [0, nan] }\nd = inf", Some("nan] }")),
            ("[[t]]\na = -inf", Some("-inf")),
            ("a = 1e300", Some("1e300")),
            ("a = 99999999999", Some("99999999999")),
        ] {
            let found = parse(text).err().map(|(offset, _)| offset);
            assert_eq!(found, refused.map(|refused| text.find(refused).expect("it is in the text")), "{text}");
        }
    }

    #[test]
    fn a_complaint_names_the_key_and_what_stands_there() {
        let text = "a = 1\n[[cut]]\nn = [7, 5]\nstock = { offset = 3, ofset = 4 }\n";
        let complaint = |part: &str| with_key(text, text.find(part).expect("it is in the text"), "no");
        assert_eq!(complaint("[7"), "no (found `cut.1.n = [7, 5]`)");
        assert_eq!(complaint("5]"), "no (found `cut.1.n.2 = 5`)");
        assert_eq!(complaint("ofset"), "no (found `cut.1.stock.ofset`)");
        assert_eq!(complaint("{"), "no (in `cut.1.stock`)");
        assert_eq!(with_key(text, 0, "missing field `program`"), "missing field `program`");
    }
}
