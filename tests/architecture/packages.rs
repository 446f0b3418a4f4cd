//! What a registry and a newcomer need of each crate that is published.

use std::path::{Component, Path, PathBuf};

use crate::complaints::assert_none;
use crate::manifest::{Entry, array, entries, string};
use crate::source::{read, rust_files};

/// Crates whose README has no example in Rust: the program's is the project's own, the C interface has one in C.
const WITHOUT_EXAMPLE: [&str; 2] = ["arcfeed", "arcfeed-c"];

/// Most keywords that the public registry takes.
const KEYWORDS_MAX: usize = 5;
/// Longest keyword that the public registry takes.
const KEYWORD_MAX: usize = 20;

/// A published crate.
struct Package {
    folder: String,
    name: String,
    manifest: String,
}

/// Members of the workspace without `publish = false`.
fn published() -> Vec<Package> {
    let members = array(&read("Cargo.toml"), "members").into_iter().map(str::to_owned).collect::<Vec<_>>();
    let packages = members.into_iter().map(|folder| {
        let manifest = read(&format!("{folder}/Cargo.toml"));
        let name = string(&manifest, "package", "name").expect("a package has a name").to_owned();
        Package { folder, name, manifest }
    });
    let is_private = |package: &Package| {
        entries(&package.manifest).contains(&Entry { section: "package", key: "publish", value: "false" })
    };
    packages.filter(|package| !is_private(package)).collect()
}

/// Faults of a manifest.
fn faults(manifest: &str) -> Vec<String> {
    let entries = entries(manifest);
    let has = |key: &str| entries.iter().any(|entry| entry.section == "package" && entry.key == key);
    let inherited = ["version", "edition", "rust-version", "license"].map(|key| format!("{key}.workspace"));
    let own = ["description", "categories", "readme"].map(str::to_owned);
    let mut faults: Vec<String> =
        own.iter().chain(&inherited).filter(|key| !has(key)).map(|key| format!("no {key}")).collect();
    let keywords = array(manifest, "keywords");
    if keywords.is_empty() || keywords.len() > KEYWORDS_MAX || keywords.iter().any(|word| word.len() > KEYWORD_MAX) {
        faults.push(format!("keywords: 1 to {KEYWORDS_MAX} of up to {KEYWORD_MAX} characters"));
    }
    faults
}

/// The files that the code of a crate includes and that are not in its own folder: the package would not build.
fn outside(folder: &str, path: &str, text: &str) -> Vec<String> {
    let code = text.split("#[cfg(test)]").next().unwrap_or_default();
    let mut found = Vec::new();
    for (at, _) in code.match_indices("include_str!(\"").chain(code.match_indices("include_bytes!(\"")) {
        let name = code[at..].split('"').nth(1).unwrap_or_default();
        let mut file = PathBuf::from(path);
        file.pop();
        for part in Path::new(name).components() {
            match part {
                Component::ParentDir => drop(file.pop()),
                part => file.push(part),
            }
        }
        if !file.starts_with(folder) {
            found.push(format!("{path} includes {name}"));
        }
    }
    found
}

#[test]
fn published_crates_have_what_a_registry_asks_for() {
    let packages = published();
    assert!(packages.len() > 15, "{}", packages.len());
    let faults = packages.iter().flat_map(|package| {
        faults(&package.manifest).into_iter().map(|fault| format!("{}: {fault}", package.name)).collect::<Vec<_>>()
    });
    assert_none(&faults.collect::<Vec<_>>());
}

#[test]
fn published_crates_begin_with_their_readme_and_its_example_is_run() {
    let mut complaints = Vec::new();
    for Package { folder, name, .. } in published() {
        if WITHOUT_EXAMPLE.contains(&name.as_str()) {
            continue;
        }
        if !read(&format!("{folder}/src/lib.rs")).contains("#![doc = include_str!(\"../README.md\")]") {
            complaints.push(format!("{folder}/src/lib.rs does not include the README"));
        }
        if !read(&format!("{folder}/README.md")).contains("\n```rust") {
            complaints.push(format!("{folder}/README.md has no example"));
        }
    }
    assert_none(&complaints);
}

#[test]
fn published_crates_include_only_their_own_files() {
    let mut complaints = Vec::new();
    for Package { folder, .. } in published() {
        for source in rust_files(&format!("{folder}/src")).iter().filter(|source| !source.production().is_empty()) {
            complaints.extend(outside(&folder, &source.path, &read(&source.path)));
        }
    }
    assert_none(&complaints);
}

#[test]
fn a_missing_key_and_a_file_of_another_folder_are_found() {
    let manifest = "[package]\nname = \"x\"\nversion.workspace = true\nkeywords = [\"a\"]\n";
    let missing = ["description", "categories", "readme", "edition.workspace", "rust-version.workspace"];
    assert_eq!(faults(manifest)[..5], missing.map(|key| format!("no {key}")));
    let text = "const A: &str = include_str!(\"../b.txt\");\nconst C: &[u8] = include_bytes!(\"../../d.bin\");";
    assert_eq!(outside("x", "x/src/e.rs", text), ["x/src/e.rs includes ../../d.bin"]);
}
