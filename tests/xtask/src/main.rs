//! Every test of arcfeed in one command: `cargo xtask test`.
//!
//! ```text
//! target    the chip's Rust target, installed where it is missing        target.rs
//! packages  programs of the system; packages of Python and npm           packages.rs, unpack.rs
//! boards    format, lints and images of each board's workspace           boards.rs
//! firmware  built for the chip; its crates; neither std nor alloc        firmware.rs
//! tests     built beside these, then run, results added up               tally.rs, selection.rs
//! python    the Python package beside the tests: wheel, types, tests     python.rs
//! ```
//!
//! All steps run even after one has failed, those for the chip only if their target is there. The last line of the output
//! is the sum of the tests. Exit code: that of the first step that failed, 2 for a word it does not know.

mod command;

mod target;

mod unpack;

mod packages;

mod selection;

mod python;

mod tally;

mod firmware;

mod boards;

mod soak;

mod linuxcnc;

mod web;

use std::process::ExitCode;
use std::thread;

use command::Failure;
use selection::Selection;
use tally::Tally;

const USAGE: &str = "usage: cargo xtask test    install what is missing, run every test, check the firmware's image
       cargo xtask test quick    the tests that take a moment; nothing for the chip
       cargo xtask test --partition N/M    part N of M of the same as `test`, for M runners side by side
       cargo xtask soak [MINUTES]    the full sets of faults for DNC sender and board link, then corrupted inputs to whatever
                                  reads, MINUTES (10) for each target
       cargo xtask linuxcnc    install LinuxCNC where it is missing, and print the figures of the published slot on it: as
                                  programmed, with F words, and with the component (root)
       cargo xtask web FOLDER [PROFILE]    the start page with arcfeed inside it, as FOLDER/index.html; the profile of cargo
                                  is the shipped one (dist) unless another is given
       cargo xtask help    this text";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["test", selection @ ..] => Selection::read(selection).map_or_else(unknown, |selection| test(&selection)),
        ["soak"] => ended(soak::soak(None)),
        ["soak", minutes] => ended(soak::soak(Some(minutes))),
        ["linuxcnc"] => ended(linuxcnc::figures()),
        ["web", folder] => ended(web::write(folder, web::SHIPPED)),
        ["web", folder, profile] => ended(web::write(folder, profile)),
        ["help"] => {
            println!("{USAGE}");
            ExitCode::SUCCESS
        }
        _ => unknown(),
    }
}

/// Words that say nothing known.
fn unknown() -> ExitCode {
    eprintln!("{USAGE}");
    ExitCode::from(2)
}

/// The exit code of a command of one step.
fn ended(result: Result<(), Failure>) -> ExitCode {
    result.map_or_else(
        |failure| {
            eprintln!("xtask: FAILED: {}", failure.what);
            ExitCode::from(failure.code)
        },
        |()| ExitCode::SUCCESS,
    )
}

/// Runs all steps, then says what failed, what was skipped, and the sum.
fn test(selection: &Selection) -> ExitCode {
    let target = target::install();
    let programs = packages::install_programs();
    let has_chip = target.is_ok() && selection.has_others();
    // The packages, the builds for the chip and that of the tests share no folder, and none keeps all cores busy by itself.
    let ([boards, firmware, modules], built) = thread::scope(|scope| {
        let modules = scope.spawn(packages::install_modules);
        let chip = scope.spawn(|| if has_chip { [boards::check(), firmware::check()] } else { [Ok(()), Ok(())] });
        let built = tally::build();
        let panicked = || Err(Failure::new("a step beside the build of the tests panicked"));
        let [boards, firmware] = chip.join().unwrap_or_else(|_| [panicked(), panicked()]);
        ([boards, firmware, modules.join().unwrap_or_else(|_| panicked())], built)
    });
    let ((mut tally, tests), python) = thread::scope(|scope| {
        let python = selection.has_others().then(|| scope.spawn(python::check));
        let tests = match built {
            Ok(()) => tally::test_workspace(selection),
            Err(failure) => (Tally::default(), Err(failure)),
        };
        let panicked = || Err(Failure::new("the check of the Python package panicked"));
        (tests, python.map(|python| python.join().unwrap_or_else(|_| panicked())))
    });
    let python = python.map_or(Ok(()), |checked| checked.map(|checked| tally.add_python(checked)));
    let steps = [programs, modules, tests, python, target, boards, firmware];
    let failures: Vec<Failure> = steps.into_iter().filter_map(Result::err).collect();
    for failure in &failures {
        eprintln!("xtask: FAILED: {}", failure.what);
    }
    for skipped in &tally.skipped {
        println!("{skipped}");
    }
    println!("{tally}");
    failures.first().map_or(ExitCode::SUCCESS, |failure| ExitCode::from(failure.code))
}
