//! The arcfeed controller in a firmware of your own, with embassy.
//!
//! Three tasks. `control` runs the controller once per millisecond, in an interrupt, so that nothing delays a tick. `panel`
//! presses the arm button. `program` prepares the blocks ahead and starts the cycle; both run in thread mode. Axes and
//! override input are simulated in `machine`, the board's timer and pins are in `time` and `pins`: replace these three by
//! your HAL. What is in `cut` (the job and its blocks, built in code) comes over a link or from flash in a real machine.
#![no_std]
#![no_main]

mod cut;
mod machine;
mod pins;
mod time;

use core::cell::Cell;
use core::panic::PanicInfo;

use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::board::{Board, Task};
use arcfeed_firmware::controller;
use arcfeed_firmware::output::{OverrideOutput, latched::Latched, parallel_lines::ParallelLines};
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::input::{Input, Work};
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_firmware::supervisor::signals::{BoardFault, Request, Signals};
use arcfeed_firmware::supervisor::{Output, Supervisor, state::State};
use arcfeed_nc::segment::Segment;
use arcfeed_units::Span;
use cortex_m_semihosting::{debug, hprintln};
use embassy_executor::{Executor, InterruptExecutor, Spawner};
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::channel::Channel;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, Ticker, Timer};

use crate::machine::Machine;
use crate::pins::Pin;
use crate::time::Interrupt;

/// From tick to tick.
const PERIOD: Span = Span::from_ms(1);
/// Blocks prepared ahead of the one being executed.
const LOOK_AHEAD: usize = 4;

/// Prepared blocks, from `program` to `control`.
static BLOCKS: Channel<CriticalSectionRawMutex, (Segment, ActiveSegment), LOOK_AHEAD> = Channel::new();
/// Buttons as they are held now, from `panel` to `control`.
static BUTTONS: Mutex<CriticalSectionRawMutex, Cell<Signals>> = Mutex::new(Cell::new(Signals::NONE));
/// The output of the last tick, from `control` to `program`.
static OUTPUT: Signal<CriticalSectionRawMutex, Output> = Signal::new();

static CONTROL_EXECUTOR: InterruptExecutor = InterruptExecutor::new();

/// The board as the controller sees it.
struct Mill {
    machine: Machine,
    segment: Option<(u32, ActiveSegment)>,
    input: Input,
    lines: Latched<ParallelLines<Pin>>,
}

impl Board for Mill {
    fn measure(&mut self) {
        if self.machine.is_at_end_of_block() {
            self.next_block();
        }
        self.input.measured.position = Some(self.machine.position());
        self.input.operator_percent = 100;
        let fault = self.lines.fault().map_or(Signals::NONE, |_| Signals::of_fault(BoardFault::Hardware));
        self.input.signals = fault.with(BUTTONS.lock(Cell::get));
    }

    fn input(&self) -> &Input {
        &self.input
    }

    fn work(&self) -> Work<'_> {
        self.segment.as_ref().map(|(count, segment)| (*count, segment))
    }

    fn set_override(&mut self, feed_override: FeedOverride) {
        // A pin that fails releases all lines, 0 %, and is reported as a fault of the board at the next tick.
        let _ = self.lines.put(feed_override);
        let feed = self.segment.as_ref().and_then(|(_, segment)| segment.feed_at(feed_override));
        self.machine.advance(feed, PERIOD);
    }
}

impl Mill {
    /// Takes the next prepared block, if there is one. The count of blocks is the controller's sign that one has begun.
    fn next_block(&mut self) {
        let count = self.segment.take().map_or(0, |(count, _)| count);
        if let Ok((block, prepared)) = BLOCKS.try_receive() {
            self.machine.begin(&block);
            self.segment = Some((count + 1, prepared));
        }
    }
}

/// One tick of the controller per millisecond.
#[embassy_executor::task]
async fn control(supervisor: Supervisor, mut mill: Mill) {
    let mut task = Task::default();
    let mut ticker = Ticker::every(Duration::from_micros(u64::from(PERIOD.0)));
    loop {
        ticker.next().await;
        OUTPUT.signal(task.run(&supervisor, &mut mill));
    }
}

/// The operator's panel: the arm button is pressed for 50 ms once the override has risen to the dial.
#[embassy_executor::task]
async fn panel() {
    Timer::after_secs(3).await;
    BUTTONS.lock(|buttons| buttons.set(Signals::of_request(Request::Arm)));
    Timer::after_millis(50).await;
    BUTTONS.lock(|buttons| buttons.set(Signals::NONE));
}

/// Prepares the blocks once the controller is armed, reports what the controller does, and ends the emulation.
#[embassy_executor::task]
async fn program() {
    let mut report = Report::default();
    while OUTPUT.wait().await.state != State::Armed {}
    hprintln!("armed");
    let job = cut::job();
    for segment in cut::segments() {
        let rule = job.rules.iter().find(|rule| rule.fits(&segment, &job.tool_of(rule).tool));
        let prepared = ActiveSegment::new(&segment, rule, &job);
        BLOCKS.send((segment, prepared)).await;
    }
    loop {
        let output = OUTPUT.wait().await;
        report.take(&output);
        if report.has_run && output.state != State::Running {
            hprintln!("program end");
            debug::exit(debug::EXIT_SUCCESS);
        }
    }
}

/// Prints each change of the override.
#[derive(Default)]
struct Report {
    percent: Option<u8>,
    has_run: bool,
}

impl Report {
    fn take(&mut self, output: &Output) {
        let percent = output.feed_override.percent;
        if output.state == State::Running && self.percent != Some(percent) {
            hprintln!("override {percent} %");
            self.percent = Some(percent);
            self.has_run = true;
        }
    }
}

/// Releases the override lines, which is 0 %, and stops. In a machine the watchdog fires next.
#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    pins::release_all();
    loop {
        debug::exit(debug::EXIT_FAILURE);
    }
}

fn start(spawner: Spawner) {
    let job = cut::job();
    let supervisor = Supervisor::new(&job, Settings::default()).expect("the limits of the job are sound");
    let measured = controller::Measurement { position: None, spindle: job.tools.first().spindle, dt: PERIOD };
    let lines = Latched::new(ParallelLines::new(pins::override_lines()).expect("these pins never fail"));
    let mill = Mill { machine: Machine::default(), segment: None, input: Input::of(measured), lines };
    // SAFETY: the handlers of both interrupts are below; the executor of `control` starts before its interrupt is pended.
    unsafe { time::start() };
    let control_spawner = CONTROL_EXECUTOR.start(Interrupt::Control);
    control_spawner.spawn(control(supervisor, mill).expect("spawned once"));
    spawner.spawn(panel().expect("spawned once"));
    spawner.spawn(program().expect("spawned once"));
}

#[unsafe(no_mangle)]
extern "C" fn CONTROL() {
    // SAFETY: called by the interrupt alone, which `CONTROL_EXECUTOR.start` enables.
    unsafe { CONTROL_EXECUTOR.on_interrupt() }
}

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut EXECUTOR: Option<Executor> = None;
    EXECUTOR.insert(Executor::new()).run(start)
}
