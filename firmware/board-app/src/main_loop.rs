//! The main loop of a board: the link to its host, and the tap if there is one. The calls are the same on a chip and
//! in process.

use arcfeed_nc::modal::Pose;
use arcfeed_units::Micros;

use crate::application::host_link::HostLink;
use crate::tap::{Tap, TapSegment};

/// Host link and tap; state. The tap has room for `N` characters; with `N` = 0 there is no tap and no code for it.
pub struct MainLoop<'q, const N: usize> {
    host_link: HostLink<'q>,
    tap: Option<&'q mut Tap<N>>,
}

impl<'q, const N: usize> MainLoop<'q, N> {
    /// A main loop. With a tap the segments come from the tapped line, and the job must have been loaded.
    pub fn new(host_link: HostLink<'q>, tap: Option<&'q mut Tap<N>>) -> Self {
        MainLoop { host_link, tap }
    }

    /// Processes bytes received on the link.
    pub fn on_link_bytes(&mut self, now: Micros, bytes: &[u8]) {
        self.host_link.on_link_bytes(now, bytes);
    }

    /// Writes the next frame of the link into `out` and returns its length; 0 if there is none. Call it until it
    /// returns 0.
    pub fn poll_link(&mut self, now: Micros, out: &mut [u8]) -> usize {
        self.host_link.poll_link(now, out)
    }

    /// Processes a character of the sender; returns it for the control.
    pub fn from_sender(&mut self, now: Micros, byte: u8) -> u8 {
        self.parts().1.map_or(byte, |tap| tap.from_sender(now, byte))
    }

    /// Processes a character of the control; returns it for the sender.
    pub fn from_control(&mut self, now: Micros, byte: u8) -> u8 {
        self.parts().1.map_or(byte, |tap| tap.from_control(now, byte))
    }

    /// Registers that a character of the sender was lost or unreadable.
    pub fn on_line_error(&mut self) {
        if let Some(tap) = self.parts().1 {
            tap.on_line_error();
        }
    }

    /// Processes a new position, before its tick.
    pub fn on_position(&mut self, position: &Pose) {
        let (host_link, Some(tap)) = self.parts() else { return };
        let status = host_link.handler().status();
        let in_work = status.filter(|status| status.is_in_work).map(|status| status.record.block);
        tap.follow(in_work, status.map_or(0, |status| status.executed), position);
        if tap.must_clear() {
            host_link.handler_mut().begin_run();
        }
        while host_link.handler().room() > 0
            && let Some(TapSegment { count, segment }) = host_link.handler().job().and_then(|job| tap.next(job))
        {
            let _room = host_link.handler_mut().push(count, segment);
        }
    }

    /// Does the periodic work, ideally before and after each tick.
    pub fn run(&mut self, now: Micros) {
        self.host_link.run(now);
    }

    fn parts(&mut self) -> (&mut HostLink<'q>, Option<&mut Tap<N>>) {
        let MainLoop { host_link, tap } = self;
        (host_link, if N == 0 { None } else { tap.as_deref_mut() })
    }

    /// The link to the host.
    pub fn host_link(&self) -> &HostLink<'q> {
        &self.host_link
    }

    /// The link to the host, for input that does not come over a line.
    pub fn host_link_mut(&mut self) -> &mut HostLink<'q> {
        &mut self.host_link
    }

    /// The tap.
    pub fn tap(&self) -> Option<&Tap<N>> {
        self.tap.as_deref()
    }
}

/// A board without a tap.
pub type Untapped<'q> = MainLoop<'q, 0>;
