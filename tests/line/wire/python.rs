//! The document's examples, decoded by a program that knows the document only, with `cobs` and `crc` of the Python Package Index.

use std::process::Stdio;

use arcfeed_tests::python::python_with;
use arcfeed_tests::{root, skip_loudly};

use crate::wire::document::{blocks, document};

#[test]
fn a_script_that_knows_the_document_only_decodes_its_examples() {
    let Some(mut script) = python_with("cobs.cobs, crc") else {
        let why = "no Python with cobs and crc (`cargo xtask test` installs them)";
        return skip_loudly("a_script_that_knows_the_document_only_decodes_its_examples", why);
    };
    script.arg(root().join("tests/line/wire/decode.py")).arg(root().join("docs/protocol.md"));
    let output = script.stderr(Stdio::inherit()).output().expect("Python starts");
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
