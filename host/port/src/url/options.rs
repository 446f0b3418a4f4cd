//! Options at the end of a port URL, `?name=value&name`, parsed as by Python's `urllib.parse.parse_qs`.

use super::UrlError;
use crate::log::Level;

/// Longest wait that a URL may set.
const SECONDS_MAX: f64 = 3_600.0;

/// Options of a URL that no caller has taken yet. Of an option given twice, the first counts.
pub struct Options(Vec<(String, String)>);

impl Options {
    /// Splits a URL at its first `?` into the text before it and the options; no options without `?`.
    pub fn split(text: &str) -> (&str, Options) {
        text.split_once('?').map_or((text, Options::none()), |(place, query)| (place, Options::read(query)))
    }

    /// Splits a URL at its last `?` into the text before it and the options; no options without `?`.
    pub fn split_last(text: &str) -> (&str, Options) {
        text.rsplit_once('?').map_or((text, Options::none()), |(place, query)| (place, Options::read(query)))
    }

    /// Empty options.
    pub fn none() -> Self {
        Options(Vec::new())
    }

    fn read(query: &str) -> Self {
        let mut found: Vec<(String, String)> = Vec::new();
        for part in query.split('&').filter(|part| !part.is_empty()) {
            let (name, value) = part.split_once('=').unwrap_or((part, ""));
            let name = decoded(name);
            if found.iter().all(|(other, _)| *other != name) {
                found.push((name, decoded(value)));
            }
        }
        Options(found)
    }

    /// Names of the options that have not been taken yet.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|(name, _)| name.as_str())
    }

    /// Removes the option `name` and returns its value, which is empty for a name alone; `None` if it was not given.
    pub fn take(&mut self, name: &str) -> Option<String> {
        let at = self.0.iter().position(|(other, _)| other == name)?;
        Some(self.0.remove(at).1)
    }

    /// Removes the option `name`, which must have no value; returns whether it was given. Fails if it has a value.
    pub fn flag(&mut self, name: &str) -> Result<bool, UrlError> {
        match self.take(name).as_deref() {
            None => Ok(false),
            Some("") => Ok(true),
            Some(value) => Err(UrlError::new(
                format!("{name}={value}"),
                format!("{name} is switched on by its name alone; write {name}, or leave it out"),
            )),
        }
    }

    /// Removes the option `name` and returns its value in seconds; `None` if it was not given. Fails if it is not a
    /// number from 0 to 3600.
    pub fn seconds(&mut self, name: &str) -> Result<Option<f64>, UrlError> {
        let Some(value) = self.take(name) else { return Ok(None) };
        let parsed = value.parse().ok().filter(|seconds| (0.0..=SECONDS_MAX).contains(seconds));
        let message = format!("write {name}=SECONDS, from 0 to {SECONDS_MAX}");
        parsed.map(Some).ok_or_else(|| UrlError::new(format!("{name}={value}"), message))
    }

    /// Removes the option `logging` and returns its level; `None` if it was not given. Fails if there is no such level.
    pub fn logging(&mut self) -> Result<Option<Level>, UrlError> {
        let Some(value) = self.take("logging") else { return Ok(None) };
        let wrong = || UrlError::new(format!("logging={value}"), "write logging=debug, info, warning or error");
        Level::named(&value).map(Some).ok_or_else(wrong)
    }

    /// Fails if options are left, which are unknown ones; `form` is the correct form of the URL for the message.
    pub fn no_more(&self, form: &str) -> Result<(), UrlError> {
        match self.0.first() {
            None => Ok(()),
            Some((name, _)) => Err(UrlError::new(name, format!("unknown option; write {form}"))),
        }
    }
}

/// Decodes `%41` as A, `+` as a blank; other text stays.
fn decoded(text: &str) -> String {
    let bytes = text.as_bytes();
    let (mut out, mut at) = (Vec::with_capacity(bytes.len()), 0);
    while at < bytes.len() {
        let code = bytes.get(at + 1..at + 3).filter(|hex| bytes[at] == b'%' && hex.iter().all(u8::is_ascii_hexdigit));
        let code = code.and_then(|hex| std::str::from_utf8(hex).ok());
        match code.and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            Some(byte) => {
                out.push(byte);
                at += 3;
            }
            None => {
                out.push(if bytes[at] == b'+' { b' ' } else { bytes[at] });
                at += 1;
            }
        }
    }
    String::from_utf8_lossy(&out).into_owned()
}
