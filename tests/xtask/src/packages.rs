//! Programs of the operating system that the tests run: present, or installed from Debian's packages; and what
//! `tests/line/wire/decode.py` decodes with, and the programs of others that repairs are compared with, from the Python Package Index, into
//! the build directory; and the packages of npm that build and test the viewer of reports, into its folder.
//!
//! No package is ever removed, and a person at a terminal is asked before anything runs as root.

use std::io::{BufRead, IsTerminal};
use std::path::Path;
use std::process::{Command, Stdio};

use crate::command::{Failure, announce, build_dir, output, program, run};
use crate::unpack;

/// A requirement of the tests, and the package that provides it.
struct Need {
    what: &'static str,
    package: &'static str,
    /// Any of these that ends well shows that it is there.
    shown_by: &'static [&'static [&'static str]],
    elsewhere: &'static str,
    /// Whether it also runs from the build directory.
    runs_unpacked: bool,
    /// Whether the tests that need it skip themselves, with a message, where it is missing.
    is_optional: bool,
}

/// Rights to install packages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rights {
    /// Already root; no question.
    Granted,
    /// As root already; somebody is there to be asked.
    Asked,
    /// By `sudo`, once somebody has agreed.
    AskedForSudo,
    /// Not at all.
    None,
}

const NEEDS: [Need; 9] = [
    Need {
        what: "emulator of the chip",
        package: "qemu-system-arm",
        shown_by: &[&["qemu-system-arm", "--version"]],
        elsewhere: "install QEMU with its Arm target",
        runs_unpacked: true,
        is_optional: false,
    },
    Need {
        what: "compiler of C for the chip",
        package: "gcc-arm-none-eabi",
        shown_by: &[&["arm-none-eabi-gcc", "--version"]],
        elsewhere: "install the Arm GNU toolchain for arm-none-eabi",
        runs_unpacked: false,
        is_optional: false,
    },
    Need {
        what: "pyserial, to talk to",
        package: "python3-serial",
        // Debian's packages are seen by Debian's Python alone, which need not be the first in the path.
        shown_by: &[&["python3", "-c", "import serial.rfc2217"], &["/usr/bin/python3", "-c", "import serial.rfc2217"]],
        elsewhere: "run `python3 -m pip install pyserial`",
        runs_unpacked: false,
        is_optional: false,
    },
    Need {
        what: "valgrind, to check accesses to memory",
        package: "valgrind",
        shown_by: &[&["valgrind", "--version"]],
        elsewhere: "install valgrind",
        runs_unpacked: false,
        is_optional: true,
    },
    Need {
        what: "LinuxCNC, to compare with and to run on",
        package: "linuxcnc-uspace",
        shown_by: &[&["sh", "-c", "command -v rs274"]],
        elsewhere: "install LinuxCNC 2.9",
        runs_unpacked: false,
        is_optional: true,
    },
    Need {
        what: "LinuxCNC's compiler of components",
        package: "linuxcnc-uspace-dev",
        shown_by: &[&["sh", "-c", "command -v halcompile"]],
        elsewhere: "install LinuxCNC 2.9 with its headers",
        runs_unpacked: false,
        is_optional: true,
    },
    Need {
        what: "Slurm, to run campaigns on",
        package: "slurm-wlm",
        shown_by: &[&[
            "sh",
            "-c",
            "PATH=$PATH:/usr/sbin; command -v slurmctld && command -v slurmd && command -v munged && command -v sbatch",
        ]],
        elsewhere: "install Slurm and MUNGE",
        runs_unpacked: false,
        is_optional: true,
    },
    Need {
        what: "a browser for reports",
        package: "chromium-headless-shell",
        shown_by: &[
            &["chromium-headless-shell", "--version"],
            &["chromium", "--version"],
            &["chromium-browser", "--version"],
            &["google-chrome", "--version"],
        ],
        elsewhere: "install Chromium or Chrome",
        runs_unpacked: false,
        is_optional: true,
    },
    Need {
        what: "Node and npm, for the viewer of reports",
        package: "npm",
        shown_by: &[&["sh", "-c", "node --version && npm --version"]],
        elsewhere: "install Node 20 or later with npm",
        runs_unpacked: false,
        is_optional: true,
    },
];

/// Folder of the viewer of reports.
const WEB: &str = "host/web";

/// Arguments of a Python that install packages. Bytecode is left to the first import: most modules are never imported.
pub const PIP_INSTALL: [&str; 6] = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-compile"];

/// Packages of the Python Package Index that scripts of the tests need.
struct PythonNeed {
    what: &'static str,
    packages: &'static [&'static str],
    /// Modules of these packages.
    modules: &'static str,
    /// Whether the tests that need them skip themselves, with a message, where they are missing.
    is_optional: bool,
}

const PYTHON_NEEDS: [PythonNeed; 5] = [
    PythonNeed {
        what: "to decode the link and to read traces with",
        packages: &["cobs==1.2.2", "crc==8.0.0", "duckdb==2.0.1"],
        modules: "cobs.cobs, crc, duckdb",
        is_optional: false,
    },
    PythonNeed {
        what: "to compare nearest points with",
        packages: &["numpy==2.4.6", "scipy==1.17.1", "rtree==1.4.1", "trimesh==5.2.0"],
        modules: "numpy, scipy, rtree, trimesh",
        is_optional: true,
    },
    PythonNeed {
        what: "to compare signed distances with",
        packages: &["numpy==2.4.6", "libigl==2.6.3"],
        modules: "numpy, igl",
        is_optional: true,
    },
    PythonNeed {
        what: "to drop balls with",
        packages: &["numpy==2.4.6", "opencamlib==2023.1.11"],
        modules: "numpy, opencamlib",
        is_optional: true,
    },
    PythonNeed {
        what: "to compare registrations with",
        packages: &["numpy==2.4.6", "open3d-cpu==0.20.0"],
        modules: "numpy, open3d",
        is_optional: true,
    },
];

/// Installs the programs that are missing; may ask a person at a terminal.
///
/// # Errors
/// Not there and not to be had; says what was tried and what to do.
pub fn install_programs() -> Result<(), Failure> {
    NEEDS.iter().map(install_one).fold(Ok(()), Result::and)
}

/// Installs the packages of Python and npm that are missing, into folders of the project.
///
/// # Errors
/// As [`install_programs`].
pub fn install_modules() -> Result<(), Failure> {
    let needs = PYTHON_NEEDS.iter().map(install_python_packages).fold(Ok(()), Result::and);
    if let Err(failure) = install_node_packages() {
        announce(&format!(
            "WITHOUT the packages of npm for the viewer ({}). With npm and the network, run `npm ci` in {WEB}.",
            failure.what
        ));
    }
    needs
}

/// Into the viewer's folder, as its lock file has them; nothing of the packages runs while they are installed.
fn install_node_packages() -> Result<(), Failure> {
    announce("packages of npm for the viewer of reports");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(WEB);
    let (lock, installed) = (folder.join("package-lock.json"), folder.join("node_modules/installed-lock.json"));
    let read = |path: &Path| std::fs::read(path).map_err(|error| Failure::new(format!("{}: {error}", path.display())));
    let wanted = read(&lock)?;
    if read(&installed).is_ok_and(|found| found == wanted) {
        return Ok(());
    }
    run(program("npm", &["ci", "--ignore-scripts", "--no-audit", "--no-fund", "--silent"]).current_dir(&folder))?;
    std::fs::write(&installed, wanted).map_err(|error| Failure::new(format!("{}: {error}", installed.display())))
}

/// Installs LinuxCNC and its compiler of components, if they are missing.
///
/// # Errors
/// As [`install_programs`].
pub fn install_linuxcnc() -> Result<(), Failure> {
    let needs = NEEDS.iter().filter(|need| need.package.starts_with("linuxcnc"));
    needs.map(|need| install_one(&Need { is_optional: false, ..*need })).fold(Ok(()), Result::and)
}

/// Into `tools/python` of the build directory, where `tests/python` looks: no Python of the system is touched, and of what is optional nothing is compiled.
fn install_python_packages(need: &PythonNeed) -> Result<(), Failure> {
    announce(&format!("Python packages {}", need.what));
    let folder = build_dir()?.join("tools/python");
    let mut import = Command::new("python3");
    import.args(["-c", &format!("import {}", need.modules)]).env("PYTHONPATH", &folder);
    if import.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success()) {
        return Ok(());
    }
    let packages = need.packages.join(" ");
    let mut pip = program("python3", &PIP_INSTALL);
    if need.is_optional {
        pip.args(["--only-binary", ":all:"]);
    }
    let failure = match run(pip.arg("--target").arg(&folder).args(need.packages)) {
        Ok(()) => return Ok(()),
        Err(failure) => failure,
    };
    let what = format!(
        "{packages} of the Python Package Index, {}: missing ({}). With pip and the network, run `python3 -m pip install --target {} \
         {packages}`.",
        need.what,
        failure.what,
        folder.display(),
    );
    if need.is_optional {
        announce(&format!("WITHOUT {what}"));
        return Ok(());
    }
    Err(Failure { what, ..failure })
}

fn install_one(need: &Need) -> Result<(), Failure> {
    announce(need.what);
    if is_there(need) {
        return Ok(());
    }
    let installed = install_with_apt(need.package).or_else(|failure| match need.runs_unpacked {
        true => {
            announce(&failure.what);
            unpack::unpack(need.package)
        }
        false => Err(failure),
    });
    let found = match installed {
        Ok(()) if is_there(need) => Ok(()),
        Ok(()) => Err(explain(need, Failure::new("installed, but does not run"))),
        Err(failure) => Err(explain(need, failure)),
    };
    match found {
        Err(failure) if need.is_optional => {
            announce(&format!("WITHOUT {}", failure.what));
            Ok(())
        }
        found => found,
    }
}

fn install_with_apt(package: &str) -> Result<(), Failure> {
    let is_root = output(&mut program("id", &["-u"])).is_ok_and(|id| id.trim() == "0");
    let is_asked = std::io::stdin().is_terminal() && std::env::var_os("CI").is_none();
    let has_sudo =
        || Command::new("sudo").arg("-V").stdout(Stdio::null()).status().is_ok_and(|status| status.success());
    let rights = rights(is_root, is_asked, is_asked && has_sudo());
    let arguments = install_arguments(package);
    match rights {
        Rights::Granted => {}
        Rights::None => return Err(Failure::new(format!("{package} is not installed: that takes root"))),
        Rights::Asked | Rights::AskedForSudo => {
            let words = arguments.join(" ");
            println!("xtask: {package} is missing. Run `apt-get {words}` as root? It removes nothing. [y/N]");
            let mut answer = String::new();
            let read = std::io::stdin().lock().read_line(&mut answer);
            if read.is_err() || !answer.trim().eq_ignore_ascii_case("y") {
                return Err(Failure::new(format!("{package} is not installed: not confirmed")));
            }
        }
    }
    announce(&format!("installing {package}"));
    let _lists_of_yesterday_may_do = run(&mut apt_get(&["update"], rights));
    run(&mut apt_get(&arguments, rights))
}

/// Rights to act as root.
fn rights(is_root: bool, is_asked: bool, has_sudo: bool) -> Rights {
    match (is_root, is_asked, has_sudo) {
        (true, false, _) => Rights::Granted,
        (true, true, _) => Rights::Asked,
        (false, true, true) => Rights::AskedForSudo,
        (false, ..) => Rights::None,
    }
}

/// Installs, and fails where another package would have to go.
fn install_arguments(package: &str) -> [&str; 5] {
    ["install", "-y", "--no-install-recommends", "--no-remove", package]
}

fn is_there(need: &Need) -> bool {
    let ends_well = |words: &&[&str]| {
        let [name, arguments @ ..] = *words else { return false };
        let status = Command::new(name).args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).status();
        status.is_ok_and(|status| status.success())
    };
    need.shown_by.iter().any(ends_well) || need.runs_unpacked && is_unpacked(need.package)
}

fn is_unpacked(package: &str) -> bool {
    let Ok(script) = unpack::place(package) else { return false };
    let status = Command::new(script).arg("--version").stdout(Stdio::null()).status();
    status.is_ok_and(|status| status.success())
}

fn apt_get(arguments: &[&str], rights: Rights) -> Command {
    let non_interactive = "DEBIAN_FRONTEND=noninteractive";
    let mut command = match rights {
        Rights::AskedForSudo => program("sudo", &["env", non_interactive, "apt-get"]),
        Rights::Granted | Rights::Asked | Rights::None => program("env", &[non_interactive, "apt-get"]),
    };
    command.args(arguments);
    command
}

fn explain(need: &Need, failure: Failure) -> Failure {
    let Need { what, package, elsewhere, .. } = need;
    let what = format!(
        "{what}: {package} is missing ({}). On Debian or Ubuntu run `apt-get update && apt-get install --no-remove {package}` as \
         root (where that fails, another package would have to be removed: decide which); elsewhere {elsewhere}.",
        failure.what
    );
    Failure { what, ..failure }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_there_is_noticed() {
        let need = |shown_by| Need {
            what: "x",
            package: "x",
            shown_by,
            elsewhere: "x",
            runs_unpacked: false,
            is_optional: false,
        };
        assert!(is_there(&need(&[&["no-such-program"], &["true"]])));
        assert!(!is_there(&need(&[&["no-such-program"], &["false"]])));
    }

    #[test]
    fn apt_removes_nothing_and_root_is_asked_for_where_somebody_can_answer() {
        for rights in [Rights::Granted, Rights::Asked, Rights::AskedForSudo] {
            let command = format!("{:?}", apt_get(&install_arguments("qemu-system-arm"), rights));
            assert!(command.contains("\"install\" \"-y\"") && command.contains("\"--no-remove\""), "{command}");
            assert_eq!(command.contains("\"sudo\""), rights == Rights::AskedForSudo, "{command}");
        }
        assert_eq!([rights(true, false, false), rights(true, true, true)], [Rights::Granted, Rights::Asked]);
        assert_eq!([rights(false, true, true), rights(false, true, false)], [Rights::AskedForSudo, Rights::None]);
        assert_eq!([rights(false, false, true), rights(false, false, false)], [Rights::None; 2]);
    }

    #[test]
    fn what_cannot_be_installed_is_named_with_what_to_do_by_hand() {
        for need in &NEEDS {
            let Failure { what, code } = explain(need, Failure { what: "that takes root".into(), code: 100 });
            let by_hand = format!("apt-get install --no-remove {}", need.package);
            assert!(what.contains(&by_hand) && what.contains("that takes root") && code == 100, "{what}");
        }
    }
}
