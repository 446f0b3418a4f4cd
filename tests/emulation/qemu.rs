//! QEMU, with bounded time and nothing left behind.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::ErrorKind;
use std::net::{Ipv4Addr, UdpSocket};
use std::os::fd::OwnedFd;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, OnceLock};
use std::time::{Duration, Instant};

use super::images::image;
use crate::Scratch;

/// No image takes more than some seconds.
const TIMEOUT: Duration = Duration::from_secs(300);
/// Longest time in which QEMU opens its lines.
const OPENING: Duration = Duration::from_secs(30);
/// Time-out of an answer: long enough for a slow board; a board that hangs is detected.
const SILENCE: Duration = Duration::from_secs(60);
/// Lines that [`Emulator::start`] opens.
pub const LINES: usize = 5;
/// QEMU's console multiplexer holds up to 32 bytes for the receiver, which then need no turn of the emulator's main loop each: a third
/// of the cost. Its escape character is put where no byte is.
const NO_ESCAPE: [&str; 2] = ["-echr", "256"];

/// Clock of the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// By instructions, 2^7 ns each (`clock.rs` of the board); waiting takes no time. Every run is the same, as long as nothing
    /// comes in from outside.
    Counted,
    /// The same, but waiting takes as long as it does.
    CountedWaiting,
    /// As that of the wall, for a board that is in lockstep from its first sample on: its own clock is its machine's, and no timer counts
    /// for its answers. Its lines, but the last one, carry datagrams: QEMU reads a stream byte by byte, with a turn of its main loop for
    /// each, and a datagram at once. Datagrams do not hold a sender back, but in lockstep either side waits for the other, and a lost
    /// byte is a board that does not answer.
    Lockstep,
    /// The same by instructions, for a board that counts them: half as much again of the emulator's time.
    CountedLockstep,
    /// As that of the wall.
    Wall,
}

/// Outputs of a run.
#[derive(Clone, Debug)]
pub struct Run {
    /// Output of the image on the emulator's console.
    pub console: Vec<u8>,
    /// Bytes that UART 1 sent.
    pub uart1: Vec<u8>,
}

/// Parts of a board that remain without power: its image, and a folder with the files in place of flash.
#[derive(Clone, Debug)]
pub struct Place {
    name: String,
    clock: Clock,
    scratch: Arc<Scratch>,
}

/// A board that runs, ended with this value.
#[derive(Debug)]
pub struct Emulator {
    place: Place,
    child: Child,
    /// UART 0 to 4.
    lines: [OwnedFd; LINES],
}

impl Clock {
    fn arguments(self) -> &'static [&'static str] {
        match self {
            Clock::Counted => &["-icount", "shift=7,sleep=off"],
            Clock::CountedWaiting | Clock::CountedLockstep => &["-icount", "shift=7,sleep=on"],
            Clock::Lockstep | Clock::Wall => &[],
        }
    }

    /// Number of lines that carry datagrams.
    fn datagram_lines(self) -> usize {
        match self {
            Clock::Lockstep | Clock::CountedLockstep => LINES - 1,
            Clock::Counted | Clock::CountedWaiting | Clock::Wall => 0,
        }
    }
}

impl Run {
    /// The console as text.
    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.console).into_owned()
    }
}

/// Runs an image of the emulated board to its end, which must be a good one: once for all tests, as every run is the same.
///
/// # Panics
/// It ends badly, or not at all.
pub fn run(name: &'static str) -> Run {
    static RUNS: Mutex<BTreeMap<&str, Arc<OnceLock<Run>>>> = Mutex::new(BTreeMap::new());
    let run = Arc::clone(RUNS.lock().expect("no thread panicked").entry(name).or_default());
    run.get_or_init(|| run_image(name, &image(name))).clone()
}

/// Runs an image to its end, which must be a good one.
///
/// # Panics
/// It ends badly, or not at all.
pub fn run_image(name: &str, image: &Path) -> Run {
    let scratch = scratch(name);
    let uart1 = PathBuf::from(scratch.path("uart1"));
    let mut qemu = command(image, &scratch, Clock::Counted);
    qemu.args(["-serial", "null", "-serial"]).arg(format!("file:{}", uart1.display()));
    let mut child = spawn(&mut qemu);
    let status = wait(name, &mut child);
    let run = Run { console: console(&scratch), uart1: fs::read(uart1).unwrap_or_default() };
    assert!(status.success(), "{name}: {status}\n{}", run.text());
    run
}

impl Emulator {
    /// Starts an image with UART 0 to 4 as sockets, all open.
    ///
    /// # Panics
    /// There is no QEMU, or it does not open them.
    pub fn start(name: &str, clock: Clock) -> Self {
        Emulator::with_flash(name, clock, &[])
    }

    /// The same with files in place of flash, by their names.
    ///
    /// # Panics
    /// As [`Emulator::start`].
    pub fn with_flash(name: &str, clock: Clock, files: &[(&str, &[u8])]) -> Self {
        let scratch = scratch(name);
        for (file, bytes) in files {
            scratch.write(file, bytes);
        }
        Place { name: name.to_owned(), clock, scratch: Arc::new(scratch) }.power_on()
    }

    /// Power off and on: another emulator, that has nothing of this one but the files in place of flash. What was on the lines is
    /// lost.
    ///
    /// # Panics
    /// As [`Emulator::start`].
    pub fn power_cycle(&mut self) {
        // It opens its lines before this one ends, and its image waits for the first word on them.
        *self = self.place.power_on();
    }

    /// The parts of the board that remain without power.
    pub fn place(&self) -> &Place {
        &self.place
    }

    /// Name of the image.
    pub fn name(&self) -> &str {
        &self.place.name
    }

    /// The sockets of UART 0 to 4.
    pub fn lines(&self) -> &[OwnedFd; LINES] {
        &self.lines
    }

    /// Output of the image on the emulator's console so far.
    pub fn console(&self) -> Vec<u8> {
        console(&self.place.scratch)
    }

    /// Waits for the image to end by itself, well; answers its console.
    ///
    /// # Panics
    /// It ends badly, or not at all.
    pub fn end(mut self) -> Vec<u8> {
        let status = wait(&self.place.name, &mut self.child);
        let console = self.console();
        assert!(status.success(), "{}: {status}\n{}", self.name(), String::from_utf8_lossy(&console));
        console
    }
}

impl Place {
    /// QEMU in this folder, with UART 0 to 4 as sockets there, all open.
    ///
    /// # Panics
    /// As [`Emulator::start`].
    pub fn power_on(&self) -> Emulator {
        let Place { name, clock, scratch } = self;
        let mut qemu = command(&image(name), scratch, *clock);
        qemu.args(NO_ESCAPE);
        let datagrams = clock.datagram_lines();
        let address = address_of_its_own();
        let sockets: Vec<UdpSocket> = (0..datagrams).map(|_| datagram_socket(address)).collect();
        for (uart, socket) in sockets.iter().enumerate() {
            let here = socket.local_addr().expect("the socket has an address").port();
            let there = datagram_port(uart);
            let ends = format!("host={address},port={here},localaddr={address},localport={there}");
            qemu.args(["-chardev", &format!("udp,id=uart{uart},{ends},mux=on")]);
        }
        let paths: Vec<String> = (datagrams..LINES).map(|uart| scratch.path(&format!("uart{uart}"))).collect();
        // The test listens and QEMU calls: neither has to guess when the other is ready. QEMU opens the lines in their order.
        let listeners: Vec<UnixListener> = paths.iter().map(|path| listen(path)).collect();
        for (uart, path) in (datagrams..).zip(&paths) {
            qemu.args(["-chardev", &format!("socket,id=uart{uart},path={path},mux=on")]);
        }
        for uart in 0..LINES {
            qemu.args(["-serial", &format!("chardev:uart{uart}")]);
        }
        let mut child = spawn(&mut qemu);
        let streams: Vec<OwnedFd> = listeners.iter().map(|listener| accept(listener, &mut child).into()).collect();
        for (uart, socket) in sockets.iter().enumerate() {
            socket.connect((address, datagram_port(uart))).expect("an address of this machine");
        }
        let lines: Vec<OwnedFd> = sockets.into_iter().map(OwnedFd::from).chain(streams).collect();
        let lines = lines.try_into().expect("as many lines as UARTs");
        Emulator { place: self.clone(), child, lines }
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        let _already_over = self.child.kill();
        let _reaped = self.child.wait();
    }
}

/// The command of every start; the console goes to a file.
fn command(image: &Path, scratch: &Scratch, clock: Clock) -> Command {
    let mut qemu = Command::new(emulator());
    qemu.args(["-machine", "mps2-an386", "-cpu", "cortex-m4", "-display", "none", "-monitor", "none"]);
    qemu.args(clock.arguments()).args(["-semihosting-config", "enable=on,target=native", "-kernel"]).arg(image);
    // The files that the board keeps in place of flash move with the folder.
    qemu.current_dir(Path::new(&scratch.path("console")).parent().expect("a folder"));
    // Another one than that of an emulator that still writes.
    let _of_the_start_before = fs::remove_file(scratch.path("console"));
    qemu.stdin(Stdio::null()).stdout(File::create(scratch.path("console")).expect("a file for the console"));
    qemu
}

/// The emulator that `cargo xtask test` has unpacked into the build directory, or else the system's.
pub fn emulator() -> PathBuf {
    // This test runs as <build directory>/<profile>/deps/<name>.
    let test = std::env::current_exe().expect("a test knows its own path");
    let unpacked = test.ancestors().nth(3).map(|folder| folder.join("tools/bin/qemu-system-arm"));
    unpacked.filter(|path| path.exists()).unwrap_or_else(|| "qemu-system-arm".into())
}

/// Starts an emulator.
pub fn spawn(qemu: &mut Command) -> Child {
    qemu.spawn().unwrap_or_else(|error| {
        panic!("qemu-system-arm: {error}. It is what stands for the chip here; `cargo xtask test` installs it.")
    })
}

fn console(scratch: &Scratch) -> Vec<u8> {
    fs::read(scratch.path("console")).unwrap_or_default()
}

/// The next caller, if the emulator lives to call.
fn accept(listener: &UnixListener, child: &mut Child) -> UnixStream {
    listener.set_nonblocking(true).expect("a socket need not block");
    let started = Instant::now();
    loop {
        match listener.accept() {
            Ok((line, _)) => {
                line.set_nonblocking(false).expect("a socket may block");
                line.set_read_timeout(Some(SILENCE)).expect("a socket can be given a time-out");
                return line;
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) => panic!("the emulator's line: {error}"),
        }
        let status = child.try_wait().expect("the emulator can be waited for");
        assert!(status.is_none(), "the emulator ended before it opened its lines: {status:?}");
        assert!(started.elapsed() < OPENING, "the emulator does not open its lines");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn wait(name: &str, child: &mut Child) -> ExitStatus {
    let started = Instant::now();
    loop {
        if let Some(status) = child.try_wait().expect("the emulator can be waited for") {
            return status;
        }
        if started.elapsed() > TIMEOUT {
            child.kill().expect("the emulator can be stopped");
            panic!("{name} still runs after {TIMEOUT:?}");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

fn listen(path: &str) -> UnixListener {
    let _of_the_start_before = fs::remove_file(path);
    UnixListener::bind(path).expect("a socket in a folder of its own")
}

/// A loopback address that no other emulator on this machine has: the ports there are free.
fn address_of_its_own() -> Ipv4Addr {
    static STARTS: AtomicU32 = AtomicU32::new(0);
    let start = STARTS.fetch_add(1, Ordering::Relaxed);
    let [_, process_high, process_low, _] = (std::process::id() << 8).to_be_bytes();
    Ipv4Addr::new(127, process_high | 0x80, process_low, start as u8)
}

/// The emulator's port for a UART.
fn datagram_port(uart: usize) -> u16 {
    20_000 + uart as u16
}

fn datagram_socket(address: Ipv4Addr) -> UdpSocket {
    let socket = UdpSocket::bind((address, 0)).expect("a free port");
    socket.set_read_timeout(Some(SILENCE)).expect("a socket can be given a time-out");
    socket
}

/// A folder for this run alone.
fn scratch(name: &str) -> Scratch {
    static RUNS: AtomicU32 = AtomicU32::new(0);
    Scratch::new(&format!("{name}-{}", RUNS.fetch_add(1, Ordering::Relaxed)))
}
