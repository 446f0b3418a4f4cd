//! Everyday programs through `check`, `init`, `adapt`, `simulate` and `stream` to `sim:`, against the table in
//! `tests/corpus/everyday/expected.txt`. No move of an adapted program without macros is faster than programmed.

use std::fmt::Write;
use std::path::Path;
use std::process::Output;

use arcfeed_nc_macro::program::first_macro;
use arcfeed_tests::{Scratch, root, run};
use arcfeed_units::LengthUnit;

use crate::without_job::feeds;

const CORPUS: &str = "tests/corpus/everyday";
/// Least share of the programs that a control runs which come to the end.
const SHARE: f64 = 1.0;

fn text(path: &str) -> String {
    String::from_utf8_lossy(&std::fs::read(root().join(path)).expect("a file of the corpus")).into_owned()
}

/// A program of the index.
struct Entry<'a> {
    name: &'a str,
    control: &'a str,
    unit: &'a str,
    decimals: &'a str,
    runs: bool,
}

impl<'a> Entry<'a> {
    fn read(row: &'a str) -> Self {
        let mut fields = row.split(';');
        let mut next = || fields.next().expect("seven fields");
        let (name, control, unit, decimals, runs) = (next(), next(), next(), next(), next() == "yes");
        Entry { name, control, unit, decimals, runs }
    }

    /// Exit codes of all commands, and the first error.
    fn results(&self, scratch: &Scratch) -> (Vec<i32>, String) {
        let program = scratch.write(self.name, std::fs::read(root().join(CORPUS).join(self.name)).expect("a program"));
        let path = Path::new(&program);
        let [job, out] = ["toml", "out"].map(|ending| path.with_extension(ending).display().to_string());
        let mut control = vec!["--control", self.control, "--decimals", self.decimals];
        let settings = root().join(CORPUS).join(Path::new(self.name).with_extension("settings")).display().to_string();
        if Path::new(&settings).exists() {
            control.extend(["--settings", &settings]);
        }
        let (mut codes, mut first) = (Vec::new(), String::new());
        let mut step = |output: Output| {
            let code = output.status.code().expect("an exit code");
            if code != 0 && first.is_empty() {
                let stderr = String::from_utf8_lossy(&output.stderr);
                let error = stderr.lines().find(|line| line.contains("error")).unwrap_or_default();
                first = error.replace(&program, "").chars().take(150).collect();
            }
            codes.push(code);
        };
        step(run(&[&["check", &program][..], &control].concat()));
        step(run(&[&["init", &program, "-o", &job][..], &control].concat()));
        self.answer(&job);
        // A macro whose executions need different feeds is written out, as the refusal says.
        let adapt = ["adapt", &job, "-o", &out];
        let adapted = run(&adapt);
        let is_expanded = String::from_utf8_lossy(&adapted.stderr).contains("use --expand");
        step(if is_expanded { run(&[&adapt[..], &["--expand"]].concat()) } else { adapted });
        self.assert_not_faster(&program, &out);
        step(run(&["simulate", &job]));
        step(run(&["stream", &job]));
        (codes, first)
    }

    /// Jobs of `init` for end mills raise no feed.
    fn assert_not_faster(&self, program: &str, out: &str) {
        let Ok(adapted) = std::fs::read(out) else { return };
        let original = std::fs::read(program).expect("a program");
        if first_macro(&original).is_some() {
            return;
        }
        let unit = if self.unit == "mm" { LengthUnit::Mm } else { LengthUnit::Inch };
        let [before, after] = [original, adapted].map(|text| feeds(&String::from_utf8_lossy(&text), unit));
        assert_eq!(before.len(), after.len(), "{}", self.name);
        for (before, after) in before.iter().zip(&after).filter(|(before, _)| before.is_some()) {
            assert!(after <= before, "{}: {after:?} above {before:?}", self.name);
        }
    }

    /// Answers what `init` leaves open.
    fn answer(&self, job: &str) {
        let Ok(text) = std::fs::read_to_string(job) else { return };
        let answers = [
            ("units = \"?\"", format!("units = \"{}\"", self.unit)),
            ("diameter = \"?\"", "diameter = \"10 mm\"".into()),
            ("rev_per_min = \"?\"", "rev_per_min = 1000".into()),
        ];
        let text = answers.iter().fold(text, |text, (question, answer)| text.replace(question, answer));
        std::fs::write(job, text).expect("it was just written");
    }
}

#[test]
fn everyday_programs_come_to_the_end_or_are_refused_for_a_reason() {
    let scratch = Scratch::new("everyday");
    let index = text(&format!("{CORPUS}/index.csv"));
    let entries: Vec<Entry<'_>> = index.lines().skip(1).map(Entry::read).collect();
    let (mut table, mut good, mut all) = (String::new(), 0, 0);
    for entry in &entries {
        let (codes, first) = entry.results(&scratch);
        all += usize::from(entry.runs);
        good += usize::from(entry.runs && codes.iter().all(|code| *code == 0));
        let codes: Vec<String> = codes.iter().map(i32::to_string).collect();
        writeln!(table, "{:<34}{} {first}", entry.name, codes.join(" ")).expect("a string takes every line");
    }
    println!("{table}{good} of {all} programs that a control runs come to the end; {} in all", entries.len());
    let table: Vec<&str> = table.lines().map(str::trim_end).collect();
    let expected = text(&format!("{CORPUS}/expected.txt"));
    assert_eq!(table, expected.lines().collect::<Vec<_>>());
    assert!(good as f64 >= SHARE * all as f64, "{good} of {all}");
}
