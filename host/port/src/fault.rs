//! `fault://`: wrapper of any port that corrupts its data by random faults, repeatable from a seed.
//!
//! Each direction has a random generator of its own and draws byte by byte: the fault of a byte depends on the seed and
//! on the bytes before it, not on the time nor on how many are read or written at once. Only short writes depend on the
//! calls, as they do on a real port.

use std::collections::VecDeque;
use std::io::ErrorKind;
use std::time::SystemTime;

use arcfeed_line_errors::Counts;
use arcfeed_units::Micros;

use super::url::{FaultPlan, Faults};
use super::{Machine, Port, PortError};

const DC1: u8 = 0x11;
const DC3: u8 = 0x13;
/// Least and largest number of bytes in a burst.
const BURST: (u64, u64) = (2, 16);
/// Most bytes passed on at once.
const AT_ONCE: usize = 64;

/// Port that loses, corrupts, doubles and delays bytes on purpose, for tests of a sender.
pub struct Fault<'p> {
    inner: Box<dyn Port + 'p>,
    plan: FaultPlan,
    tx: Lane,
    rx: Lane,
    /// Generator for the loss of DC1 and DC3.
    signals: Random,
    short: Random,
    written: u64,
}

/// One direction of the port.
struct Lane {
    faults: Faults,
    random: Random,
    burst_left: u64,
    latest: Micros,
    /// Due time of each byte.
    queue: VecDeque<(Micros, u8)>,
}

/// SplitMix64 (Steele, Lea and Flood, OOPSLA 2014): independent of the platform, the same on every machine.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Number from 0 to below `end`.
    fn below(&mut self, end: u64) -> u64 {
        self.next() % end.max(1)
    }

    /// Draws a number only if the chance is neither 0 nor 1.
    fn happens(&mut self, chance: f64) -> bool {
        chance > 0.0 && ((self.next() >> 11) as f64) < chance * (1_u64 << 53) as f64
    }
}

impl Lane {
    fn new(faults: &Faults, random: Random) -> Self {
        Lane { faults: *faults, random, burst_left: 0, latest: Micros(0), queue: VecDeque::new() }
    }

    /// Adds a byte at `now`.
    fn take(&mut self, byte: u8, now: Micros) {
        let Faults { drop, flip, dup, burst, delay } = self.faults;
        let random = &mut self.random;
        if random.happens(burst) {
            self.burst_left = BURST.0 + random.below(BURST.1 - BURST.0 + 1);
        }
        if random.happens(drop) {
            return;
        }
        let mut corrupted = byte;
        if self.burst_left > 0 {
            self.burst_left -= 1;
            corrupted = random.below(256) as u8;
        }
        if random.happens(flip) {
            corrupted ^= 1 << random.below(8);
        }
        let copies = if random.happens(dup) { 2 } else { 1 };
        let late = if delay > Micros(0) { Micros(random.below(delay.0 + 1)) } else { Micros(0) };
        self.latest = self.latest.max(now.after(late));
        self.queue.extend(std::iter::repeat_n((self.latest, corrupted), copies));
    }

    /// The due bytes at the front, at most [`AT_ONCE`].
    fn due(&self, now: Micros) -> Vec<u8> {
        let due = self.queue.iter().take_while(|(due, _)| *due <= now);
        due.map(|(_, byte)| *byte).take(AT_ONCE).collect()
    }
}

impl<'p> Fault<'p> {
    /// Wraps a port so that its data are corrupted according to a plan.
    pub fn new(inner: Box<dyn Port + 'p>, plan: &FaultPlan) -> Self {
        let mut seeds = Random(plan.seed);
        let mut part = || Random(seeds.next());
        let (tx, mut rx) = (Lane::new(&plan.tx, part()), Lane::new(&plan.rx, part()));
        let (signals, short, mut noise) = (part(), part(), part());
        rx.queue.extend((0..plan.garbage).map(|_| (Micros(0), noise.below(256) as u8)));
        Fault { inner, plan: plan.clone(), tx, rx, signals, short, written: 0 }
    }

    /// Passes on the bytes that are due.
    fn pump(&mut self) -> Result<(), PortError> {
        loop {
            let due = self.tx.due(self.inner.now());
            let taken = self.inner.write(&due)?;
            self.tx.queue.drain(..taken);
            if taken == 0 || taken < due.len() {
                return Ok(());
            }
        }
    }

    fn connected(&self) -> Result<(), PortError> {
        match self.plan.disconnect {
            Some(end) if self.written >= end => {
                let source = std::io::Error::new(ErrorKind::BrokenPipe, format!("disconnected after byte {end}"));
                Err(PortError { name: format!("fault://disconnect={end}"), source })
            }
            _ => Ok(()),
        }
    }

    /// Number of bytes of `len` that a write accepts.
    fn taken(&mut self, len: usize) -> usize {
        let left = self.plan.disconnect.map_or(u64::MAX, |end| end - self.written);
        let len = len.min(usize::try_from(left).unwrap_or(usize::MAX));
        if len > 0 && self.short.happens(self.plan.short) { self.short.below(len as u64) as usize } else { len }
    }
}

impl Port for Fault<'_> {
    fn now(&self) -> Micros {
        self.inner.now()
    }

    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        self.connected()?;
        self.pump()?;
        let mut arrived = [0; AT_ONCE];
        let len = self.inner.read(&mut arrived)?;
        let now = self.inner.now();
        for &byte in &arrived[..len] {
            let is_dropped = match byte {
                DC1 => self.signals.happens(self.plan.lost_xon),
                DC3 => self.signals.happens(self.plan.lost_xoff),
                _ => false,
            };
            if !is_dropped {
                self.rx.take(byte, now);
            }
        }
        let due = self.rx.due(now);
        let len = due.len().min(buffer.len());
        buffer[..len].copy_from_slice(&due[..len]);
        self.rx.queue.drain(..len);
        Ok(len)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<usize, PortError> {
        self.connected()?;
        let (len, now) = (self.taken(bytes.len()), self.inner.now());
        for &byte in &bytes[..len] {
            self.tx.take(byte, now);
        }
        self.written += len as u64;
        self.pump()?;
        Ok(len)
    }

    fn out_waiting(&mut self) -> Result<usize, PortError> {
        self.pump()?;
        Ok(self.tx.queue.len() + self.inner.out_waiting()?)
    }

    fn wait(&mut self, deadline: Micros) {
        // An error here occurs again at the next call that can report it.
        let _said_later = self.pump();
        let due = self.tx.queue.front().map_or(deadline, |(due, _)| *due);
        let soon = self.inner.now().after(Micros(1));
        self.inner.wait(deadline.min(due).max(soon));
    }

    fn line_errors(&self) -> Option<Counts> {
        self.inner.line_errors()
    }

    fn opened(&self) -> Option<SystemTime> {
        self.inner.opened()
    }

    fn control_is_done(&self) -> Option<bool> {
        self.inner.control_is_done()
    }

    fn blocks_executed(&self) -> Option<usize> {
        self.inner.blocks_executed()
    }

    fn machine(&self) -> Machine {
        self.inner.machine()
    }

    fn feed_hold(&mut self) -> bool {
        self.inner.feed_hold()
    }
}

#[cfg(test)]
mod tests;
