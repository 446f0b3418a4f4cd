//! A cable to the host that takes time and corrupts frames, in machine time: the same for each seed.

use std::collections::VecDeque;

use arcfeed_hil_sim::override_source::board::{AttachedDevices, Traffic, Wire};
use arcfeed_units::Micros;

/// Ways.
pub const TO_BOARD: usize = 0;
/// The other one.
pub const FROM_BOARD: usize = 1;

/// Bytes in transit, with their time of arrival.
type OnItsWay = VecDeque<(Micros, Vec<u8>)>;

/// A cable with something at its far end. Keeps its state between calls.
#[derive(Debug)]
pub struct Cable<A> {
    /// Device at the far end.
    pub far: A,
    /// When it corrupted a byte on the way to the board, and on the way from it.
    pub corrupted: [Vec<Micros>; 2],
    latency: Micros,
    corrupted_per_mille: u64,
    random: u64,
    to_board: OnItsWay,
    from_board: OnItsWay,
}

impl<A> Cable<A> {
    /// A cable with this latency each way, on which of a thousand periods so many have a byte flipped, if they have any.
    pub fn new(far: A, latency: Micros, corrupted_per_mille: u64, seed: u64) -> Self {
        let random = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        let [to_board, from_board] = [OnItsWay::new(), OnItsWay::new()];
        Cable { far, latency, corrupted_per_mille, random, corrupted: [vec![], vec![]], to_board, from_board }
    }

    /// Each way.
    pub fn latency(&self) -> Micros {
        self.latency
    }

    /// Whether the line never corrupts a byte.
    pub fn is_clean(&self) -> bool {
        self.corrupted_per_mille == 0
    }

    fn bits(&mut self) -> u64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        self.random
    }

    /// Flips a bit of what is sent in a period, or none.
    fn corrupt(&mut self, at: Micros, way: usize, bytes: &mut [u8]) {
        if !bytes.is_empty() && self.bits() % 1_000 < self.corrupted_per_mille {
            let index = self.bits() as usize % bytes.len();
            bytes[index] ^= 1 << (self.bits() % 8);
            self.corrupted[way].push(at);
        }
    }
}

impl<A: AttachedDevices> AttachedDevices for Cable<A> {
    fn send(&mut self, at: Micros, traffic: &mut Traffic) {
        for bytes in arrived(&mut self.from_board, at) {
            self.far.receive(at, Wire::Link, &bytes);
        }
        let mut said = Traffic::default();
        self.far.send(at, &mut said);
        self.corrupt(at, TO_BOARD, &mut said.link);
        self.to_board.push_back((at.after(self.latency), said.link));
        traffic.link.extend(arrived(&mut self.to_board, at).flatten());
    }

    fn receive(&mut self, at: Micros, wire: Wire, bytes: &[u8]) {
        assert_eq!(wire, Wire::Link, "nothing else is attached");
        let mut bytes = bytes.to_vec();
        self.corrupt(at, FROM_BOARD, &mut bytes);
        self.from_board.push_back((at.after(self.latency), bytes));
    }
}

fn arrived(on_its_way: &mut OnItsWay, now: Micros) -> impl Iterator<Item = Vec<u8>> + '_ {
    std::iter::from_fn(move || on_its_way.pop_front_if(|(at, _)| *at <= now).map(|(_, bytes)| bytes))
}
