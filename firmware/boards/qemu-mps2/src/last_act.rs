//! Final state of a failed board: releases the lines (0 %) and records the cause for the next start.
//!
//! ```text
//! watchdog, first time-out -> NMI ---+
//!                                    +--> released, noted, shown; then nothing until the second time-out resets the board
//! fault of the core -----------------+
//! ```

use arcfeed_link::frame::ENCODED_MAX;
use arcfeed_link::message::Message;
use arcfeed_link::message::codes::StateCode;
use arcfeed_link::message::table::Setpoint;
use arcfeed_link::plain::PlainLine;
use arcfeed_units::Micros;

use crate::tick::{PERIOD, costs};
use crate::uart::{Registers, UART1};
use crate::{mirror, reset_cause, watchdog};

/// Releases the override lines (0 %), records the cause for the next start, and never returns.
///
/// # Safety
/// Called only by the handlers of the NMI and of the core's faults, which no interrupt preempts.
pub unsafe fn release_for_good() -> ! {
    mirror::release();
    let ticks = costs().ticks;
    reset_cause::note_watchdog(ticks.wrapping_sub(watchdog::fed_at()));
    // SAFETY: neither another handler nor the main program runs again.
    let mut line = unsafe { Registers::seize(UART1) };
    let at = u64::from(ticks) * u64::from(PERIOD.0);
    let state = StateCode::Faulted;
    let released = Message::Setpoint(Setpoint { at, lines: mirror::low(), state, link_bytes: 0, tap_bytes: 0 });
    let mut frame = [0; ENCODED_MAX];
    let length = PlainLine::new().encode(Micros(at), &released, &mut frame);
    // A leading delimiter: a frame may have been interrupted.
    for byte in [0].iter().chain(frame.iter().take(length)) {
        while !line.try_send(*byte) {}
    }
    loop {
        core::hint::spin_loop();
    }
}

/// Defines the handlers that call [`release_for_good`](crate::last_act::release_for_good): those of the NMI (watchdog)
/// and of faults of the core.
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
