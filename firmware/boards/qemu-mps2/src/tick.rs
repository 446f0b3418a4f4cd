//! The side of the tick: what the timer's interrupt owns, and what it costs.
//!
//! The main program hands it samples of the machine and takes setpoints from it, both through queues without a lock. A sample in
//! lockstep says what time it is; otherwise each tick is a millisecond after the one before.

use core::sync::atomic::{AtomicU32, Ordering};

use arcfeed_firmware::application::control_task::ControlTask;
use arcfeed_firmware::application::sensors::{MachineLine, setpoint};
use arcfeed_firmware::output::OverrideOutput;
use arcfeed_firmware::output::latched::Latched;
use arcfeed_firmware::spsc::{Consumer, Producer, split};
use arcfeed_shared::units::{Micros, Span};
use arcfeed_shared::wire::message::codes::ModeCode;
use arcfeed_shared::wire::message::table::{Sample, Setpoint};
use heapless::spsc::Queue;

use crate::clock::InstructionCounter;
use crate::handed::{Handed, Once};
use crate::mirror::{self, Mirror};
use crate::timer;

/// From tick to tick.
pub const PERIOD: Span = Span::from_ms(1);
/// Samples and setpoints that may wait, less one.
const WAITING: usize = 8;

/// A sample, or a frame that was none.
pub type Heard = Option<Sample>;

/// What only the tick touches while it runs.
pub struct TickSide {
    task: ControlTask<'static>,
    machine: MachineLine,
    now: Micros,
    heard: Consumer<'static, Heard>,
    setpoints: Producer<'static, Setpoint>,
    lines: Latched<Mirror>,
    counter: InstructionCounter,
}

/// The main program's ends.
pub struct MainSide {
    /// What was heard on the machine line.
    pub heard: Producer<'static, Heard>,
    /// What was put out.
    pub setpoints: Consumer<'static, Setpoint>,
}

/// Ticks, and the worst of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Costs {
    /// How many.
    pub ticks: u32,
    /// Instructions of the longest.
    pub worst: u32,
    /// Instructions from the timer's end to the tick, least and most; of ticks by the timer only.
    pub late: [u32; 2],
}

static TICK_SIDE: Handed<TickSide> = Handed::nothing();
static TICKS: AtomicU32 = AtomicU32::new(0);
static WORST: AtomicU32 = AtomicU32::new(0);
static EARLIEST: AtomicU32 = AtomicU32::new(u32::MAX);
static LATEST: AtomicU32 = AtomicU32::new(0);

/// Prepares the tick; `None` if that was done before.
pub fn prepare(task: ControlTask<'static>) -> Option<MainSide> {
    static HEARD: Once<Queue<Heard, WAITING>> = Once::new(Queue::new());
    static SETPOINTS: Once<Queue<Setpoint, WAITING>> = Once::new(Queue::new());
    let (heard, heard_out) = split(HEARD.take()?);
    let (setpoints_in, setpoints) = split(SETPOINTS.take()?);
    // SAFETY: the queues were given out for the first time: the tick's side is not there yet, nor is its interrupt let through.
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

/// What ticks cost so far.
pub fn costs() -> Costs {
    let [ticks, worst, earliest, latest] =
        [&TICKS, &WORST, &EARLIEST, &LATEST].map(|figure| figure.load(Ordering::Relaxed));
    Costs { ticks, worst, late: [earliest, latest] }
}

/// One tick.
///
/// # Safety
/// Called by the timer's handler alone, which does not interrupt itself.
pub unsafe fn on_timer() {
    let late = timer::late_steps();
    timer::acknowledge();
    // SAFETY: the handler is the one user from its first call on.
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
        // Lines in memory refuse nothing.
        let _put = self.lines.put(output.feed_override);
        let setpoint = Setpoint { lines: mirror::low(), ..setpoint(self.now.0, &output, [0; 2]) };
        // With no room, nobody listens.
        let _room = self.setpoints.enqueue(setpoint);
    }

    fn hear(&mut self, heard: Heard) {
        let Some(sample) = heard else { return self.machine.count_invalid() };
        if sample.mode == ModeCode::Lockstep {
            self.now = Micros(sample.at);
        }
        // What makes no sense is counted there.
        let _is_valid = self.machine.on_sample(self.now, &sample);
    }
}
