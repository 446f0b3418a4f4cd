//! The board on the DNC line between a sender and the control, with the example's job in place of parameters in flash.

use arcfeed_firmware::tap::Tap;
use arcfeed_firmware::tap::settings::TapSettings;
use arcfeed_shared::nc::tape_code::Code;

use crate::example::ibr_slot::{add_rules, job};
use crate::main_loop::Main;

/// Characters between the sender and the machine: a control's buffer, and some.
const ROOM: usize = 4_096;

/// A board with its tap.
pub type Tapped = Main<ROOM>;

/// A tapped board that has just started; `None` if what it is told makes no sense, or if it was called before.
pub fn start() -> Option<Tapped> {
    let mut job = job();
    add_rules(&mut job);
    let settings = TapSettings { code: Some(Code::Ascii), ..TapSettings::new(job.unit) };
    Main::start(Some((Tap::<ROOM>::new(settings).ok()?, &job)))
}
