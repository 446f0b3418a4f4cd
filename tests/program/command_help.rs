//! `docs/commands.md`: the help of every command, as the program prints it.

use std::fs;

use arcfeed_tests::{root, run};

const DOCUMENT: &str = "docs/commands.md";
const HEAD: &str = "# Commands

The help of every command. `UPDATE_GOLDEN=1 cargo test -p arcfeed-tests --test program command_help` writes this page from the program.
";

/// The help of a command, in plain text.
fn help(command: &[&str]) -> String {
    let output = run(&[command, &["--help"]].concat());
    assert!(output.status.success(), "{command:?}");
    let text = String::from_utf8(output.stdout).expect("help is UTF-8");
    text.lines().map(str::trim_end).collect::<Vec<_>>().join("\n")
}

/// Names of the commands that a help lists.
fn subcommands(help: &str) -> Vec<String> {
    let listed = help.split_once("\nCommands:\n").map_or("", |(_, rest)| rest);
    let lines = listed.lines().take_while(|line| !line.is_empty());
    // Continued descriptions are indented further than names.
    let names = lines.filter(|line| !line.starts_with("   ")).filter_map(|line| line.split_whitespace().next());
    names.filter(|name| *name != "help").map(str::to_owned).collect()
}

/// Adds a command and its subcommands to the document.
fn add(document: &mut String, command: &[&str]) {
    let text = help(command);
    let title = [&["arcfeed"], command].concat().join(" ");
    let level = "#".repeat(2 + command.len().saturating_sub(1));
    *document += &format!("\n{level} {title}\n\n```text\n{}\n```\n", text.trim_end());
    for subcommand in subcommands(&text) {
        add(document, &[command, &[subcommand.as_str()]].concat());
    }
}

#[test]
fn the_page_of_commands_is_the_help_of_the_program() {
    let mut document = HEAD.to_owned();
    add(&mut document, &[]);
    for command in ["check", "adapt", "simulate", "stream", "board set", "plan cup-mill"] {
        assert!(document.contains(&format!(" arcfeed {command}\n")), "{command}");
    }
    let path = root().join(DOCUMENT);
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        fs::write(&path, &document).expect("the page can be written");
    }
    let written = fs::read_to_string(&path).expect("the page");
    assert!(written == document, "{DOCUMENT} is older than the program: UPDATE_GOLDEN=1 rewrites it");
}
