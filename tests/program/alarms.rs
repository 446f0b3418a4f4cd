//! Every alarm: raised by a program made to raise it, at its place and nowhere else; listed in `docs/alarms.md`.

use std::collections::BTreeSet;
use std::path::Path;
use std::time::Duration;

use arcfeed::program::{Expansion, Program, RunBounds, Severity};
use arcfeed_nc::alarm::Alarm;
use arcfeed_nc::block::Reading;
use arcfeed_nc::settings::{Preset, Scope, Settings, Tables};
use arcfeed_tests::root;
use arcfeed_units::LengthUnit;

const CORPUS: &str = "tests/corpus/bad";
const TABLE: &str = "docs/alarms.md";
/// Those that the line or the end of what was sent raises, not a block: held by the tests of the control.
const OF_THE_CONTROL: [Alarm; 6] = [
    Alarm::BlockParity,
    Alarm::SequenceNotFound,
    Alarm::LineError,
    Alarm::NotReady,
    Alarm::BufferOverflow,
    Alarm::EndOfRecord,
];

fn text(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Alarm, line, column and name of each program.
fn expected() -> Vec<(u16, usize, usize, String)> {
    let row = |row: &str| {
        let mut fields = row.split([' ', ':']).filter(|field| !field.is_empty());
        let mut number = || fields.next().and_then(|field| field.parse().ok()).expect("a number");
        let (alarm, line, column) = (number(), number(), number());
        (alarm as u16, line, column, fields.next().expect("a name").to_owned())
    };
    text(&format!("{CORPUS}/expected.txt")).lines().map(row).collect()
}

fn read(name: &str) -> Program {
    let path = format!("{CORPUS}/{name}.nc");
    let mut settings = Settings::preset(Preset::Fanuc16i, LengthUnit::Mm, Reading::Strict);
    settings.scope = Scope::Everything;
    let bounds = RunBounds { blocks: 1_000, time: Duration::from_secs(60) };
    let expansion = Expansion { settings, tables: Tables::default(), library: None, keeps_moves: false, bounds };
    Program::run(Path::new(&path), text(&path).as_bytes(), expansion)
}

#[test]
fn each_bad_program_raises_its_alarm_at_its_place_and_no_other() {
    for (alarm, line, column, name) in expected() {
        let found = read(&name).diagnostics;
        let places: Vec<_> = found.iter().map(|found| (found.alarm, found.line, found.column)).collect();
        assert_eq!(places, [(Some(alarm), line, column)], "{name}: {found:#?}");
        assert_eq!(found[0].severity, Severity::Error, "{name}");
        assert!(found[0].end_column > found[0].column, "{name}");
    }
}

#[test]
fn every_alarm_has_a_program_and_every_program_an_entry() {
    let listed: BTreeSet<u16> = expected().into_iter().map(|(alarm, ..)| alarm).collect();
    let alarms = Alarm::ALL.iter().filter(|alarm| !OF_THE_CONTROL.contains(alarm));
    let all: BTreeSet<u16> = alarms.map(|alarm| alarm.number()).collect();
    assert_eq!(listed, all, "alarms of the corpus, alarms of the code");
    let names: BTreeSet<String> = expected().into_iter().map(|(.., name)| name + ".nc").collect();
    let folder = std::fs::read_dir(root().join(CORPUS)).expect("the corpus");
    let files = folder.map(|entry| entry.expect("an entry").file_name().into_string().expect("a name"));
    assert_eq!(files.filter(|name| name.ends_with(".nc")).collect::<BTreeSet<_>>(), names);
    println!("{} programs for {} alarms", names.len(), all.len());
}

#[test]
fn the_numbers_ascend_and_each_alarm_says_what_to_do() {
    assert!(Alarm::ALL.windows(2).all(|pair| pair[0].number() < pair[1].number()));
    for alarm in Alarm::ALL {
        assert!(!alarm.when().is_empty() && !alarm.remedy().is_empty(), "{alarm:?}");
        assert_eq!(alarm.explanation(), format!("{}; {}", alarm.when(), alarm.remedy()));
    }
}

#[test]
fn the_table_of_alarms_is_that_of_the_code() {
    let rows = Alarm::ALL.iter().map(|alarm| {
        let (number, when, remedy) = (alarm.number(), alarm.when(), alarm.remedy());
        format!("| PS{number:04} | {when} | {remedy} |\n")
    });
    let table: String = rows.collect();
    let document = text(TABLE);
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        let head = document.split("| PS").next().expect("a head");
        std::fs::write(root().join(TABLE), format!("{head}{table}")).expect("the table can be written");
        return;
    }
    let found: String =
        document.lines().filter(|line| line.starts_with("| PS")).map(|line| format!("{line}\n")).collect();
    assert_eq!(found, table, "run with UPDATE_GOLDEN=1 and read the difference");
}
