//! The application of a board in this process: the same objects as on the chip, bytes in and bytes out.

use std::collections::VecDeque;

use arcfeed_board_app::application::control_task::ControlTask;
use arcfeed_board_app::application::sensors::{MachineLine, setpoint};
use arcfeed_board_app::lockstep::{BoardLine, BoardLines, Lockstep};
use arcfeed_board_app::main_loop::MainLoop;

use super::board::{BoardFailure, Wire, Wires};

/// Number of lines of a board.
const LINES: usize = 4;

/// Application of a feed board that runs in this process, with byte queues in place of its serial lines.
pub struct InProcess<'q, const N: usize> {
    main_loop: MainLoop<'q, N>,
    task: ControlTask<'q>,
    machine: MachineLine,
    lockstep: Lockstep,
    rings: Rings,
    log: Log,
}

/// Log of the board. Keeps its state between calls.
#[derive(Debug, Default)]
struct Log {
    /// Frames, each with the number of ticks after which it is sent.
    frames: VecDeque<(u32, Vec<u8>)>,
    ticks: u32,
    waiting: Vec<u8>,
}

/// Bytes to the board and from it, by line.
#[derive(Debug, Default)]
struct Rings {
    inward: [VecDeque<u8>; LINES],
    outward: [VecDeque<u8>; LINES],
}

impl BoardLines for Rings {
    fn waiting(&self, line: BoardLine) -> usize {
        self.inward[line as usize].len()
    }

    fn receive(&mut self, line: BoardLine) -> Option<u8> {
        self.inward[line as usize].pop_front()
    }

    fn send(&mut self, line: BoardLine, bytes: &[u8]) -> usize {
        self.outward[line as usize].extend(bytes);
        bytes.len()
    }
}

impl<'q, const N: usize> InProcess<'q, N> {
    /// Board that has just started.
    pub fn new(main_loop: MainLoop<'q, N>, task: ControlTask<'q>) -> Self {
        let (machine, lockstep) = (MachineLine::new(), Lockstep::new());
        InProcess { main_loop, task, machine, lockstep, rings: Rings::default(), log: Log::default() }
    }

    /// Adds log frames that the board sends to the host, each with the number of ticks after which it is sent. On a chip the
    /// image's logger writes the log; a board in this process gets it here.
    #[must_use]
    pub fn with_log(mut self, frames: impl IntoIterator<Item = (u32, Vec<u8>)>) -> Self {
        self.log.frames = frames.into_iter().collect();
        self
    }

    /// Main loop of the board.
    pub fn main_loop(&self) -> &MainLoop<'q, N> {
        &self.main_loop
    }

    fn run(&mut self) {
        let InProcess { main_loop, task, machine, lockstep, rings, log } = self;
        let mut tick = |now, sample: &_| {
            machine.on_sample(now, sample);
            setpoint(sample.at, &task.tick(now, &machine.sensors(now)), [0; 2])
        };
        while lockstep.poll(main_loop, rings, &mut tick) {
            log.ticks += 1;
            while log.frames.front().is_some_and(|(ticks, _)| *ticks <= log.ticks) {
                log.waiting.extend(log.frames.pop_front().map_or(Vec::new(), |(_, frame)| frame));
            }
            let sent = main_loop.host_link_mut().log(&log.waiting);
            log.waiting.drain(..sent);
        }
    }
}

impl<const N: usize> Wires for InProcess<'_, N> {
    fn put(&mut self, wire: Wire, bytes: &[u8]) -> Result<(), BoardFailure> {
        self.rings.inward[line(wire) as usize].extend(bytes);
        self.run();
        Ok(())
    }

    fn take(&mut self, wire: Wire, bytes: &mut [u8]) -> Result<(), BoardFailure> {
        let length = self.take_waiting(wire, bytes)?;
        if length == bytes.len() { Ok(()) } else { Err(BoardFailure::Silent(wire)) }
    }

    fn take_waiting(&mut self, wire: Wire, bytes: &mut [u8]) -> Result<usize, BoardFailure> {
        let ring = &mut self.rings.outward[line(wire) as usize];
        let length = ring.len().min(bytes.len());
        bytes.iter_mut().zip(ring.drain(..length)).for_each(|(place, byte)| *place = byte);
        Ok(length)
    }
}

/// The board's end of a wire.
fn line(wire: Wire) -> BoardLine {
    match wire {
        Wire::Link => BoardLine::Link,
        Wire::Machine => BoardLine::Machine,
        Wire::Sender => BoardLine::Sender,
        Wire::Control => BoardLine::Control,
    }
}
