//! The feed board on the DNC line between a sender and the control: `arcfeed_qemu_mps2::tapped`.
//!
//! No panic is reachable: the panic handler calls an undefined function, so that an image that contains the handler
//! does not link. This holds in release mode only; without optimisation, checks remain that cannot fail.
#![no_std]
#![no_main]

use arcfeed_qemu_mps2::tick::on_timer;
use arcfeed_qemu_mps2::{last_act_handlers, leave, line_handlers, tapped};
use cortex_m_semihosting::debug;

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

#[cortex_m_rt::entry]
fn main() -> ! {
    let Some(board) = tapped::start() else {
        defmt::error!("the board's settings make no sense");
        leave(debug::EXIT_FAILURE)
    };
    board.run()
}
