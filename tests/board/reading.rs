//! Reading NC text on the chip: instructions by themselves and in the tap, room, and that the tap's overrides are those of a
//! controller that is notified of the executed blocks.

use std::fs;
use std::sync::OnceLock;

use arcfeed_tests::emulation::images::{EMULATED, image};
use arcfeed_tests::emulation::log::messages;
use arcfeed_tests::emulation::qemu::run;

use crate::budgets::sizes;
use crate::elf::Elf;
use crate::images::assert_gated;

/// Instructions, median and worst, over the motion blocks of an example, just above what is needed: a block's text to words (the goal
/// is 1100 for a block), to a segment; a character, a block to its segment, all of a block, a position.
const BUDGETS: [(&str, [u32; 2], [u32; 2]); 6] = [
    ("lex", [1_060, 1_180], [560, 940]),
    ("read", [3_450, 3_920], [1_485, 3_040]),
    ("hear", [160, 1_750], [160, 1_750]),
    ("segment", [21_100, 82_500], [8_560, 42_000]),
    ("block", [28_000, 89_200], [11_350, 46_500]),
    ("follow", [1_000, 1_000], [760, 930]),
];
const EXAMPLES: [(&str, u32); 2] = [("ibr-slot", 43), ("pocket", 20)];
/// Bytes: program with its constants, the tap itself, stack of reading and following.
const FLASH_MAX: u32 = 155 * 1024 + 512;
const TAP_MAX: u32 = 26 * 1024;
const STACK_MAX: u32 = 4 * 1024 + 256;
/// The recorded run stands for the encoders and the sender: no part of the tap.
const NOT_COUNTED: &str = ".recorded_run";
/// Ticks per thousand on which the tap's override may differ from the notified controller's, and by how many per cent: at
/// the beginning of a block, which the position shows a moment later.
const OTHER_PER_MILLE_MAX: usize = 4;

fn text() -> &'static str {
    static TEXT: OnceLock<String> = OnceLock::new();
    TEXT.get_or_init(|| run("lex-cost").text())
}

/// Count, median and worst on a line of `lex-cost`.
fn figures(name: &str) -> [u32; 3] {
    let line = text().lines().find(|line| line.split_whitespace().next() == Some(name));
    let words: Vec<&str> = line.unwrap_or_else(|| panic!("no {name} in\n{}", text())).split_whitespace().collect();
    [2, 4, 6].map(|at| words[at].parse().expect("a number"))
}

#[test]
fn reading_a_block_on_the_chip_stays_within_its_budget() {
    print!("{}", text());
    for (kind, slot, pocket) in BUDGETS {
        for ((example, blocks), [median_max, worst_max]) in EXAMPLES.into_iter().zip([slot, pocket]) {
            let [count, median, worst] = figures(&format!("{kind}-{example}"));
            assert!(count >= blocks, "{kind}-{example}: {count} of {blocks}");
            assert!(median <= median_max && worst <= worst_max, "{kind}-{example}: {median}, {worst}");
        }
    }
}

#[test]
fn the_taps_overrides_on_the_chip_are_those_of_a_notified_controller() {
    let (tapped, notified) = (run("tap-run").uart1, run("example-run").uart1);
    assert_eq!(tapped.len(), notified.len());
    let others = tapped.iter().zip(&notified).filter(|(ours, theirs)| ours != theirs).count();
    println!("{others} of {} ticks differ", notified.len());
    assert!(others * 1_000 <= OTHER_PER_MILLE_MAX * notified.len());
    assert!(notified.iter().any(|percent| *percent > 110), "the override is at work");
}

#[test]
fn the_tap_has_its_room_and_no_character_makes_it_panic() {
    let file = fs::read(image("tap-run")).expect("the image is there");
    let (flash, _) = sizes(&Elf::parse(&file), NOT_COUNTED);
    let log = messages(&file, &run("tap-run").console);
    println!("{log:?}");
    let bytes = |name: &str| -> u32 {
        let line = log.iter().find(|line| line.contains(name) && line.ends_with("bytes"));
        let words = line.unwrap_or_else(|| panic!("no {name} in {log:?}")).split_whitespace();
        words.rev().nth(1).and_then(|number| number.parse().ok()).expect("a number")
    };
    for (name, used, max) in
        [("flash", flash, FLASH_MAX), ("tap", bytes("tap:"), TAP_MAX), ("stack", bytes("stack:"), STACK_MAX)]
    {
        println!("{name}: {used} of {max} bytes");
        assert!(used > 0 && used <= max, "{name}: {used} of {max} bytes");
    }
    assert_gated(EMULATED, "tap-run");
}
