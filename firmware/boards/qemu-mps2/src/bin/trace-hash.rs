//! The runs of [`arcfeed_bench::trace`] on the chip, printed as the program of that name prints them on the host.
#![no_std]
#![no_main]

use arcfeed_bench::trace::{LAWS, run};
use arcfeed_qemu_mps2::leave;
use cortex_m_semihosting::{debug, hprintln};

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    hprintln!("{}", info);
    leave(debug::EXIT_FAILURE)
}

#[cortex_m_rt::entry]
fn main() -> ! {
    for (name, choice) in LAWS {
        hprintln!("{} {}", name, run(choice));
    }
    leave(debug::EXIT_SUCCESS)
}
