//! Permitted dependencies between crates.

use std::collections::BTreeSet;

use crate::complaints::assert_none;
use crate::manifest::{Entry, array, dependencies, entries, string};
use crate::source::{CHIP, HOST, SIMULATOR, Source, read, rust_files, rust_files_of, tokens};

/// Top-level folders in the order of dependence: a crate may use those of its own folder and of the ones before it.
const LAYERS: [&str; 5] = ["shared", "firmware", "hil-sim", "host", "tests"];

/// Crates of the simulator.
const SIMULATOR_CRATES: [&str; 7] = [
    "arcfeed_control",
    "arcfeed_dexel",
    "arcfeed_modal",
    "arcfeed_fe",
    "arcfeed_milling",
    "arcfeed_blades",
    "arcfeed_hil_sim",
];

/// Crates that can be used without the rest, and those of ours that they bring along.
const ALONE: [(&str, &[&str]); 9] = [
    ("arcfeed-units", &[]),
    ("arcfeed-kinematics", &[]),
    ("arcfeed-nc", &["arcfeed-units"]),
    ("arcfeed-compensation", &["arcfeed-nc", "arcfeed-units"]),
    ("arcfeed-law", &["arcfeed-model", "arcfeed-nc", "arcfeed-units"]),
    ("arcfeed-firmware", &["arcfeed-law", "arcfeed-model", "arcfeed-nc", "arcfeed-units"]),
    ("arcfeed-port", &["arcfeed-line-errors", "arcfeed-units"]),
    ("arcfeed-program", &["arcfeed-compensation", "arcfeed-nc", "arcfeed-nc-macro", "arcfeed-units"]),
    ("arcfeed-dnc", &["arcfeed-line-errors", "arcfeed-nc", "arcfeed-port", "arcfeed-units"]),
];

/// Crates that measure the cut: they know no feed law.
const MEASURING: [&str; 5] = ["arcfeed-dexel", "arcfeed-modal", "arcfeed-fe", "arcfeed-milling", "arcfeed-blades"];

/// Files or folders in which the host composes the simulator for `sim:`.
const COMPOSITION_ROOT: [&str; 7] = [
    "host/src/commands/stream",
    "host/src/commands/simulate",
    "host/src/commands/engage",
    "host/src/commands/serve",
    "host/src/commands/measure",
    "host/src/commands/lobes",
    "host/src/commands/plan/earlier_stock",
];

/// Lints against panics.
const PANICS: [&str; 4] = ["unwrap_used", "expect_used", "panic", "indexing_slicing"];

/// A member of the workspace.
struct Member {
    layer: usize,
    name: String,
    manifest: String,
}

fn members() -> Vec<Member> {
    let members: Vec<_> = array(&read("Cargo.toml"), "members")
        .into_iter()
        .map(|folder| {
            let manifest = read(&format!("{folder}/Cargo.toml"));
            let layer = LAYERS.iter().position(|layer| folder.split('/').next() == Some(layer));
            let name = string(&manifest, "package", "name").expect("a package has a name").to_owned();
            Member { layer: layer.unwrap_or_else(|| panic!("{folder} is in no layer")), name, manifest }
        })
        .collect();
    assert!(!members.is_empty(), "no members in Cargo.toml");
    members
}

/// Dependence on a later layer that only unifies features (`as-tests` of `host/python/Cargo.toml`).
const FOR_FEATURES: [&str; 2] = ["arcfeed-python", "arcfeed-tests"];

/// Dependences on a later layer.
fn upward(members: &[Member]) -> Vec<String> {
    let mut complaints = Vec::new();
    for member in members {
        let used = dependencies(&member.manifest);
        let above = members.iter().filter(|other| {
            let is_for_features = [member.name.as_str(), other.name.as_str()] == FOR_FEATURES;
            other.layer > member.layer && used.contains(&other.name.as_str()) && !is_for_features
        });
        complaints.extend(above.map(|other| format!("{} must not depend on {}", member.name, other.name)));
    }
    complaints
}

/// The crates of ours that a crate needs, directly or not, sorted.
fn needed<'a>(members: &'a [Member], name: &str) -> BTreeSet<&'a str> {
    let mut needed = BTreeSet::new();
    let mut open = vec![name.to_owned()];
    while let Some(name) = open.pop() {
        let member = members.iter().find(|member| member.name == name).expect("a member of the workspace");
        let used = dependencies(&member.manifest);
        for other in members.iter().filter(|other| used.contains(&other.name.as_str())) {
            if needed.insert(other.name.as_str()) {
                open.push(other.name.clone());
            }
        }
    }
    needed
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
fn crates_depend_on_their_own_layer_and_those_below() {
    let members = members();
    assert_none(&upward(&members));
    for member in &members {
        println!("{} -> {}", member.name, needed(&members, &member.name).into_iter().collect::<Vec<_>>().join(", "));
    }
}

#[test]
fn what_can_be_used_alone_brings_little_along() {
    let members = members();
    for (name, brought) in ALONE {
        assert_eq!(needed(&members, name), brought.iter().copied().collect(), "{name}");
    }
}

#[test]
fn the_host_names_the_simulator_only_where_it_composes_it() {
    let sources = rust_files_of(&["host/src", "host/program/src", "host/adapt/src"]);
    assert_eq!(naming(&sources, &SIMULATOR_CRATES, &COMPOSITION_ROOT), [""; 0]);
}

#[test]
fn unsafe_stands_where_no_safe_crate_helps_and_nowhere_else() {
    let folders = [&CHIP[..], &SIMULATOR, &HOST, &["firmware/bench/src"]].concat();
    let names_it = |source: &Source| tokens(&source.code).contains(&"unsafe");
    let found: Vec<String> = rust_files_of(&folders).into_iter().filter(names_it).map(|source| source.path).collect();
    let pointers_of_c = ["firmware/c/src/exports.rs", "firmware/c/src/exports/tests.rs"];
    // Names of functions for a page, and the declaration of one of its own: no block.
    let of_page = "host/wasm/src/lib.rs";
    let wanted =
        [&["shared/units/src/fmath.rs"], &pointers_of_c[..], &["host/line-errors/src/lib.rs", of_page]].concat();
    assert_eq!(found, wanted);
    assert!(!read(of_page).contains("unsafe {"));
    let call = read("host/line-errors/src/lib.rs");
    assert_eq!((call.matches("unsafe {").count(), call.matches("// SAFETY:").count()), (1, 1));
    for Member { name: package, manifest, .. } in members() {
        let own = |value| Entry { section: "lints.rust", key: "unsafe_code", value };
        let of_workspace = Entry { section: "lints", key: "workspace", value: "true" };
        let is_exempt =
            ["arcfeed-units", "arcfeed-c", "arcfeed-line-errors", "arcfeed-wasm"].contains(&package.as_str());
        let wanted = if is_exempt { [own("\"deny\""); 2] } else { [own("\"forbid\""), of_workspace] };
        let is_kept_out = entries(&manifest).iter().any(|entry| wanted.contains(entry));
        assert!(is_kept_out, "{package}: its lints do not keep `unsafe` out");
    }
    let forbidden = Entry { section: "workspace.lints.rust", key: "unsafe_code", value: "\"forbid\"" };
    assert!(entries(&read("Cargo.toml")).contains(&forbidden));
}

#[test]
fn what_measures_the_cut_knows_no_law() {
    let members = members();
    for name in MEASURING {
        let needed = needed(&members, name);
        assert!(!needed.contains("arcfeed-law") && !needed.contains("arcfeed-firmware"), "{name}: {needed:?}");
    }
}

#[test]
fn crates_for_the_chip_are_no_std() {
    for folder in CHIP {
        let lib = format!("{folder}/lib.rs");
        let source = Source::new(&lib, &read(&lib));
        assert!(source.code.lines().any(|line| line == "#![cfg_attr(not(test), no_std)]"), "{lib}");
    }
}

#[test]
fn crates_for_the_chip_deny_what_panics_and_allow_it_nowhere() {
    for sources in CHIP {
        let folder = sources.trim_end_matches("/src");
        let manifest = read(&format!("{folder}/Cargo.toml"));
        for key in PANICS {
            let denied = Entry { section: "lints.clippy", key, value: "\"deny\"" };
            assert!(entries(&manifest).contains(&denied), "{folder}/Cargo.toml lacks {key} = \"deny\"");
        }
        // The one attribute of the crate that speaks of its tests names them, nothing else may.
        for source in rust_files(sources) {
            let code = source.production().lines().filter(|line| !line.starts_with("#![cfg_attr(test,"));
            let code: String = code.collect::<Vec<_>>().join("\n");
            let named = tokens(&code).windows(3).any(|w| w[..2] == ["clippy", "::"] && PANICS.contains(&w[2]));
            assert!(!named, "{} allows what panics", source.path);
        }
    }
}

#[test]
fn a_dependence_on_a_later_layer_is_found() {
    let member =
        |layer, name: &str, manifest: &str| Member { layer, name: name.to_owned(), manifest: manifest.to_owned() };
    let low = member(0, "low", "[dev-dependencies]\nhigh.workspace = true\n");
    let members = [low, member(1, "high", "[dependencies]\nlow.workspace = true\n")];
    assert_eq!(upward(&members), ["low must not depend on high"]);
    assert_eq!(needed(&members, "high"), BTreeSet::from(["high", "low"]));
}

#[test]
fn only_the_composition_root_and_its_parts_are_exempt() {
    let names_it = |path: &str| Source::new(path, "use arcfeed_hil_sim::simulation; // not: arcfeed_firmware");
    let sources = ["a/serve.rs", "a/serve/board.rs", "a/server.rs", "a/adapt.rs"].map(names_it);
    assert_eq!(naming(&sources, &["arcfeed_hil_sim"], &["a/serve"]), ["a/server.rs", "a/adapt.rs"]);
    assert_eq!(naming(&sources, &["arcfeed_firmware"], &[]), [""; 0]);
}
