//! Flash, RAM and stack of the image, compared with their budgets.

use std::fs;
use std::slice;

use crate::elf::{Elf, Section};
use crate::figures;
use arcfeed_tests::emulation::images::image;
use arcfeed_tests::emulation::log::messages;
use arcfeed_tests::emulation::qemu::run;

/// Bytes that an image may take: program with its constants; variables; stack, interrupts included.
const FLASH_MAX: u32 = 53 * 1024;
const RAM_MAX: u32 = 4 * 1024 + 768;
const STACK_MAX: u32 = 12 * 1024 + 768;
/// Bytes of stack of the tick itself.
const TICK_STACK_MAX: u32 = 320;

/// Address of the RAM of both boards.
const RAM: u32 = 0x2000_0000;
/// The recorded run stands for the encoders: no part of the controller.
const NOT_COUNTED: &str = ".recorded_run";

/// Bytes in flash and in RAM, without a section of this name.
pub fn sizes(elf: &Elf<'_>, without: &str) -> (u32, u32) {
    let counted = |section: &&Section<'_>| section.is_loaded() && section.name != without;
    let in_ram = |section: &Section<'_>| section.address >= RAM;
    let sections = || elf.sections.iter().filter(counted);
    // Initial values lie in flash too.
    let flash = sections().filter(|section| section.has_content()).map(|section| section.size).sum();
    let ram = sections().filter(|section| in_ram(section)).map(|section| section.size).sum();
    (flash, ram)
}

/// The number before `bytes` in a line that starts with `name`.
fn bytes(lines: &[String], name: &str) -> u32 {
    let line = lines.iter().find(|line| line.contains(name)).unwrap_or_else(|| panic!("no {name} in {lines:?}"));
    let numbers: Vec<u32> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    numbers[0]
}

#[test]
fn flash_ram_and_stack_stay_within_their_budgets() {
    let file = fs::read(image("example-run")).expect("the image is there");
    let (flash, ram) = sizes(&Elf::parse(&file), NOT_COUNTED);
    let stack = bytes(&messages(&file, &run("example-run").console), "stack:");
    let figures: Vec<String> = figures::text().lines().map(str::to_owned).collect();
    // The law that takes most.
    let stacks = figures.iter().filter(|line| line.starts_with("stack-"));
    let tick_stack = stacks.map(|line| bytes(slice::from_ref(line), "stack-")).max().expect("the stack was measured");
    for (name, used, max) in [
        ("flash", flash, FLASH_MAX),
        ("RAM", ram, RAM_MAX),
        ("stack", stack, STACK_MAX),
        ("tick's stack", tick_stack, TICK_STACK_MAX),
    ] {
        println!("{name}: {used} of {max} bytes");
        assert!(used > 0 && used <= max, "{name}: {used} of {max} bytes");
    }
}

/// Bytes that the whole board may take, with its rings, its queues, its jobs and, behind a tap, the tap with its reader of NC text
/// and the 16 KiB that stand for the page of flash with its parameters, which a chip reads in place: flash and RAM.
const BOARDS: [(&str, u32, u32); 2] = [("feedboard", 117 * 1024, 39 * 1024), ("feedboard-tap", 195 * 1024, 80 * 1024)];

#[test]
fn whole_boards_stay_within_their_budgets() {
    for (name, flash_max, ram_max) in BOARDS {
        let file = fs::read(image(name)).expect("the image is there");
        let (flash, ram) = sizes(&Elf::parse(&file), NOT_COUNTED);
        println!("{name}: {flash} of {flash_max} bytes of flash, {ram} of {ram_max} of RAM");
        assert!(flash > 0 && flash <= flash_max, "{name}: {flash} of {flash_max} bytes of flash");
        assert!(ram > 0 && ram <= ram_max, "{name}: {ram} of {ram_max} bytes of RAM");
    }
}
