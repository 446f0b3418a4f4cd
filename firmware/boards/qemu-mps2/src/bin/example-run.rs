//! The controller alone on the board: a tick every millisecond from a timer's interrupt, segments from the main loop.
//!
//! ```text
//! main loop:  block of the program -> ActiveSegment -> queue          log
//!                                                        |
//! TIMER0:     position, block count ->  Task::run  <-----+  -> override -> UART 1
//! ```
//!
//! The main loop never blocks the tick: it prepares segments ahead and logs. The program and the positions are those
//! of the example's run. At the end it logs the results and leaves the emulator.
//!
//! No panic is reachable: the panic handler calls an undefined function, so that an image that contains the handler
//! does not link. This holds in release mode only; without optimisation, checks remain that cannot fail.
#![no_std]
#![no_main]

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::board::{Board, Task};
use arcfeed_firmware::controller;
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::Supervisor;
use arcfeed_firmware::supervisor::input::{Input, Work};
use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_qemu_mps2::example::ibr_slot::{EXAMPLE, add_rules, job};
use arcfeed_qemu_mps2::example::{Block, Run, TICK};
use arcfeed_qemu_mps2::handed::Handed;
use arcfeed_qemu_mps2::stack::Painted;
use arcfeed_qemu_mps2::uart::{Registers, UART1};
use arcfeed_qemu_mps2::{leave, timer};
use cortex_m_semihosting::debug;
use heapless::spsc::{Consumer, Queue};

/// Segments prepared ahead of the tick.
const AHEAD: usize = 8;

/// A prepared segment and its block's count.
type Prepared = (u32, Option<ActiveSegment>);

/// State of the tick.
struct TickState {
    supervisor: Supervisor,
    task: Task,
    segments: Consumer<'static, Prepared>,
    run: Run,
    io: BoardIo,
}

/// Hardware of the controller.
struct BoardIo {
    segment: Option<(u32, ActiveSegment)>,
    input: Input,
    line: Registers,
}

static TICK_STATE: Handed<TickState> = Handed::nothing();
static TICKS: AtomicU32 = AtomicU32::new(0);
static STARVED: AtomicU32 = AtomicU32::new(0);
static DROPPED: AtomicU32 = AtomicU32::new(0);
static OVER: AtomicBool = AtomicBool::new(false);

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn arcfeed_a_panic_can_be_reached() -> !;
    }
    // SAFETY: never linked, hence never called.
    unsafe { arcfeed_a_panic_can_be_reached() }
}

impl Board for BoardIo {
    fn measure(&mut self) {}

    fn input(&self) -> &Input {
        &self.input
    }

    fn work(&self) -> Work<'_> {
        self.segment.as_ref().map(|(count, segment)| (*count, segment))
    }

    fn set_override(&mut self, feed_override: FeedOverride) {
        if !self.line.try_send(feed_override.percent) {
            DROPPED.store(DROPPED.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
        }
    }
}

#[unsafe(no_mangle)]
extern "C" fn TIMER0() {
    timer::acknowledge();
    // SAFETY: the handler is the one user, see `Handed`, and does not interrupt itself.
    if let Some(state) = unsafe { TICK_STATE.get() } {
        tick(state);
    }
}

fn tick(state: &mut TickState) {
    let Some((position, new)) = state.run.next() else {
        timer::stop();
        OVER.store(true, Ordering::Release);
        return;
    };
    if new.is_some() {
        let next = state.segments.dequeue();
        if next.is_none() {
            STARVED.store(STARVED.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
        }
        state.io.segment = next.and_then(|(count, segment)| Some((count, segment?)));
    }
    state.io.input.measured.position = Some(position);
    state.task.run(&state.supervisor, &mut state.io);
    TICKS.store(TICKS.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
    #[cfg(feature = "prove-the-gate")]
    core::hint::black_box(EXAMPLE.blocks[TICKS.load(Ordering::Relaxed) as usize].first_tick);
}

#[cortex_m_rt::entry]
fn main() -> ! {
    let painted = Painted::below_here();
    let mut job = job();
    add_rules(&mut job);
    let Ok(supervisor) = Supervisor::new(&job, Settings::default()) else {
        defmt::error!("the limits of the override make no sense");
        leave(debug::EXIT_FAILURE)
    };
    static QUEUE: Handed<Queue<Prepared, AHEAD>> = Handed::with(Queue::new());
    // SAFETY: taken once, by the one main.
    let Some(queue) = (unsafe { QUEUE.get() }) else { leave(debug::EXIT_FAILURE) };
    let (mut segments, consumer) = queue.split();
    let prepare = |(count, block): (u32, &'static Block)| {
        (count, block.segment.as_ref().map(|segment| ActiveSegment::new(segment, block.cut(&job), &job)))
    };
    let mut blocks = (1..).zip(EXAMPLE.blocks.iter()).map(prepare).peekable();
    while segments.ready() && blocks.peek().is_some() {
        if let Some(prepared) = blocks.next() {
            let _room = segments.enqueue(prepared);
        }
    }
    defmt::info!("example: {=usize} blocks, a tick every {=u32} us", EXAMPLE.blocks.len(), TICK.0);
    let measured = controller::Measurement { position: None, spindle: job.tools.first().spindle, dt: TICK };
    // SAFETY: UART 1 is used here only; the timer starts below, so the state has no other user yet.
    unsafe {
        let io = BoardIo { segment: None, input: Input::of(measured), line: Registers::start_transmitter(UART1) };
        let (run, task) = (EXAMPLE.run(), Task::from(Memory::armed()));
        TICK_STATE.put(TickState { supervisor, task, segments: consumer, run, io });
        timer::start(TICK.0);
    }
    while !OVER.load(Ordering::Acquire) {
        while segments.ready() && blocks.peek().is_some() {
            if let Some((count, active)) = blocks.next() {
                defmt::info!("block {=u32} ready at tick {=u32}", count, TICKS.load(Ordering::Relaxed));
                let _ = segments.enqueue((count, active));
            }
        }
        cortex_m::asm::wfi();
    }
    let [ticks, starved, dropped] = [&TICKS, &STARVED, &DROPPED].map(|count| count.load(Ordering::Relaxed));
    defmt::info!("over: {=u32} ticks, {=u32} starved, {=u32} overrides dropped", ticks, starved, dropped);
    defmt::info!("stack: {=usize} bytes", painted.above() + painted.used());
    leave(if starved + dropped == 0 { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE })
}
