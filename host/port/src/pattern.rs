//! Regular expressions for `arcfeed ports` and `hwgrep://`; a stand-in if this build has none.

/// Regular expression that ignores case.
#[cfg(feature = "hwgrep")]
#[derive(Clone, Debug)]
pub struct Pattern(regex::Regex);

#[cfg(feature = "hwgrep")]
impl Pattern {
    /// Parses an expression.
    ///
    /// # Errors
    /// The text is not a regular expression.
    pub fn new(text: &str) -> Result<Self, String> {
        let regex = regex::RegexBuilder::new(text).case_insensitive(true).build();
        regex.map(Pattern).map_err(|error| format!("no regular expression: {}", error.to_string().replace('\n', " ")))
    }

    /// Whether some part of the text matches, ignoring case.
    pub fn matches(&self, text: &str) -> bool {
        self.0.is_match(text)
    }
}

/// Stand-in in a build without regular expressions: has no values, because [`Pattern::new`] always fails.
#[cfg(not(feature = "hwgrep"))]
#[derive(Clone, Debug)]
pub enum Pattern {}

#[cfg(not(feature = "hwgrep"))]
impl Pattern {
    /// Always fails with a message that names the missing feature.
    ///
    /// # Errors
    /// Always.
    pub fn new(_text: &str) -> Result<Self, String> {
        Err("this arcfeed was built without regular expressions (cargo feature `hwgrep`): build it with this feature, the \
             program with `cargo build --release --features full`"
            .to_owned())
    }

    /// Never called, because there is no value.
    pub fn matches(&self, _text: &str) -> bool {
        match *self {}
    }
}
