//! embassy's time from CMSDK timer 0, one tick per millisecond, and the interrupts. The HAL of a chip brings its own
//! (`embassy-stm32`, feature `time-driver-any`).

use core::cell::{Cell, RefCell};
use core::task::Waker;

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use critical_section::Mutex;
use embassy_time_driver::{Driver, TICK_HZ, time_driver_impl};
use embassy_time_queue_utils::Queue;

/// Frequency of the board's clock.
const CLOCK_HZ: u32 = 25_000_000;
const CONTROL_REGISTER: *mut u32 = 0x4000_0000 as *mut u32;
const RELOAD: *mut u32 = 0x4000_0008 as *mut u32;
const CLEAR: *mut u32 = 0x4000_000C as *mut u32;
/// Counting, with interrupt.
const RUNNING: u32 = 1 | (1 << 3);

/// Interrupts of this firmware by their number.
#[derive(Clone, Copy)]
pub enum Interrupt {
    /// CMSDK timer 0.
    Timer = 8,
    /// Line of a device that is not used: the executor of `control` pends it.
    Control = 31,
}

// SAFETY: the numbers are those of the vector table below, and no two are the same.
unsafe impl InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self as u16
    }
}

/// Time since the start, and who waits for it.
struct Clock {
    ticks: Mutex<Cell<u64>>,
    waiting: Mutex<RefCell<Queue>>,
}

time_driver_impl!(static CLOCK: Clock = Clock {
    ticks: Mutex::new(Cell::new(0)),
    waiting: Mutex::new(RefCell::new(Queue::new())),
});

impl Driver for Clock {
    fn now(&self) -> u64 {
        critical_section::with(|section| self.ticks.borrow(section).get())
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        // The interrupt of each tick looks at the queue: there is no alarm to be set.
        critical_section::with(|section| {
            self.waiting.borrow_ref_mut(section).schedule_wake(at, waker);
        });
    }
}

/// Starts the timer.
///
/// # Safety
/// Nothing else uses timer 0, and the handlers of [`Interrupt`] are ready to run.
pub unsafe fn start() {
    // SAFETY: registers of timer 0, says the caller.
    unsafe {
        RELOAD.write_volatile(CLOCK_HZ / TICK_HZ as u32 - 1);
        CONTROL_REGISTER.write_volatile(RUNNING);
        NVIC::unmask(Interrupt::Timer);
    }
}

unsafe extern "C" fn on_timer() {
    // SAFETY: a register of timer 0.
    unsafe { CLEAR.write_volatile(1) };
    critical_section::with(|section| {
        let ticks = CLOCK.ticks.borrow(section);
        ticks.set(ticks.get() + 1);
        CLOCK.waiting.borrow_ref_mut(section).next_expiration(ticks.get());
    });
}

/// An entry of the vector table.
#[derive(Clone, Copy)]
pub union Vector {
    handler: unsafe extern "C" fn(),
    _reserved: usize,
}

unsafe extern "C" {
    fn CONTROL();
    fn DefaultHandler();
}

/// Lines 0 to 31 of the board.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
pub static __INTERRUPTS: [Vector; 32] = {
    let mut table = [Vector { handler: DefaultHandler }; 32];
    table[Interrupt::Timer as usize] = Vector { handler: on_timer };
    table[Interrupt::Control as usize] = Vector { handler: CONTROL };
    table
};
