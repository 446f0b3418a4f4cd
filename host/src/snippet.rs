//! Diagnostics in the style of a compiler: the line, and a mark under the place.

use std::path::Path;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

use crate::program::{Diagnostic, Severity};

/// Renders one diagnostic with its line of the program, which may hold any bytes, and a note below it.
pub fn render(path: &Path, text: &[u8], diagnostic: &Diagnostic, below: Option<&str>, renderer: &Renderer) -> String {
    // Each byte becomes one character, so that columns stay where they are.
    let shown: String =
        text.iter().map(|byte| if (32..127).contains(byte) { char::from(*byte) } else { '?' }).collect();
    let start = (diagnostic.column - 1).min(shown.len());
    let end = (diagnostic.end_column - 1).clamp(start, shown.len());
    let (says, remedy) = diagnostic.message.split_once("; ").unwrap_or((&diagnostic.message, ""));
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let title = match diagnostic.alarm {
        Some(alarm) => format!("PS{alarm:04}: {says}"),
        None => says.to_owned(),
    };
    let mark = AnnotationKind::Primary.span(start..end).label(remedy);
    let origin = path.display().to_string();
    let snippet = Snippet::source(shown.as_str()).line_start(diagnostic.line).path(origin.as_str()).annotation(mark);
    let group = level.primary_title(title.as_str()).element(snippet);
    let notes = below.into_iter().map(|below| Level::NOTE.message(below));
    renderer.render(&[group.elements(notes)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::Program;
    use arcfeed_nc::block::Reading;
    use arcfeed_units::LengthUnit;

    fn shown(text: &[u8]) -> String {
        let path = Path::new("part.nc");
        let program = Program::parse(path, text, LengthUnit::Inch, Reading::Lenient);
        let found = &program.diagnostics[0];
        render(path, program.texts().nth(found.line - 1).unwrap(), found, None, &Renderer::plain())
    }

    #[test]
    fn the_mark_stands_under_the_word() {
        let text = shown(b"G0\nN5G1X-1.O5Y1.F1.\n");
        assert!(text.starts_with("error: PS0009: this address is not allowed here\n"), "{text}");
        assert!(text.contains("part.nc:2:9\n"), "{text}");
        let lines: Vec<&str> = text.lines().collect();
        let source = lines.iter().position(|line| line.contains("N5G1X-1.O5Y1.F1.")).unwrap();
        assert_eq!(lines[source].find("O5"), lines[source + 1].find("^^"), "{text}");
        assert!(!lines[source + 1].contains("^^^"), "{text}");
    }

    #[test]
    fn a_place_behind_the_line_and_bytes_that_are_no_text_are_shown_too() {
        assert!(shown(b"G1X").contains("part.nc:1:4"));
        assert!(shown(b"G1X1.(\xe9 \xff)").contains("warning: PS0001"));
    }
}
