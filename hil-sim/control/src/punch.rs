//! Output of the control: text to the sender (DPRNT), at line rate; the sender stops it with DC3 and starts it with
//! DC1.
//!
//! Opening sends DC2, closing DC4. After the sender's DC3 a control sends at most ten more characters; this model sends
//! none. Source: B-63503EN p. 62; that POPEN and PCLOS send DC2 and DC4 is not published, an assumption. BPRNT sends
//! eight bits per character: a line of seven data bits truncates them, and a sender cannot distinguish DC1, DC3 and DC4
//! from numbers.

use std::collections::VecDeque;

use arcfeed_nc_macro::print::Output;

use super::code::{DC1, DC2, DC3, DC4, TapeCode, with_even_parity};

/// Queue of the control's output to the sender (statements POPEN, DPRNT, BPRNT, PCLOS). Keeps its state between calls.
#[derive(Debug, Default)]
pub struct Punch {
    queue: VecDeque<u8>,
    is_open: bool,
    is_stopped: bool,
}

impl Punch {
    /// Queues the output of a macro statement; `code` is the character code of the line.
    pub fn put(&mut self, output: &Output, code: TapeCode) {
        match output {
            Output::Open => self.open(),
            Output::Close => self.close(),
            Output::Text(text) => self.print(text.strip_suffix(b"\n").unwrap_or(text), code),
            Output::Binary(frames) => self.queue.extend(frames),
        }
    }

    /// Whether characters are queued and the sender has not stopped the output.
    pub fn is_sending(&self) -> bool {
        !self.queue.is_empty() && !self.is_stopped
    }

    /// Queues the characters that begin an output (POPEN).
    pub fn open(&mut self) {
        self.is_open = true;
        self.is_stopped = false;
        self.queue.push_back(with_even_parity(DC2));
    }

    /// Queues a line of text (DPRNT); characters that the code does not have become blanks.
    pub fn print(&mut self, text: &[u8], code: TapeCode) {
        let frames = text.iter().chain(b"\n").filter_map(|byte| code.encode(*byte).or(code.encode(b' ')));
        self.queue.extend(frames);
    }

    /// Queues the characters that end an output (PCLOS).
    pub fn close(&mut self) {
        if std::mem::take(&mut self.is_open) {
            self.queue.push_back(with_even_parity(DC4));
        }
    }

    /// Reset: discards what has not been sent.
    pub fn reset(&mut self) {
        self.queue.clear();
        self.close();
        self.is_stopped = false;
    }

    /// Handles a character from the sender: DC3 stops the output, DC1 starts it again. Returns whether the character was meant for the
    /// output: it is DC1 or DC3, and output is open or waits.
    pub fn receive(&mut self, byte: u8) -> bool {
        match byte {
            DC1 => self.is_stopped = false,
            DC3 => self.is_stopped = true,
            _ => return false,
        }
        self.is_open || !self.queue.is_empty()
    }

    /// Takes the next character to be sent; `None` if there is none or the sender has stopped the output.
    pub fn poll(&mut self) -> Option<u8> {
        if self.is_stopped { None } else { self.queue.pop_front() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drain(punch: &mut Punch) -> Vec<u8> {
        std::iter::from_fn(|| punch.poll()).collect()
    }

    #[test]
    fn a_line_goes_out_between_dc2_and_dc4() {
        let mut punch = Punch::default();
        punch.open();
        punch.print(b"X1.5", TapeCode::Ascii);
        punch.close();
        assert_eq!(drain(&mut punch), b"\x12X1.5\n\x14");
    }

    #[test]
    fn dc3_stops_it_and_dc1_starts_it_again() {
        let mut punch = Punch::default();
        punch.open();
        punch.print(b"AB", TapeCode::Ascii);
        assert_eq!((punch.poll(), punch.poll()), (Some(DC2), Some(b'A')));
        assert!(punch.receive(DC3));
        assert_eq!(punch.poll(), None);
        assert!(punch.receive(DC1));
        assert_eq!(drain(&mut punch), b"B\n");
    }
}
