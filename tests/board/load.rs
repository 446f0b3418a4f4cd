//! The tick while the link is as good as idle, and while it is loaded to 95 % of its bit rate with the queue of segments full: in
//! lockstep for what it costs, by the timer for when it comes.

use std::fs;
use std::time::{Duration, Instant};

use arcfeed_hil_sim::override_source::board::{Wire, Wires};
use arcfeed_link::frame::ENCODED_MAX;
use arcfeed_link::message::codes::ModeCode;
use arcfeed_link::plain::PlainLine;
use arcfeed_tests::emulation::host::FILLER;
use arcfeed_tests::emulation::images::image;
use arcfeed_tests::emulation::log::messages;
use arcfeed_tests::emulation::qemu::{Clock, Emulator};
use arcfeed_units::Micros;

use crate::free::OBEYING;
use crate::runs::{Example, prepare, try_prepare};

const LOAD_PERCENT: i64 = 95;
/// Periods from cycle start on in lockstep: the first arcs under their law, with segments coming in behind them.
const PERIODS: u32 = 8_000;
/// The order to a board that is measured: no watchdog, no sleep.
const MEASURED: u8 = b'w';
/// Number of timer ticks of a board before it is judged; the time is that of this machine.
const FREE_TICKS: u32 = 4_000;
/// Interval between two readings of its log.
const LOOK: Duration = Duration::from_millis(100);
/// A board that does not get there hangs.
const TIMEOUT: Duration = Duration::from_secs(300);
/// A machine with much else to do may lose a link by the wall's clock; not every time.
const ATTEMPTS: u32 = 10;
/// Most instructions of a whole tick: samples, commands, supervisor, telemetry, output.
const TICK_MAX: u32 = 1_600;
/// Bytes of stack, of main loop and interrupts together.
pub const STACK_MAX: u32 = 29 * 1024 + 512;
/// From the timer's end to the tick.
const LATE_MAX: u32 = 40;

/// Figures that the board logs of itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Costs {
    ticks: u32,
    pub worst: u32,
    late: [u32; 2],
    lost: u32,
    pub stack: u32,
}

/// The last figures in an image's log, if there are any yet.
pub fn costs(name: &str, console: &[u8]) -> Option<Costs> {
    let image = fs::read(image(name)).expect("the image is there");
    let whole = console.iter().rposition(|byte| *byte == 0).map_or(0, |end| end + 1);
    let log = messages(&image, &console[..whole]);
    let line = log.iter().rfind(|line| line.contains("ticks, worst"))?;
    let words = line.split_whitespace().map(|word| word.trim_end_matches(','));
    let numbers: Vec<u32> = words.filter_map(|word| word.parse().ok()).collect();
    let [ticks, worst, earliest, latest, lost, stack] = numbers[..] else { panic!("{line}") };
    Some(Costs { ticks, worst, late: [earliest, latest], lost, stack })
}

/// Figures of a run in lockstep, and the part of its line that each end kept busy, %.
fn in_lockstep(example: &Example, load_percent: i64) -> (Costs, [u64; 2]) {
    let host = example.host();
    let host = if load_percent > 0 { host.with_load(load_percent) } else { host };
    let mut simulation =
        example.simulation(Emulator::start("feedboard", Clock::CountedLockstep), host, ModeCode::Lockstep);
    prepare(&mut simulation);
    let before = simulation.source().attached().bytes();
    simulation.control_mut().cycle_start();
    (0..PERIODS).for_each(|_| simulation.step());
    assert_eq!(simulation.source().failure(), None);
    let after = simulation.source().attached().bytes();
    let carried = u64::from(PERIODS) * 1_152 / 100;
    let busy = [0, 1].map(|way| (after[way] - before[way]) * 100 / carried);
    (costs("feedboard", &simulation.source().wires().console()).expect("it logs its figures"), busy)
}

/// Figures of a board that ticks by its timer, and the bytes it got on its link for each 100 ticks. Its clock is that of its
/// instructions, much faster than the wall's: what comes on the link comes at every phase of the tick, as fast as the emulator
/// takes it. Without its watchdog and without sleep: where waiting takes no time the emulator may wait through all of a time-out at once, and
/// beside programs of real time past a tick.
fn by_timer(is_loaded: bool) -> (Costs, u64) {
    let mut board = Emulator::start(OBEYING, Clock::Counted);
    board.order(MEASURED);
    std::thread::sleep(LOOK);
    let (began, mut bytes) = (Instant::now(), 0);
    let mut line = PlainLine::new();
    let mut frame = [0; ENCODED_MAX];
    let mut looked = began;
    loop {
        if is_loaded && looked > began {
            let length = line.encode(Micros(0), &FILLER, &mut frame);
            board.put(Wire::Link, &frame[..length]).expect("the line is open");
            bytes += length as u64;
        } else {
            std::thread::sleep(LOOK / 10);
        }
        if looked.elapsed() < LOOK {
            continue;
        }
        looked = Instant::now();
        // The first word is the link's: the board runs free. An emulator may hold back what came before a line was set up, until
        // more comes.
        board.order(MEASURED);
        board.put(Wire::Link, &[0]).expect("the line is open");
        bytes += 1;
        if let Some(costs) = costs(OBEYING, &board.console()).filter(|costs| costs.ticks >= FREE_TICKS) {
            return (costs, bytes * 100 / u64::from(costs.ticks));
        }
        assert!(began.elapsed() < TIMEOUT, "it does not tick");
    }
}

#[test]
fn a_loaded_link_and_a_full_queue_cost_the_tick_nothing() {
    let example = Example::load();
    let ((idle, idle_busy), (loaded, busy)) = (in_lockstep(&example, 0), in_lockstep(&example, LOAD_PERCENT));
    println!("idle, {idle_busy:?} % busy: {idle:?}");
    println!("loaded, {busy:?} % busy: {loaded:?}");
    assert!(busy[0] >= 94 && busy[1] >= 90 && idle_busy[0] < 20, "to the board and from it");
    assert!(idle.worst <= TICK_MAX && loaded.worst <= TICK_MAX);
    assert!(loaded.stack <= STACK_MAX, "{} bytes of stack", loaded.stack);
    // A tick hears of the host more often on a loaded link: so much it may cost.
    assert!(loaded.worst <= idle.worst + idle.worst / 20, "{} against {}", loaded.worst, idle.worst);
    assert_eq!((idle.lost, loaded.lost), (0, 0), "bytes");
}

#[test]
fn no_tick_is_late_whatever_comes_on_the_link() {
    let ((idle, _), (loaded, bytes)) = (by_timer(false), by_timer(true));
    println!("idle: {idle:?}");
    println!("loaded, {bytes} bytes in 100 ticks: {loaded:?}");
    assert!(bytes > 0, "something came");
    assert!(idle.late[1] <= LATE_MAX && loaded.late[1] <= LATE_MAX, "instructions from the timer to the tick");
    // Loaded, more comes than any line of its bit rate brings: bytes that find no room are lost and counted, and delay nothing.
    assert_eq!(idle.lost, 0, "bytes");
}

#[test]
fn by_the_walls_clock_the_link_comes_up_and_a_person_arms() {
    let example = Example::load();
    for attempt in 1..=ATTEMPTS {
        let mut simulation =
            example.simulation(Emulator::start("feedboard", Clock::Wall), example.host(), ModeCode::Free);
        let began = Instant::now();
        let mut periods = 0;
        let prepared = try_prepare(&mut simulation, |host| {
            periods += 1;
            let due = began + Duration::from_millis(periods);
            std::thread::sleep(due.saturating_duration_since(Instant::now()));
            assert!(host.link().counters().crc_errors == 0, "no frame is corrupted");
        });
        match prepared {
            Ok(()) => {
                let srtt = simulation.source().attached().link().counters().srtt;
                println!("attempt {attempt}: armed after {:?}, round trip {srtt:?}", began.elapsed());
                return;
            }
            Err(reason) => println!("attempt {attempt}: {reason}"),
        }
    }
    panic!("never armed");
}
