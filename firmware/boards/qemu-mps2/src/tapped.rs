//! The board on the DNC line between a sender and the control, with tool, laws and cut rules from flash.

use core::mem::MaybeUninit;

use arcfeed_board_app::application::command_handler::CommandHandler;
use arcfeed_board_app::tap::Tap;
use arcfeed_board_app::tap::settings::TapSettings;
use arcfeed_link::message::page::{PAGE_MAX, PageError};
use arcfeed_units::LengthUnit;

use crate::flash;
use crate::handed::Once;
use crate::main_loop::Main;

/// Characters between the sender and the machine: a control's buffer and a reserve.
const ROOM: usize = 4_096;
/// Number of the only set of parameters.
const SET: u32 = 1;

/// Copy of the flash page; a real chip reads its flash in place.
static PAGE: Once<[u8; PAGE_MAX]> = Once::new([0; PAGE_MAX]);
static TAP: Once<MaybeUninit<Tap<ROOM>>> = Once::new(MaybeUninit::uninit());

/// Main program of a board with a tap on the DNC line.
pub type Tapped = Main<ROOM>;

/// Starts a board with a tap; `None` if it was started before.
pub fn start() -> Option<Tapped> {
    Main::start(Some(tap))
}

fn tap(handler: &mut CommandHandler<'_>) -> Option<&'static mut Tap<ROOM>> {
    let settings = adopt(handler, flash::parameters(PAGE.take()?));
    Tap::place(TAP.take()?, settings).ok()
}

/// Loads the parameters in flash and returns the settings of their line. Without parameters, or with corrupt ones, a
/// tap only forwards characters.
fn adopt(handler: &mut CommandHandler<'_>, page: &[u8]) -> TapSettings {
    let line = handler.load_page(page, SET).unwrap_or_else(|error| {
        match error {
            PageError::Blank => defmt::warn!("no parameters in flash: nothing is adapted"),
            PageError::Schema => defmt::error!("the parameters in flash are of another version: write them anew"),
            _ => defmt::error!("the parameters in flash are broken: write them anew"),
        }
        Default::default()
    });
    TapSettings::of_line(line, handler.job().map_or(LengthUnit::Mm, |job| job.unit))
}
