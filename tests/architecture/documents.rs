//! Documents: every link leads somewhere, and the book has them all.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use arcfeed_tests::{root, texts_below};
use pulldown_cmark::{Event, Parser, Tag, TagEnd};

use crate::complaints::assert_none;

const FOLDERS: [&str; 6] = ["docs", "examples", "firmware", "host", "hil-sim", "tests"];
const FILES: [&str; 6] =
    ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "SECURITY.md", "CODE_OF_CONDUCT.md", "CHANGELOG.md"];
const CONTENTS: &str = "docs/SUMMARY.md";

/// Links of a document, and the names of its headings as a link can give them.
#[derive(Default)]
pub struct Document {
    links: Vec<String>,
    /// Anchors of the headings.
    pub headings: BTreeSet<String>,
}

impl Document {
    /// Reads the text of a document.
    pub fn read(text: &str) -> Self {
        let mut document = Document::default();
        let mut heading: Option<String> = None;
        for event in Parser::new(text) {
            match event {
                Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                    document.links.push(dest_url.into_string());
                }
                Event::Start(Tag::Heading { .. }) => heading = Some(String::new()),
                Event::Text(text) | Event::Code(text) => heading.iter_mut().for_each(|heading| heading.push_str(&text)),
                Event::End(TagEnd::Heading(_)) => {
                    document.headings.extend(heading.take().map(|heading| anchor(&heading)));
                }
                _ => {}
            }
        }
        document
    }
}

/// The anchor of a heading: lower case, spaces as hyphens, no punctuation.
fn anchor(heading: &str) -> String {
    let kept = |letter: &char| letter.is_alphanumeric() || matches!(letter, ' ' | '-' | '_');
    heading.to_lowercase().chars().filter(kept).map(|letter| if letter == ' ' { '-' } else { letter }).collect()
}

/// A path without `.` and `..`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for component in path.components() {
        match component {
            Component::ParentDir => {
                plain.pop();
            }
            Component::CurDir => {}
            other => plain.push(other),
        }
    }
    plain
}

fn documents() -> BTreeMap<PathBuf, Document> {
    let below = FOLDERS.iter().flat_map(|folder| texts_below(folder));
    let files = FILES.iter().map(|file| (root().join(file), std::fs::read_to_string(root().join(file)).expect("text")));
    let is_document = |path: &Path| path.extension().is_some_and(|ending| ending == "md");
    let documents = below.chain(files).filter(|(path, _)| is_document(path));
    documents.map(|(path, text)| (plain(&path), Document::read(&text))).collect()
}

#[test]
fn every_link_between_documents_leads_to_a_file_and_a_heading() {
    let documents = documents();
    let (mut complaints, mut seen) = (Vec::new(), 0);
    for (path, document) in &documents {
        for link in document.links.iter().filter(|link| !link.contains("://") && !link.starts_with("mailto:")) {
            seen += 1;
            let (file, heading) = link.split_once('#').map_or((link.as_str(), None), |(file, to)| (file, Some(to)));
            let folder = path.parent().expect("a document has a folder");
            let target = if file.is_empty() { path.clone() } else { plain(&folder.join(file)) };
            let is_there = match (documents.get(&target), heading) {
                (Some(target), Some(heading)) => target.headings.contains(heading),
                (_, None) => target.exists(),
                (None, Some(_)) => false,
            };
            complaints.extend((!is_there).then(|| format!("{}: dead link `{link}`", path.display())));
        }
    }
    assert!(seen > 200, "{seen} links are not all there are");
    assert_none(&complaints);
}

#[test]
fn the_book_has_every_document_once() {
    let documents = documents();
    let contents = root().join(CONTENTS);
    let listed = documents[&contents].links.iter().map(|link| plain(&root().join("docs").join(link)));
    let mut listed: Vec<PathBuf> = listed.collect();
    listed.sort();
    let docs = root().join("docs");
    let there: Vec<PathBuf> =
        documents.into_keys().filter(|path| path.starts_with(&docs) && *path != contents).collect();
    assert_eq!(listed, there);
}

/// The book has pages for the documents in `docs` only: a link to another document goes to its folder.
#[test]
fn links_out_of_the_book_lead_to_folders() {
    let docs = root().join("docs");
    let mut complaints = Vec::new();
    for (path, document) in documents().iter().filter(|(path, _)| path.starts_with(&docs)) {
        let folder = path.parent().expect("a document has a folder");
        let is_dead = |link: &&String| link.ends_with(".md") && !plain(&folder.join(link)).starts_with(&docs);
        let dead = document.links.iter().filter(is_dead);
        complaints.extend(dead.map(|link| format!("{}: `{link}` has no page in the book", path.display())));
    }
    assert_none(&complaints);
}

#[test]
fn an_anchor_is_a_heading_without_punctuation() {
    let document = Document::read("# A `G2` arc: what, where?\n\n[there](#x) ![picture](p.png)\n");
    assert_eq!(document.headings, BTreeSet::from(["a-g2-arc-what-where".to_owned()]));
    assert_eq!(document.links, ["#x", "p.png"]);
    let page = Document::read("# Laws\n## Full slot (2/3)\n```\n# no\n```\n#no\n");
    assert_eq!(page.headings, BTreeSet::from(["laws", "full-slot-23"].map(str::to_owned)));
}
