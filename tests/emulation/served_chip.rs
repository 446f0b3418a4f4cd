//! The board's image in the emulator at a TCP port, in the time of the wall, at a machine that stands.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use arcfeed_hil_sim::override_source::board::{Wire, Wires};
use arcfeed_link::frame::ENCODED_MAX;
use arcfeed_link::message::Message;
use arcfeed_link::message::codes::{ModeCode, StateCode};
use arcfeed_link::message::fixed::Q40;
use arcfeed_link::message::table::Sample;
use arcfeed_link::plain::PlainLine;
use arcfeed_units::Micros;

use super::qemu::{Clock, Emulator, Place};
use crate::wait_for;

const ROUND: Duration = Duration::from_millis(1);
/// Rounds from one sample to the next: positions are fresh for 50 ms.
const SHOWN_EVERY: u32 = 8;

/// A chip with its host's line; the line stays when the chip loses its power.
pub struct ServedChip {
    /// To give to arcfeed.
    pub url: String,
    place: Place,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct Shared {
    is_over: AtomicBool,
    /// To be switched on in place of the one that runs.
    next: Mutex<Option<Emulator>>,
    /// State of the override, as last reported since this start of the chip.
    state: Mutex<Option<StateCode>>,
    log: Mutex<Vec<String>>,
}

/// Data of the thread.
struct Bench {
    chip: Emulator,
    machine: PlainLine,
    host: Option<TcpStream>,
}

impl ServedChip {
    /// A chip just switched on, which waits for a host.
    pub fn start() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        listener.set_nonblocking(true).expect("a listener can be asked without waiting");
        let url = format!("socket://{}", listener.local_addr().expect("it has an address"));
        let shared = Arc::new(Shared::default());
        // By instructions: its watchdog does not reset a chip that a busy machine keeps from running.
        let chip = Emulator::start("feedboard", Clock::CountedWaiting);
        let place = chip.place().clone();
        let bench = Bench { chip, machine: PlainLine::new(), host: None };
        let of_thread = Arc::clone(&shared);
        let thread = std::thread::spawn(move || bench.serve(&listener, &of_thread));
        ServedChip { url, place, shared, thread: Some(thread) }
    }

    /// Power off and on. The emulator that is next has begun before the other one ends: a chip does not take as long. Its image waits
    /// for the first word on its lines, and reports it only when it has their far ends.
    pub fn power_cycle(&self) {
        let next = self.place.power_on();
        wait_for("the start of the image", || (!next.console().is_empty()).then_some(()));
        *self.shared.next.lock().expect("no thread panicked") = Some(next);
    }

    /// State of the override, as last reported since this start of the chip.
    pub fn state(&self) -> Option<StateCode> {
        *self.shared.state.lock().expect("no thread panicked")
    }

    /// Power off; what its last start has logged.
    pub fn log(mut self) -> Vec<String> {
        self.end();
        std::mem::take(&mut self.shared.log.lock().expect("no thread panicked"))
    }

    fn end(&mut self) {
        self.shared.is_over.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            let _panicked = thread.join();
        }
    }
}

impl Drop for ServedChip {
    fn drop(&mut self) {
        self.end();
    }
}

impl Bench {
    fn serve(mut self, listener: &TcpListener, shared: &Shared) {
        for round in 0_u32.. {
            if shared.is_over.load(Ordering::SeqCst) {
                break;
            }
            if let Some(next) = shared.next.lock().expect("no thread panicked").take() {
                (self.chip, self.machine) = (next, PlainLine::new());
                *shared.state.lock().expect("no thread panicked") = None;
            }
            if let Ok((stream, _)) = listener.accept() {
                stream.set_nonblocking(true).expect("a stream can be asked without waiting");
                self.host = Some(stream);
            }
            if round.is_multiple_of(SHOWN_EVERY) {
                show_standing(&mut self.chip, &mut self.machine);
            }
            self.pass_link();
            self.hear_machine(&mut shared.state.lock().expect("no thread panicked"));
            std::thread::sleep(ROUND);
        }
        *shared.log.lock().expect("no thread panicked") = self.chip.log();
    }

    /// Passes on the bytes of the link, in both directions.
    fn pass_link(&mut self) {
        let Some(host) = &mut self.host else { return };
        let mut bytes = [0; 512];
        match host.read(&mut bytes) {
            Ok(0) => return self.host = None,
            Ok(length) => self.chip.put(Wire::Link, &bytes[..length]).expect("the link is open"),
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(_) => return self.host = None,
        }
        let length = self.chip.take_waiting(Wire::Link, &mut bytes).expect("the link is open");
        let _gone = host.write_all(&bytes[..length]);
    }

    fn hear_machine(&mut self, state: &mut Option<StateCode>) {
        let mut bytes = [0; 512];
        let length = self.chip.take_waiting(Wire::Machine, &mut bytes).expect("the machine line is open");
        for message in bytes[..length].iter().filter_map(|byte| self.machine.on_byte(*byte)) {
            if let Message::Setpoint(setpoint) = message {
                *state = Some(setpoint.state);
            }
        }
    }
}

/// Shows a chip a machine that stands at its zero; the chip runs free then.
///
/// # Panics
/// The machine line is closed.
pub fn show_standing(chip: &mut Emulator, machine: &mut PlainLine) {
    static SHOWN: AtomicU64 = AtomicU64::new(0);
    let sample = Sample {
        at: SHOWN.fetch_add(1, Ordering::Relaxed),
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
    let length = machine.encode(Micros(0), &Message::Sample(sample), &mut frame);
    chip.put(Wire::Machine, &frame[..length]).expect("the machine line is open");
}
