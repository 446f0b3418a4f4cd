//! The example through the tap on the emulated chip, from pyserial: a sender that knows of no board, at a serial port.
//!
//! ```text
//! pyserial -- pseudo-terminal -- line of the simulated machine's time -- chip -- control
//! ```
//!
//! The operating system decides when pyserial writes; the simulated machine decides when a character is on the line, because a
//! free line waits for pyserial's next character. pyserial therefore counts as a sender that always has characters ready, like
//! one in this process, and the run is the same to the last bit.

use std::fs::File;
use std::io::{ErrorKind, Read, Write};
use std::time::Duration;

use arcfeed_control::code::{DC1, DC3};
use arcfeed_tests::Scratch;
use arcfeed_tests::python::{Script, python_or_skip};
use serialport::{SerialPort, TTYPort};

use crate::runs::Example;
use crate::tapped::{Sender, assert_same, in_process, run, tapped_chip};

/// A pyserial that writes nothing for so long has died.
const TIMEOUT: Duration = Duration::from_secs(120);
/// A terminal that gives nothing for so long has nothing.
const QUIET: Duration = Duration::from_millis(500);
/// More than a terminal holds on its own.
const LONG: usize = 1 << 18;

/// pyserial at the far end of a pseudo-terminal.
struct Pyserial {
    script: Script,
    line: TTYPort,
    /// The other end, held open so that the line exists before pyserial opens it.
    _theirs: File,
    /// Characters that are still to come.
    left: usize,
    _scratch: Scratch,
}

impl Pyserial {
    /// With this program to send.
    fn start(python: &str, name: &str, program: &[u8]) -> Self {
        let scratch = Scratch::new(name);
        let (mut line, theirs) = TTYPort::pair().expect("a pseudo-terminal");
        let device = theirs.name().expect("it has a name");
        // As a plain file: a serial port is locked, and pyserial must be able to open it.
        let held = File::options().read(true).write(true).open(&device).expect("it is there");
        drop(theirs);
        line.set_timeout(TIMEOUT).expect("a pseudo-terminal takes a timeout");
        let program_path = scratch.write("program.nc", program);
        let script = Script::start(python, "terminal_sender.py", &[&device, &program_path], &scratch.path("out"));
        script.line("open");
        Pyserial { script, line, _theirs: held, left: program.len(), _scratch: scratch }
    }

    /// All that comes until nothing comes any more.
    fn drain(&mut self) -> Vec<u8> {
        self.line.set_timeout(QUIET).expect("a pseudo-terminal takes a timeout");
        let (mut drained, mut buffer) = (Vec::new(), [0; 4_096]);
        loop {
            match self.line.read(&mut buffer) {
                Ok(length) => drained.extend(&buffer[..length]),
                Err(error) if error.kind() == ErrorKind::TimedOut => break,
                Err(error) => panic!("the terminal is gone: {error}"),
            }
        }
        self.line.set_timeout(TIMEOUT).expect("a pseudo-terminal takes a timeout");
        self.left -= drained.len();
        drained
    }
}

impl Sender for Pyserial {
    fn take(&mut self, most: usize) -> Vec<u8> {
        let mut bytes = vec![0; most.min(self.left)];
        self.left -= bytes.len();
        self.line.read_exact(&mut bytes).unwrap_or_else(|error| {
            panic!("pyserial sends nothing: {error}; it said `{}`", self.script.printed());
        });
        bytes
    }

    fn hear(&mut self, bytes: &[u8]) {
        self.line.write_all(bytes).expect("the terminal takes them");
    }
}

#[test]
fn pyserials_program_is_cut_through_the_chips_tap_bit_for_bit_as_that_of_a_sender_in_process() {
    let Some(python) = python_or_skip("pyserial through the chip's tap") else { return };
    let example = Example::load().of_eight_arcs();
    let sender = Pyserial::start(python, "tap-pyserial", &example.text);
    let chip = run(&example, tapped_chip(&example), sender);
    assert_same(&chip, &in_process(&example), &example);
    assert!(chip.line.xoff_count > 0 && chip.line.max_bytes_after_xoff <= 10, "{:?}", chip.line);
}

/// The example fits into the terminal: that pyserial obeys the control's DC3 is seen where it has more to send.
#[test]
fn the_same_pyserial_stops_at_dc3_and_goes_on_at_dc1() {
    let Some(python) = python_or_skip("pyserial, DC1 and DC3") else { return };
    let program: Vec<u8> = (0..LONG).map(|at| b'0' + (at % 10) as u8).collect();
    let mut sender = Pyserial::start(python, "tap-xoff", &program);
    let mut received = sender.take(1_000);
    sender.hear(&[DC3]);
    // The operating system stops pyserial with a delay.
    std::thread::sleep(QUIET);
    received.extend(sender.drain());
    let held = received.len();
    println!("{held} of {LONG} characters came before it stopped");
    assert!(held < LONG / 2 && !sender.script.printed().contains("sent"), "{held}");
    sender.hear(&[DC1]);
    received.extend(sender.take(usize::MAX));
    sender.script.line("sent");
    assert!(received == program, "byte for byte");
}
