//! The controller on the chip: a tick every millisecond from TIM5's interrupt, blocks from the main loop.
//!
//! ```text
//! main loop:  block of the program -> ActiveSegment -> queue            watchdog
//!                                                        |                 ^
//! TIM5:       sensors -> BoardIo::tick (supervisor) <----+  -> *FV0-7      | ticks
//! NMI:        the crystal stopped -> lines released      HardFault: lines released, until the watchdog fires
//! ```
//!
//! No panic is reachable: the panic handler calls an undefined function, so that an image that contains the handler
//! does not link. This holds in release mode only.
#![no_std]
#![no_main]

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicU32, Ordering};

use arcfeed_firmware::output::latched::Latched;
use arcfeed_firmware::output::port_lines::PortLines;
use arcfeed_firmware::output::settling::Settling;
use arcfeed_model::job::Job;
use arcfeed_stm32f405::board_io::{BoardIo, Outputs, Sensors};
use arcfeed_stm32f405::clock::{self, Clock};
use arcfeed_stm32f405::dial::DialConverter;
use arcfeed_stm32f405::encoders::Encoders;
use arcfeed_stm32f405::guard::{Guard, Prepared};
use arcfeed_stm32f405::lines::{CycleDelay, FvPort, PinsDiffer, StatusPins, let_go};
use arcfeed_stm32f405::spindle::SpindleTimer;
use arcfeed_stm32f405::tick_timer::{self, TickTimer};
use arcfeed_stm32f405::watchdog::Watchdog;
use arcfeed_stm32f405::{machine, pins, program, reset_cause};
use cortex_m_rt::{ExceptionFrame, entry, exception};
use heapless::spsc::{Producer, Queue};
use stm32f4::stm32f405::{GPIOC, Peripherals, RCC, interrupt};

/// Blocks prepared ahead of the tick.
const AHEAD: usize = 8;

/// State of the tick.
struct TickState {
    timer: TickTimer,
    io: BoardIo,
}

/// Data of the handler, stored before the timer starts.
struct Handed<T>(UnsafeCell<Option<T>>);

// SAFETY: written before the interrupt is unmasked, used only by its handler from then on.
unsafe impl<T> Sync for Handed<T> {}

static TICK_STATE: Handed<TickState> = Handed(UnsafeCell::new(None));
static TICKS: AtomicU32 = AtomicU32::new(0);
/// Number of restarts of the program.
static RUN: AtomicU32 = AtomicU32::new(0);

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn arcfeed_a_panic_can_be_reached() -> !;
    }
    // SAFETY: never linked, hence never called.
    unsafe { arcfeed_a_panic_can_be_reached() }
}

#[exception]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    loop {
        let_go();
    }
}

#[exception]
unsafe fn NonMaskableInt() {
    let_go();
    // SAFETY: the main loop is past its use of this register, and nothing else of it is touched.
    clock::take_failure(unsafe { &*RCC::ptr() });
}

#[interrupt]
fn TIM5() {
    // SAFETY: the handler is the one user, see `Handed`, and does not interrupt itself.
    if let Some(state) = unsafe { &mut *TICK_STATE.0.get() } {
        tick(state);
    }
}

fn tick(state: &mut TickState) {
    let TickState { timer, io } = state;
    timer.acknowledge();
    io.tick();
    RUN.store(io.run(), Ordering::Relaxed);
    if timer.is_late() {
        io.report_late();
    }
    let ticks = TICKS.load(Ordering::Relaxed).wrapping_add(1);
    TICKS.store(ticks, Ordering::Relaxed);
    #[cfg(feature = "prove-the-gate")]
    core::hint::black_box(program::BLOCKS[ticks as usize].first_tick);
}

#[entry]
fn main() -> ! {
    let Some(chip) = Peripherals::take() else { rest(None) };
    let Peripherals { RCC: rcc, GPIOA: port_a, GPIOB: port_b, GPIOC: port_c, .. } = chip;
    clock::supply(&rcc);
    pins::set_up(&port_a, &port_b, &port_c);
    let clock = clock::start(&rcc, &chip.FLASH, &chip.PWR);
    let mut watchdog = Watchdog::start(chip.IWDG);
    let cause = reset_cause::fault(rcc.csr().read().bits());
    // Clear the flags for the next start.
    rcc.csr().modify(|_, w| w.rmvf().set_bit());

    let job = program::job();
    static QUEUE: Handed<Queue<Prepared, AHEAD>> = Handed(UnsafeCell::new(Some(Queue::new())));
    // SAFETY: taken once, by the one main.
    let Some(queue) = (unsafe { &mut *QUEUE.0.get() }) else { rest(Some(watchdog)) };
    let (producer, consumer) = queue.split();
    let (Ok(guard), Some(tacho)) = (Guard::new(&job, consumer), machine::tacho()) else { rest(Some(watchdog)) };
    let Ok(outputs) = outputs(port_c, clock) else { rest(Some(watchdog)) };
    let sensors = Sensors {
        encoders: Encoders::start(chip.TIM3, chip.TIM4, chip.TIM1),
        spindle: SpindleTimer::start(chip.TIM2, clock.timer_mhz),
        dial: DialConverter::start(chip.ADC1, &chip.ADC_COMMON),
        contacts: port_b,
    };
    let io = BoardIo::new((sensors, outputs), tacho, guard, cause);

    watchdog.feed();
    let timer = TickTimer::start(chip.TIM5, clock.timer_mhz);
    // SAFETY: the state has no user before the interrupt is enabled, and only its handler from then on.
    unsafe {
        *TICK_STATE.0.get() = Some(TickState { timer, io });
        tick_timer::allow();
    }
    serve(&job, producer, watchdog)
}

/// The outputs, with released lines.
fn outputs(port: GPIOC, clock: Clock) -> Result<Outputs, PinsDiffer> {
    let port = FvPort::new(port);
    let status = StatusPins::beside(&port);
    let delay = CycleDelay { core_mhz: clock.core_mhz };
    let lines = PortLines::with_settling(port, Settling { delay, settle_ns: machine::LINES_SETTLE_NS })?;
    Ok(Outputs { lines: Latched::new(lines), status })
}

/// The main loop: prepares blocks ahead of the tick, and feeds the watchdog after each tick.
fn serve(job: &Job, mut prepared: Producer<'static, Prepared>, mut watchdog: Watchdog) -> ! {
    let (mut run, mut fed_at) = (0, 0);
    let mut blocks = program::BLOCKS.iter();
    loop {
        let asked = RUN.load(Ordering::Relaxed);
        if asked != run {
            (run, blocks) = (asked, program::BLOCKS.iter());
        }
        if prepared.ready()
            && let Some(segment) = blocks.next().and_then(|block| block.prepare(job))
        {
            let _room = prepared.enqueue((run, segment));
        }
        let ticks = TICKS.load(Ordering::Relaxed);
        if ticks != fed_at {
            watchdog.feed();
            fed_at = ticks;
        }
        cortex_m::asm::wfi();
    }
}

/// Stays at 0 % and "not ready" if the start has failed: no output was set so far.
fn rest(mut watchdog: Option<Watchdog>) -> ! {
    loop {
        let_go();
        if let Some(watchdog) = &mut watchdog {
            watchdog.feed();
        }
    }
}
