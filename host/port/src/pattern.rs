//! Regular expressions of `ports` and `hwgrep://`.

/// Regular expression that ignores case.
#[cfg(feature = "hwgrep")]
#[derive(Clone, Debug)]
pub struct Pattern(regex::Regex);

#[cfg(feature = "hwgrep")]
impl Pattern {
    /// Parses an expression.
    ///
    /// # Errors
    /// The text is no regular expression.
    pub fn new(text: &str) -> Result<Self, String> {
        let regex = regex::RegexBuilder::new(text).case_insensitive(true).build();
        regex.map(Pattern).map_err(|error| format!("no regular expression: {}", error.to_string().replace('\n', " ")))
    }

    /// Some part of the text matches.
    pub fn matches(&self, text: &str) -> bool {
        self.0.is_match(text)
    }
}

/// Stand-in for a build without regular expressions.
#[cfg(not(feature = "hwgrep"))]
#[derive(Clone, Debug)]
pub enum Pattern {}

#[cfg(not(feature = "hwgrep"))]
impl Pattern {
    /// Always fails.
    ///
    /// # Errors
    /// Always.
    pub fn new(_text: &str) -> Result<Self, String> {
        Err("this arcfeed was built without regular expressions (cargo feature `hwgrep`): build it with this feature, the \
             program with `cargo build --release --features full`"
            .to_owned())
    }

    /// Matches nothing.
    pub fn matches(&self, _text: &str) -> bool {
        match *self {}
    }
}
