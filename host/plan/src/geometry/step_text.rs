//! Records of a STEP file (ISO 10303-21, the data section): `#12 = NAME(parameters);`, also those of several types,
//! `#12 = (NAME(..) NAME(..));`.

use std::collections::HashMap;

use super::point_file::{Fault, ReadError};

/// Parameter.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    /// Real or integer.
    Number(f64),
    /// Text, as in the file.
    Text(String),
    /// Enumeration without its points; `T` and `F` are the logical ones.
    Word(String),
    /// `#12`
    Reference(u64),
    /// List; also the parameters of a type that stands before them.
    List(Vec<Value>),
    /// `$` or `*`
    Absent,
}

/// One type of a record with its parameters.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Part {
    pub(super) name: String,
    pub(super) values: Vec<Value>,
}

/// Records by their number; each with one part, or several.
pub(super) type Records = HashMap<u64, Vec<Part>>;

/// Deepest nesting of lists.
const DEPTH_MAX: usize = 32;

/// Reads the data section.
///
/// # Errors
/// The place at which this is no STEP file.
pub(super) fn records(text: &str) -> Result<Records, ReadError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let start = text.find("DATA").filter(|_| text.trim_start().starts_with("ISO-10303-21"));
    let start = start.ok_or_else(|| Fault::NotStep.at(1, 1))?;
    let mut reader = Reader { text, at: start + "DATA".len() };
    reader.skip_past(b';');
    let mut found = Records::new();
    loop {
        reader.gap();
        if reader.text[reader.at..].starts_with("ENDSEC") {
            return Ok(found);
        }
        let number = reader.reference()?;
        reader.expect(b'=')?;
        reader.gap();
        let parts = if reader.peek() == Some(b'(') { reader.parts()? } else { vec![reader.part()?] };
        reader.expect(b';')?;
        found.insert(number, parts);
    }
}

pub(super) fn reference(value: &Value) -> Option<u64> {
    if let Value::Reference(number) = value { Some(*number) } else { None }
}

pub(super) fn list(value: &Value) -> &[Value] {
    if let Value::List(values) = value { values } else { &[] }
}

pub(super) fn numbers(value: &Value) -> Vec<f64> {
    list(value)
        .iter()
        .filter_map(|value| if let Value::Number(number) = value { Some(*number) } else { None })
        .collect()
}

pub(super) fn rows<T>(values: &[Value], row: impl Fn(&Value) -> T) -> Vec<T> {
    values.first().map_or(&[][..], list).iter().map(row).collect()
}

pub(super) fn references(values: &[Value]) -> Vec<u64> {
    let of = |value: &Value| match value {
        Value::Reference(number) => vec![*number],
        Value::List(values) => references(values),
        _ => Vec::new(),
    };
    values.iter().flat_map(of).collect()
}

struct Reader<'t> {
    text: &'t str,
    at: usize,
}

impl Reader<'_> {
    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn fault(&self) -> ReadError {
        let before = self.text.get(..self.at).unwrap_or(self.text);
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        Fault::NotStep.at(before.matches('\n').count() + 1, column)
    }

    fn skip_past(&mut self, wanted: u8) {
        while self.peek().is_some_and(|byte| byte != wanted) {
            self.at += 1;
        }
        self.at += usize::from(self.at < self.text.len());
    }

    /// Skips blanks and comments.
    fn gap(&mut self) {
        loop {
            while self.peek().is_some_and(|byte| byte.is_ascii_whitespace()) {
                self.at += 1;
            }
            match self.text.get(self.at..).filter(|rest| rest.starts_with("/*")).map(|rest| rest.find("*/")) {
                Some(Some(end)) => self.at += end + 2,
                Some(None) => self.at = self.text.len(),
                None => return,
            }
        }
    }

    fn expect(&mut self, wanted: u8) -> Result<(), ReadError> {
        self.gap();
        if self.peek() != Some(wanted) {
            return Err(self.fault());
        }
        self.at += 1;
        Ok(())
    }

    fn take(&mut self, is_part: impl Fn(u8) -> bool) -> &str {
        let from = self.at;
        while self.peek().is_some_and(&is_part) {
            self.at += 1;
        }
        &self.text[from..self.at]
    }

    fn reference(&mut self) -> Result<u64, ReadError> {
        self.expect(b'#')?;
        let number = self.take(|byte| byte.is_ascii_digit()).parse();
        number.map_err(|_| self.fault())
    }

    fn part(&mut self) -> Result<Part, ReadError> {
        self.gap();
        let name = self.take(|byte| byte.is_ascii_alphanumeric() || byte == b'_').to_ascii_uppercase();
        if name.is_empty() {
            return Err(self.fault());
        }
        Ok(Part { name, values: self.list(0)? })
    }

    fn parts(&mut self) -> Result<Vec<Part>, ReadError> {
        self.expect(b'(')?;
        let mut parts = Vec::new();
        loop {
            self.gap();
            if self.peek() == Some(b')') {
                self.at += 1;
                return Ok(parts);
            }
            parts.push(self.part()?);
        }
    }

    fn list(&mut self, depth: usize) -> Result<Vec<Value>, ReadError> {
        self.expect(b'(')?;
        let mut values = Vec::new();
        loop {
            self.gap();
            match self.peek() {
                Some(b')') => {
                    self.at += 1;
                    return Ok(values);
                }
                Some(b',') => self.at += 1,
                Some(_) if depth < DEPTH_MAX => values.push(self.value(depth + 1)?),
                _ => return Err(self.fault()),
            }
        }
    }

    fn value(&mut self, depth: usize) -> Result<Value, ReadError> {
        match self.peek() {
            Some(b'#') => self.reference().map(Value::Reference),
            Some(b'(') => self.list(depth).map(Value::List),
            Some(b'\'') => Ok(Value::Text(self.string())),
            Some(b'$' | b'*') => {
                self.at += 1;
                Ok(Value::Absent)
            }
            Some(b'.') => {
                self.at += 1;
                let word = self.take(|byte| byte != b'.' && byte != b'\n').to_owned();
                self.expect(b'.')?;
                Ok(Value::Word(word))
            }
            Some(byte) if byte.is_ascii_alphabetic() => self.part().map(|part| Value::List(part.values)),
            _ => {
                let number =
                    self.take(|byte| byte.is_ascii_digit() || matches!(byte, b'+' | b'-' | b'.' | b'e' | b'E'));
                let number = number.parse::<f64>().ok().filter(|number| number.is_finite());
                number.map(Value::Number).ok_or_else(|| self.fault())
            }
        }
    }

    /// Text in quotes; two of them stand for one.
    fn string(&mut self) -> String {
        let mut text = String::new();
        loop {
            self.at += 1;
            text += self.take(|byte| byte != b'\'');
            self.at += usize::from(self.at < self.text.len());
            if self.peek() != Some(b'\'') {
                return text;
            }
            text.push('\'');
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_are_read_over_lines_and_comments() {
        let text = "ISO-10303-21;\nHEADER;\nFILE_NAME('it''s');\nENDSEC;\nDATA;\n#1 = A('it''s; (x)',\n  -1.5E-1,.T.,$,(#2,*));\n/* ; */\n\
                    #2=(B(1) C());\nENDSEC;\nEND-ISO-10303-21;\n";
        let records = records(text).unwrap();
        let list = Value::List(vec![Value::Reference(2), Value::Absent]);
        let values =
            vec![Value::Text("it's; (x)".into()), Value::Number(-0.15), Value::Word("T".into()), Value::Absent, list];
        assert_eq!(records[&1], [Part { name: "A".into(), values }]);
        assert_eq!(records[&2].iter().map(|part| part.name.as_str()).collect::<Vec<_>>(), ["B", "C"]);
    }

    #[test]
    fn a_broken_file_is_refused_where_it_breaks() {
        let broken = |data: &str| records(&format!("ISO-10303-21;\nDATA;\n{data}")).unwrap_err();
        assert_eq!((broken("#1=A(1,2;\nENDSEC;").line, broken("#1=A(1,2;\nENDSEC;").column), (3, 9));
        assert_eq!(broken("#1=A(1);\n#x=B();").line, 4);
        assert_eq!(broken("#1=A('open").line, 3);
        assert_eq!(records("solid blade").unwrap_err().line, 1);
        assert!(records(&format!("ISO-10303-21;\nDATA;\n#1=A{}", "(".repeat(100_000))).is_err());
    }
}
