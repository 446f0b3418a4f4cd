//! The commands of the tutorials, run as they stand there: each line that a tutorial shows is in the output, in that order.

use std::fs;
use std::path::Path;
use std::process::Command;

use arcfeed_tests::{Scratch, arcfeed, root};

const FOLDER: &str = "docs/tutorials";
const EXAMPLES: [&str; 2] = ["pocket", "ibr-slot"];
const EXIT_CODE: &str = "# exit code ";

/// A command of a tutorial, and what it shows of the output.
#[derive(Debug, PartialEq)]
struct Shown {
    arguments: Vec<String>,
    exit_code: i32,
    lines: Vec<String>,
}

/// The commands in the blocks of a document that are marked `console`.
fn commands(document: &str) -> Vec<Shown> {
    let mut commands: Vec<Shown> = Vec::new();
    let mut is_console = false;
    for line in document.lines() {
        if let Some(kind) = line.strip_prefix("```") {
            is_console = kind == "console";
        } else if !is_console {
        } else if let Some(command) = line.strip_prefix("$ arcfeed ") {
            let (command, code) = command.split_once(EXIT_CODE).unwrap_or((command, "0"));
            let arguments = command.split_whitespace().map(|part| part.trim_matches('"').to_owned()).collect();
            commands.push(Shown { arguments, exit_code: code.parse().expect("a number"), lines: Vec::new() });
        } else {
            commands.last_mut().expect("a command before its output").lines.push(line.to_owned());
        }
    }
    commands
}

/// A folder with copies of the examples, so that a tutorial can write beside them.
fn workplace(name: &str) -> Scratch {
    let scratch = Scratch::new(name);
    for example in EXAMPLES {
        let folder = Path::new("examples").join(example);
        fs::create_dir_all(scratch.path(&folder.to_string_lossy())).expect("a folder of its own");
        for file in fs::read_dir(root().join(&folder)).expect("the example") {
            let name = folder.join(file.expect("a file").file_name());
            fs::copy(root().join(&name), scratch.path(&name.to_string_lossy())).expect("a copy");
        }
    }
    scratch
}

#[test]
fn every_command_of_the_tutorials_prints_what_they_show() {
    let mut run = 0;
    for tutorial in fs::read_dir(root().join(FOLDER)).expect("the tutorials") {
        let path = tutorial.expect("a file").path();
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let scratch = workplace(&format!("tutorial-{name}"));
        for shown in commands(&fs::read_to_string(&path).expect("text")) {
            let output = Command::new(arcfeed()).args(&shown.arguments).current_dir(scratch.path("")).output();
            let output = output.expect("arcfeed runs");
            let text = [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
            assert_eq!(output.status.code(), Some(shown.exit_code), "{name}: {:?}\n{text}", shown.arguments);
            let mut rest = text.as_str();
            for line in &shown.lines {
                let found = rest.split_once(line.as_str());
                (_, rest) = found.unwrap_or_else(|| panic!("{name}: {:?}: no `{line}` in\n{rest}", shown.arguments));
            }
            run += 1;
        }
    }
    assert!(run >= 10, "{run} commands are not all there are");
}

#[test]
fn a_command_is_read_with_its_exit_code_and_its_lines() {
    let text = "```sh\n$ arcfeed no\n```\n```console\n$ arcfeed check \"A.nc\"   # exit code 1\nA.nc: 1 error\n```\n";
    let arguments = ["check", "A.nc"].map(str::to_owned).to_vec();
    assert_eq!(commands(text), [Shown { arguments, exit_code: 1, lines: vec!["A.nc: 1 error".to_owned()] }]);
}
