//! A board in software at a TCP port, in the time of the wall: what a host meets at the end of a cable, but for the cable.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use arcfeed_board_app::application::command_handler::Identity;
use arcfeed_board_app::application::control_task::Supply;
use arcfeed_board_app::application::messages::Queues;
use arcfeed_board_app::application::sensors::Sensors;
use arcfeed_board_app::assembly::{Config, assemble};
use arcfeed_firmware::supervisor::input::Freshness;
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_firmware::supervisor::signals::{BoardFault, Request, Signals};
use arcfeed_link::frame::ENCODED_MAX;
use arcfeed_link::message::codes::ResetCode;
use arcfeed_nc::modal::Pose;
use arcfeed_units::{Micros, RevPerMin};

/// Moves it holds ahead, and one.
pub const AHEAD: usize = 9;
const TICK: Duration = Duration::from_millis(1);

/// A board whose axes stand at the origin.
pub struct ServedBoard {
    /// To give to arcfeed.
    pub url: String,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct Shared {
    is_over: AtomicBool,
    restarts: AtomicU32,
    is_silent: AtomicBool,
    is_broken: AtomicBool,
    is_reset: AtomicBool,
}

impl ServedBoard {
    /// A board that waits for a host.
    pub fn start() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        listener.set_nonblocking(true).expect("a listener can be asked without waiting");
        let url = format!("socket://{}", listener.local_addr().expect("it has an address"));
        let shared = Arc::new(Shared::default());
        let of_thread = Arc::clone(&shared);
        let thread = std::thread::spawn(move || serve(&listener, &of_thread));
        ServedBoard { url, shared, thread: Some(thread) }
    }

    /// Power off and on: the line stays, all it knew is gone.
    pub fn restart(&self) {
        self.shared.restarts.fetch_add(1, Ordering::SeqCst);
    }

    /// Finds its hardware at fault, and does so until it is reset.
    pub fn fail(&self) {
        self.shared.is_broken.store(true, Ordering::SeqCst);
    }

    /// Somebody mends it and presses its button.
    pub fn reset(&self) {
        self.shared.is_broken.store(false, Ordering::SeqCst);
        self.shared.is_reset.store(true, Ordering::SeqCst);
    }

    /// Neither hears nor speaks from now on.
    pub fn fall_silent(&self) {
        self.shared.is_silent.store(true, Ordering::SeqCst);
    }
}

impl Drop for ServedBoard {
    fn drop(&mut self) {
        self.shared.is_over.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            let _panicked = thread.join();
        }
    }
}

fn serve(listener: &TcpListener, shared: &Shared) {
    let mut line = None;
    for starts in 1.. {
        let restarts = shared.restarts.load(Ordering::SeqCst);
        let is_on = || !shared.is_over.load(Ordering::SeqCst) && shared.restarts.load(Ordering::SeqCst) == restarts;
        live(listener, &mut line, starts, shared, &is_on);
        if shared.is_over.load(Ordering::SeqCst) {
            return;
        }
    }
}

/// From power-on to power-off.
fn live(listener: &TcpListener, line: &mut Option<TcpStream>, starts: u32, shared: &Shared, is_on: &dyn Fn() -> bool) {
    let mut queues = Box::new(Queues::<AHEAD>::new());
    let identity = Identity { name: "served", version: [0, 1, 0], reset: ResetCode::Power, starts };
    let config = Config { supply: Supply::Link, settings: Settings::default(), identity, fault: None };
    let (mut host_link, mut task) = assemble(&mut queues, config).expect("sound");
    let sensors = Sensors {
        position: Some(Pose::ORIGIN),
        freshness: Freshness::NOW,
        spindle: RevPerMin(1_000.0),
        operator_percent: 100,
        signals: Signals::NONE,
    };
    let started = Instant::now();
    while is_on() {
        std::thread::sleep(TICK);
        let now = Micros(started.elapsed().as_micros() as u64);
        if let Ok((stream, _)) = listener.accept() {
            stream.set_nonblocking(true).expect("a stream can be asked without waiting");
            *line = Some(stream);
        }
        let signals = if shared.is_broken.load(Ordering::SeqCst) {
            Signals::of_fault(BoardFault::Hardware)
        } else if shared.is_reset.swap(false, Ordering::SeqCst) {
            Signals::of_request(Request::Reset)
        } else {
            Signals::NONE
        };
        task.tick(now, &Sensors { signals, ..sensors });
        let Some(stream) = line.as_mut().filter(|_| !shared.is_silent.load(Ordering::SeqCst)) else { continue };
        let mut bytes = [0; 512];
        match stream.read(&mut bytes) {
            Ok(0) => *line = None,
            Ok(len) => host_link.on_link_bytes(now, &bytes[..len]),
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(_) => *line = None,
        }
        host_link.run(now);
        let mut frame = [0; ENCODED_MAX];
        while let length @ 1.. = host_link.poll_link(now, &mut frame) {
            if let Some(stream) = line {
                let _gone = stream.write_all(&frame[..length]);
            }
        }
    }
}
