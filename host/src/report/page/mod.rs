//! Report as one self-contained HTML file: a title, and sections one below the other.
//!
//! A section is a heading and a body; each part of the report adds its own.

pub mod png;

pub mod plot;

pub mod map;

pub mod load_plot;

pub mod tables;

pub mod loads;

pub mod marks;

pub mod viewer;

#[cfg(feature = "plan")]
pub mod plan;

use std::fmt;

use viewer::ViewerData;

/// Report page (HTML).
#[derive(Clone, Debug)]
pub struct Page {
    /// Title.
    pub title: String,
    /// Result in one line below the title.
    pub lead: Option<String>,
    /// Viewer of a run above the sections.
    pub viewer: Option<ViewerData>,
    /// Sections in order.
    pub sections: Vec<Section>,
}

/// Section of a report page.
#[derive(Clone, Debug)]
pub struct Section {
    /// Heading, plain text.
    pub heading: String,
    /// Body, HTML.
    pub body: String,
}

impl fmt::Display for Page {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let title = escaped(&self.title);
        let lead =
            self.lead.as_deref().map(|lead| format!("<p class=\"lead\">{}</p>\n", escaped(lead))).unwrap_or_default();
        let [head, body] = self.viewer.as_ref().map(ViewerData::html).unwrap_or_default();
        write!(
            f,
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n<style>\n\
             body {{ font: 15px/1.5 sans-serif; max-width: 66em; margin: 2em auto; padding: 0 1em; color: #222 }}\n\
             pre {{ overflow-x: auto; background: #f6f6f6; padding: 1em; font-size: 12px }}\n\
             table {{ border-collapse: collapse }}\n\
             th, td {{ padding: .2em .8em; border-bottom: 1px solid #ddd; text-align: right }}\n\
             th:first-child, td:first-child {{ text-align: left }}\n\
             svg {{ max-width: 100%; height: auto; font: 12px sans-serif }}\n\
             .lead {{ font-weight: bold }}\n\
             .warning {{ color: #a00000; font-weight: bold }}\n</style>\n{head}</head>\n<body>\n<main>\n<h1>{title}</h1>\n{lead}{body}"
        )?;
        for Section { heading, body } in &self.sections {
            writeln!(f, "<h2>{}</h2>\n{}", escaped(heading), body.trim_end())?;
        }
        f.write_str("</main>\n</body>\n</html>\n")
    }
}

/// Escapes text for use between tags and in attributes.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_of_others_is_no_markup() {
        let page = Page {
            title: "<b>&\"".into(),
            lead: None,
            viewer: None,
            sections: vec![Section { heading: "a<b".into(), body: "<p>".into() }],
        };
        let html = page.to_string();
        assert!(html.contains("<h1>&lt;b&gt;&amp;&quot;</h1>\n<h2>a&lt;b</h2>\n<p>\n</main>\n</body>"), "{html}");
    }
}
