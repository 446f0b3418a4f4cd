//! The image for the STM32F405: its gate, its budgets, and as much of it as runs without the chip.
//!
//! QEMU's `netduinoplus2` has this chip's core, memory and timers 2 to 5. Clock control, pins, watchdog and the rest are
//! "unimplemented": they read 0, and QEMU logs what is written. So the crystal never starts, the dial is silent, the lines
//! read back wrong: a board with nothing in order. What it must do then is all that can be seen here.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use arcfeed_tests::root;

use crate::budgets::sizes;
use crate::elf::Elf;
use arcfeed_tests::emulation::images::built;
use arcfeed_tests::emulation::qemu;

use crate::images::assert_gated;

const BOARD: &str = "firmware/boards/stm32f405";
const IMAGE: &str = "feedboard-stm32f405";

/// The heartbeat changes every 100 ticks; so many changes are seen before the emulator is stopped.
const HEARTBEATS: usize = 5;
/// The emulator needs a fraction of a second for that.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Bits of the outputs on port C, as in the board's README.
const LINES: u32 = 0xFF;
const READY: u32 = 1 << 8;
const HEARTBEAT: u32 = 1 << 9;

/// A write to a peripheral that the emulator does not have.
#[derive(Clone, Debug, PartialEq)]
struct Write {
    device: String,
    offset: u32,
    value: u32,
}

fn image() -> PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| built(BOARD)).join(IMAGE)
}

/// `GPIOC: unimplemented device write (size 4, offset 0x018, value 0x000000ff)`.
fn parse(line: &str) -> Option<Write> {
    let (device, rest) = line.split_once(": unimplemented device write (")?;
    let number = |name: &str| {
        let (_, digits) = rest.split_once(&format!("{name} 0x"))?;
        let digits: String = digits.chars().take_while(char::is_ascii_hexdigit).collect();
        u32::from_str_radix(&digits, 16).ok()
    };
    Some(Write { device: device.to_owned(), offset: number("offset")?, value: number("value")? })
}

/// Everything the image writes to missing peripherals until it has ticked long enough; run once.
fn writes() -> &'static [Write] {
    static WRITES: OnceLock<Vec<Write>> = OnceLock::new();
    WRITES.get_or_init(emulated)
}

fn emulated() -> Vec<Write> {
    let log = image().with_file_name(format!("run-{IMAGE}-{}", std::process::id()));
    let mut qemu = Command::new(qemu::emulator());
    qemu.args(["-machine", "netduinoplus2", "-display", "none", "-monitor", "none", "-serial", "none"]);
    qemu.args(["-icount", "shift=3,sleep=off", "-d", "unimp", "-D"]).arg(&log).arg("-kernel").arg(image());
    let mut child = qemu::spawn(qemu.stdin(Stdio::null()));
    let started = Instant::now();
    let writes = loop {
        std::thread::sleep(Duration::from_millis(100));
        let text = fs::read_to_string(&log).unwrap_or_default();
        let writes: Vec<Write> = text.lines().filter_map(parse).collect();
        if heartbeats(&writes) >= HEARTBEATS {
            break writes;
        }
        let ended = child.try_wait().expect("the emulator can be waited for");
        if ended.is_some() || started.elapsed() > TIMEOUT {
            let _ = child.kill();
            panic!("no {HEARTBEATS} heartbeats in {:?}, emulator ended: {ended:?}", started.elapsed());
        }
    };
    child.kill().expect("the emulator can be stopped");
    child.wait().expect("the emulator can be waited for");
    let _ = fs::remove_file(&log);
    writes
}

/// Writes to port C's register that sets (low half) and resets (high half) pins.
fn pin_writes(writes: &[Write]) -> impl Iterator<Item = u32> {
    writes.iter().filter(|write| write.device == "GPIOC" && write.offset == 0x18).map(|write| write.value)
}

/// Changes of the heartbeat's level.
fn heartbeats(writes: &[Write]) -> usize {
    let levels: Vec<u32> = pin_writes(writes).filter(|pins| pins & (HEARTBEAT | HEARTBEAT << 16) != 0).collect();
    // The first writes set the pins up.
    levels.windows(2).filter(|pair| (pair[0] ^ pair[1]) & HEARTBEAT != 0).count()
}

#[test]
fn the_board_without_a_crystal_ticks_at_0_percent_and_is_never_ready() {
    let writes = writes();
    assert!(pin_writes(writes).any(|pins| pins & LINES == LINES), "the lines are never released");
    assert!(pin_writes(writes).all(|pins| pins & LINES << 16 == 0), "a line is pulled down");
    assert!(pin_writes(writes).any(|pins| pins & READY == READY), "\"not ready\" is never said");
    assert!(pin_writes(writes).all(|pins| pins & READY << 16 == 0), "\"ready\" is said");
    let clock = |offset, value| Write { device: "RCC".to_owned(), offset, value };
    let asked = writes.iter().position(|write| *write == clock(0, 1 << 16)).expect("the crystal is asked for");
    assert!(writes[asked..].contains(&clock(8, 0)), "back to the chip's own oscillator");
    // QEMU calls the page of the watchdog by its neighbour's name.
    let fed = writes.iter().filter(|write| write.device == "I2S2ext" && write.value == 0xAAAA).count();
    println!("{} writes, watchdog fed {fed} times, {} heartbeats", writes.len(), heartbeats(writes));
    assert!(fed > 100 * (HEARTBEATS - 1), "fed {fed} times");
}

#[test]
fn lines_are_released_before_their_pins_are_driven() {
    let writes = writes();
    let first = |offset| writes.iter().position(|write| write.device == "GPIOC" && write.offset == offset);
    let (mode, kind, level) = (first(0x00), first(0x04), first(0x18));
    assert!(level < kind && kind < mode && mode.is_some(), "level {level:?}, open drain {kind:?}, output {mode:?}");
}

/// Pins in the first column of the README's table.
fn documented_pins() -> BTreeSet<String> {
    let text = fs::read_to_string(root().join("firmware/boards/stm32f405/README.md")).expect("the page is there");
    let cells = text.lines().filter_map(|line| line.strip_prefix("| P")?.split_once(" |"));
    cells.flat_map(|(cell, _)| format!("P{cell}").split(", ").map(str::to_owned).collect::<Vec<_>>()).collect()
}

/// Pins that get a mode or a pull-up. Registers read 0 in the emulator, so what is written is what the image asks for.
fn pins_set_up(writes: &[Write]) -> BTreeSet<String> {
    let mut pins = BTreeSet::new();
    for write in writes.iter().filter(|write| matches!(write.offset, 0x00 | 0x0C)) {
        if let Some(port) = write.device.strip_prefix("GPIO") {
            let used = (0..16).filter(|pin| write.value >> (2 * pin) & 3 != 0);
            pins.extend(used.map(|pin| format!("P{port}{pin}")));
        }
    }
    pins
}

#[test]
fn the_readme_lists_the_pins_that_the_image_sets_up() {
    let pins = documented_pins();
    println!("{} pins: {pins:?}", pins.len());
    assert_eq!(pins, pins_set_up(writes()));
}

#[test]
fn a_panic_that_can_be_reached_keeps_the_image_from_linking() {
    assert!(image().exists());
    assert_gated(BOARD, IMAGE);
}

#[test]
fn flash_and_ram_stay_within_the_budgets_of_the_boards_folder() {
    let text = fs::read_to_string(root().join("firmware/boards/stm32f405/budgets.txt")).expect("the budgets are there");
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    let budgets: BTreeMap<&str, u32> = lines
        .filter_map(|line| line.split_once(' '))
        .map(|(name, bytes)| (name, bytes.parse().expect("bytes")))
        .collect();
    let file = fs::read(image()).expect("the image is there");
    // The job is compiled in and counts.
    let (flash, ram) = sizes(&Elf::parse(&file), "");
    for (name, used) in [("flash", flash), ("ram", ram)] {
        let max = budgets[name];
        println!("{IMAGE}, {name}: {used} of {max} bytes");
        assert!(used > 0 && used <= max, "{name}: {used} of {max} bytes");
    }
}
