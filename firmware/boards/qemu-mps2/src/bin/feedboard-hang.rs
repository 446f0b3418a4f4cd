//! The board of `feedboard-tap` with commands that make it hang, for tests of the watchdog.
//!
//! The commands are bytes on UART 4, for which no productive image has a handler. They are executed with a higher
//! priority than the main program and a lower one than the lines and the tick, which continue.
//!
//! No panic is reachable: otherwise the image would not link.
#![no_std]
#![no_main]

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use arcfeed_qemu_mps2::handed::Handed;
use arcfeed_qemu_mps2::interrupts::{Priority, enable};
use arcfeed_qemu_mps2::serial::lost_of_sender;
use arcfeed_qemu_mps2::tick::on_timer;
use arcfeed_qemu_mps2::uart::{Registers, UART4};
use arcfeed_qemu_mps2::{last_act_handlers, leave, line_handlers, tapped, timer, watchdog};
use cortex_m_semihosting::debug;

static ORDERS: Handed<Registers> = Handed::nothing();
static IS_MEASURED: AtomicBool = AtomicBool::new(false);
static MUST_STOP: AtomicBool = AtomicBool::new(false);
/// Tick of the last feeding of the watchdog when the main loop was ordered to stop.
static FED_AT_ORDER: AtomicU32 = AtomicU32::new(0);

line_handlers!();
last_act_handlers!();

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn arcfeed_a_panic_can_be_reached() -> !;
    }
    // SAFETY: never linked, hence never called.
    unsafe { arcfeed_a_panic_can_be_reached() }
}

#[unsafe(no_mangle)]
extern "C" fn TIMER0() {
    // SAFETY: this is the timer's handler.
    unsafe { on_timer() };
}

#[unsafe(no_mangle)]
extern "C" fn UART4_RX() {
    // SAFETY: this is the receiver's handler, the one user.
    let Some(registers) = (unsafe { ORDERS.get() }) else { return };
    registers.acknowledge_received();
    match registers.receive() {
        // The main loop stops right behind the next feeding of the watchdog.
        Some(b'm') => {
            FED_AT_ORDER.store(watchdog::fed_at(), Ordering::Relaxed);
            MUST_STOP.store(true, Ordering::Relaxed);
        }
        // The main loop is blocked until the tapped line has lost a byte.
        Some(b'l') => {
            let before = lost_of_sender();
            while lost_of_sender() == before {
                core::hint::spin_loop();
            }
        }
        // The tick stops.
        Some(b't') => timer::stop(),
        // The board is measured: the watchdog does not start, and the main loop does not sleep.
        Some(b'w') => IS_MEASURED.store(true, Ordering::Relaxed),
        // A fault of the core.
        Some(b'f') => cortex_m::asm::udf(),
        _ => {}
    }
}

#[cortex_m_rt::entry]
fn main() -> ! {
    let Some(board) = tapped::start() else {
        defmt::error!("the board's settings make no sense");
        leave(debug::EXIT_FAILURE)
    };
    // SAFETY: UART 4 is used here only; the data of its handler are ready when it is enabled.
    unsafe {
        ORDERS.put(Registers::start(UART4));
        enable(UART4.received, Priority::Third);
    }
    board.run_measured(is_measured)
}

/// Whether the board is measured. Behind a feeding that came after the order to stop, the main loop stops here: with a sleep between
/// the two, over which the emulator's clock jumps, the ticks from the feeding on would not be those of the watchdog's time.
fn is_measured() -> bool {
    while MUST_STOP.load(Ordering::Relaxed) && watchdog::fed_at() != FED_AT_ORDER.load(Ordering::Relaxed) {
        core::hint::spin_loop();
    }
    IS_MEASURED.load(Ordering::Relaxed)
}
