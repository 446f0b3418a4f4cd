//! The control tick: data of the timer's interrupt, and its cost.
//!
//! The main program passes samples of the machine to the tick and receives setpoints from it, both through lock-free
//! queues. In lockstep the sample gives the time; otherwise each tick is a millisecond after the previous one.

use core::sync::atomic::{AtomicU32, Ordering};

use arcfeed_board_app::application::control_task::ControlTask;
use arcfeed_board_app::application::sensors::{MachineLine, setpoint};
use arcfeed_board_app::spsc::{Consumer, Producer, split};
use arcfeed_firmware::output::OverrideOutput;
use arcfeed_firmware::output::latched::Latched;
use arcfeed_link::message::codes::ModeCode;
use arcfeed_link::message::table::{Sample, Setpoint};
use arcfeed_units::{Micros, Span};
use heapless::spsc::Queue;

use crate::clock::InstructionCounter;
use crate::handed::{Handed, Once};
use crate::mirror::{self, Mirror};
use crate::timer;

/// Time between two control ticks.
pub const PERIOD: Span = Span::from_ms(1);
/// Length of the queues of samples and setpoints, plus one.
const WAITING: usize = 8;

/// Sample received from the machine; `None` stands for an invalid frame.
pub type Heard = Option<Sample>;

/// Data of the interrupt handler that runs the control tick.
pub struct TickSide {
    task: ControlTask<'static>,
    machine: MachineLine,
    now: Micros,
    heard: Consumer<'static, Heard>,
    setpoints: Producer<'static, Setpoint>,
    lines: Latched<Mirror>,
    counter: InstructionCounter,
}

/// Ends of the queues to and from the tick that the main program uses.
pub struct MainSide {
    /// Samples received from the machine, for the tick.
    pub heard: Producer<'static, Heard>,
    /// Answers of the tick to the machine: the outputs.
    pub setpoints: Consumer<'static, Setpoint>,
}

/// Number of ticks so far, and their cost in instructions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Costs {
    /// Number of ticks.
    pub ticks: u32,
    /// Number of instructions of the longest tick.
    pub worst: u32,
    /// Smallest and largest number of instructions between the timer's overflow and the start of the tick; only for
    /// ticks that the timer starts.
    pub late: [u32; 2],
}

static TICK_SIDE: Handed<TickSide> = Handed::nothing();
static TICKS: AtomicU32 = AtomicU32::new(0);
static WORST: AtomicU32 = AtomicU32::new(0);
static EARLIEST: AtomicU32 = AtomicU32::new(u32::MAX);
static LATEST: AtomicU32 = AtomicU32::new(0);

/// Prepares the control tick around this task; `None` if it was called before.
pub fn prepare(task: ControlTask<'static>) -> Option<MainSide> {
    static HEARD: Once<Queue<Heard, WAITING>> = Once::new(Queue::new());
    static SETPOINTS: Once<Queue<Setpoint, WAITING>> = Once::new(Queue::new());
    let (heard, heard_out) = split(HEARD.take()?);
    let (setpoints_in, setpoints) = split(SETPOINTS.take()?);
    // SAFETY: the queues were taken for the first time: the tick's data do not exist yet, and its interrupt is not
    // enabled.
    unsafe {
        TICK_SIDE.put(TickSide {
            task,
            machine: MachineLine::new(),
            now: Micros(0),
            heard: heard_out,
            setpoints: setpoints_in,
            lines: Latched::new(Mirror::new()),
            counter: InstructionCounter::start(),
        });
    }
    Some(MainSide { heard, setpoints })
}

/// Number of ticks so far, and their cost.
pub fn costs() -> Costs {
    let [ticks, worst, earliest, latest] =
        [&TICKS, &WORST, &EARLIEST, &LATEST].map(|figure| figure.load(Ordering::Relaxed));
    Costs { ticks, worst, late: [earliest, latest] }
}

/// Runs one tick; to be called by the timer's interrupt handler.
///
/// # Safety
/// Called only by the timer's handler, which does not interrupt itself.
pub unsafe fn on_timer() {
    let late = timer::late_steps();
    timer::acknowledge();
    // SAFETY: the handler is the only user from its first call on.
    let Some(side) = (unsafe { TICK_SIDE.get() }) else { return };
    let TickSide { counter, .. } = side;
    let counter = *counter;
    let (cost, ()) = counter.of(|| side.tick());
    WORST.store(WORST.load(Ordering::Relaxed).max(cost), Ordering::Relaxed);
    if let Some(steps) = late {
        let late = InstructionCounter::of_steps(steps);
        EARLIEST.store(EARLIEST.load(Ordering::Relaxed).min(late), Ordering::Relaxed);
        LATEST.store(LATEST.load(Ordering::Relaxed).max(late), Ordering::Relaxed);
    }
    TICKS.store(TICKS.load(Ordering::Relaxed).wrapping_add(1), Ordering::Relaxed);
}

impl TickSide {
    fn tick(&mut self) {
        self.now = self.now.after(Micros(u64::from(PERIOD.0)));
        while let Some(heard) = self.heard.dequeue() {
            self.hear(heard);
        }
        let output = self.task.tick(self.now, &self.machine.sensors(self.now));
        // Lines in memory cannot fail.
        let _put = self.lines.put(output.feed_override);
        let setpoint = Setpoint { lines: mirror::low(), ..setpoint(self.now.0, &output, [0; 2]) };
        // A full queue means that the main program does not read it.
        let _room = self.setpoints.enqueue(setpoint);
    }

    fn hear(&mut self, heard: Heard) {
        let Some(sample) = heard else { return self.machine.count_invalid() };
        if sample.mode == ModeCode::Lockstep {
            self.now = Micros(sample.at);
        }
        // Invalid samples are counted there.
        let _is_valid = self.machine.on_sample(self.now, &sample);
    }
}
