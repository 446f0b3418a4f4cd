//! Files that commands write: never over a file that they read, never in place of a link, a device or a FIFO, and whole or not
//! at all when the disk is full or the folder locked.
#![cfg(unix)]

use std::fs::Permissions;
use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt, symlink};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Command, Output};

use arcfeed_tests::{Scratch, arcfeed, root, run, skip_loudly, texts_below};

/// User `nobody` on Debian and most other systems.
const UNPRIVILEGED_USER: u32 = 65_534;

/// The example's job and program as files of a test's own; the job.
fn job(scratch: &Scratch) -> String {
    for name in ["ibr-slot.nc", "job.toml"] {
        let bytes = std::fs::read(root().join("examples/ibr-slot").join(name)).expect("the example");
        scratch.write(name, bytes);
    }
    scratch.path("job.toml")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn read(path: &str) -> Vec<u8> {
    std::fs::read(path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The output is refused with these words, and what is there stays.
fn refused(arguments: &[&str], output: &str, words: &str) {
    let before = read(output);
    let ended = run(arguments);
    let said = stderr(&ended);
    assert_eq!(ended.status.code(), Some(1), "{arguments:?}: {said}");
    assert!(said.contains(words), "{arguments:?}: {said}");
    assert_eq!(read(output), before, "{arguments:?}");
}

#[test]
fn no_command_writes_over_a_file_that_it_reads() {
    let scratch = Scratch::new("over-input");
    let job = job(&scratch);
    let program = scratch.path("ibr-slot.nc");
    let (linked, symbolic) = (scratch.path("hard-link.nc"), scratch.path("symbolic-link.nc"));
    std::fs::hard_link(&program, &linked).expect("a link");
    symlink("ibr-slot.nc", &symbolic).expect("a link");
    let input = "this is the input";
    for output in [&program, &linked, &symbolic, &job] {
        refused(&["adapt", &job, "-o", output], output, input);
        refused(&["adapt", &job, "--report", output], output, input);
        refused(&["simulate", &job, "--report", output], output, input);
        refused(&["stream", &job, "--report", output], output, input);
        refused(&["stream", &job, "--log", output], output, input);
        refused(&["stream", &job, "--executed", output], output, input);
        refused(&["stream", &job, "--journal", output], output, input);
        refused(&["stream", &job, "--port", &format!("spy://sim:?file={output}")], output, input);
        refused(&["serve", &job, "--pty", "--once", "--executed", output], output, input);
        refused(&["verify", &job, "--port", "loop://", "-o", output], output, input);
        refused(&["parameters", &job, "-o", output], output, input);
    }
    refused(&["init", &program, "-o", &linked, "--force"], &linked, input);
    let stl = scratch.path("blank.stl");
    let text = String::from_utf8(read(&job)).expect("text");
    let (before, after) = text.split_once("block = ").expect("the workpiece");
    let after = after.split_once('\n').expect("more").1;
    std::fs::copy(&program, &stl).expect("a file");
    let meshed = scratch.write("meshed.toml", format!("{before}stl = \"blank.stl\"\n{after}"));
    refused(&["simulate", &meshed, "--surface", &stl], &stl, input);
    let cl = scratch.path("path.apt");
    std::fs::copy(root().join("examples/five-axis/tournier-strategy-2.apt"), &cl).expect("the example");
    refused(&["post", &cl, "--machine", "mikron-ucp710", "-o", &cl], &cl, input);
    let both = scratch.path("both");
    let twice = run(&["stream", &job, "--log", &both, "--journal", &both]);
    assert!(twice.status.code() == Some(1) && stderr(&twice).contains("two outputs"), "{}", stderr(&twice));
}

#[test]
fn an_engagement_map_is_not_written_over_the_job_or_the_program() {
    let scratch = Scratch::new("over-engaged");
    job(&scratch);
    let text = std::fs::read(root().join("examples/ibr-slot/job-engaged.toml")).expect("the example");
    let job = scratch.write("job-engaged.toml", text);
    refused(&["engage", &job, "-o", &job], &job, "this is the input");
    let program = scratch.path("ibr-slot.nc");
    refused(&["engage", &job, "-o", &program], &program, "this is the input");
}

#[test]
fn links_are_written_through_and_none_can_be_planted_under_a_temporary_name() {
    let scratch = Scratch::new("links");
    let job = job(&scratch);
    let (victim, target, link) =
        (scratch.write("victim", "mine"), scratch.write("old.nc", "old"), scratch.path("out.nc"));
    symlink(&target, &link).expect("a link");
    symlink(&victim, scratch.path("out.nc.part")).expect("a link");
    symlink(&victim, scratch.path("old.nc.part")).expect("a link");
    assert!(run(&["adapt", &job, "-o", &link]).status.success());
    assert!(Path::new(&link).is_symlink() && read(&target).starts_with(b"%"), "the file behind the link is written");
    assert_eq!(read(&victim), b"mine");
    let nowhere = scratch.path("nowhere.nc");
    symlink(scratch.path("gone.nc"), &nowhere).expect("a link");
    let dangling = run(&["adapt", &job, "-o", &nowhere]);
    assert!(dangling.status.code() == Some(1) && stderr(&dangling).contains("symbolic link"), "{}", stderr(&dangling));
    assert!(!scratch.files().contains(&"gone.nc".to_owned()));
    let folder = run(&["adapt", &job, "-o", &scratch.path("")]);
    assert!(folder.status.code() == Some(1) && stderr(&folder).contains("folder"), "{}", stderr(&folder));
}

#[test]
fn devices_and_fifos_are_written_to_and_stay_what_they_are() {
    let scratch = Scratch::new("devices");
    let job = job(&scratch);
    let null = || std::fs::metadata("/dev/null").expect("it is there").file_type().is_char_device();
    for arguments in [["adapt", &job, "-o", "/dev/null"], ["stream", &job, "--log", "/dev/null"]] {
        assert!(run(&arguments).status.success() && null(), "{arguments:?}");
    }
    for (device, words) in [("/dev/null", "no link, device or folder"), ("/dev/full", "no link, device or folder")] {
        let journal = run(&["stream", &job, "--journal", device]);
        assert!(journal.status.code() == Some(1) && stderr(&journal).contains(words), "{}", stderr(&journal));
        assert!(null());
    }
    let full = run(&["adapt", &job, "-o", "/dev/full"]);
    assert!(full.status.code() == Some(1) && stderr(&full).contains("the disk is full"), "{}", stderr(&full));
    let fifo = scratch.path("fifo");
    assert!(Command::new("mkfifo").arg(&fifo).status().expect("mkfifo runs").success());
    let reader = std::thread::spawn({
        let fifo = fifo.clone();
        move || read(&fifo)
    });
    assert!(run(&["adapt", &job, "-o", &fifo]).status.success());
    assert!(reader.join().expect("the reader ends").starts_with(b"%"));
    assert!(std::fs::metadata(&fifo).expect("it stays").file_type().is_fifo());
}

#[test]
fn permissions_are_kept_and_new_files_have_the_usual_ones() {
    let scratch = Scratch::new("modes");
    let job = job(&scratch);
    let kept = scratch.write("kept.nc", "old");
    let mode = |path: &str| std::fs::metadata(path).expect("it is there").mode() & 0o777;
    for wanted in [0o600, 0o664] {
        std::fs::set_permissions(&kept, Permissions::from_mode(wanted)).expect("a mode");
        assert!(run(&["adapt", &job, "-o", &kept]).status.success());
        assert_eq!((mode(&kept), read(&kept).starts_with(b"%")), (wanted, true));
    }
    let usual = mode(&scratch.write("usual", ""));
    let [new, first] = ["new.nc", "first.toml"].map(|name| scratch.path(name));
    assert!(run(&["adapt", &job, "-o", &new]).status.success());
    assert!(run(&["init", &scratch.path("ibr-slot.nc"), "-o", &first]).status.success());
    assert_eq!([mode(&new), mode(&first)], [usual; 2]);
    std::fs::set_permissions(&kept, Permissions::from_mode(0o444)).expect("a mode");
    refused(&["adapt", &job, "-o", &kept], &kept, "the file is read-only");
    assert_eq!(scratch.files(), ["first.toml", "ibr-slot.nc", "job.toml", "kept.nc", "new.nc", "usual"]);
}

/// `adapt`, `init` and `simulate` into this folder fail with these words, and leave what is there as it is.
fn fails(scratch: &Scratch, folder: &Path, words: &str, command: &dyn Fn(&[&str]) -> Output) {
    let names = || {
        let entries = std::fs::read_dir(folder).expect("a folder");
        let mut names: Vec<_> = entries.map(|entry| entry.expect("an entry").file_name()).collect();
        names.sort();
        names
    };
    let (job, program) = (scratch.path("job.toml"), scratch.path("ibr-slot.nc"));
    let [old, new, first, csv, parquet] =
        ["old.nc", "new.nc", "new.toml", "new.csv", "new.parquet"].map(|name| folder.join(name).display().to_string());
    let before = (names(), read(&old));
    for arguments in [
        ["adapt", &job, "-o", &old],
        ["adapt", &job, "-o", &new],
        ["init", &program, "-o", &first],
        ["simulate", &job, "--trace", &csv],
        ["simulate", &job, "--trace", &parquet],
    ] {
        let ended = command(&arguments);
        assert_eq!(ended.status.code(), Some(1), "{arguments:?}: {}", stderr(&ended));
        assert!(stderr(&ended).contains(words), "{arguments:?}: {}", stderr(&ended));
        assert!((names(), read(&old)) == before, "{arguments:?}: {:?}", names());
    }
}

#[test]
fn a_full_disk_is_said_and_leaves_nothing_new_and_nothing_empty() {
    let scratch = Scratch::new("full");
    job(&scratch);
    let folder = Path::new(&scratch.path("disk")).to_owned();
    std::fs::create_dir(&folder).expect("a folder");
    std::fs::write(folder.join("old.nc"), "old").expect("a file");
    // A limit of one block of 512 or 1024 bytes: the program has more.
    fails(&scratch, &folder, "the disk is full, or a limit of size is reached", &|arguments| {
        let mut shell = Command::new("sh");
        shell.args(["-c", "trap '' XFSZ; ulimit -f 1; exec \"$@\"", "sh"]).arg(arcfeed()).args(arguments);
        shell.output().expect("sh runs")
    });
    let mount = Command::new("mount").args(["-t", "tmpfs", "-o", "size=4k", "tmpfs"]).arg(&folder).output();
    if !mount.is_ok_and(|mount| mount.status.success()) {
        return skip_loudly(
            "a_full_disk_is_said_and_leaves_nothing_new_and_nothing_empty",
            "no small disk can be mounted",
        );
    }
    let ended = std::panic::catch_unwind(|| {
        std::fs::write(folder.join("old.nc"), "old").expect("a file");
        fails(&scratch, &folder, "the disk is full", &|arguments| run(arguments));
    });
    assert!(Command::new("umount").arg(&folder).status().expect("umount runs").success());
    ended.expect("nothing is written to a full disk");
}

#[test]
fn a_folder_that_cannot_be_written_is_named_as_such() {
    let test = "a_folder_that_cannot_be_written_is_named_as_such";
    let scratch = Scratch::new("locked");
    job(&scratch);
    let program = scratch.path("arcfeed");
    std::fs::copy(arcfeed(), &program).expect("a copy that everybody may run");
    let folder = Path::new(&scratch.path("folder")).to_owned();
    std::fs::create_dir(&folder).expect("a folder");
    std::fs::write(folder.join("old.nc"), "old").expect("a file");
    std::fs::set_permissions(folder.join("old.nc"), Permissions::from_mode(0o666)).expect("a mode");
    let is_root = std::fs::metadata(&program).expect("it is there").uid() == 0;
    let as_nobody = |arguments: &[&str]| {
        let mut command = Command::new(&program);
        if is_root {
            command.uid(UNPRIVILEGED_USER).gid(UNPRIVILEGED_USER);
        }
        command.args(arguments).output().expect("arcfeed runs")
    };
    for (mode, words) in [(0o555, "is read-only: write elsewhere"), (0o755, "is locked for this user")] {
        if mode == 0o755 && !is_root {
            skip_loudly(test, "a folder of somebody else takes root to make");
            continue;
        }
        std::fs::set_permissions(&folder, Permissions::from_mode(mode)).expect("a mode");
        fails(&scratch, &folder, words, &as_nobody);
    }
    std::fs::set_permissions(&folder, Permissions::from_mode(0o755)).expect("a mode");
    let nowhere = run(&["adapt", &scratch.path("job.toml"), "-o", &scratch.path("no/such/out.nc")]);
    assert!(stderr(&nowhere).contains("there is no folder"), "{}", stderr(&nowhere));
}

#[test]
fn a_journal_never_takes_the_place_of_another_file() {
    let scratch = Scratch::new("journal-place");
    let job = job(&scratch);
    let kept = "there is a file that is no journal, and it is kept as it is";
    for name in ["notes.txt", "other.toml"] {
        let other = scratch.write(name, "clamp the part at the left\n");
        refused(&["stream", &job, "--journal", &other], &other, kept);
    }
    let journal = scratch.write("empty", "");
    for _ in 0..2 {
        let ended = run(&["stream", &job, "--journal", &journal]);
        assert!(ended.status.success(), "{}", stderr(&ended));
    }
    let old = scratch.write("empty.old", "mine");
    refused(&["stream", &job, "--journal", &journal], &old, kept);
    let link = scratch.path("link");
    symlink(&journal, &link).expect("a link");
    refused(&["stream", &job, "--journal", &link], &journal, "no link, device or folder");
}

#[test]
fn only_one_module_writes_files() {
    let mut found = Vec::new();
    let folders = ["host/src", "host/program/src", "host/adapt/src", "host/port/src", "host/dnc/src"];
    for (path, text) in folders.into_iter().flat_map(texts_below) {
        let writes = ["File::create", "fs::write(", "fs::copy("].iter().any(|call| text.contains(call));
        let is_test =
            path.ends_with("tests.rs") || text.find("mod tests {").is_some_and(|at| !text[..at].contains("fs::write("));
        if writes && !is_test {
            found.push(path.strip_prefix(root()).expect("of the workspace").display().to_string());
        }
    }
    // The port's own way to create the file of a spy, for which the program has another; the folder of `view`, which is removed.
    let others = ["host/src/commands/view/runner.rs", "host/port/src/open.rs"];
    assert_eq!(found, others, "these write past host/src/output.rs");
}
