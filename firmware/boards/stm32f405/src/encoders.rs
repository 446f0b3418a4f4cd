//! Encoders X on TIM3, Y on TIM4, Z on TIM1: A quad B, counted by the timers in both directions, 16 bits each.

use stm32f4::stm32f405::{TIM1, TIM3, TIM4};

/// Running timers that count the encoders of X, Y and Z.
#[derive(Debug)]
pub struct Encoders {
    x: TIM3,
    y: TIM4,
    z: TIM1,
}

/// Input filter: eight samples must agree; spikes below 0.05 us (Z) or 0.1 us (X, Y) are ignored.
const FILTER: u8 = 0b0011;

/// Configures a timer to count all edges of both inputs.
macro_rules! count {
    ($timer:expr) => {
        // SAFETY: the filters take any four bits.
        $timer.ccmr1_input().write(|w| unsafe { w.cc1s().ti1().cc2s().ti2().ic1f().bits(FILTER).ic2f().bits(FILTER) });
        $timer.smcr().write(|w| w.sms().encoder_mode_3());
        // SAFETY: any period is valid.
        $timer.arr().write(|w| unsafe { w.arr().bits(u16::MAX) });
        $timer.cr1().write(|w| w.cen().set_bit());
    };
}

impl Encoders {
    /// Starts the counters at zero.
    pub fn start(x: TIM3, y: TIM4, z: TIM1) -> Self {
        count!(x);
        count!(y);
        count!(z);
        Encoders { x, y, z }
    }

    /// Counts of X, Y, Z, 16 bits each; they wrap around.
    pub fn read(&self) -> [u16; 3] {
        let Encoders { x, y, z } = self;
        [x.cnt().read().cnt().bits(), y.cnt().read().cnt().bits(), z.cnt().read().cnt().bits()]
    }
}
