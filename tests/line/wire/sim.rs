//! Two ends and the line between them, in virtual time. Each end has a clock of its own.

use std::collections::VecDeque;

use arcfeed_link::frame::ENCODED_MAX;
use arcfeed_link::link::{Delivery, Link, LinkState, Received};
use arcfeed_link::settings::{LinkSettings, Role};
use arcfeed_units::{Micros, Span};
use fastrand::Rng;

pub const SCHEMA: u32 = 0x00C0_FFEE;
/// Kinds of messages: reliable ones, and the first of the latest-wins ones.
pub const RELIABLE: u8 = 1;
pub const LATEST: u8 = 10;

/// Faults of one direction: probabilities per frame or per byte.
#[derive(Clone, Debug, Default)]
pub struct Faults {
    pub frame_lost: f64,
    pub frame_twice: f64,
    pub frame_burst: f64,
    pub byte_lost: f64,
    pub byte_flipped: f64,
    /// Nothing passes within.
    pub cut: Vec<[u64; 2]>,
}

/// One way of the line.
#[derive(Debug)]
pub struct Direction {
    pub ns_per_byte: u64,
    pub latency_us: u64,
    pub jitter_us: u64,
    pub faults: Faults,
    rng: Rng,
    free_at_us: u64,
    arrived_us: u64,
    under_way: VecDeque<(u64, Vec<u8>)>,
}

impl Direction {
    pub fn new(bits_per_s: u32, [latency_us, jitter_us]: [u64; 2], faults: Faults, seed: u64) -> Self {
        let ns_per_byte = if bits_per_s == 0 { 0 } else { 10_000_000_000 / u64::from(bits_per_s) };
        let rng = Rng::with_seed(seed);
        Direction {
            ns_per_byte,
            latency_us,
            jitter_us,
            faults,
            rng,
            free_at_us: 0,
            arrived_us: 0,
            under_way: VecDeque::new(),
        }
    }

    fn put(&mut self, now: u64, frame: &[u8]) {
        self.free_at_us = self.free_at_us.max(now) + (frame.len() as u64 * self.ns_per_byte).div_ceil(1_000);
        let is_cut = self.faults.cut.iter().any(|[from, until]| (*from..*until).contains(&self.free_at_us));
        if is_cut || self.rng.f64() < self.faults.frame_lost {
            return;
        }
        let times = 1 + u64::from(self.rng.f64() < self.faults.frame_twice);
        for _ in 0..times {
            let corrupted = self.corrupt(frame);
            let late = self.latency_us + self.rng.u64(..=self.jitter_us);
            // A line does not reorder.
            self.arrived_us = self.arrived_us.max(self.free_at_us + late);
            self.under_way.push_back((self.arrived_us, corrupted));
        }
    }

    fn corrupt(&mut self, frame: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(frame.len());
        for byte in frame {
            if self.faults.byte_lost > 0.0 && self.rng.f64() < self.faults.byte_lost {
                continue;
            }
            let is_flipped = self.faults.byte_flipped > 0.0 && self.rng.f64() < self.faults.byte_flipped;
            bytes.push(if is_flipped { byte ^ (1 << self.rng.u8(..8)) } else { *byte });
        }
        if !bytes.is_empty() && self.rng.f64() < self.faults.frame_burst {
            let from = self.rng.usize(..bytes.len());
            let until = (from + self.rng.usize(2..17)).min(bytes.len());
            bytes[from..until].iter_mut().for_each(|byte| *byte = self.rng.u8(..));
        }
        bytes
    }

    fn take(&mut self, now: u64) -> Option<Vec<u8>> {
        let is_here = self.under_way.front().is_some_and(|(at, _)| *at <= now);
        is_here.then(|| self.under_way.pop_front()).flatten().map(|(_, bytes)| bytes)
    }
}

/// A kind of value that an end offers from time to time.
#[derive(Clone, Copy, Debug)]
pub struct Offering {
    pub every_us: u64,
    pub ttl: Span,
    pub len: usize,
    next_us: u64,
    count: u64,
}

impl Offering {
    pub fn new(every_us: u64, ttl: Span, len: usize) -> Self {
        Offering { every_us, ttl, len, next_us: 0, count: 0 }
    }
}

/// Last received message of a kind: its number, and the time when it was offered.
#[derive(Clone, Copy, Debug)]
struct Held {
    count: u64,
    offered_us: u64,
}

/// One end, and what it has seen.
#[derive(Debug)]
pub struct End {
    pub link: Link<16, 4>,
    /// Clock at the true time 0, and its relative error.
    pub clock: (u64, i64),
    /// Reliable messages to send in all, and sent.
    pub to_send: u64,
    pub sent: u64,
    /// Payload of each, its number among it.
    pub len: usize,
    /// Reliable messages taken.
    pub got: u64,
    pub offerings: Vec<Offering>,
    held: [Option<Held>; 4],
    pub latest_taken: u64,
    /// The greatest age of the newest value of the first kind while the link was up.
    pub worst_age_us: u64,
    /// Takes no reliable messages within.
    pub busy: Vec<[u64; 2]>,
    /// Does nothing until then: it restarts.
    pub dead_until: u64,
    pub came_up: Option<u64>,
    pub lost: Option<u64>,
    pub broken: Option<String>,
}

impl End {
    pub fn new(settings: LinkSettings, session: u32, clock: (u64, i64)) -> Self {
        End {
            link: Link::new(settings, session).expect("settings that work"),
            clock,
            to_send: 0,
            sent: 0,
            len: 40,
            got: 0,
            offerings: Vec::new(),
            held: [None; 4],
            latest_taken: 0,
            worst_age_us: 0,
            busy: Vec::new(),
            dead_until: 0,
            came_up: None,
            lost: None,
            broken: None,
        }
    }

    pub fn local(&self, now: u64) -> Micros {
        let drift = now as i64 * self.clock.1 / 1_000_000;
        Micros(self.clock.0 + now.saturating_add_signed(drift))
    }

    /// Work of the application: offers what is due, sends what there is room for.
    fn work(&mut self, now: u64) {
        let local = self.local(now);
        if !self.busy.is_empty() {
            self.link.set_ready(!self.busy.iter().any(|[from, until]| (*from..*until).contains(&now)));
        }
        for (kind, offering) in self.offerings.iter_mut().enumerate() {
            if now < offering.next_us {
                continue;
            }
            offering.next_us = now + offering.every_us;
            let mut payload = vec![0x5A; offering.len.max(16)];
            payload[..8].copy_from_slice(&offering.count.to_le_bytes());
            payload[8..16].copy_from_slice(&now.to_le_bytes());
            if self.link.offer(LATEST + kind as u8, local, offering.ttl, &payload).is_ok() {
                offering.count += 1;
            }
        }
        while self.sent < self.to_send && self.link.send(RELIABLE, &message(self.sent, self.len)).is_ok() {
            self.sent += 1;
        }
    }

    fn take(&mut self, now: u64, bytes: &[u8], peer: &[Offering]) {
        let (local, clock) = (self.local(now), self.clock);
        let (got, held, len) = (&mut self.got, &mut self.held, self.len);
        let (taken, broken) = (&mut self.latest_taken, &mut self.broken);
        self.link.on_bytes(local, bytes, &mut |received| match received.delivery {
            Delivery::Reliable => {
                if received.kind != RELIABLE || received.payload != message(*got, len) {
                    broken.get_or_insert(format!("at {now}: message {got} is {received:?}"));
                }
                *got += 1;
            }
            Delivery::Latest { expires } => {
                *taken += 1;
                if let Err(what) = latest(now, &received, expires_true(expires, clock), peer, held) {
                    broken.get_or_insert(format!("at {now}: {what}"));
                }
            }
        });
    }

    /// Forgets its peer; the application begins its work anew.
    pub fn begin_again(&mut self, session: u32) {
        self.link.restart(session);
        (self.sent, self.got, self.held) = (0, 0, [None; 4]);
        (self.came_up, self.lost) = (None, None);
    }

    pub fn is_done(&self) -> bool {
        self.sent == self.to_send && self.link.unacknowledged() == 0
    }
}

/// Message `count`: nothing else has these bytes.
fn message(count: u64, len: usize) -> Vec<u8> {
    let mut payload = count.to_le_bytes().to_vec();
    let mut rng = Rng::with_seed(count);
    payload.extend((8..len + rng.usize(..9)).map(|_| if rng.u8(..4) == 0 { 0 } else { rng.u8(..) }));
    payload
}

fn expires_true(expires: Micros, (start, ppm): (u64, i64)) -> u64 {
    let local = expires.0.saturating_sub(start) as i64;
    (local - local * ppm / (1_000_000 + ppm)) as u64
}

/// Checks a value at the moment it is handed over.
fn latest(
    now: u64,
    received: &Received<'_>,
    expires_us: u64,
    peer: &[Offering],
    held: &mut [Option<Held>; 4],
) -> Result<(), String> {
    let number = |at: usize| u64::from_le_bytes(received.payload[at..at + 8].try_into().expect("eight bytes"));
    let kind = usize::from(received.kind - LATEST);
    let (count, offered_us) = (number(0), number(8));
    let ttl_us = u64::from(peer[kind].ttl.0);
    // By either clock: the two differ by what the settings allow.
    let end_us = offered_us + ttl_us + ttl_us * 5 / 10_000 + 2;
    if now >= end_us || expires_us > end_us {
        return Err(format!("kind {kind} offered at {offered_us} for {ttl_us}, to be used until {expires_us}"));
    }
    if let Some(last) = held[kind].filter(|last| last.count >= count) {
        return Err(format!("kind {kind}: {count} after {}", last.count));
    }
    held[kind] = Some(Held { count, offered_us });
    Ok(())
}

/// Both ends and both ways.
#[derive(Debug)]
pub struct Sim {
    pub now: u64,
    pub step_us: u64,
    pub ends: [End; 2],
    /// From the end of that index to the other.
    pub ways: [Direction; 2],
}

impl Sim {
    /// A host and a board with the same settings and clocks that differ.
    pub fn new(host: LinkSettings, ways: [Direction; 2], clocks: [(u64, i64); 2]) -> Self {
        let board = LinkSettings { role: Role::Board, ..host };
        let ends = [End::new(host, 0xA000_0001, clocks[0]), End::new(board, 0xB000_0001, clocks[1])];
        Sim { now: 0, step_us: 500, ends, ways }
    }

    /// One step of both ends.
    pub fn step(&mut self) {
        self.now += self.step_us;
        let now = self.now;
        for index in 0..2 {
            let offerings = self.ends[1 - index].offerings.clone();
            let end = &mut self.ends[index];
            if now < end.dead_until {
                while self.ways[1 - index].take(now).is_some() {}
                continue;
            }
            while let Some(bytes) = self.ways[1 - index].take(now) {
                end.take(now, &bytes, &offerings);
            }
            end.work(now);
            let (mut out, local) = ([0; ENCODED_MAX], end.local(now));
            loop {
                match end.link.poll_transmit(local, &mut out) {
                    0 => break,
                    len => self.ways[index].put(now, &out[..len]),
                }
            }
            watch(end, now);
        }
    }

    /// Until `until`, or until `is_over` after a step.
    pub fn run(&mut self, until: u64, is_over: impl Fn(&Self) -> bool) {
        while self.now < until && !is_over(self) {
            self.step();
        }
    }

    pub fn are_up(&self) -> bool {
        self.ends.iter().all(|end| end.link.state() == LinkState::Up)
    }

    /// Description of a failure for a person.
    pub fn summary(&self) -> String {
        self.ends.each_ref().map(|end| format!("{:?} {:#?}\n", end.link.state(), end.link.counters())).concat()
    }

    /// The first broken promise.
    pub fn broken(&self) -> Option<&str> {
        self.ends.iter().find_map(|end| end.broken.as_deref())
    }
}

fn watch(end: &mut End, now: u64) {
    match end.link.state() {
        LinkState::Up => {
            end.came_up.get_or_insert(now);
            if let Some(held) = end.held[0] {
                end.worst_age_us = end.worst_age_us.max(now - held.offered_us);
            }
        }
        LinkState::Lost(_) => {
            end.lost.get_or_insert(now);
        }
        LinkState::Greeting | LinkState::Refused(_) => {}
    }
}
