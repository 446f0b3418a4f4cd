//! A tapped board that obeys orders and runs free, seen from its machine.

use std::fs;

use arcfeed_hil_sim::decider::board::{Wire, Wires};
use arcfeed_shared::units::Micros;
use arcfeed_shared::wire::frame::ENCODED_MAX;
use arcfeed_shared::wire::message::Message;
use arcfeed_shared::wire::message::codes::ModeCode;
use arcfeed_shared::wire::message::fixed::Q40;
use arcfeed_shared::wire::message::table::Sample;
use arcfeed_shared::wire::plain::PlainLine;
use arcfeed_tests::emulation::images::image;
use arcfeed_tests::emulation::log::messages;
use arcfeed_tests::emulation::qemu::Emulator;

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
        Free { board: chip_with_page(OBEYING, &page_of(&Example::load())), line: PlainLine::new() }
    }

    /// Shows it a machine that stands at its zero.
    pub fn show(&mut self) {
        let sample = Sample {
            at: 0,
            mode: ModeCode::Free,
            linear: Some([0; 3]),
            rotary: None,
            spindle: Q40::of(1_000.0_f32).expect("a speed"),
            operator_percent: 100,
            signals: 0,
            link_bytes: 0,
            tap_bytes: 0,
        };
        let mut frame = [0; ENCODED_MAX];
        let length = self.line.encode(Micros(0), &Message::Sample(sample), &mut frame);
        self.board.put(Wire::Machine, &frame[..length]).expect("the machine line is open");
    }

    /// What it has logged.
    pub fn log(&self) -> Vec<String> {
        let console = self.board.console();
        let whole = console.iter().rposition(|byte| *byte == 0).map_or(0, |end| end + 1);
        if whole == 0 { Vec::new() } else { messages(&fs::read(image(OBEYING)).expect("the image"), &console[..whole]) }
    }

    /// How often it has started.
    pub fn starts(&self) -> usize {
        self.log().iter().filter(|line| line.contains("feedboard: start")).count()
    }
}
