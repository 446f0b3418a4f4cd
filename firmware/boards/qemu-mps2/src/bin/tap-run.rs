//! The tap and the controller alone: the inputs are the characters of the example's program and the positions of its
//! run.
//!
//! Each tick writes its override to UART 1, as in `example-run`, which gets the block in execution as an input:
//! `tests/board/reading.rs` compares the two. At the end it logs the cost of reading and following.
//!
//! No panic is reachable with any characters: otherwise the image would not link.
#![no_std]
#![no_main]

use arcfeed_board_app::tap::Tap;
use arcfeed_board_app::tap::settings::TapSettings;
use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::controller;
use arcfeed_firmware::queue::Follower;
use arcfeed_firmware::supervisor::Supervisor;
use arcfeed_firmware::supervisor::input::Input;
use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_model::job::Job;
use arcfeed_nc::modal::Pose;
use arcfeed_nc::tape_code::TapeCode;
use arcfeed_qemu_mps2::example::TICK;
use arcfeed_qemu_mps2::example::ibr_slot::{EXAMPLE, PROGRAM, add_rules, job};
use arcfeed_qemu_mps2::handed::Handed;
use arcfeed_qemu_mps2::leave;
use arcfeed_qemu_mps2::stack::Painted;
use arcfeed_qemu_mps2::uart::{Registers, UART1};
use arcfeed_units::Micros;
use cortex_m_semihosting::debug;
use heapless::Deque;

/// Characters between the sender and the machine: a control's buffer and a reserve.
const ROOM: usize = 4_096;
/// Segments in the tick's queue.
const AT_HAND: usize = 8;
/// Positions at rest before the program comes.
const BEFORE: u32 = 20;

type Line = Tap<ROOM>;

static TAP: Handed<Line> = Handed::nothing();

/// State of the tick.
struct Tick {
    supervisor: Supervisor,
    memory: Memory,
    follower: Follower,
    queue: Deque<ActiveSegment, AT_HAND>,
    executed: u32,
    input: Input,
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn arcfeed_a_panic_can_be_reached() -> !;
    }
    // SAFETY: never linked, hence never called.
    unsafe { arcfeed_a_panic_can_be_reached() }
}

#[cortex_m_rt::entry]
fn main() -> ! {
    let mut job = job();
    add_rules(&mut job);
    let (Some(tap), Some(mut tick)) = (start(&job), Tick::new(&job)) else { leave(debug::EXIT_FAILURE) };
    // SAFETY: UART 1 is used here only.
    let mut line = unsafe { Registers::start_transmitter(UART1) };
    let painted = Painted::below_here();
    for byte in PROGRAM.iter().copied().chain([b'\n']) {
        tap.from_sender(Micros(0), byte);
    }
    for (position, _) in EXAMPLE.run() {
        tick.follow(&position);
        // Counts begin with 0 and none is dropped: the count of the segment in execution is the number of executed
        // segments.
        tap.follow(tick.queue.front().map(|_| tick.executed), tick.executed, &position);
        let is_to_clear = tap.must_clear();
        while !is_to_clear && !tick.queue.is_full() {
            let Some(handed) = tap.next(&job) else { break };
            let _room = tick.queue.push_back(handed.segment);
        }
        let percent = tick.decide();
        while !line.try_send(percent) {}
    }
    let counters = tap.counters();
    #[cfg(feature = "prove-the-gate")]
    core::hint::black_box(PROGRAM[counters.segments as usize]);
    defmt::info!(
        "tap: {=u32} segments, {=u32} governed, {=u32} lost",
        counters.segments,
        counters.governed,
        counters.losses
    );
    defmt::info!("tap: {=usize} bytes", size_of::<Line>());
    defmt::info!("stack: {=usize} bytes", painted.used());
    leave(if counters.losses == 0 { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE })
}

/// Creates the tap in its memory, with the axes at rest. The stack that its creation needs is free again.
#[inline(never)]
fn start(job: &Job) -> Option<&'static mut Line> {
    let settings = TapSettings { code: Some(TapeCode::Ascii), ..TapSettings::new(job.unit) };
    let tap = Tap::new(settings).ok()?;
    // SAFETY: no handler runs, and no other code takes it.
    let tap = unsafe {
        TAP.put(tap);
        TAP.get()?
    };
    for _ in 0..BEFORE {
        tap.follow(None, 0, &Pose::ORIGIN);
    }
    Some(tap)
}

impl Tick {
    fn new(job: &Job) -> Option<Self> {
        let measured = controller::Measurement { position: None, spindle: job.tools.first().spindle, dt: TICK };
        Some(Tick {
            supervisor: Supervisor::new(job, Settings::default()).ok()?,
            memory: Memory::armed(),
            follower: Follower::default(),
            queue: Deque::new(),
            executed: 0,
            input: Input::of(measured),
        })
    }

    fn follow(&mut self, position: &Pose) {
        self.input.measured.position = Some(*position);
        let Some(segment) = self.queue.front() else { return };
        if self.follower.follow(self.supervisor.controller(), segment, &self.input.measured) {
            self.queue.pop_front();
            self.executed = self.executed.wrapping_add(1);
        }
    }

    fn decide(&mut self) -> u8 {
        self.supervisor
            .tick(&mut self.memory, self.follower.in_work(self.queue.front()), &self.input)
            .feed_override
            .percent
    }
}
