//! Errors and warnings of a check, grouped by kind.

use std::collections::HashMap;
use std::io::IsTerminal;
use std::path::Path;

use annotate_snippets::Renderer;

use crate::commands::outcome::say;
use crate::console::note;
use crate::program::{Diagnostic, Severity};
use crate::snippet;

/// Errors and warnings that the JSON object lists; the others are counted.
const LISTED_MAX: usize = 10_000;
/// Places of a kind of warning that are named; the others are counted.
const PLACES_MAX: usize = 3;

/// Errors and warnings of one check, which are counted, grouped by kind and printed.
pub struct CheckFindings<'a> {
    /// Path of the program.
    pub path: &'a Path,
    /// Path as given on the command line.
    given: &'a Path,
    is_json: bool,
    /// Number of errors.
    pub errors: usize,
    /// Number of warnings.
    pub warnings: usize,
    /// Errors and warnings in full for the JSON output, at most 10 000.
    pub listed: Vec<Diagnostic>,
    /// Kinds of errors and warnings, in the order of their first places.
    kinds: Vec<FindingKind>,
    /// Index of the kind with a message.
    by_message: HashMap<String, usize>,
}

/// Errors or warnings with the same message.
struct FindingKind {
    first: Diagnostic,
    text: Option<Vec<u8>>,
    /// Lines and columns of the next ones.
    next: Vec<[usize; 2]>,
    count: usize,
}

impl<'a> CheckFindings<'a> {
    /// Empty list of findings, for a check of the file `path`, which was given as `given`.
    pub fn new(given: &'a Path, path: &'a Path, is_json: bool) -> Self {
        CheckFindings {
            path,
            given,
            is_json,
            errors: 0,
            warnings: 0,
            listed: Vec::new(),
            kinds: Vec::new(),
            by_message: HashMap::new(),
        }
    }

    /// Adds an error or warning, with the text of its line if there is one.
    pub fn add(&mut self, diagnostic: Diagnostic, text: Option<&[u8]>) {
        match diagnostic.severity {
            Severity::Error => self.errors += 1,
            Severity::Warning => self.warnings += 1,
        }
        if self.is_json {
            if self.listed.len() < LISTED_MAX {
                self.listed.push(diagnostic);
            }
        } else {
            self.add_kind(diagnostic, text);
        }
    }

    /// Adds errors and warnings that concern the whole program, and sorts those for the JSON output by place.
    pub fn add_all<'t>(&mut self, found: impl Iterator<Item = (Diagnostic, &'t [u8])>) {
        found.for_each(|(diagnostic, text)| self.add(diagnostic, Some(text)));
        self.listed.sort_by_key(|found| (found.line, found.column));
    }

    fn add_kind(&mut self, diagnostic: Diagnostic, text: Option<&[u8]>) {
        let known = self.by_message.get(&diagnostic.message).and_then(|index| self.kinds.get_mut(*index));
        if let Some(kind) = known {
            kind.count += 1;
            if kind.next.len() + 1 < PLACES_MAX {
                kind.next.push([diagnostic.line, diagnostic.column]);
            }
            return;
        }
        self.by_message.insert(diagnostic.message.clone(), self.kinds.len());
        let text = text.map(<[u8]>::to_vec);
        self.kinds.push(FindingKind { first: diagnostic, text, next: Vec::new(), count: 1 });
    }

    /// Prints errors and warnings; findings of one kind are printed once, with their first places.
    pub fn print(&mut self) {
        let (out, err) = (std::io::stdout().is_terminal(), std::io::stderr().is_terminal());
        let mut kinds = std::mem::take(&mut self.kinds);
        kinds.sort_by_key(|kind| (kind.first.severity == Severity::Warning, kind.first.line, kind.first.column));
        for kind in kinds {
            let others = kind.others();
            let words =
                |is_terminal: bool| self.in_words(&kind.first, kind.text.as_deref(), is_terminal, others.as_deref());
            match kind.first.severity {
                Severity::Error => note(format_args!("{}", words(err))),
                Severity::Warning => say(format_args!("{}", words(out))),
            }
        }
    }

    fn in_words(&self, of: &Diagnostic, text: Option<&[u8]>, is_terminal: bool, others: Option<&str>) -> String {
        match text {
            Some(text) if is_terminal => snippet::render(self.given, text, of, others, &Renderer::styled()),
            _ => {
                format!("{}:{of}{}", self.path.display(), others.map_or(String::new(), |others| format!("; {others}")))
            }
        }
    }
}

impl FindingKind {
    /// Places of those after the first, in words.
    fn others(&self) -> Option<String> {
        let mut places: Vec<String> = self.next.iter().map(|[line, column]| format!("{line}:{column}")).collect();
        let more = self.count - 1 - places.len();
        places.extend((more > 0).then(|| format!("{more} more")));
        let last = places.pop()?;
        Some(if places.is_empty() {
            format!("also at {last}")
        } else {
            format!("also at {} and {last}", places.join(", "))
        })
    }
}
