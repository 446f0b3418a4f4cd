//! The Python package: built by pip as its users build it, installed into an environment of its own, checked and tested there.
//!
//! It has the profile of the tests, so that it shares with them what both need in the same form.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::command::{Failure, announce, build_dir, cargo, output, program, run};

/// Folder of the package.
const FOLDER: &str = "host/python";
/// What builds, checks and tests it, and the libraries that read traces.
const PACKAGES: [&str; 11] = [
    "maturin==1.16.0",
    "numpy==2.4.6",
    "pytest==9.2.0",
    "mypy==2.4.1",
    "nbclient==0.11.0",
    "ipykernel==7.4.0",
    "matplotlib==3.11.2",
    "pandas==3.1.1",
    "polars==2.1.0",
    "pyarrow==26.0.1",
    "duckdb==2.0.1",
];
/// Modules of these packages.
const MODULES: &str = "import numpy, pytest, mypy, nbclient, ipykernel, matplotlib, pandas, polars, pyarrow, duckdb";

/// Result of the check: the tests that passed, or why there were none.
pub enum Checked {
    /// Number of tests.
    Passed(u64),
    /// What is missing.
    Skipped(String),
}

/// Builds, installs, checks and tests the package.
///
/// # Errors
/// It does not build, its types or tests fail; in CI also that its packages cannot be had.
pub fn check() -> Result<Checked, Failure> {
    announce("the Python package");
    let environment = build_dir()?.join("tools/python-package");
    if let Err(failure) = install_packages(&environment) {
        let message = format!(
            "SKIPPED (loudly): the Python package: {} of the Python Package Index cannot be had ({})",
            PACKAGES.join(", "),
            failure.what
        );
        return if std::env::var_os("CI").is_some() {
            Err(Failure::new(message))
        } else {
            Ok(Checked::Skipped(message))
        };
    }
    let wheel = build(&environment)?;
    let wheel = wheel.to_string_lossy();
    let install = ["-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--force-reinstall", &wheel];
    run(&mut python(&environment, &install))?;
    run(python(&environment, &["-m", "mypy", "python/arcfeed", "tests"]).current_dir(folder()))?;
    run(&mut python(&environment, &["-m", "mypy.stubtest", "arcfeed._native"]))?;
    test(&environment).map(Checked::Passed)
}

fn install_packages(environment: &Path) -> Result<(), Failure> {
    let mut import = python(environment, &["-c", MODULES]);
    if import.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success()) {
        return Ok(());
    }
    run(program("python3", &["-m", "venv"]).arg(environment))?;
    run(python(environment, &["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]).args(PACKAGES))
}

/// Builds the wheel, as `pip install .` does, into a folder of its own.
fn build(environment: &Path) -> Result<PathBuf, Failure> {
    let wheels = build_dir()?.join("python");
    if wheels.exists() {
        std::fs::remove_dir_all(&wheels).map_err(|error| Failure::new(format!("{}: {error}", wheels.display())))?;
    }
    let mut pip =
        python(environment, &["-m", "pip", "wheel", "--quiet", "--no-build-isolation", "--no-deps", "--no-index"]);
    pip.arg("--wheel-dir").arg(&wheels).arg(folder());
    // maturin is found in the environment, and shares the build directory with the tests.
    let path = std::env::var_os("PATH").unwrap_or_default();
    let paths = std::iter::once(environment.join("bin")).chain(std::env::split_paths(&path));
    let path = std::env::join_paths(paths).map_err(|error| Failure::new(format!("PATH: {error}")))?;
    pip.env("PATH", path).env("CARGO_TARGET_DIR", build_dir()?).env("MATURIN_PEP517_ARGS", "--profile dev --locked");
    run(&mut pip)?;
    let found = std::fs::read_dir(&wheels).into_iter().flatten().flatten().map(|entry| entry.path()).next();
    found.ok_or_else(|| Failure::new(format!("no wheel in {}", wheels.display())))
}

/// Runs the tests; returns how many passed.
fn test(environment: &Path) -> Result<u64, Failure> {
    run(&mut cargo(&["build", "--quiet", "--workspace", "--bin", "arcfeed"]))?;
    let binary = build_dir()?.join(format!("debug/arcfeed{}", std::env::consts::EXE_SUFFIX));
    let mut pytest = python(environment, &["-m", "pytest", "-q", "-p", "no:cacheprovider"]);
    pytest.current_dir(folder()).env("ARCFEED_PROGRAM", binary).env("MPLBACKEND", "agg");
    let printed = output(&mut pytest);
    if let Ok(printed) = &printed {
        print!("{printed}");
    }
    printed.map(|printed| passed(&printed))
}

/// Number of tests that passed, from the last line of pytest: `42 passed, 1 warning in 30.1s`.
fn passed(printed: &str) -> u64 {
    let words: Vec<&str> = printed.lines().next_back().unwrap_or_default().split_whitespace().collect();
    let number = words.windows(2).find(|pair| pair[1].trim_end_matches(',') == "passed").map(|pair| pair[0]);
    number.and_then(|number| number.parse().ok()).unwrap_or_default()
}

/// The environment's Python, in the workspace's root, writing no bytecode beside the sources.
fn python(environment: &Path, arguments: &[&str]) -> Command {
    let mut command = program(environment.join("bin/python"), arguments);
    command.env("PYTHONDONTWRITEBYTECODE", "1").env("MYPYPATH", "").env_remove("PYTHONPATH");
    command
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(FOLDER)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tests_that_passed_are_counted() {
        assert_eq!(passed("....\n42 passed, 1 warning in 30.10s\n"), 42);
        assert_eq!(passed("7 passed in 0.1s\n"), 7);
        assert_eq!(passed(""), 0);
    }
}
