//! The board on the DNC line between a sender and the control, with the example's job in place of parameters in flash.

use core::mem::MaybeUninit;

use arcfeed_firmware::tap::Tap;
use arcfeed_firmware::tap::settings::TapSettings;
use arcfeed_shared::job::Job;
use arcfeed_shared::nc::tape_code::Code;

use crate::example::ibr_slot::{add_rules, job};
use crate::handed::Once;
use crate::main_loop::Main;

/// Characters between the sender and the machine: a control's buffer, and some.
const ROOM: usize = 4_096;

static JOB: Once<MaybeUninit<Job>> = Once::new(MaybeUninit::uninit());
static TAP: Once<MaybeUninit<Tap<ROOM>>> = Once::new(MaybeUninit::uninit());

/// A board with its tap.
pub type Tapped = Main<ROOM>;

/// A tapped board that has just started; `None` if what it is told makes no sense, or if it was called before.
pub fn start() -> Option<Tapped> {
    let job = JOB.take()?.write(job());
    add_rules(job);
    let settings = TapSettings { code: Some(Code::Ascii), ..TapSettings::new(job.unit) };
    Main::start(Some((Tap::place(TAP.take()?, settings).ok()?, job)))
}
