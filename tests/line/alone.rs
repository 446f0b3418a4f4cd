//! Crates used without the rest: a new package outside the workspace depends on one of them by its path, and runs the
//! example of its README.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use arcfeed_tests::{Scratch, root};

/// Use of one crate by a new package.
struct Use {
    /// Folder of the crate.
    folder: &'static str,
    /// Crates of ours that the example names.
    named: &'static [(&'static str, &'static str)],
    /// Last line of the program, which prints a figure.
    print: &'static str,
    /// The line that it must print.
    printed: &'static str,
    /// Most crates in the package's tree, our own included.
    crates_max: usize,
}

const UNITS: (&str, &str) = ("arcfeed-units", "shared/units");

const READER: Use = Use {
    folder: "shared/nc",
    named: &[("arcfeed-nc", "shared/nc"), UNITS],
    print: "println!(\"radius {} mm\", arc.radius_mm());",
    printed: "radius 10 mm\n",
    crates_max: 9,
};
const LAW: Use = Use {
    folder: "firmware/law",
    named: &[("arcfeed-law", "firmware/law"), ("arcfeed-model", "shared/model"), UNITS],
    print: "println!(\"{:.4} mm per tooth\", demand.path_mm_per_tooth);",
    printed: "0.0375 mm per tooth\n",
    crates_max: 20,
};
const PORT: Use = Use {
    folder: "host/port",
    named: &[("arcfeed-port", "host/port")],
    print: "println!(\"{length} bytes\");",
    printed: "2 bytes\n",
    crates_max: 23,
};
const SENDER: Use = Use {
    folder: "host/dnc",
    named: &[("arcfeed-dnc", "host/dnc"), UNITS],
    print: "println!(\"{length} characters\");",
    printed: "4 characters\n",
    crates_max: 32,
};

/// The first example of a README in Rust.
fn example(readme: &str) -> &str {
    let code = readme.split_once("```rust\n").map_or("", |(_, rest)| rest);
    code.split_once("```").map_or("", |(code, _)| code)
}

/// Runs cargo in a package, without the network, in a folder for products that later runs find again.
fn cargo(package: &Path, arguments: &[&str]) -> Output {
    let test = std::env::current_exe().expect("a test knows its own path");
    let target = test.ancestors().nth(3).expect("tests run from target/<profile>/deps").join("alone");
    let mut command = Command::new(env!("CARGO"));
    command.args(arguments).args(["--quiet", "--offline"]).current_dir(package).env("CARGO_TARGET_DIR", target);
    let output = command.output().expect("cargo runs");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    output
}

/// Makes the package, runs it, and counts its crates.
fn check(used: &Use) {
    let name = used.folder.replace('/', "-");
    let scratch = Scratch::new(&format!("alone-{name}"));
    let paths = used.named.iter().map(|(name, folder)| format!("{name}.path = {:?}\n", root().join(folder)));
    let manifest = format!(
        "[package]\nname = \"outside-{name}\"\nedition = \"2024\"\n\n[dependencies]\n{}\n[workspace]\n",
        paths.collect::<String>()
    );
    let folder = PathBuf::from(scratch.path(""));
    scratch.write("Cargo.toml", manifest);
    // The versions that the workspace has, which are there without the network.
    std::fs::copy(root().join("Cargo.lock"), folder.join("Cargo.lock")).expect("a scratch file can be written");
    std::fs::create_dir(folder.join("src")).expect("a scratch folder can be made");
    let readme = std::fs::read_to_string(root().join(used.folder).join("README.md")).expect("a crate has a README");
    let code = example(&readme);
    assert!(code.contains("assert"), "{}: its README has no example", used.folder);
    scratch.write("src/main.rs", format!("fn main() {{\n{code}\n{}\n}}\n", used.print));

    let output = cargo(&folder, &["run"]);
    assert_eq!(String::from_utf8_lossy(&output.stdout), used.printed, "{}", used.folder);
    let tree = cargo(&folder, &["tree", "--edges", "normal,build", "--prefix", "none", "--format", "{p}"]);
    let listing = String::from_utf8_lossy(&tree.stdout);
    let mut crates: Vec<&str> = listing.lines().filter_map(|line| line.split_whitespace().next()).collect();
    crates.sort_unstable();
    crates.dedup();
    // Less the package itself.
    let count = crates.len() - 1;
    let ours = crates.iter().filter(|name| name.starts_with("arcfeed")).count();
    println!("{}: {count} crates, {ours} of them ours; {}", used.folder, used.printed.trim_end());
    assert!(count <= used.crates_max, "{}: {count} crates: {}", used.folder, crates.join(" "));
}

#[test]
fn the_nc_reader_runs_in_a_new_package() {
    check(&READER);
}

#[test]
fn a_feed_law_runs_in_a_new_package() {
    check(&LAW);
}

#[test]
fn a_port_runs_in_a_new_package() {
    check(&PORT);
}

#[test]
fn the_sender_runs_in_a_new_package() {
    check(&SENDER);
}
