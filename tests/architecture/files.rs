//! Sizes of files, and that each file of tests is one that runs.

use std::collections::BTreeSet;

use crate::complaints::assert_none;
use crate::manifest::{Entry, entries};
use crate::modules::undeclared;
use crate::source::{CHIP, HOST, SIMULATOR, Source, names, read, root, rust_files, rust_files_of};

/// Lines of code a file may have, tests apart.
const LIMIT: usize = 300;

/// Lines that are neither blank, nor comment, nor tests.
fn lines_of_code(source: &Source) -> usize {
    source.production().lines().filter(|line| !line.trim().is_empty()).count()
}

/// Files of the folder of tests that cargo would build if they were declared.
fn test_files() -> BTreeSet<String> {
    let not_tests = ["lib.rs", "build.rs"];
    let mut files = BTreeSet::new();
    for name in names("tests") {
        if name.ends_with(".rs") && !not_tests.contains(&name.as_str()) {
            files.insert(name);
        } else if name.ends_with('/') && root().join("tests").join(&name).join("main.rs").exists() {
            files.insert(name + "main.rs");
        }
    }
    files
}

/// Paths of the `[[test]]` entries of a manifest.
fn declared_tests(manifest: &str) -> BTreeSet<String> {
    let paths = entries(manifest).into_iter().filter(|entry| entry.section == "test" && entry.key == "path");
    paths.map(|entry| entry.value.trim_matches('"').to_owned()).collect()
}

#[test]
fn no_file_has_more_than_300_lines_of_code() {
    let sources = rust_files_of(&[&CHIP[..], &SIMULATOR, &HOST, &["tests"]].concat());
    let sizes = sources.iter().map(|source| (source.path.as_str(), lines_of_code(source)));
    let long: Vec<String> =
        sizes.filter(|(_, lines)| *lines > LIMIT).map(|(path, lines)| format!("{path}: {lines}")).collect();
    assert_none(&long);
}

#[test]
fn every_file_of_tests_is_declared_and_every_declared_one_is_there() {
    let files = test_files();
    assert!(files.contains("architecture/main.rs"), "this file itself is not among {files:?}");
    assert_eq!(declared_tests(&read("tests/Cargo.toml")), files, "[[test]] paths in Cargo.toml, files in tests");
}

#[test]
fn every_file_below_a_test_is_one_of_its_modules() {
    let folders = test_files().into_iter().filter_map(|file| file.strip_suffix("/main.rs").map(str::to_owned));
    let found: Vec<String> = folders
        .flat_map(|folder| {
            let root = format!("tests/{folder}");
            undeclared(&root, &rust_files(&root))
        })
        .collect();
    assert_none(&found);
}

#[test]
fn no_declared_test_is_switched_off() {
    let manifest = read("tests/Cargo.toml");
    let switches = |entry: &Entry<'_>| entry.section == "test" && matches!(entry.key, "test" | "required-features");
    assert_eq!(entries(&manifest).into_iter().find(switches), None);
}

#[test]
fn the_example_of_the_firmware_takes_no_more_than_25_lines() {
    let readme = read("firmware/README.md");
    let example = readme.split_once("```rust\n").and_then(|(_, rest)| rest.split_once("```")).expect("an example").0;
    assert!((10..=25).contains(&example.lines().count()), "{} lines", example.lines().count());
    assert!(read("firmware/src/lib.rs").contains("include_str!(\"../README.md\")"), "the example is not compiled");
}

#[test]
fn only_code_is_counted() {
    let text = "//! Doc.\n\nuse a; // why\n/* b\nc */\nconst D: &str = \"\ne // f\n\";\n#[cfg(test)]\nmod tests {\n}\n";
    assert_eq!(lines_of_code(&Source::new("x.rs", text)), 4);
}
