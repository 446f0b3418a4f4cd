//! Reading of TOML into types by serde, with the place of each value.
//!
//! The deserializer of `toml` shows a table to each type in three ways: as itself, with its place, and as a date. Each is compiled for each of some sixty types of files,
//! which was a quarter of the code of `arcfeed`. This one has a single way for all. Of a type's visitor it calls only the function for the kind of value that the
//! type asks for. The messages are those of `toml`; no file here has dates, and all enums are words.

use std::ops::Range;
use std::vec;

use serde::de::value::CowStrDeserializer;
use serde::de::{
    DeserializeOwned, DeserializeSeed, Deserializer, Error, Expected, IntoDeserializer, MapAccess, SeqAccess,
    Unexpected, Visitor,
};
use serde::forward_to_deserialize_any;
use toml::Spanned;
use toml::de::{DeString, DeValue};

use crate::toml_values::parse;

/// Reads a file of TOML.
///
/// # Errors
/// Byte offset and description of the first fault; offset 0 for one of the whole file.
pub fn read<T: DeserializeOwned>(text: &str) -> Result<T, (usize, String)> {
    let file = parse(text)?;
    let file = Spanned::new(file.span(), DeValue::Table(file.into_inner()));
    T::deserialize(Value::new(file)).map_err(|fault| (fault.offset.unwrap_or(0), fault.message))
}

/// Reason why a value does not suit its type.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
struct Fault {
    /// Byte offset of the innermost value that has a place.
    offset: Option<usize>,
    message: String,
}

impl Error for Fault {
    fn custom<M: std::fmt::Display>(message: M) -> Self {
        Fault { offset: None, message: message.to_string() }
    }
}

/// A value or a key with its place.
struct Value<'de> {
    span: Range<usize>,
    content: Content<'de>,
}

/// Values by the function of a visitor that takes them.
enum Content<'de> {
    Text(DeString<'de>),
    Integer(i64),
    Float(f64),
    Boolean(bool),
    Items(Items<'de>),
    Entries(Entries<'de>),
    /// No type takes this.
    Wrong(String),
}

/// Values of an array.
struct Items<'de>(vec::IntoIter<Spanned<DeValue<'de>>>);

impl Items<'_> {
    /// Refuses values that are left when the type has all that it needs.
    fn end(&self, all: usize) -> Result<(), Fault> {
        let Some(first) = self.0.as_slice().first() else { return Ok(()) };
        let message = format!("{} values are needed here, not {all}", all - self.0.len());
        Err(Fault { offset: Some(first.span().start), message })
    }
}

/// Keys of a table, or of a value with its place, each followed by its value.
struct Entries<'de>(vec::IntoIter<Value<'de>>);

// Generic functions are compiled for each type that is read: whatever does not depend on that type is in functions that are not generic.

impl<'de> Value<'de> {
    fn new(value: Spanned<DeValue<'de>>) -> Self {
        let span = value.span();
        let content = match value.into_inner() {
            DeValue::String(text) => Content::Text(text),
            DeValue::Integer(integer) => match i64::from_str_radix(integer.as_str(), integer.radix()) {
                Ok(integer) => Content::Integer(integer),
                Err(error) => Content::Wrong(error.to_string()),
            },
            DeValue::Float(float) => match float.as_str().parse() {
                Ok(float) => Content::Float(float),
                Err(_) => Content::Wrong(format!("`{float}` is no number")),
            },
            DeValue::Boolean(boolean) => Content::Boolean(boolean),
            DeValue::Datetime(_) => Content::Wrong("a date or time has no meaning here; write a text in quotes".into()),
            DeValue::Array(values) => Content::Items(Items(values.into_iter())),
            DeValue::Table(table) => {
                let entries: Vec<Value<'de>> =
                    table.into_iter().flat_map(|(key, value)| [Value::key(key), Value::new(value)]).collect();
                Content::Entries(Entries(entries.into_iter()))
            }
        };
        Value { span, content }
    }

    fn key(key: Spanned<DeString<'de>>) -> Self {
        Value { span: key.span(), content: Content::Text(key.into_inner()) }
    }

    /// Entries of [`Spanned`], from the names of its fields: start, end, value.
    fn placed(self, [start, end, value]: [&'static str; 3]) -> Entries<'de> {
        let Range { start: from, end: to } = self.span;
        let field = |name| Value { span: from..to, content: Content::Text(DeString::Borrowed(name)) };
        let offset = |offset: usize| Value { span: from..to, content: Content::Integer(offset as i64) };
        Entries(vec![field(start), offset(from), field(end), offset(to), field(value), self].into_iter())
    }

    /// Reads a value as the type of a seed. A fault without a place gets this one.
    fn given_to<S: DeserializeSeed<'de>>(self, seed: S) -> Result<S::Value, Fault> {
        let offset = self.span.start;
        seed.deserialize(self).map_err(|fault| Fault { offset: fault.offset.or(Some(offset)), ..fault })
    }

    /// Name of an enum's variant.
    fn variant(self) -> Result<CowStrDeserializer<'de, Fault>, Fault> {
        match self.content {
            Content::Text(name) => Ok(name.into_deserializer()),
            _ => Err(Fault::custom("a word in quotes is needed")),
        }
    }
}

impl Content<'_> {
    /// Why this does not suit a type.
    #[cold]
    fn unsuited(self, expected: &dyn Expected) -> Fault {
        let found = match &self {
            Content::Text(text) => Unexpected::Str(text),
            Content::Integer(integer) => Unexpected::Signed(*integer),
            Content::Float(float) => Unexpected::Float(*float),
            Content::Boolean(boolean) => Unexpected::Bool(*boolean),
            Content::Items(_) => Unexpected::Seq,
            Content::Entries(_) => Unexpected::Map,
            Content::Wrong(message) => return Fault::custom(message),
        };
        Fault::invalid_type(found, expected)
    }
}

/// Functions of the same content as another: a visitor says itself which numbers it has no room for.
macro_rules! as_types {
    ($other:ident for $($function:ident)*) => {
        $(fn $function<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
            self.$other(visitor)
        })*
    };
}

impl<'de> Deserializer<'de> for Value<'de> {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.content {
            Content::Text(_) => self.deserialize_str(visitor),
            Content::Integer(_) | Content::Float(_) => self.deserialize_f64(visitor),
            Content::Boolean(_) => self.deserialize_bool(visitor),
            Content::Items(_) => self.deserialize_seq(visitor),
            Content::Entries(_) | Content::Wrong(_) => self.deserialize_map(visitor),
        }
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.content {
            Content::Text(DeString::Borrowed(text)) => visitor.visit_borrowed_str(text),
            Content::Text(DeString::Owned(text)) => visitor.visit_string(text),
            other => Err(other.unsuited(&visitor)),
        }
    }

    fn deserialize_i64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.content {
            Content::Integer(integer) => visitor.visit_i64(integer),
            other => Err(other.unsuited(&visitor)),
        }
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.content {
            Content::Integer(integer) => visitor.visit_i64(integer),
            Content::Float(float) => visitor.visit_f64(float),
            other => Err(other.unsuited(&visitor)),
        }
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.content {
            Content::Boolean(boolean) => visitor.visit_bool(boolean),
            other => Err(other.unsuited(&visitor)),
        }
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.content {
            Content::Items(mut items) => {
                let all = items.0.len();
                let read = visitor.visit_seq(&mut items)?;
                items.end(all).map(|()| read)
            }
            other => Err(other.unsuited(&visitor)),
        }
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.content {
            Content::Entries(entries) => visitor.visit_map(entries),
            other => Err(other.unsuited(&visitor)),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        match fields {
            [start, end, value] if serde_spanned::de::is_spanned(name) => {
                visitor.visit_map(self.placed([start, end, value]))
            }
            _ => self.deserialize_map(visitor),
        }
    }

    /// An enum from the name of a variant.
    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        visitor.visit_enum(self.variant()?)
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_unit()
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, _: usize, visitor: V) -> Result<V::Value, Fault> {
        self.deserialize_seq(visitor)
    }

    as_types! { deserialize_str for deserialize_string deserialize_identifier }
    as_types! { deserialize_i64 for deserialize_i8 deserialize_i16 deserialize_i32 deserialize_u8 deserialize_u16 deserialize_u32 deserialize_u64 }
    as_types! { deserialize_f64 for deserialize_f32 }

    forward_to_deserialize_any! { char bytes byte_buf unit unit_struct tuple_struct }
}

impl<'de> SeqAccess<'de> for &mut Items<'de> {
    type Error = Fault;

    fn next_element_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>, Fault> {
        match self.0.next().map(Value::new) {
            Some(value) => value.given_to(seed).map(Some),
            None => Ok(None),
        }
    }
}

impl<'de> MapAccess<'de> for Entries<'de> {
    type Error = Fault;

    fn next_key_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>, Fault> {
        match self.0.next() {
            Some(key) => key.given_to(seed).map(Some),
            None => Ok(None),
        }
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, Fault> {
        match self.0.next() {
            Some(value) => value.given_to(seed),
            None => Err(Fault::custom("a value is taken before its key")),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use serde::Deserialize;

    use super::*;

    #[derive(Debug, PartialEq, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct File {
        count: u16,
        text: Option<Spanned<String>>,
        word: Option<Spanned<Word>>,
        #[serde(default)]
        ratios: Vec<Spanned<f64>>,
        pair: Option<Spanned<[f64; 2]>>,
        #[serde(default)]
        named: BTreeMap<Spanned<String>, bool>,
        inner: Option<Spanned<Inner>>,
        #[serde(default)]
        many: Vec<Inner>,
    }

    #[derive(Debug, PartialEq, Deserialize)]
    #[serde(rename_all = "lowercase")]
    enum Word {
        One,
        Other,
    }

    #[derive(Debug, PartialEq, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Inner {
        at: Spanned<i64>,
    }

    #[test]
    fn files_and_faults_are_those_of_the_deserializer_of_toml() {
        let texts = [
            "count = 7",
            "count = 0x10\ntext = 'a'\nword = \"other\"\nratios = [1, 2.5, -3e2]\npair = [1, 2.0]",
            "count = 1_000\ntext = \"a\\tb\"\n[named]\na = true\n\"b\\u0063\" = false\n[inner]\nat = -3",
            "count = 1\ninner.at = 2\n[[many]]\nat = 1\n[[many]]\nat = 2",
            "inner = { at = 1 }\ncount = 2\nmany = [{ at = 5 }]",
            "",
            "count = 70000",
            "count = -1",
            "count = 1.5",
            "count = \"7\"",
            "count = 1\ncounts = 2",
            "count = 1\nword = \"third\"",
            "count = 1\ntext = 3",
            "count = 1\nratios = 3",
            "count = 1\nratios = [1, \"2\"]",
            "count = 1\npair = [1]",
            "count = 1\nnamed = { a = 1 }",
            "count = 1\ninner = 3",
            "count = 1\n[inner]",
            "count = 1\n[inner]\nat = 1\nfor = 2",
            "count = 1\n[[many]]\nat = 1\n[[many]]",
            "count = 1\n[many]\nat = 1",
            "count = 1\ncount = 2",
            "count = ",
        ];
        for text in texts {
            let theirs: Result<File, toml::de::Error> = toml::from_str(text);
            let theirs = theirs.map_err(|error| (error.span().map_or(0, |s| s.start), error.message().to_owned()));
            assert_eq!(read::<File>(text), theirs, "{text}");
        }
    }

    #[test]
    fn what_no_type_takes_is_refused_at_its_place() {
        for (text, part, message) in [
            ("count = 1\ninner = [1]", "[", "invalid type: sequence, expected struct Inner"),
            ("count = 1\nword = 3", "3", "a word in quotes is needed"),
            ("count = 1\nword = { one = 3 }", "{", "a word in quotes is needed"),
            ("count = 1\npair = [1, 2, 3]", "3", "2 values are needed here, not 3"),
            ("count = 1979-05-27", "1979", "a date or time has no meaning here; write a text in quotes"),
            ("count = 1e10", "1e10", "a number between -1e9 and 1e9 is needed; write one, or remove the key"),
        ] {
            let offset = text.find(part).expect("it is in the text");
            assert_eq!(read::<File>(text), Err((offset, message.to_owned())), "{text}");
        }
    }
}
