//! Log messages of a transmission: everything that has changed since the messages were last requested.

use super::sender::{Sender, State};

/// Source of log messages about a transmission (signals of the control, blocks sent and executed, alarm, end). It keeps
/// what it has already reported, so that each change is reported once.
#[derive(Debug)]
pub struct Events {
    /// Lines that a control counts as blocks.
    blocks: Vec<usize>,
    is_taken: Option<bool>,
    xoffs: u32,
    state: State,
    line: usize,
    executed: usize,
    has_alarm: bool,
}

impl Events {
    /// Starts with the sender's present state: only later changes are reported.
    pub fn new(sender: &Sender) -> Self {
        Events {
            blocks: sender.transmission().block_lines(),
            is_taken: sender.is_taken(),
            xoffs: sender.counters().xoff_count,
            state: sender.state(),
            line: sender.line(),
            executed: 0,
            has_alarm: false,
        }
    }

    /// Messages for all changes since the last call. `executed` is the number of blocks that the control has started,
    /// `alarm` its alarm; both are `None` if the control does not report them.
    pub fn messages(&mut self, sender: &Sender, executed: Option<usize>, alarm: Option<&str>) -> Vec<String> {
        let mut new = Vec::new();
        self.signals(sender, &mut new);
        let sending = sender.transmission();
        let place = |index: usize| match sending.lines().get(index).map_or(0, |line| line.source) {
            0 => "a line of ours".to_owned(),
            line => format!("line {line}"),
        };
        let line = sender.line();
        for index in (self.line..line).filter(|index| sending.is_block(*index)) {
            let text = sending.line_text(index).unwrap_or_default().trim_ascii();
            new.push(format!("sent {}: {}", place(index), text.escape_ascii()));
        }
        let executed = executed.unwrap_or(0).min(self.blocks.len());
        new.extend(self.blocks.get(self.executed..executed).unwrap_or_default().iter().map(|index| {
            let place = place(*index);
            format!("executes {place}")
        }));
        (self.line, self.executed) = (line, executed.max(self.executed));
        if let Some(alarm) = alarm.filter(|_| !self.has_alarm) {
            new.push(format!("alarm: {alarm}"));
            self.has_alarm = true;
        }
        let state = sender.state();
        if state != self.state {
            match state {
                State::Held => new.push("held".into()),
                State::Sent => new.push("all sent".into()),
                State::Aborted => new.push("aborted".into()),
                State::Failed(why) => new.push(format!("given up: {why}")),
                State::Sending | State::Stopped if self.state == State::Held => new.push("resumed".into()),
                State::Waiting | State::Sending | State::Stopped => {}
            }
            self.state = state;
        }
        new
    }

    /// Message for DC1 and DC3, which alternate: their number and the last one are enough.
    fn signals(&mut self, sender: &Sender, new: &mut Vec<String>) {
        let (last, mut dc3s) = (sender.is_taken(), sender.counters().xoff_count - self.xoffs);
        while dc3s > 0 || self.is_taken != last {
            let is_dc3 = self.is_taken == Some(true);
            new.push(if is_dc3 { "DC3" } else { "DC1" }.into());
            dc3s = dc3s.saturating_sub(u32::from(is_dc3));
            self.is_taken = Some(!is_dc3);
        }
        self.xoffs = sender.counters().xoff_count;
    }
}

#[cfg(test)]
mod tests {
    use arcfeed_units::Micros;

    use super::*;
    use crate::pace::Pace;
    use crate::sender::{CHUNK, LineUse};
    use crate::transmission::{Transmission, Wire};

    #[test]
    fn what_happens_between_two_looks_is_reported_in_its_order() {
        let wire = Wire { encode: Some, filters: false, tv_check: false };
        let sending = Transmission::new(b"%\nG0X1.\nM30\n%\n", |at| at + 1, &wire).unwrap();
        let pace = Pace::new(11, 9_600, Some(Micros(0)));
        let line = LineUse { pace, xonxoff: true, eight_bits: false, start_timeout: None, xoff_timeout: None };
        let mut sender = Sender::new(sending, line);
        let mut events = Events::new(&sender);
        assert!(events.messages(&sender, None, None).is_empty());
        let (now, mut out) = (Micros::from_ms(1_000), [0; CHUNK]);
        sender.on_bytes(now, &[0x11, 0x13, 0x11]);
        assert_eq!(events.messages(&sender, None, None), ["DC1", "DC3", "DC1"]);
        for ms in 1_000..1_020 {
            sender.poll_transmit(Micros::from_ms(ms), &mut out);
        }
        sender.on_bytes(now, &[0x13]);
        let found = events.messages(&sender, Some(1), Some("PS0010"));
        assert_eq!(found[..2], ["DC3".to_owned(), "sent line 3: G0X1.".to_owned()]);
        assert_eq!(found[found.len() - 3..], ["executes line 3", "alarm: PS0010", "all sent"]);
        assert!(events.messages(&sender, Some(1), Some("PS0010")).is_empty());
    }
}
