//! The document's examples, decoded by a program that knows the document only, with `cobs` and `crc` of the Python Package Index.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use arcfeed_tests::{root, skip_loudly};

use crate::wire::document::{blocks, document};

/// Place of the packages that `cargo xtask test` installs in the build directory.
const PACKAGES: &str = "tools/python";
const CANDIDATES: [&str; 2] = ["python3", "/usr/bin/python3"];

fn packages() -> PathBuf {
    // This test runs as <build directory>/<profile>/deps/<name>.
    let test = std::env::current_exe().expect("a test knows its own path");
    test.ancestors().nth(3).expect("tests run from the deps folder").join(PACKAGES)
}

/// A Python that has both packages.
fn python() -> Option<&'static str> {
    let has_them = |python: &&str| {
        let mut import = Command::new(python);
        import.args(["-c", "import cobs.cobs, crc"]).env("PYTHONPATH", packages()).stderr(Stdio::null());
        import.status().is_ok_and(|status| status.success())
    };
    CANDIDATES.into_iter().find(has_them)
}

#[test]
fn a_script_that_knows_the_document_only_decodes_its_examples() {
    let Some(python) = python() else {
        let why = "no Python with cobs and crc (`cargo xtask test` installs them)";
        return skip_loudly("a_script_that_knows_the_document_only_decodes_its_examples", why);
    };
    let mut script = Command::new(python);
    script.arg(root().join("tests/line/wire/decode.py")).arg(root().join("docs/protocol.md"));
    script.env("PYTHONPATH", packages()).env("PYTHONDONTWRITEBYTECODE", "1").stderr(Stdio::inherit());
    let output = script.output().expect("Python starts");
    assert!(output.status.success(), "decode.py refuses the document");
    let document = document();
    let count = |mark| blocks(&document, mark).len();
    let rows = blocks(&document, "talk").iter().map(|talk| talk.lines().count()).sum::<usize>();
    let [frames, messages, salts] = ["frame", "message", "salt"].map(count);
    let expected = format!("{frames} frames, {messages} messages, {salts} salts, {rows} rows of talk\n");
    assert_eq!(String::from_utf8_lossy(&output.stdout), expected);
    assert!(messages > 0 && rows > 5);
    print!("{expected}");
}
