//! The feed board on the DNC line between a sender and the control, with the example's job in place of parameters in flash:
//! `arcfeed_qemu_mps2::main_loop`.
//!
//! No panic can be reached here: the panic handler calls a function that does not exist, so that an image in which the
//! handler is left over does not link. In release mode, that is: without optimisation checks remain that cannot fail.
#![no_std]
#![no_main]

use arcfeed_firmware::tap::Tap;
use arcfeed_firmware::tap::settings::TapSettings;
use arcfeed_qemu_mps2::example::ibr_slot::{add_rules, job};
use arcfeed_qemu_mps2::main_loop::Main;
use arcfeed_qemu_mps2::tick::on_timer;
use arcfeed_qemu_mps2::{leave, line_handlers};
use arcfeed_shared::nc::tape_code::Code;
use cortex_m_semihosting::debug;

/// Characters between the sender and the machine: a control's buffer, and some.
const ROOM: usize = 4_096;

line_handlers!();

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
    let mut job = job();
    add_rules(&mut job);
    let settings = TapSettings { code: Some(Code::Ascii), ..TapSettings::new(job.unit) };
    let tap = Tap::<ROOM>::new(settings).ok();
    let Some(board) = tap.and_then(|tap| Main::start(Some((tap, &job)))) else {
        defmt::error!("the board's settings make no sense");
        leave(debug::EXIT_FAILURE)
    };
    board.run()
}
