//! Inputs: pieces of real programs, cut, spliced, corrupted and mixed with what readers stumble over.

use std::fs;

use arcfeed_tests::root;
use fastrand::Rng;

/// Words that mean something, and some that nearly do.
const DICTIONARY: [&str; 60] = [
    "G0",
    "G1",
    "G2",
    "G3",
    "G02",
    "G91",
    "G90",
    "G93",
    "G94",
    "G17",
    "G18",
    "G19",
    "G20",
    "G21",
    "G28",
    "G68",
    "G73",
    "G81",
    "G83",
    "G98",
    "G99",
    "G65",
    "G66",
    "M98",
    "M99",
    "M30",
    "X1.",
    "Y-.5",
    "Z0",
    "R-10.",
    "I1.",
    "J",
    "K9",
    "F25.",
    "P1000",
    "L3",
    "#1=#2",
    "#[#1+2]",
    "IF[#1EQ0]GOTO10",
    "WHILE[#1LT5]DO1",
    "END1",
    "GOTO1",
    "DPRNT[X#1[44]]",
    "N10",
    "N99999",
    "O1234",
    "/",
    "/9",
    "%",
    "(",
    ")",
    ";",
    "\n",
    "\r\n",
    "99999999999999999999",
    "0.000000000001",
    "--1",
    "..",
    "[[[[[[",
    "#",
];

/// Makes one input after the other.
#[derive(Debug)]
pub struct Mutator {
    random: Rng,
    corpus: Vec<Vec<u8>>,
}

impl Mutator {
    /// Starts from every program of the repository.
    pub fn new(seed: u64) -> Self {
        let mut corpus = Vec::new();
        for folder in ["tests/corpus", "tests/cases", "examples"] {
            collect(&root().join(folder), &mut corpus);
        }
        assert!(corpus.len() > 3, "no programs to start from");
        Mutator { random: Rng::with_seed(seed), corpus }
    }

    /// The next input, at most some kilobytes.
    pub fn next(&mut self) -> Vec<u8> {
        let mut input = self.piece(600);
        for _ in 0..self.random.u32(0..8) {
            let at = self.random.usize(..=input.len());
            match self.random.u8(..6) {
                0 => self.corrupt(&mut input),
                1 => drop(input.splice(at..at, DICTIONARY[self.random.usize(..DICTIONARY.len())].bytes())),
                2 => {
                    let other = self.piece(80);
                    input.splice(at..at, other);
                }
                3 => input.truncate(at),
                4 => {
                    let to = (at + self.random.usize(..40)).min(input.len());
                    let copy: Vec<u8> = input[at..to].to_vec();
                    input.splice(at..at, copy);
                }
                _ => {
                    let to = (at + self.random.usize(..40)).min(input.len());
                    input.drain(at..to);
                }
            }
        }
        input
    }

    /// Some lines of some program.
    fn piece(&mut self, bytes_max: usize) -> Vec<u8> {
        let program = &self.corpus[self.random.usize(..self.corpus.len())];
        let from = self.random.usize(..=program.len());
        let to = (from + self.random.usize(..bytes_max)).min(program.len());
        program[from..to].to_vec()
    }

    fn corrupt(&mut self, input: &mut [u8]) {
        if !input.is_empty() {
            let at = self.random.usize(..input.len());
            input[at] = if self.random.bool() { self.random.u8(..) } else { input[at] ^ 1 << self.random.u8(..8) };
        }
    }
}

fn collect(folder: &std::path::Path, into: &mut Vec<Vec<u8>>) {
    let mut entries: Vec<_> = fs::read_dir(folder).expect("the folder is there").flatten().map(|e| e.path()).collect();
    // The order of a folder is the file system's: the same seed must give the same inputs everywhere.
    entries.sort();
    for path in entries {
        if path.is_dir() {
            collect(&path, into);
        } else if path.extension().is_some_and(|extension| extension == "nc" || extension == "toml") {
            into.push(fs::read(&path).expect("the file can be read"));
        }
    }
}
