//! Selection of the workspace's tests: all of them, the short ones, or one part of several.

use std::collections::BTreeSet;

use crate::command::{Failure, cargo, output};

/// The test programs, those that take longest first: two start at once, and a long one at the end would leave a core idle.
const PROGRAMS: [&str; 8] = ["linuxcnc", "line", "plan", "board", "feed", "machine", "program", "architecture"];
/// The test programs that `quick` runs.
const QUICK: [&str; 12] = [
    "--lib",
    "--bins",
    "--test",
    "architecture",
    "--test",
    "program",
    "--test",
    "feed",
    "--test",
    "line",
    "--test",
    "machine",
];
/// Parts of test names that `quick` leaves out: tests that run for seconds, or build something first.
const SLOW: [&str; 50] = [
    "alone::",
    "application::",
    "blade::",
    "campaigns::",
    "chips::",
    "compensation::clearance",
    "corners::",
    "cutting_loads::",
    "cutting_stock::",
    "dnc::campaign",
    "dnc::command",
    "dnc::echo",
    "dnc::kill",
    "dnc::resume",
    "dnc::verify",
    "dynamics::",
    "engage::",
    "engaged_arc_oracle::",
    "everyday::",
    "fe::",
    "feed_bounds::no_chip",
    "feed_bounds::tools",
    "fuzz::",
    "instructions::",
    "job_values::values",
    "json_docs::",
    "kinematics::",
    "law_suite::",
    "live_page::",
    "macros::garbage",
    "macros::loops",
    "macros::refusals",
    "one_run::",
    "plain_build::",
    "plunge_law::",
    "program_memory::",
    "published_factors::tests::walking",
    "pyserial::",
    "report_page::",
    "rewrite_only::",
    "screen::a_",
    "serving::",
    "serving_clients::",
    "slurm::",
    "stability::",
    "streaming::",
    "tap::damage",
    "traces::",
    "wire::",
    "with_board::",
];

/// Tests to run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Selection {
    /// Every test once.
    #[default]
    All,
    /// Without the slow ones, and nothing for the chip.
    Quick,
    /// One part of as many as there are runners; together they are all.
    Partition(Partition),
}

/// Part `number` of `parts`, counted from one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Partition {
    number: u64,
    parts: u64,
}

impl Selection {
    /// Reads what stands behind `cargo xtask test`; `None` if it says nothing that is known.
    pub fn read(words: &[&str]) -> Option<Self> {
        match words {
            [] => Some(Selection::All),
            ["quick"] => Some(Selection::Quick),
            ["--partition", part] => Partition::read(part).map(Selection::Partition),
            _ => None,
        }
    }

    /// Whether the chip's image, the boards and the Python package are checked too: only once for all parts.
    pub fn has_others(&self) -> bool {
        match self {
            Selection::All => true,
            Selection::Quick => false,
            Selection::Partition(partition) => partition.is_first(),
        }
    }

    /// The arguments of each `cargo` that runs them.
    ///
    /// # Errors
    /// The tests cannot be built or listed.
    pub fn runs(&self) -> Result<Vec<Vec<String>>, Failure> {
        let words = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
        let all = words(&["test", "--workspace", "--no-fail-fast"]);
        let programs = PROGRAMS.iter().map(|program| vec!["--test", program]).chain([vec!["--lib", "--bins"]]);
        let programs = programs.map(|which| [all.clone(), words(&which)].concat());
        let examples_of_the_docs = [all.clone(), words(&["--doc"])].concat();
        match self {
            Selection::All => Ok(programs.chain([examples_of_the_docs]).collect()),
            Selection::Quick => {
                let skips = SLOW.iter().flat_map(|name| words(&["--skip", name])).collect();
                Ok(vec![[all, words(&QUICK), words(&["--"]), skips].concat()])
            }
            Selection::Partition(partition) => {
                let names = listed()?.into_iter().filter(|name| partition.has(name)).collect();
                // Each program is given the names of all, and leaves out what it does not have.
                let names = [words(&["--", "--exact"]), names].concat();
                let tests = programs.map(|program| [program, names.clone()].concat());
                Ok(tests.chain(partition.is_first().then_some(examples_of_the_docs)).collect())
            }
        }
    }
}

impl Partition {
    /// Reads `2/3`.
    fn read(text: &str) -> Option<Self> {
        let (number, parts) = text.split_once('/')?;
        let (number, parts) = (number.parse().ok()?, parts.parse().ok()?);
        (1..=parts).contains(&number).then_some(Partition { number, parts })
    }

    fn is_first(&self) -> bool {
        self.number == 1
    }

    /// Whether a test is in this part. Only its name decides, so that another test moves none. FNV-1a of its bytes.
    fn has(&self, name: &str) -> bool {
        let hash = name
            .bytes()
            .fold(0xCBF2_9CE4_8422_2325, |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01B3));
        hash % self.parts + 1 == self.number
    }
}

/// The names of all tests but those in documentation. Benchmarks have none, and would take the arguments for theirs.
fn listed() -> Result<BTreeSet<String>, Failure> {
    let mut command = cargo(&["test", "--workspace", "--tests", "--", "--list", "--format", "terse"]);
    let names = output(&mut command)?;
    Ok(names.lines().filter_map(|line| line.strip_suffix(": test")).map(str::to_owned).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_test_is_in_one_part() {
        let parts: Vec<Partition> = (1..=3).map(|number| Partition { number, parts: 3 }).collect();
        let mut sizes = [0; 3];
        for index in 0..3000 {
            let name = format!("dnc::campaign::test_{index}");
            let has: Vec<usize> = (0..3).filter(|at| parts[*at].has(&name)).collect();
            assert_eq!(has.len(), 1, "{name}");
            sizes[has[0]] += 1;
        }
        assert!(sizes.iter().all(|size| (900..1100).contains(size)), "{sizes:?}");
    }

    #[test]
    fn no_test_program_is_left_out() {
        let metadata = output(&mut cargo(&["metadata", "--no-deps", "--format-version", "1", "--offline"])).unwrap();
        assert_eq!(metadata.matches(r#""kind":["test"]"#).count(), PROGRAMS.len());
        for program in PROGRAMS {
            assert!(metadata.contains(&format!(r#""name":"{program}","src_path":"#)), "{program}");
        }
    }

    #[test]
    fn only_a_part_that_there_is_is_read() {
        let part = |number, parts| Some(Selection::Partition(Partition { number, parts }));
        assert_eq!(Selection::read(&["--partition", "2/3"]), part(2, 3));
        assert_eq!(Selection::read(&["--partition", "1/1"]), part(1, 1));
        for wrong in ["0/3", "4/3", "1", "1/0", "a/b", "-1/3", ""] {
            assert_eq!(Selection::read(&["--partition", wrong]), None, "{wrong}");
        }
        assert_eq!(Selection::read(&["fast"]), None);
    }
}
