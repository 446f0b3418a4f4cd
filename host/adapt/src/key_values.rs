//! Values given on the command line that replace those of a job file, or of its machine's file, by keys with dots.

use std::fmt;
use std::str::FromStr;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::toml_values::walk;

/// First part of the keys of a machine's file.
const MACHINE_FILE: &str = "machine-file.";

/// Key with a value: `KEY=VALUE`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyValue {
    /// Dotted key; items of arrays are counted from 1, as in messages.
    key: String,
    /// Value in TOML.
    value: String,
}

impl KeyValue {
    /// Key with dots and its value in TOML, on one line.
    pub const fn new(key: String, value: String) -> Self {
        KeyValue { key, value }
    }
}

impl FromStr for KeyValue {
    type Err = &'static str;

    /// A value that is no TOML is a text.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (key, value) = text.split_once('=').ok_or("write KEY=VALUE, for example spindle.rev_per_min=1200")?;
        let (key, value) = (key.trim(), value.trim());
        if key.split('.').any(|part| part.is_empty() || part.contains(|letter: char| letter.is_whitespace())) {
            return Err("a key is words with dots between them, for example cut.1.feed_per_tooth");
        }
        if value.is_empty() || value.contains(['\n', '\r']) {
            return Err("a value is one line, and not empty");
        }
        let is_toml = DeTable::parse(&format!("value = {value}")).is_ok_and(|table| table.get_ref().len() == 1);
        let value = if is_toml { value.to_owned() } else { toml::Value::from(value).to_string() };
        Ok(KeyValue { key: key.to_owned(), value })
    }
}

impl fmt::Display for KeyValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.key, self.value)
    }
}

/// Separates values into those of the machine's file, whose keys lose their first part, and those of the job.
pub fn divide(values: &[KeyValue]) -> [Vec<KeyValue>; 2] {
    let (mut machine, mut job) = (Vec::new(), Vec::new());
    for value in values {
        match value.key.strip_prefix(MACHINE_FILE) {
            Some(key) => machine.push(KeyValue::new(key.to_owned(), value.value.clone())),
            None => job.push(value.clone()),
        }
    }
    [machine, job]
}

/// Text of a file in which these values replace its own or are added.
///
/// # Errors
/// The key that cannot have a value, with the reason.
pub fn with_values(text: &str, values: &[KeyValue]) -> Result<String, String> {
    let mut text = text.to_owned();
    for value in values {
        text = with_value(&text, value)?;
    }
    Ok(text)
}

/// Place of a key in a text.
enum KeyPlace {
    /// Range of the value.
    Value(std::ops::Range<usize>),
    /// Offset at which the rest of the key is written, with a separator before and behind it.
    Missing { at: usize, rest: String, around: [&'static str; 2] },
}

fn with_value(text: &str, KeyValue { key, value }: &KeyValue) -> Result<String, String> {
    let mut place = KeyPlace::Missing { at: 0, rest: key.clone(), around: ["", "\n"] };
    let mut table: Option<String> = None;
    walk(text, &mut |found, _, entry| {
        let span = entry.span();
        let is_written = |open: char| text.get(span.start..).is_some_and(|rest| rest.starts_with(open));
        if found == key {
            let is_header = match entry.get_ref() {
                DeValue::Table(_) => !is_written('{'),
                DeValue::Array(items) => items.first().is_some_and(|item| is_table(item) && !text_at(text, item, '{')),
                _ => false,
            };
            table = is_header.then(|| found.to_owned());
            place = KeyPlace::Value(span);
            return;
        }
        let rest = key.strip_prefix(found).and_then(|rest| rest.strip_prefix('.'));
        if let (Some(rest), true, KeyPlace::Missing { .. }) = (rest, is_table(entry), &place) {
            let (at, around) = if is_written('{') {
                let is_empty = matches!(entry.get_ref(), DeValue::Table(table) if table.is_empty());
                (span.start + 1, [" ", if is_empty { "" } else { "," }])
            } else {
                let end = text.get(span.start..).and_then(|rest| rest.find('\n')).map(|at| span.start + at);
                // The table of dotted keys alone has no line of its own: the key stays whole, above everything.
                if !is_written('[') {
                    return;
                }
                (end.unwrap_or(text.len()), ["\n", ""])
            };
            place = KeyPlace::Missing { at, rest: rest.to_owned(), around };
        }
    });
    if let Some(table) = table {
        return Err(format!("`{table}` is a table: give a value to one of its keys"));
    }
    let mut text = text.to_owned();
    match place {
        KeyPlace::Value(span) => text.replace_range(span, value),
        KeyPlace::Missing { at, rest, around: [before, behind] } => {
            text.insert_str(at, &format!("{before}{rest} = {value}{behind}"));
        }
    }
    Ok(text)
}

fn is_table(entry: &Spanned<DeValue<'_>>) -> bool {
    matches!(entry.get_ref(), DeValue::Table(_))
}

fn text_at(text: &str, entry: &Spanned<DeValue<'_>>, open: char) -> bool {
    text.get(entry.span().start..).is_some_and(|rest| rest.starts_with(open))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "units = \"mm\"\nlimits = { max_feed = 1 }\nempty = {}\n\n[spindle] # turns\nrev_per_min = 1000\n\n[[cut]]\n\
                        n = [1, 2]\n\n[[cut]]\nn = [3, 4]\nstock.offset = 3\n";

    fn changed(values: &[&str]) -> Result<toml::Table, String> {
        let values: Vec<KeyValue> = values.iter().map(|value| value.parse().expect("a value")).collect();
        with_values(TEXT, &values).map(|text| toml::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}")))
    }

    /// The value of a dotted key.
    fn value(table: &toml::Table, key: &str) -> String {
        let mut found = &toml::Value::Table(table.clone());
        for part in key.split('.') {
            found = match part.parse::<usize>() {
                Ok(number) => &found[number - 1],
                Err(_) => &found[part],
            };
        }
        found.to_string()
    }

    #[test]
    fn every_key_has_its_new_value_and_all_others_keep_theirs() {
        for (given, key, wanted) in [
            ("units=inch", "units", "\"inch\""),
            ("spindle.rev_per_min=1200.5", "spindle.rev_per_min", "1200.5"),
            ("spindle.set_by=operator", "spindle.set_by", "\"operator\""),
            ("limits.max_raise = 4", "limits.max_raise", "4"),
            ("empty.x=true", "empty.x", "true"),
            ("cut.2.n=[7, 8]", "cut.2.n", "[7, 8]"),
            ("cut.1.z=[1, 2]", "cut.1.z", "[1, 2]"),
            ("cut.2.stock.offset=4", "cut.2.stock.offset", "4"),
            ("machine.max_feed.x=\"9 m/min\"", "machine.max_feed.x", "\"9 m/min\""),
        ] {
            let table = changed(&[given]).unwrap_or_else(|error| panic!("{given}: {error}"));
            assert_eq!(value(&table, key), wanted, "{given}");
            let before: toml::Table = toml::from_str(TEXT).expect("TOML");
            for other in ["units", "limits.max_feed", "spindle.rev_per_min", "cut.1.n", "cut.2.n", "cut.2.stock.offset"]
            {
                assert!(other == key || value(&table, other) == value(&before, other), "{given} changes {other}");
            }
        }
        let both = changed(&["spindle.a=1", "spindle.b=2", "new=3"]).expect("values");
        assert_eq!(["spindle.a", "spindle.b", "new"].map(|key| value(&both, key)), ["1", "2", "3"]);
    }

    #[test]
    fn a_table_gets_no_value_and_a_key_is_words() {
        assert_eq!(
            changed(&["spindle=1"]).err().as_deref(),
            Some("`spindle` is a table: give a value to one of its keys")
        );
        assert!(changed(&["cut=1"]).is_err_and(|error| error.contains("`cut` is a table")));
        for text in ["spindle", "a..b=1", "=1", "a=", "a b=1", "a=1\nb=2"] {
            assert!(text.parse::<KeyValue>().is_err(), "{text:?}");
        }
    }

    #[test]
    fn keys_of_the_machine_are_divided_from_those_of_the_job() {
        let values =
            ["machine-file.rotary.1.max_feed=3", "machine.preset=x"].map(|text| text.parse().expect("a value"));
        let [machine, job] = divide(&values).map(|values| values.iter().map(KeyValue::to_string).collect::<Vec<_>>());
        assert_eq!((machine, job), (vec!["rotary.1.max_feed=3".into()], vec!["machine.preset=\"x\"".into()]));
    }
}
