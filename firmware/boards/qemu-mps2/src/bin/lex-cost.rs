//! Instructions for reading NC text on the chip, over the blocks of whole example jobs: alone and in the tap.
//!
//! Prints a line for each figure, `NAME count N median M worst W`, which `tests/board/reading.rs` checks:
//!
//! ```text
//! lex-JOB       a motion block's text to its words
//! read-JOB      the same to its checked segment: words, modal state, geometry
//! hear-JOB      a character into the tap: what the line would wait for if the board passed it on last
//! segment-JOB   a block in the tap's text to the segment with its law
//! block-JOB     all the tap does for a motion block: its characters and its segment
//! follow-JOB    a position held against the path in work
//! stack-JOB     `bytes N`: stack that hearing, reading and following used, below this program's own frames
//! ```
//! Interrupts are masked.
#![no_std]
#![no_main]

use core::hint::black_box;

use arcfeed_board_app::tap::settings::TapSettings;
use arcfeed_board_app::tap::{Tap, TapSegment};
use arcfeed_model::job::Job;
use arcfeed_nc::block::{Parsed, Reading};
use arcfeed_nc::modal::Pose;
use arcfeed_nc::reader::{InterpretedLine, Reader};
use arcfeed_nc::tape_code::TapeCode;
use arcfeed_qemu_mps2::clock::InstructionCounter;
use arcfeed_qemu_mps2::example::{ibr_slot, pocket_contour};
use arcfeed_qemu_mps2::figures::Costs;
use arcfeed_qemu_mps2::leave;
use arcfeed_qemu_mps2::stack::Painted;
use arcfeed_units::Micros;
use cortex_m_semihosting::{debug, hprintln};

/// Room of the tap for the whole example.
const ROOM: usize = 4_096;
/// Positions at rest before the program begins.
const BEFORE: u32 = 20;

/// Results for the tap.
#[derive(Default)]
struct Figures {
    hear: Costs,
    segment: Costs,
    block: Costs,
    follow: Costs,
    stack_bytes: usize,
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    hprintln!("{}", info);
    leave(debug::EXIT_FAILURE)
}

#[cortex_m_rt::entry]
fn main() -> ! {
    cortex_m::interrupt::disable();
    let counter = InstructionCounter::start();
    for (name, program, job) in [
        ("ibr-slot", ibr_slot::PROGRAM, ibr_slot::whole_job()),
        ("pocket", pocket_contour::PROGRAM, pocket_contour::whole_job()),
    ] {
        count_reading(&counter, name, program, &job);
        count_tap(&counter, program, &job).print(name);
    }
    leave(debug::EXIT_SUCCESS)
}

fn lines(program: &[u8]) -> impl Iterator<Item = &[u8]> {
    program.split(|byte| *byte == b'\n')
}

/// Counts the lexer and the reader alone, on each block that moves.
#[inline(never)]
fn count_reading(counter: &InstructionCounter, name: &str, program: &[u8], job: &Job) {
    let (mut lex, mut read) = (Costs::default(), Costs::default());
    let (mut reader, mut understood) = (Reader::new(job.unit, Reading::Lenient), InterpretedLine::default());
    let mut parsed = Parsed::default();
    for line in lines(program) {
        let (of_lexer, _) = counter.of(|| parsed.read(black_box(line), Reading::Lenient).is_ok());
        let (of_reader, is_read) = counter.of(|| reader.read_into(black_box(line), &mut understood).is_ok());
        if is_read && understood.segment.is_some() {
            lex.add(of_lexer);
            read.add(of_reader);
        }
    }
    lex.print("lex-", name);
    read.print("read-", name);
}

/// Runs the program through the tap, block by block; each segment counts as done when it is emitted.
#[inline(never)]
fn count_tap(counter: &InstructionCounter, program: &[u8], job: &Job) -> Figures {
    let mut figures = Figures::default();
    let settings = TapSettings { code: Some(TapeCode::Ascii), ..TapSettings::new(job.unit) };
    let Ok(mut tap) = Tap::<ROOM>::new(settings) else { leave(debug::EXIT_FAILURE) };
    let (mut position, mut done) = (Pose::ORIGIN, 0);
    for _ in 0..BEFORE {
        follow(&mut tap, None, done, &position);
    }
    for line in lines(program) {
        let mut of_block = 0;
        for byte in line.iter().copied().chain([b'\n']) {
            let painted = Painted::below_here();
            let (cost, _) = counter.of(|| hear(&mut tap, black_box(byte)));
            figures.note_stack(painted);
            figures.hear.add(cost);
            of_block += cost;
        }
        loop {
            let painted = Painted::below_here();
            let (cost, handed) = counter.of(|| hand_out(&mut tap, black_box(job)));
            figures.note_stack(painted);
            let Some(TapSegment { count, segment }) = handed else { break };
            figures.segment.add(cost);
            figures.block.add(of_block + cost);
            (position, done) = (*segment.end(), count + 1);
            let painted = Painted::below_here();
            let (cost, ()) = counter.of(|| follow(&mut tap, Some(count), count, &position));
            figures.note_stack(painted);
            figures.follow.add(cost);
            follow(&mut tap, None, done, &position);
        }
    }
    figures
}

#[inline(never)]
fn hear(tap: &mut Tap<ROOM>, byte: u8) -> u8 {
    tap.from_sender(Micros(0), byte)
}

#[inline(never)]
fn hand_out(tap: &mut Tap<ROOM>, job: &Job) -> Option<TapSegment> {
    tap.next(job)
}

#[inline(never)]
fn follow(tap: &mut Tap<ROOM>, in_work: Option<u32>, executed: u32, position: &Pose) {
    tap.follow(in_work, executed, position);
}

impl Figures {
    fn note_stack(&mut self, painted: Painted) {
        self.stack_bytes = self.stack_bytes.max(painted.used());
    }

    fn print(mut self, name: &str) {
        self.hear.print("hear-", name);
        self.segment.print("segment-", name);
        self.block.print("block-", name);
        self.follow.print("follow-", name);
        hprintln!("stack-{} bytes {}", name, self.stack_bytes);
    }
}
