//! The Python package: built and installed by pip in a fresh environment, as its users do; then installed into an environment with
//! the packages of its tests, checked and tested there.
//!
//! It has the profile of the tests and the features of their dependencies, so that it shares with them what both need. Only the fresh environment builds:
//! pyo3 depends on the path of the interpreter, and would be compiled again for another.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::command::{Failure, announce, build_dir, cargo, output, program, run};
use crate::packages::PIP_INSTALL;

/// Folder of the package.
const FOLDER: &str = "host/python";
/// What builds it.
const MATURIN: &str = "maturin>=1.9,<2";
/// What checks and tests it, the libraries that read traces, a cluster, and the schema of Kubernetes.
const PACKAGES: [&str; 12] = [
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
    "distributed==2026.8.0",
    "kubernetes-validate==1.37.0",
];
/// Modules of these packages.
const MODULES: &str = "import numpy, pytest, mypy, nbclient, ipykernel, matplotlib, pandas, polars, pyarrow, duckdb, distributed, \
                       kubernetes_validate";
/// The README's example in an environment without other packages, and the version.
const FIRST_USE: &str = "import arcfeed, importlib.metadata as metadata, sys
text = open('host/python/README.md', encoding='utf-8').read()
exec(text.split('```python\\n')[1].split('```')[0])
assert metadata.version('arcfeed') == sys.argv[1], metadata.version('arcfeed')";

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
    if let Err(failure) = install_packages(&environment).and_then(|()| fetch_maturin(&environment)) {
        let message = format!(
            "SKIPPED (loudly): the Python package: {MATURIN}, {} of the Python Package Index cannot be had ({})",
            PACKAGES.join(", "),
            failure.what
        );
        return if std::env::var_os("CI").is_some() {
            Err(Failure::new(message))
        } else {
            Ok(Checked::Skipped(message))
        };
    }
    let wheel = install_fresh()?;
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
    run(python(environment, &PIP_INSTALL).args(PACKAGES))
}

/// Fetches the build requirement, which pip installs anew for each build, into pip's cache.
fn fetch_maturin(environment: &Path) -> Result<(), Failure> {
    let arguments = ["-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps", MATURIN, "--dest"];
    run(python(environment, &arguments).arg(build_dir()?.join("tools/maturin")))
}

/// What `pip install ./host/python` does in a new environment, in its two steps, of which the first leaves the wheel: builds it with
/// the build requirements of the package, and installs it with its requirements. Then the package's README is tried.
fn install_fresh() -> Result<PathBuf, Failure> {
    let [fresh, wheels] = ["tools/python-fresh", "python"].map(|folder| build_dir().map(|build| build.join(folder)));
    let (fresh, wheels) = (fresh?, wheels?);
    for folder in [&fresh, &wheels].into_iter().filter(|folder| folder.exists()) {
        std::fs::remove_dir_all(folder).map_err(|error| Failure::new(format!("{}: {error}", folder.display())))?;
    }
    run(program("python3", &["-m", "venv"]).arg(&fresh))?;
    let pip =
        |words: &[&str]| python(&fresh, &[&["-m", "pip", "--quiet", "--disable-pip-version-check"], words].concat());
    let mut build = pip(&["wheel", "--no-deps"]);
    build.arg("--wheel-dir").arg(&wheels).arg(folder());
    run(build
        .env("CARGO_TARGET_DIR", build_dir()?)
        .env("MATURIN_PEP517_ARGS", "--profile dev --locked --features as-tests"))?;
    let wheel = wheel_in(&wheels)?;
    run(pip(&["install"]).arg(&wheel))?;
    run(&mut python(&fresh, &["-c", FIRST_USE, env!("CARGO_PKG_VERSION")]))?;
    Ok(wheel)
}

/// The wheel in a folder.
fn wheel_in(wheels: &Path) -> Result<PathBuf, Failure> {
    let found = std::fs::read_dir(wheels).into_iter().flatten().flatten().map(|entry| entry.path()).next();
    found.ok_or_else(|| Failure::new(format!("no wheel in {}", wheels.display())))
}

/// Runs the tests; returns how many passed.
fn test(environment: &Path) -> Result<u64, Failure> {
    run(&mut cargo(&["build", "--quiet", "--workspace", "--bin", "arcfeed", "--tests"]))?;
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

/// The environment's Python, in the workspace's root. Bytecode goes into the environment, not beside the sources.
fn python(environment: &Path, arguments: &[&str]) -> Command {
    let mut command = program(environment.join("bin/python"), arguments);
    command.env("PYTHONPYCACHEPREFIX", environment.join("bytecode")).env("MYPYPATH", "").env_remove("PYTHONPATH");
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
