//! The order of the modules: each imports only from those declared above it.
//!
//! At the first module where the path of the importing file and the imported path part, both are siblings, and the file
//! that declares them lists the imported one first. What a parent offers its children (`super::Item`) is free.

use std::collections::BTreeMap;

use crate::complaints::assert_none;
use crate::source::{CHIP, HOST, SIMULATOR, Source, rust_files, tokens};

/// Crates with at most one module beside their root: they have no order.
const SINGLE: [&str; 3] = ["shared/units/src", "host/line-errors/src", "host/wasm/src"];

/// Roots of crates, `lib.rs` or `main.rs` in them.
fn roots() -> Vec<&'static str> {
    [&CHIP[..], &SIMULATOR, &HOST, &["tests/xtask/src", "tests/architecture"]].concat()
}

type Path = Vec<String>;

/// The module a file is: `law/step.rs` is `[law, step]`, `law/mod.rs` is `[law]`, the root is `[]`.
fn module_of(source: &Source, root: &str) -> Path {
    let inner = source.path.trim_start_matches(root).trim_start_matches('/').trim_end_matches(".rs");
    let mut path: Path = inner.split('/').map(str::to_owned).collect();
    if matches!(path.last().map(String::as_str), Some("mod" | "lib" | "main")) {
        path.pop();
    }
    path
}

/// Submodules declared in a file, in order.
fn declared(code: &str) -> Vec<String> {
    let tokens = tokens(code);
    tokens.windows(3).filter(|w| w[0] == "mod" && w[2] == ";").map(|w| w[1].to_owned()).collect()
}

/// All paths in the code that begin at the crate, a parent or the module itself, groups expanded.
fn references(code: &str) -> Vec<Path> {
    let tokens = tokens(code);
    let mut found = Vec::new();
    for at in 0..tokens.len() {
        let begins = matches!(tokens[at], "crate" | "super" | "self") && tokens.get(at + 1) == Some(&"::");
        if begins && (at == 0 || tokens[at - 1] != "::") {
            expand(&tokens[at..], &[], &mut found);
        }
    }
    found
}

/// Adds the paths that begin with `prefix` and go on with `tokens`; answers how many tokens they took.
fn expand(tokens: &[&str], prefix: &[String], found: &mut Vec<Path>) -> usize {
    let mut path = prefix.to_vec();
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        if *token == "{" {
            return at + expand_group(&tokens[at..], &path, found);
        }
        path.push((*token).to_owned());
        at += 1;
        if tokens.get(at) != Some(&"::") {
            break;
        }
        at += 1;
    }
    found.push(path);
    at
}

fn expand_group(tokens: &[&str], prefix: &[String], found: &mut Vec<Path>) -> usize {
    let mut at = 1;
    while at < tokens.len() && tokens[at] != "}" {
        at += match tokens[at] {
            "," => 1,
            // `x as y`: the path was x.
            "as" => 2,
            _ => expand(&tokens[at..], prefix, found),
        };
    }
    at + 1
}

/// A path as seen from the crate's root; `self` inside a group is the group's own path.
fn resolve(here: &[String], path: &[String]) -> Path {
    let mut absolute = here.to_vec();
    for segment in path {
        match segment.as_str() {
            "crate" => absolute.clear(),
            "super" => drop(absolute.pop()),
            "self" => {}
            _ => absolute.push(segment.clone()),
        }
    }
    absolute
}

/// Error message if module `here` must not name `target`.
fn complaint(here: &[String], target: &[String], declarations: &BTreeMap<Path, Vec<String>>) -> Option<String> {
    let parting = here.iter().zip(target).take_while(|(a, b)| a == b).count();
    let (own, other) = (here.get(parting)?, target.get(parting)?);
    let siblings = declarations.get(&here[..parting])?;
    let place = |name: &String| siblings.iter().position(|sibling| sibling == name);
    match (place(own), place(other)) {
        (None, _) => Some(format!("module {own} is not declared by its parent")),
        (Some(own), Some(other)) if other < own => None,
        (Some(_), Some(_)) => Some(format!("{own} names {other}, which stands below it")),
        (Some(_), None) => None,
    }
}

/// Submodules that the files of a crate declare, by the module that declares them.
fn declarations_of(root: &str, sources: &[Source]) -> BTreeMap<Path, Vec<String>> {
    let mut declarations: BTreeMap<Path, Vec<String>> = BTreeMap::new();
    for source in sources {
        declarations.entry(module_of(source, root)).or_default().extend(declared(source.production()));
    }
    declarations
}

/// Files below `root` that no file declares as a module: the compiler never sees them.
pub fn undeclared(root: &str, sources: &[Source]) -> Vec<String> {
    let declarations = declarations_of(root, sources);
    let is_declared = |source: &&Source| {
        let mut parent = module_of(source, root);
        parent.pop().is_none_or(|name| declarations.get(&parent).is_some_and(|names| names.contains(&name)))
    };
    sources.iter().filter(|source| !is_declared(source)).map(|source| source.path.clone()).collect()
}

/// Errors in the crate whose sources are in `root`.
fn check(root: &str, sources: &[Source]) -> Vec<String> {
    let declarations = declarations_of(root, sources);
    let mut complaints = Vec::new();
    for source in sources {
        let here = module_of(source, root);
        let code = source.production();
        if declared(code).iter().any(|name| name == "tests") {
            complaints.push(format!("{}: mod tests without #[cfg(test)] above it", source.path));
        }
        for path in references(code) {
            let wrong = complaint(&here, &resolve(&here, &path), &declarations);
            complaints.extend(wrong.map(|what| format!("{}: {what} ({})", source.path, path.join("::"))));
        }
    }
    complaints
}

#[test]
fn a_module_imports_only_from_modules_declared_above_it() {
    let found: Vec<String> = roots().into_iter().flat_map(|root| check(root, &rust_files(root))).collect();
    assert_none(&found);
}

#[test]
fn the_order_is_read_from_every_crate() {
    for root in roots().into_iter().filter(|root| !SINGLE.contains(root)) {
        let sources = rust_files(root);
        let imports: usize = sources.iter().map(|source| references(source.production()).len()).sum();
        let modules: usize = sources.iter().map(|source| declared(source.production()).len()).sum();
        assert!(modules > 1 && imports > 0, "{root}: {modules} modules, {imports} imports between them");
    }
}

#[test]
fn a_file_that_no_module_declares_is_found() {
    let sources = [
        Source::new("x/main.rs", "mod a;\nmod b;"),
        Source::new("x/a/mod.rs", "mod p;"),
        Source::new("x/a/p.rs", ""),
        Source::new("x/a/q.rs", ""),
        Source::new("x/b.rs", "mod r;"),
        Source::new("x/b/r.rs", ""),
        Source::new("x/c.rs", ""),
    ];
    assert_eq!(undeclared("x", &sources), ["x/a/q.rs", "x/c.rs"]);
}

#[test]
fn an_import_from_below_is_found_at_every_depth() {
    let found = check(
        "x",
        &[
            Source::new("x/lib.rs", "pub mod a;\npub mod b;"),
            Source::new("x/a/mod.rs", "pub(crate) mod p;\nmod q;\nuse crate::b::T;\npub struct Own;"),
            Source::new("x/a/p.rs", "use super::{Own, q::{self, R}};\nuse crate::{Lost, a::Own as Mine};"),
            Source::new("x/a/q.rs", "fn f() { super::p::g() }"),
            Source::new("x/b.rs", "use crate::a::q;\n#[cfg(test)]\nmod tests {\nuse super::super::c;\n}"),
        ],
    );
    let expected = [
        "x/a/mod.rs: a names b, which stands below it (crate::b::T)",
        "x/a/p.rs: p names q, which stands below it (super::q::self)",
        "x/a/p.rs: p names q, which stands below it (super::q::R)",
    ];
    assert_eq!(found, expected);
}
