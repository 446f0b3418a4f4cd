//! List for the operator at a restart: the functions that the program commands before the block, which the control does
//! not send again, and the modal state at the block.

use std::collections::VecDeque;

use arcfeed_nc::block::Block;
use arcfeed_nc::modal::{CompensationSide, FeedMode, Modal, MotionKind, Plane, Turn};
use arcfeed_units::{LengthUnit, Nm};

/// Largest number of M codes in the list; the last ones stay.
const M_CODES: usize = 35;

/// Functions commanded before the block of a restart, which the control shows to the operator.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RestartList {
    /// M codes in program order, at most the last ones; without stops (M0 to M2, M30) and calls (M98, M99).
    pub m: VecDeque<i64>,
    /// Last T number; `None` without one.
    pub t: Option<i64>,
    /// Last S value; `None` without one.
    pub s: Option<i64>,
    /// Modal state before the block of the restart; `None` if no block was read.
    pub modal: Option<Modal>,
    pending: Vec<(u8, i64)>,
}

impl RestartList {
    /// Enters the functions of the block before into the list, because a further block is read.
    pub(super) fn begin_block(&mut self, modal: &Modal) {
        self.modal = Some(*modal);
        for (letter, number) in self.pending.drain(..) {
            match letter {
                b'M' => {
                    self.m.push_back(number);
                    if self.m.len() > M_CODES {
                        self.m.pop_front();
                    }
                }
                b'T' => self.t = Some(number),
                _ => self.s = Some(number),
            }
        }
    }

    /// Feed in force before the block of the restart.
    pub fn feed(&self) -> Option<Nm> {
        self.modal.and_then(|modal| modal.feed)
    }

    /// Modal G codes in force before the block of the restart.
    pub fn codes(&self) -> Vec<String> {
        self.modal.as_ref().map(codes).unwrap_or_default()
    }

    /// Keeps the functions of a block until the next one is read.
    pub(super) fn add(&mut self, block: &Block) {
        let is_function = |letter, number| match letter {
            b'M' => !matches!(number, 0..=2 | 30 | 98 | 99),
            _ => matches!(letter, b'S' | b'T'),
        };
        let given = block.words.iter().filter_map(|word| Some((word.letter, word.number.as_whole()?)));
        self.pending.extend(given.filter(|(letter, number)| is_function(*letter, *number)));
    }
}

/// The modal G codes, group by group.
fn codes(modal: &Modal) -> Vec<String> {
    let motion = match modal.motion {
        MotionKind::Rapid => 0,
        MotionKind::Line => 1,
        MotionKind::Arc(Turn::Cw) => 2,
        MotionKind::Arc(Turn::Ccw) => 3,
    };
    let plane = match modal.plane {
        Plane::Xy => 17,
        Plane::Zx => 18,
        Plane::Yz => 19,
    };
    let feed_mode = match modal.feed_mode {
        FeedMode::InverseTime => 93,
        FeedMode::PerMinute => 94,
        FeedMode::PerRevolution => 95,
    };
    let compensation = match modal.compensation {
        None => 40,
        Some(CompensationSide::Left) => 41,
        Some(CompensationSide::Right) => 42,
    };
    let motion = modal.cycle.map_or(motion, |cycle| i32::from(cycle.code));
    let distance = if modal.absolute { 90 } else { 91 };
    let unit = if modal.unit == LengthUnit::Inch { 20 } else { 21 };
    let level = if modal.returns_to_r { 99 } else { 98 };
    let whole = [motion, plane, distance, feed_mode, unit, compensation, level];
    let mut codes: Vec<String> = whole.into_iter().map(|code| format!("G{code}")).collect();
    codes.push(match modal.length_sign {
        0 => "G49".to_owned(),
        sign => {
            let code = if modal.follows_tool_center {
                "43.4"
            } else if sign > 0 {
                "43"
            } else {
                "44"
            };
            format!("G{code} H{}", modal.length_offset)
        }
    });
    codes.push(match modal.system {
        system @ 0..=5 => format!("G{}", 54 + system),
        system => format!("G54.1 P{}", system - 5),
    });
    codes.extend(modal.polar.map(|_| "G16".to_owned()));
    codes.extend(modal.frame.scaling().map(|stretch| if stretch.code == 510 { "G51" } else { "G51.1" }.to_owned()));
    codes.extend(modal.frame.rotation().map(|turned| format!("G68 R{}", turned.angle.to_deg())));
    codes
}
