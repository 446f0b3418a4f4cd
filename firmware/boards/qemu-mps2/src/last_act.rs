//! The board's last act, when it is not to be relied on any more: the lines are released, 0 %, and the next start told why.
//!
//! ```text
//! watchdog, first time-out -> NMI ---+
//!                                    +--> released, noted, shown; then nothing until the second time-out resets the board
//! fault of the core -----------------+
//! ```

use arcfeed_shared::units::Micros;
use arcfeed_shared::wire::frame::ENCODED_MAX;
use arcfeed_shared::wire::message::Message;
use arcfeed_shared::wire::message::codes::StateCode;
use arcfeed_shared::wire::message::table::Setpoint;
use arcfeed_shared::wire::plain::PlainLine;

use crate::tick::{PERIOD, costs};
use crate::uart::{Registers, UART1};
use crate::{mirror, reset_cause, watchdog};

/// Releases, and never returns.
///
/// # Safety
/// Called by the handlers of the NMI and of the core's faults alone, which no interrupt goes before.
pub unsafe fn release_for_good() -> ! {
    mirror::release();
    let ticks = costs().ticks;
    reset_cause::note_watchdog(ticks.wrapping_sub(watchdog::fed_at()));
    // SAFETY: no other handler runs again, nor does the main program.
    let mut line = unsafe { Registers::seize(UART1) };
    let at = u64::from(ticks) * u64::from(PERIOD.0);
    let state = StateCode::Faulted;
    let released = Message::Setpoint(Setpoint { at, lines: mirror::low(), state, link_bytes: 0, tap_bytes: 0 });
    let mut frame = [0; ENCODED_MAX];
    let length = PlainLine::new().encode(Micros(at), &released, &mut frame);
    // Before it an end of frame: one may have been under way.
    for byte in [0].iter().chain(frame.iter().take(length)) {
        while !line.try_send(*byte) {}
    }
    loop {
        core::hint::spin_loop();
    }
}

/// The handlers of the board's last act, for images that are a whole board.
#[macro_export]
macro_rules! last_act_handlers {
    () => {
        #[unsafe(no_mangle)]
        extern "C" fn NonMaskableInt() {
            // SAFETY: this is the handler of the NMI.
            unsafe { $crate::last_act::release_for_good() }
        }

        #[cortex_m_rt::exception]
        unsafe fn HardFault(_: &cortex_m_rt::ExceptionFrame) -> ! {
            // SAFETY: this is the handler of the core's faults.
            unsafe { $crate::last_act::release_for_good() }
        }
    };
}
