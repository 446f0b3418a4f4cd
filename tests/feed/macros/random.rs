//! Random programs: what is written back runs as the adapted blocks do, and what is refused has a reason.

use std::collections::{BTreeMap, BTreeSet};

use arcfeed_nc::reader::Reader;
use arcfeed_nc_macro::stack::SourceLine;
use arcfeed_tests::{Scratch, of_full_set};
use arcfeed_units::Nm;

use super::programs::{RandomProgram, random};
use super::reference::{Executed, feed, on_the_control, plain_moves, run};
use super::{Case, JOB};

/// Programs that also run on the simulated control.
const ON_THE_CONTROL: usize = 8;

/// Feeds of a line in the blocks as adapted, and whether its text had to change in one of them.
#[derive(Default)]
struct Line {
    feeds: BTreeSet<Option<Nm>>,
    is_changed: bool,
}

/// Checks that each refused line has a reason: its F word has to change, and it has two feeds or stands in the library.
fn assert_justified(case: &Case, before: &[Executed], seed: u64) {
    let Err(refusal) = &case.written else { return };
    let [old, new] = case.expanded();
    let (mut reader, mut executed) = (Reader::with(case.file.nc, case.file.tables), before.iter());
    let mut lines: BTreeMap<SourceLine, Line> = BTreeMap::new();
    for (old, new) in old.lines().zip(new.lines()) {
        let Some(segment) = reader.read(new.as_bytes()).expect("no fault").segment else { continue };
        let line = lines.entry(executed.next().expect("a move").place).or_default();
        line.feeds.insert(feed(&segment));
        line.is_changed |= old != new;
    }
    for message in refusal.lines() {
        let number = message.split(':').nth(1).and_then(|number| number.parse().ok()).expect("file:line:column");
        let own = lines.get(&SourceLine { library: None, line: number });
        let has_two = own.is_some_and(|line| line.is_changed && line.feeds.len() > 1);
        let of_library = || lines.iter().any(|(place, line)| place.library.is_some() && line.is_changed);
        assert!(has_two || (message.contains("library") && of_library()), "seed {seed}: {message}\n{}", case.text);
    }
}

#[test]
fn written_back_programs_run_like_the_adapted_blocks_and_refused_ones_need_two_feeds() {
    let (mut written, mut changed, mut refused, mut moves, mut governed, mut on_control) = (0, 0, 0, 0, 0, 0);
    for seed in 0..of_full_set(1_000, 100) {
        let RandomProgram { text, library } = random(seed);
        let scratch = Scratch::new("macros-random");
        let mode = if seed % 5 == 0 { "rewrite-only" } else { "safe-base" };
        let job = format!("{JOB}[override]\nmode = \"{mode}\"\n");
        let case =
            Case::new(&scratch, &text, &library, &job).unwrap_or_else(|error| panic!("seed {seed}: {error}\n{text}"));
        let [_, adapted] = case.expanded();
        let before = run(&text, &library, &case.file);
        let sent = plain_moves(&adapted, &case.file);
        moves += sent.len();
        governed += case.adapted.blocks.iter().filter(|block| block.demand.is_some()).count();
        // The blocks as executed make the moves of the program.
        assert_eq!(before.len(), sent.len(), "seed {seed}\n{text}\n{adapted}");
        for (one, other) in before.iter().zip(&sent) {
            assert_eq!((one.segment.start, one.segment.end), (other.start, other.end), "seed {seed}\n{text}");
        }
        let Ok(back) = &case.written else {
            refused += 1;
            assert_justified(&case, &before, seed);
            continue;
        };
        written += 1;
        changed += usize::from(*back != text);
        let after = run(back, &library, &case.file);
        assert_eq!(after.len(), sent.len(), "seed {seed}");
        for ((one, other), was) in after.iter().zip(&sent).zip(&before) {
            assert_eq!(one.place, was.place, "seed {seed}");
            assert_eq!(one.segment, *other, "seed {seed}, {:?}\n{text}\n{back}", one.place);
            assert!(feed(&one.segment) <= feed(other), "seed {seed}");
        }
        if *back != text && on_control < ON_THE_CONTROL {
            on_control += 1;
            let (blocks, feeds) = on_the_control(back, &library);
            let (plain_blocks, plain_feeds) = on_the_control(&adapted, &[]);
            assert_eq!(blocks, plain_blocks, "seed {seed}");
            assert_eq!(feeds, plain_feeds, "seed {seed}");
        }
    }
    println!(
        "{written} programs written back ({changed} of them changed), {refused} refused; {moves} moves, {governed} governed; \
         {on_control} on the control"
    );
    assert!(changed > 15 && refused > 15 && governed > 1_000 && on_control == ON_THE_CONTROL);
}
