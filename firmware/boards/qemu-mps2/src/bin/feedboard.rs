//! The feed board at the end of a link to a host: `arcfeed_qemu_mps2::main_loop`.
//!
//! No panic is reachable: the panic handler calls an undefined function, so that an image that contains the handler
//! does not link. This holds in release mode only; without optimisation, checks remain that cannot fail.
#![no_std]
#![no_main]

use arcfeed_qemu_mps2::main_loop::Main;
use arcfeed_qemu_mps2::tick::on_timer;
use arcfeed_qemu_mps2::{last_act_handlers, leave, line_handlers};
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
    #[cfg(feature = "prove-the-gate")]
    core::hint::black_box(b"none"[core::hint::black_box(4)]);
    let Some(board) = Main::<0>::start(None) else {
        defmt::error!("the board's settings make no sense");
        leave(debug::EXIT_FAILURE)
    };
    board.run()
}
