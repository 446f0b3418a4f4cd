//! The plain build, a newcomer's first: it does the main job, leaves out what is expensive to build, and says of each part
//! that it leaves out how to get it.

use std::path::PathBuf;
use std::process::{Command, Output};
use std::sync::OnceLock;

use arcfeed_tests::root;

const JOB: &str = "examples/ibr-slot/job.toml";

/// Crates that only parts of the feature `full` need.
const LEFT_OUT: [&str; 7] = ["arcfeed-fe", "arcfeed-plan", "defmt-decoder", "httparse", "parquet", "ratatui", "regex"];

fn cargo(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO"));
    command.args(arguments).current_dir(root());
    command
}

/// The names of all crates of the host program, those that only its build needs too.
fn crates(features: &[&str]) -> Vec<String> {
    let arguments = ["tree", "--locked", "--package", "arcfeed", "--edges", "normal,build", "--prefix", "none"];
    let output = cargo(&arguments).args(features).output().expect("cargo runs");
    let listing = String::from_utf8_lossy(&output.stdout);
    let mut names: Vec<String> =
        listing.lines().filter_map(|line| line.split_whitespace().next()).map(str::to_owned).collect();
    names.sort();
    names.dedup();
    names
}

/// Runs the plain build's program. Where the other tests are a release build too, it has a folder of its own, or it would take the
/// place of their program.
fn run(arguments: &[&str]) -> Output {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    let program = PROGRAM.get_or_init(|| {
        let test = std::env::current_exe().expect("a test knows its own path");
        let target = test.ancestors().nth(3).expect("tests run from target/<profile>/deps");
        let is_release = test.starts_with(target.join("release"));
        let folder = if is_release { target.join("plain") } else { target.to_owned() };
        let built = cargo(&["build", "--locked", "--quiet", "--release", "--target-dir"]).arg(&folder).output();
        let built = built.expect("cargo runs");
        let said = String::from_utf8_lossy(&built.stderr);
        assert!(built.status.success(), "the plain arcfeed does not build: {said}");
        // The lints of the workspace see only the build with all features.
        assert!(!said.contains("warning"), "the plain arcfeed builds with warnings: {said}");
        folder.join(format!("release/arcfeed{}", std::env::consts::EXE_SUFFIX))
    });
    Command::new(program).args(arguments).current_dir(root()).output().expect("arcfeed runs")
}

#[test]
fn it_needs_none_of_the_crates_that_only_other_commands_need() {
    let (plain, full) = (crates(&[]), crates(&["--features", "full"]));
    println!("crates to build: {} for the plain program, {} for the full one", plain.len(), full.len());
    for name in LEFT_OUT {
        assert!(full.iter().any(|other| other == name), "{name}: not in the full program either");
        assert!(!plain.iter().any(|other| other == name), "{name}");
    }
}

#[test]
fn it_does_the_main_job() {
    let output = run(&["stream", JOB, "--port", "sim:"]);
    let out = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && out.contains("blocks: 52 sent, 52 executed, no alarm"), "{output:?}");
}

#[test]
fn what_it_leaves_out_says_which_feature_has_it_and_how_to_build_that() {
    let strip = "workpiece.flexible={ block = { from = [-3.0, 6.0, -28.9], to = [3.5, 10.0, -27.2], cells = [2, 2, 2], clamped = \"z-\" }, \
                 material = \"structural steel\", modes = 2, damping = 0.02 }";
    let cases: [(&str, &[&str]); 9] = [
        ("plan", &["plan", "cup-mill", "examples/blisk-19/PART.toml"]),
        ("board-log", &["board", "loop://", "log", "--elf", "image.elf"]),
        ("fe", &["simulate", "examples/ibr-slot/job-cutting.toml", "--set", strip]),
        ("hwgrep", &["ports", "usb"]),
        ("hwgrep", &["stream", JOB, "--port", "hwgrep://usb"]),
        ("parquet", &["simulate", JOB, "--trace", "run.parquet"]),
        ("tui", &["stream", JOB, "--port", "sim:", "--tui"]),
        ("web", &["stream", JOB, "--port", "sim:", "--web"]),
        ("web", &["view"]),
    ];
    for (feature, arguments) in cases {
        let output = run(arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success(), "{arguments:?}");
        for part in ["this arcfeed was built without", &format!("`{feature}`"), "cargo build --release --features full"]
        {
            assert!(message.contains(part), "{arguments:?}: {message}");
        }
    }
}

#[test]
fn its_help_shows_what_it_leaves_out() {
    for (arguments, word) in [
        (&["--help"][..], "plan"),
        (&["--help"], "view"),
        (&["stream", "--help"], "--web"),
        (&["board", "--help"], "log"),
        (&["stream", "--help"], "--tui"),
        (&["ports", "--help"], "REGEXP"),
    ] {
        let output = run(arguments);
        let words = String::from_utf8_lossy(&output.stdout);
        assert!(words.split([' ', '[', ']', '\n']).any(|other| other == word), "{arguments:?}: {words}");
    }
}
