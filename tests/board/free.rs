//! A tapped board that obeys orders and runs free, seen from its machine.

use arcfeed_link::plain::PlainLine;
use arcfeed_tests::emulation::qemu::{Clock, Emulator};
use arcfeed_tests::emulation::served_chip::show_standing;

use crate::runs::Example;
use crate::tapped::{chip_with_page, page_of};

/// The image that obeys orders.
pub const OBEYING: &str = "feedboard-hang";

/// The board and its line to the machine.
pub struct Free {
    pub board: Emulator,
    pub line: PlainLine,
}

impl Free {
    /// With the example's job in its flash; it runs free from the first sample that it is shown.
    pub fn start() -> Self {
        Free {
            board: chip_with_page(OBEYING, Clock::CountedWaiting, &page_of(&Example::load())),
            line: PlainLine::new(),
        }
    }

    /// Shows it a machine that stands at its zero.
    pub fn show(&mut self) {
        show_standing(&mut self.board, &mut self.line);
    }

    /// Log of the board.
    pub fn log(&self) -> Vec<String> {
        self.board.log()
    }

    /// Number of its starts.
    pub fn starts(&self) -> usize {
        self.log().iter().filter(|line| line.contains("feedboard: start")).count()
    }
}
