//! Meaning of the contacts on port B: buttons, and signals of the control's ladder.
//!
//! A contact is closed while its coupler conducts. A signal of the ladder is active while its contact is **open**, so
//! that a broken wire excludes the laws. The buttons arm, reset and zero are pressed while closed, and count only
//! after they were open. Disarm is pressed while open; after it, arm must be released before it counts again.

use arcfeed_firmware::supervisor::signals::{Request, Signals};

/// Contact: the receivers of all three encoders report no error.
pub const ENCODERS_SOUND: u16 = 1 << 0;
/// Button: the axes are at the program's zero, before its start.
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

/// Contacts that count as closed at the start: open signals of the control exclude the laws, and the buttons arm,
/// reset and zero count only after a release.
pub const AT_START: u16 = ZERO | ARM | RESET;

/// Reads the panel's contacts; holds which buttons were open and which pressed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Panel {
    seen_open: u16,
    pressed_before: u16,
}

/// Signals and pressed buttons of the panel at a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PanelState {
    /// Signals of the control's PLC and requests of a person, each as long as its contact is active.
    pub signals: Signals,
    /// Whether the button zero (the axes are at the program's zero) was pressed at this tick.
    pub zero_now: bool,
    /// Whether the button reset was pressed at this tick.
    pub reset_now: bool,
}

impl Panel {
    /// Processes the debounced contacts of a tick; a bit is 1 if its contact is closed.
    pub fn read(&mut self, closed: u16) -> PanelState {
        self.seen_open |= !closed;
        if closed & NO_DISARM == 0 {
            // A press of arm during disarm, or one that lasts longer, does not arm.
            self.seen_open &= !ARM;
        }
        let pressed = closed & self.seen_open;
        let pressed_now = pressed & !self.pressed_before;
        self.pressed_before = pressed;
        PanelState {
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
