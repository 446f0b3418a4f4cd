//! Units: conversion factors in one file, and a unit in the name of every public field and parameter that is a float.

use crate::complaints::assert_none;
use crate::source::{CHIP, SIMULATOR, Source, rust_files_of, tokens};

/// The one place for conversion factors.
const UNITS: &str = "shared/units/src/lib.rs";

/// Millimetres in an inch, seconds in a minute, thousandths, milliseconds in a minute, nanometres in an inch.
const FLOAT_FACTORS: [f64; 5] = [25.4, 60.0, 1_000.0, 60_000.0, 25_400_000.0];

/// Whole numbers that are nothing but conversions. 60 and 1000 may be counts.
const WHOLE_FACTORS: [f64; 2] = [60_000.0, 25_400_000.0];

/// Functions of plain numbers, which have no unit.
const MATHS: &str = "shared/units/src/fmath.rs";

/// Endings of names that carry a unit.
const SUFFIXES: [&str; 27] = [
    // The length of a control whose unit does not matter.
    "_units",
    "_mm",
    "_mm2",
    "_mm3",
    "_mm_per_min",
    "_mm_per_s",
    "_mm_per_s2",
    "_mm_per_s3",
    "_mm_per_tooth",
    "_rad",
    "_deg",
    "_us",
    "_ms",
    "_s",
    "_ratio",
    "_percent",
    "_percent_per_s",
    "_per_min",
    "_n",
    "_w",
    "_hz",
    "_mpa",
    "_n_per_mm",
    "_n_m",
    "_kg",
    "_kg_per_m3",
    "_per_s2",
];

/// Whether a number in the code is a conversion factor, in any spelling.
fn is_factor(token: &str) -> bool {
    let plain = token.replace('_', "");
    if plain.starts_with("0x") || plain.starts_with("0b") || plain.starts_with("0o") {
        return false;
    }
    let digits = plain.find(['f', 'i', 'u']).map_or(plain.as_str(), |suffix| &plain[..suffix]);
    let is_float = plain.contains(['.', 'e', 'E', 'f']);
    let value: f64 = digits.parse().unwrap_or_else(|_| panic!("not a number: {token}"));
    if is_float { FLOAT_FACTORS.contains(&value) } else { WHOLE_FACTORS.contains(&value) }
}

/// The conversion factors in a file's code, with their lines.
fn factors(source: &Source) -> Vec<String> {
    let mut found = Vec::new();
    for (index, line) in source.production().lines().enumerate() {
        let numbers = tokens(line).into_iter().filter(|token| token.starts_with(|c: char| c.is_ascii_digit()));
        found.extend(
            numbers.filter(|token| is_factor(token)).map(|token| format!("{}:{}: {token}", source.path, index + 1)),
        );
    }
    found
}

/// Public float fields of a file: `pub name: f32,`.
fn float_fields(source: &Source) -> Vec<&str> {
    let tokens = tokens(source.production());
    let is_field =
        |w: &&[&str]| w[0] == "pub" && w[2] == ":" && matches!(w[3], "f32" | "f64") && matches!(w[4], "," | "}");
    tokens.windows(5).filter(is_field).map(|w| w[1]).collect()
}

/// Float parameters of a file's public functions.
fn float_parameters(source: &Source) -> Vec<&str> {
    let tokens = tokens(source.production());
    let mut names = Vec::new();
    for at in 0..tokens.len() {
        let head = tokens[at..].iter().take_while(|token| !matches!(**token, "(" | "{" | ";" | "=")).count();
        if tokens[at] == "pub" && tokens[at..at + head].contains(&"fn") {
            names.extend(float_names(&tokens[at + head..]));
        }
    }
    names
}

/// Names of type float in a parenthesis that opens with the first token.
fn float_names<'a>(tokens: &[&'a str]) -> Vec<&'a str> {
    let mut depth = 0;
    let mut names = Vec::new();
    for w in tokens.windows(4) {
        match w[0] {
            "(" => depth += 1,
            ")" => depth -= 1,
            name if w[1] == ":" && matches!(w[2], "f32" | "f64") && matches!(w[3], "," | ")") => names.push(name),
            _ => {}
        }
        if depth == 0 {
            break;
        }
    }
    names
}

fn carries_unit(name: &str) -> bool {
    SUFFIXES.iter().any(|suffix| name.ends_with(suffix))
}

/// Sources of the crates whose numbers are physics.
fn sources_with_physics() -> Vec<Source> {
    rust_files_of(&[&CHIP[..], &SIMULATOR].concat())
}

#[test]
fn conversion_factors_stand_only_in_units() {
    let sources = sources_with_physics();
    let (units, others): (Vec<Source>, Vec<Source>) = sources.into_iter().partition(|source| source.path == UNITS);
    let in_units: Vec<String> = units.iter().flat_map(factors).collect();
    assert!(in_units.len() >= 3, "the check finds too little where the factors are: {in_units:?}");
    assert_none(&others.iter().flat_map(factors).collect::<Vec<_>>());
}

#[test]
fn public_float_fields_carry_a_unit() {
    let sources = sources_with_physics();
    let fields = || sources.iter().flat_map(|source| float_fields(source).into_iter().map(|name| (&source.path, name)));
    assert!(fields().count() > 0, "no public float field anywhere");
    let bare: Vec<String> =
        fields().filter(|(_, name)| !carries_unit(name)).map(|(path, name)| format!("{path}: {name}")).collect();
    assert_none(&bare);
}

#[test]
fn public_float_parameters_carry_a_unit() {
    let sources: Vec<Source> = sources_with_physics().into_iter().filter(|source| source.path != MATHS).collect();
    let parameters =
        || sources.iter().flat_map(|source| float_parameters(source).into_iter().map(|name| (&source.path, name)));
    assert!(parameters().count() > 0, "no public float parameter anywhere");
    // A parameter may be the unit itself: `from_mm(mm)`.
    let bare = parameters().filter(|(_, name)| !carries_unit(&format!("_{name}")));
    assert_none(&bare.map(|(path, name)| format!("{path}: {name}")).collect::<Vec<_>>());
}

#[test]
fn a_bare_parameter_is_found() {
    let text = "pub const fn f(&self, mut feed: f32, g: (u8, u8), path_mm: f64) -> f32 { h(|x: f32| x) }\n\
                fn private(x: f32) {}\npub struct S { x: f64, y: u8 }\nfn p(x: f32, y: u8) {}";
    assert_eq!(float_parameters(&Source::new("x.rs", text)), ["feed", "path_mm"]);
}

#[test]
fn a_factor_is_found_in_every_spelling_and_only_there() {
    let text = "let x = 25.4 + 60.0_f32 + 1e3 + 60f64 + 60_000u32 + 25_400_000; // 25.4\nlet y = \"60.0\";";
    assert_eq!(factors(&Source::new("x.rs", text)).len(), 6);
    let innocent = "let x = [60, 1_000, 6.0, 0x60]; x.60; 0..60; 160.0";
    assert_eq!(factors(&Source::new("x.rs", innocent)), [""; 0]);
}

#[test]
fn a_bare_field_is_found_and_a_newtype_is_none() {
    let text = "pub struct A { pub feed: f32, pub path_mm: f64 }\npub struct B(pub f32);\npub const C: f64 = 1.0;";
    assert_eq!(float_fields(&Source::new("x.rs", text)), ["feed", "path_mm"]);
    assert!(!carries_unit("feed") && !carries_unit("mm") && carries_unit("path_mm"));
}
