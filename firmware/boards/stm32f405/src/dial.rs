//! ADC1, channel 4: continuous conversion of the operator's dial.

use stm32f4::stm32f405::{ADC_COMMON, ADC1};

/// Channel of PA4.
const CHANNEL: u8 = 4;
/// Power-up time of the converter in cycles of the fastest core: 3 us.
const POWER_UP_CYCLES: u32 = 3 * 168;

/// Running analogue-to-digital converter of the operator's dial.
#[derive(Debug)]
pub struct DialConverter(ADC1);

impl DialConverter {
    /// Starts conversions, one every 23 us.
    pub fn start(adc: ADC1, common: &ADC_COMMON) -> Self {
        common.ccr().modify(|_, w| w.adcpre().div4());
        adc.smpr2().write(|w| w.smp4().cycles480());
        // SAFETY: a channel that the converter has.
        adc.sqr3().write(|w| unsafe { w.sq1().bits(CHANNEL) });
        adc.cr2().write(|w| w.adon().set_bit().cont().set_bit());
        cortex_m::asm::delay(POWER_UP_CYCLES);
        adc.cr2().modify(|_, w| w.swstart().set_bit());
        DialConverter(adc)
    }

    /// The newest reading of the dial, in counts of 12 bits; `None` if there was none since the last call.
    pub fn read(&mut self) -> Option<u16> {
        let is_converted = self.0.sr().read().eoc().bit_is_set();
        // Reading the data clears the flag.
        is_converted.then(|| self.0.dr().read().data().bits())
    }
}
