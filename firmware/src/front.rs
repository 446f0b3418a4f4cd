//! The main loop's side of a board: the desk, and the tap where there is one. Same calls on a chip and in process.

use arcfeed_shared::nc::modal::Pose;
use arcfeed_shared::units::Micros;

use crate::station::desk::Desk;
use crate::tap::{Handed, Tap};

/// Desk and tap; state. The tap has room for `N` characters; with 0 there is none, and no code for one.
pub struct Front<'q, const N: usize> {
    desk: Desk<'q>,
    tap: Option<&'q mut Tap<N>>,
}

impl<'q, const N: usize> Front<'q, N> {
    /// A desk; with a tap the segments are the tapped line's, and the job must have been adopted.
    pub fn new(desk: Desk<'q>, tap: Option<&'q mut Tap<N>>) -> Self {
        Front { desk, tap }
    }

    /// Takes bytes off the link's line.
    pub fn on_link_bytes(&mut self, now: Micros, bytes: &[u8]) {
        self.desk.on_link_bytes(now, bytes);
    }

    /// Puts the next frame for the link's line into `out`; its length, 0 if there is none. Call until it answers 0.
    pub fn poll_link(&mut self, now: Micros, out: &mut [u8]) -> usize {
        self.desk.poll_link(now, out)
    }

    /// A character of the sender: the same, for the control.
    pub fn from_sender(&mut self, now: Micros, byte: u8) -> u8 {
        self.parts().1.map_or(byte, |tap| tap.from_sender(now, byte))
    }

    /// A character of the control: the same, for the sender.
    pub fn from_control(&mut self, now: Micros, byte: u8) -> u8 {
        self.parts().1.map_or(byte, |tap| tap.from_control(now, byte))
    }

    /// A character of the sender was lost, or could not be read, behind all that was heard so far.
    pub fn on_line_error(&mut self) {
        if let Some(tap) = self.parts().1 {
            tap.on_line_error();
        }
    }

    /// A new position, before the tick that takes it.
    pub fn see(&mut self, position: &Pose) {
        let (desk, Some(tap)) = self.parts() else { return };
        let told = desk.clerk().told();
        let in_work = told.filter(|told| told.is_in_work).map(|told| told.record.block);
        tap.follow(in_work, told.map_or(0, |told| told.executed), position);
        if tap.must_clear() {
            desk.clerk_mut().begin_run();
        }
        while desk.clerk().room() > 0
            && let Some(Handed { count, segment }) = desk.clerk().job().and_then(|job| tap.next(job))
        {
            let _room = desk.clerk_mut().push(count, segment);
        }
    }

    /// What is to be done now and then, best before and after each tick.
    pub fn run(&mut self, now: Micros) {
        self.desk.run(now);
    }

    fn parts(&mut self) -> (&mut Desk<'q>, Option<&mut Tap<N>>) {
        let Front { desk, tap } = self;
        (desk, if N == 0 { None } else { tap.as_deref_mut() })
    }

    /// The desk.
    pub fn desk(&self) -> &Desk<'q> {
        &self.desk
    }

    /// The desk, for what does not come over a line.
    pub fn desk_mut(&mut self) -> &mut Desk<'q> {
        &mut self.desk
    }

    /// The tap.
    pub fn tap(&self) -> Option<&Tap<N>> {
        self.tap.as_deref()
    }
}

/// A board without a tap.
pub type Untapped<'q> = Front<'q, 0>;
