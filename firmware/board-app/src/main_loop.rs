//! The main loop of a board: the link to its host, and the tap if there is one. The calls are the same on a chip and
//! in process.

use arcfeed_nc::modal::Pose;
use arcfeed_units::Micros;

use crate::application::host_link::HostLink;
use crate::tap::{Tap, TapSegment};

/// Main loop of a board: its host link, and its tap if it has one. The tap has room for `N` characters; with `N` = 0
/// there is no tap, and no code for it.
pub struct MainLoop<'q, const N: usize> {
    host_link: HostLink<'q>,
    tap: Option<&'q mut Tap<N>>,
}

impl<'q, const N: usize> MainLoop<'q, N> {
    /// Main loop of these parts. With a tap, the segments come from the tapped line, and the job must have been loaded
    /// before.
    pub fn new(host_link: HostLink<'q>, tap: Option<&'q mut Tap<N>>) -> Self {
        MainLoop { host_link, tap }
    }

    /// Processes bytes that have arrived on the link at the time `now`.
    pub fn on_link_bytes(&mut self, now: Micros, bytes: &[u8]) {
        self.host_link.on_link_bytes(now, bytes);
    }

    /// Writes the next frame of the link into `out` and returns its length; 0 if there is none. Call it until it
    /// returns 0.
    pub fn poll_link(&mut self, now: Micros, out: &mut [u8]) -> usize {
        self.host_link.poll_link(now, out)
    }

    /// Processes a character that has arrived from the sender of the NC program; returns it to be passed on to the
    /// control.
    pub fn from_sender(&mut self, now: Micros, byte: u8) -> u8 {
        self.parts().1.map_or(byte, |tap| tap.from_sender(now, byte))
    }

    /// Processes a character that has arrived from the control; returns it to be passed on to the sender.
    pub fn from_control(&mut self, now: Micros, byte: u8) -> u8 {
        self.parts().1.map_or(byte, |tap| tap.from_control(now, byte))
    }

    /// Records that a character of the sender was lost or could not be read.
    pub fn on_line_error(&mut self) {
        if let Some(tap) = self.parts().1 {
            tap.on_line_error();
        }
    }

    /// Processes a new position of the axes; to be called before the tick that uses it.
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

    /// Does everything that does not depend on arriving bytes; to be called before and after each tick.
    pub fn run(&mut self, now: Micros) {
        self.host_link.run(now);
    }

    fn parts(&mut self) -> (&mut HostLink<'q>, Option<&mut Tap<N>>) {
        let MainLoop { host_link, tap } = self;
        (host_link, if N == 0 { None } else { tap.as_deref_mut() })
    }

    /// Link to the host.
    pub fn host_link(&self) -> &HostLink<'q> {
        &self.host_link
    }

    /// Link to the host, for input that does not come over a line.
    pub fn host_link_mut(&mut self) -> &mut HostLink<'q> {
        &mut self.host_link
    }

    /// The tap; `None` if the board has none.
    pub fn tap(&self) -> Option<&Tap<N>> {
        self.tap.as_deref()
    }
}

/// Main loop of a board without a tap.
pub type Untapped<'q> = MainLoop<'q, 0>;
