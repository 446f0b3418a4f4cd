//! What the contacts on port B mean: buttons, and what the control's ladder says.
//!
//! A contact is closed while its coupler conducts. What the ladder says is true while its contact is **open**, so that a
//! broken wire keeps the laws off. Buttons that ask for more - arm, reset, zero - are pressed while closed, and count only
//! after they were seen open; disarm is pressed while open, and while it is, arm must be let go before it counts again.

use arcfeed_firmware::supervisor::signals::{Request, Signals};

/// The receivers of all three encoders are content.
pub const ENCODERS_SOUND: u16 = 1 << 0;
/// "The axes stand at the program's zero, and it is about to begin."
const ZERO: u16 = 1 << 1;
const NO_FEED_HOLD: u16 = 1 << 8;
const NO_RAPID: u16 = 1 << 9;
/// Neither a tapping cycle nor G63.
const NO_TAPPING: u16 = 1 << 10;
const NO_THREADING: u16 = 1 << 11;
const NO_CUTTER_COMPENSATION: u16 = 1 << 12;
const ARM: u16 = 1 << 13;
const NO_DISARM: u16 = 1 << 14;
const RESET: u16 = 1 << 15;

/// Closed contacts to begin with: all that is open keeps the laws off, the buttons that ask for more seem stuck.
pub const AT_START: u16 = ZERO | ARM | RESET;

/// Buttons seen open; state.
#[derive(Clone, Copy, Debug, Default)]
pub struct Panel {
    seen_open: u16,
    pressed_before: u16,
}

/// What the panel says at a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Said {
    /// What the ladder says, and what a person asks for: each for as long as its contact says so.
    pub signals: Signals,
    /// Zero was pressed just now.
    pub zero_now: bool,
    /// Reset was pressed just now.
    pub reset_now: bool,
}

impl Panel {
    /// Takes the settled contacts, closed ones 1.
    pub fn read(&mut self, closed: u16) -> Said {
        self.seen_open |= !closed;
        if closed & NO_DISARM == 0 {
            // Neither a press in the meantime nor one that outlasts it arms.
            self.seen_open &= !ARM;
        }
        let pressed = closed & self.seen_open;
        let pressed_now = pressed & !self.pressed_before;
        self.pressed_before = pressed;
        Said {
            signals: signals(closed, pressed),
            zero_now: pressed_now & ZERO != 0,
            reset_now: pressed_now & RESET != 0,
        }
    }
}

fn signals(closed: u16, pressed: u16) -> Signals {
    let while_open = [
        (NO_FEED_HOLD, Signals::FEED_HOLD),
        (NO_RAPID, Signals::RAPID),
        (NO_TAPPING, Signals::TAPPING),
        (NO_THREADING, Signals::THREADING),
        (NO_CUTTER_COMPENSATION, Signals::CUTTER_COMPENSATION),
        (NO_DISARM, Signals::of_request(Request::Disarm)),
    ];
    let while_pressed = [(ARM, Signals::of_request(Request::Arm)), (RESET, Signals::of_request(Request::Reset))];
    let open = while_open.into_iter().filter(|(contact, _)| closed & contact == 0);
    let held = while_pressed.into_iter().filter(|(contact, _)| pressed & contact != 0);
    open.chain(held).fold(Signals::NONE, |all, (_, signal)| all.with(signal))
}
