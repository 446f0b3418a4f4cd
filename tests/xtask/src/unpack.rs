//! Debian's packages unpacked into the build directory, where installing them would remove others or takes rights that are not
//! there: nothing of the system changes, and root is not needed.
//!
//! `tools/bin/PROGRAM` is a script that starts the program with its own libraries; tests look there first.

use std::fs;
use std::path::{Path, PathBuf};

use crate::command::{Failure, announce, build_dir, output, program, run};

/// Names and versions of the packages that would be installed, as `apt-get --simulate` lists them.
fn listed(simulation: &str) -> Vec<String> {
    let entry = |line: &str| {
        let (name, rest) = line.strip_prefix("Inst ")?.split_once(' ')?;
        let (_, rest) = rest.split_once('(')?;
        Some(format!("{name}={}", rest.split([' ', ')']).next()?))
    };
    simulation.lines().filter_map(entry).collect()
}

/// The script that starts a program of an unpacked folder.
fn script(folder: &Path, libraries: &[PathBuf], name: &str) -> String {
    let quoted = |path: &Path| format!("'{}'", path.display());
    let libraries: Vec<String> = libraries.iter().map(|path| path.display().to_string()).collect();
    format!(
        "#!/bin/sh\nLD_LIBRARY_PATH='{}'\"${{LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}}\"\nexport LD_LIBRARY_PATH\nexec {} -L {} \"$@\"\n",
        libraries.join(":"),
        quoted(&folder.join("usr/bin").join(name)),
        quoted(&folder.join("usr/share/qemu")),
    )
}

/// Place of the script of an unpacked program.
///
/// # Errors
/// The operating system does not know where xtask is.
pub fn place(name: &str) -> Result<PathBuf, Failure> {
    Ok(build_dir()?.join("tools/bin").join(name))
}

/// Unpacks a package of QEMU, and what of its dependencies is not installed.
///
/// # Errors
/// It cannot be found, loaded or unpacked.
pub fn unpack(package: &str) -> Result<(), Failure> {
    let tools = build_dir()?.join("tools");
    announce(&format!("unpacking {package} into {}, without installing it", tools.display()));
    let arguments = ["--simulate", "--no-install-recommends", "install", package];
    let wanted = listed(&output(&mut program("apt-get", &arguments))?);
    if wanted.is_empty() {
        return Err(Failure::new(format!("apt-get knows no {package} to load")));
    }
    let (archives, folder) = (tools.join("archives"), tools.join(package));
    let failed = |error: std::io::Error| Failure::new(format!("{}: {error}", tools.display()));
    for new in [&archives, &folder] {
        let _was_not_there = fs::remove_dir_all(new);
        fs::create_dir_all(new).map_err(failed)?;
    }
    let mut download = program("apt-get", &["download"]);
    run(download.args(&wanted).current_dir(&archives))?;
    for archive in fs::read_dir(&archives).map_err(failed)? {
        run(program("dpkg-deb", &["-x"]).arg(archive.map_err(failed)?.path()).arg(&folder))?;
    }
    let script_place = place(package)?;
    fs::create_dir_all(tools.join("bin")).map_err(failed)?;
    fs::write(&script_place, script(&folder, &library_folders(&folder), package)).map_err(failed)?;
    run(program("chmod", &["+x"]).arg(&script_place))
}

/// Folders of libraries, of whatever architecture.
fn library_folders(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for parent in [folder.join("usr/lib"), folder.join("lib")] {
        let entries = fs::read_dir(&parent).into_iter().flatten().flatten().map(|entry| entry.path());
        found.extend(entries.filter(|path| path.to_string_lossy().contains("-linux-gnu")));
    }
    for index in 0..found.len() {
        // PulseAudio's own are one level below.
        found.push(found[index].join("pulseaudio"));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_to_be_loaded_is_read_from_a_simulation() {
        let simulation = "Reading package lists...\nRemv qemu-utils [1:7.2+b1]\nInst libfdt1 (1.6.1-4+b1 Debian:12.14 [amd64])\n\
                          Inst qemu-system-common [1:7.1] (1:7.2+b2 Debian:12.14 [amd64])\nConf libfdt1 (1.6.1-4+b1 Debian:12.14 [amd64])\n";
        assert_eq!(listed(simulation), ["libfdt1=1.6.1-4+b1", "qemu-system-common=1:7.2+b2"]);
        assert_eq!(listed("0 upgraded, 0 newly installed"), [""; 0]);
    }

    #[test]
    fn an_unpacked_program_starts_with_its_own_libraries_and_data() {
        let text = script(Path::new("/b/tools/q"), &[PathBuf::from("/b/tools/q/usr/lib/x86_64-linux-gnu")], "q-arm");
        assert!(text.starts_with("#!/bin/sh\nLD_LIBRARY_PATH='/b/tools/q/usr/lib/x86_64-linux-gnu'"), "{text}");
        assert!(text.ends_with("exec '/b/tools/q/usr/bin/q-arm' -L '/b/tools/q/usr/share/qemu' \"$@\"\n"), "{text}");
    }
}
