//! Permitted dependencies between crates.

use std::collections::BTreeSet;

use crate::complaints::assert_none;
use crate::manifest::{Entry, array, dependencies, entries, string};
use crate::source::{Source, read, rust_files, rust_files_of, tokens};

/// Each package of the workspace with those it may use.
const ARROWS: [(&str, &[&str]); 9] = [
    ("arcfeed-shared", &[]),
    ("arcfeed-firmware", &["arcfeed-shared"]),
    ("arcfeed-bench", &["arcfeed-shared", "arcfeed-firmware"]),
    ("arcfeed-hil-sim", &["arcfeed-shared", "arcfeed-firmware"]),
    ("arcfeed-line-errors", &[]),
    ("arcfeed-plan", &["arcfeed-shared"]),
    ("arcfeed", &["arcfeed-shared", "arcfeed-firmware", "arcfeed-hil-sim", "arcfeed-line-errors", "arcfeed-plan"]),
    (
        "arcfeed-tests",
        &[
            "arcfeed-shared",
            "arcfeed-firmware",
            "arcfeed-bench",
            "arcfeed-hil-sim",
            "arcfeed-line-errors",
            "arcfeed-plan",
            "arcfeed",
        ],
    ),
    ("xtask", &[]),
];

/// Files or folders in which the host composes the simulator for `sim:`.
const COMPOSITION_ROOT: [&str; 4] =
    ["host/src/commands/stream", "host/src/commands/simulate", "host/src/commands/engage", "host/src/commands/serve"];

/// Lints against panics.
const PANICS: [&str; 4] = ["unwrap_used", "expect_used", "panic", "indexing_slicing"];

/// Name and manifest of each member of the workspace.
fn members() -> Vec<(String, String)> {
    let members: Vec<_> = array(&read("Cargo.toml"), "members")
        .into_iter()
        .map(|folder| read(&format!("{folder}/Cargo.toml")))
        .map(|manifest| (string(&manifest, "package", "name").expect("a package has a name").to_owned(), manifest))
        .collect();
    assert!(!members.is_empty(), "no members in Cargo.toml");
    members
}

/// Dependencies in the manifest of `package` that break the permitted order.
fn against_the_arrows(package: &str, manifest: &str) -> Vec<String> {
    let allowed = ARROWS.iter().find(|(name, _)| *name == package).map_or(&[][..], |(_, allowed)| *allowed);
    let is_ours = |name: &str| ARROWS.iter().any(|(ours, _)| *ours == name);
    let used = dependencies(manifest).into_iter().filter(|name| is_ours(name) && !allowed.contains(name));
    used.map(|name| format!("{package} must not depend on {name}")).collect()
}

/// The sources that name one of the `words`, but for those that start with one of the `exempt` paths.
fn naming<'a>(sources: &'a [Source], words: &[&str], exempt: &[&str]) -> Vec<&'a str> {
    let is_exempt = |source: &Source| {
        let rests = exempt.iter().filter_map(|path| source.path.strip_prefix(path));
        rests.into_iter().any(|rest| rest == ".rs" || rest.starts_with('/'))
    };
    let names_it = |source: &Source| tokens(&source.code).iter().any(|token| words.contains(token));
    sources.iter().filter(|source| !is_exempt(source) && names_it(source)).map(|source| source.path.as_str()).collect()
}

#[test]
fn crates_depend_on_each_other_only_along_the_arrows() {
    let members = members();
    let names: BTreeSet<&str> = members.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(
        names,
        ARROWS.iter().map(|(name, _)| *name).collect(),
        "members of the workspace and packages in ARROWS"
    );
    let complaints: Vec<_> =
        members.iter().flat_map(|(package, manifest)| against_the_arrows(package, manifest)).collect();
    assert_none(&complaints);
}

#[test]
fn the_firmware_is_seen_to_use_shared() {
    let members = members();
    let (_, firmware) = members.iter().find(|(name, _)| name == "arcfeed-firmware").expect("a firmware");
    assert!(dependencies(firmware).contains(&"arcfeed-shared"), "the check of the arrows reads no dependencies");
}

#[test]
fn the_host_names_the_simulator_only_where_it_composes_it() {
    let sources = rust_files("host/src");
    assert_eq!(naming(&sources, &["arcfeed_hil_sim", "hil_sim"], &COMPOSITION_ROOT), [""; 0]);
}

#[test]
fn unsafe_stands_where_no_safe_crate_helps_and_nowhere_else() {
    let folders = [
        "shared/src",
        "firmware/src",
        "firmware/bench/src",
        "hil-sim/src",
        "host/src",
        "host/line-errors/src",
        "host/plan/src",
    ];
    let names_it = |source: &Source| tokens(&source.code).contains(&"unsafe");
    let found: Vec<String> = rust_files_of(&folders).into_iter().filter(names_it).map(|source| source.path).collect();
    assert_eq!(found, ["shared/src/fmath.rs", "host/line-errors/src/lib.rs"]);
    let call = read("host/line-errors/src/lib.rs");
    assert_eq!((call.matches("unsafe {").count(), call.matches("// SAFETY:").count()), (1, 1));
    for (package, manifest) in members() {
        let own = |value| Entry { section: "lints.rust", key: "unsafe_code", value };
        let of_workspace = Entry { section: "lints", key: "workspace", value: "true" };
        let is_exempt = ["arcfeed-shared", "arcfeed-line-errors"].contains(&package.as_str());
        let wanted = if is_exempt { [own("\"deny\""); 2] } else { [own("\"forbid\""), of_workspace] };
        let is_kept_out = entries(&manifest).iter().any(|entry| wanted.contains(entry));
        assert!(is_kept_out, "{package}: its lints do not keep `unsafe` out");
    }
    let forbidden = Entry { section: "workspace.lints.rust", key: "unsafe_code", value: "\"forbid\"" };
    assert!(entries(&read("Cargo.toml")).contains(&forbidden));
}

#[test]
fn what_measures_the_cut_does_not_name_the_firmware() {
    let sources = rust_files("hil-sim/src/cutting");
    assert_eq!(naming(&sources, &["arcfeed_firmware"], &[]), [""; 0]);
}

#[test]
fn crates_for_the_chip_are_no_std() {
    for lib in ["shared/src/lib.rs", "firmware/src/lib.rs"] {
        let source = Source::new(lib, &read(lib));
        assert!(source.code.trim_start().starts_with("#![cfg_attr(not(test), no_std)]"), "{lib}");
    }
}

#[test]
fn crates_for_the_chip_deny_what_panics_and_allow_it_nowhere() {
    for folder in ["shared", "firmware"] {
        let manifest = read(&format!("{folder}/Cargo.toml"));
        for key in PANICS {
            let denied = Entry { section: "lints.clippy", key, value: "\"deny\"" };
            assert!(entries(&manifest).contains(&denied), "{folder}/Cargo.toml lacks {key} = \"deny\"");
        }
        // The one attribute of the crate that speaks of its tests names them, nothing else may.
        for source in rust_files(&format!("{folder}/src")) {
            let code = source.production().lines().filter(|line| !line.starts_with("#![cfg_attr(test,"));
            let code: String = code.collect::<Vec<_>>().join("\n");
            let named = tokens(&code).windows(3).any(|w| w[..2] == ["clippy", "::"] && PANICS.contains(&w[2]));
            assert!(!named, "{} allows what panics", source.path);
        }
    }
}

#[test]
fn an_arrow_that_points_up_is_found() {
    let manifest = "[dev-dependencies]\narcfeed-firmware.workspace = true\n";
    assert_eq!(against_the_arrows("arcfeed-shared", manifest), ["arcfeed-shared must not depend on arcfeed-firmware"]);
}

#[test]
fn only_the_composition_root_and_its_parts_are_exempt() {
    let names_it = |path: &str| Source::new(path, "use arcfeed_hil_sim::simulation; // not: arcfeed_firmware");
    let sources = ["a/serve.rs", "a/serve/board.rs", "a/server.rs", "a/adapt.rs"].map(names_it);
    assert_eq!(naming(&sources, &["arcfeed_hil_sim"], &["a/serve"]), ["a/server.rs", "a/adapt.rs"]);
    assert_eq!(naming(&sources, &["arcfeed_firmware"], &[]), [""; 0]);
}
