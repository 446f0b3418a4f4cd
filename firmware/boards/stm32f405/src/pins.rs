//! All pins of the image. The table of README.md describes this file.

use stm32f4::stm32f405::{GPIOA, GPIOB, GPIOC};

/// Pins of port C: *FV0 to *FV7, in this order from pin 0; a high pin is a released line.
pub const LINES: u32 = 0xFF;
/// Pin of port C that is low while no alarm is latched (fault of the board, loss of the position).
pub const READY: u32 = 1 << 8;
/// Pin of port C whose level changes every 100 ms while the tick runs.
pub const HEARTBEAT: u32 = 1 << 9;

/// Values of a pin's two bits in MODER and PUPDR.
const OUTPUT: u32 = 1;
const ALTERNATE: u32 = 2;
const ANALOG: u32 = 3;
const PULL_UP: u32 = 1;

/// Port A: the tacho on TIM2, X on TIM3, Z on TIM1, the dial.
const TACHO: [usize; 1] = [0];
const X: [usize; 2] = [6, 7];
const Z: [usize; 2] = [8, 9];
const DIAL: [usize; 1] = [4];
/// Port B: Y on TIM4, and the contacts.
const Y: [usize; 2] = [6, 7];
const CONTACTS: [usize; 10] = [0, 1, 8, 9, 10, 11, 12, 13, 14, 15];

/// Changes the fields of the used pins in a register.
macro_rules! set {
    ($register:expr, $fields:expr) => {
        // SAFETY: every value of two or four bits is valid here, and only fields of pins listed above change.
        $register.modify(|r, w| unsafe { w.bits((r.bits() & !$fields.0) | $fields.1) })
    };
}

/// Releases the override lines, sets "not ready", then configures all pins.
pub fn set_up(a: &GPIOA, b: &GPIOB, c: &GPIOC) {
    let outputs = LINES | READY | HEARTBEAT;
    // SAFETY: sets output bits that are not driven yet, so that they begin high: released.
    c.bsrr().write(|w| unsafe { w.bits(outputs) });
    // SAFETY: open drain on our outputs.
    c.otyper().modify(|r, w| unsafe { w.bits(r.bits() | outputs) });
    let ten = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9];
    set!(c.pupdr(), fields::<2>(&[(&ten, PULL_UP)]));
    set!(c.moder(), fields::<2>(&[(&ten, OUTPUT)]));

    set!(a.pupdr(), fields::<2>(&[(&TACHO, PULL_UP), (&X, PULL_UP), (&Z, PULL_UP), (&DIAL, 0)]));
    set!(a.afrl(), fields::<4>(&[(&TACHO, 1), (&X, 2)]));
    set!(a.afrh(), fields::<4>(&[(&Z.map(|pin| pin - 8), 1)]));
    set!(a.moder(), fields::<2>(&[(&TACHO, ALTERNATE), (&X, ALTERNATE), (&Z, ALTERNATE), (&DIAL, ANALOG)]));

    set!(b.pupdr(), fields::<2>(&[(&Y, PULL_UP), (&CONTACTS, PULL_UP)]));
    set!(b.afrl(), fields::<4>(&[(&Y, 2)]));
    set!(b.moder(), fields::<2>(&[(&Y, ALTERNATE), (&CONTACTS, 0)]));
}

/// Mask and value of a register with `BITS` bits per pin.
fn fields<const BITS: usize>(pins: &[(&[usize], u32)]) -> (u32, u32) {
    let each = pins.iter().flat_map(|(pins, value)| pins.iter().map(|pin| (BITS * pin, *value)));
    each.fold((0, 0), |(mask, bits), (shift, value)| {
        let ones = (1 << BITS) - 1;
        (mask | (ones << shift), bits | (value << shift))
    })
}
