//! Seeded schedules of faults.

use arcfeed_link::settings::{LinkSettings, Role};
use arcfeed_units::Span;
use fastrand::Rng;

use crate::wire::sim::{Direction, Faults, Offering, SCHEMA, Sim};

/// Faults happen before, none after.
pub const FAULTS_END_US: u64 = 4_000_000;

/// Kind of fault of a schedule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Nothing.
    Clean,
    /// Frames are lost.
    Loss,
    /// Frames arrive twice.
    Twice,
    /// Bits are flipped.
    Flips,
    /// Bytes are lost.
    Bytes,
    /// Stretches of bytes are overwritten.
    Bursts,
    /// The line is cut for a while.
    Cuts,
    /// One end takes nothing for a while.
    Busy,
    /// All of it, a little.
    Mixed,
}

pub const KINDS: [Kind; 9] =
    [Kind::Clean, Kind::Loss, Kind::Twice, Kind::Flips, Kind::Bytes, Kind::Bursts, Kind::Cuts, Kind::Busy, Kind::Mixed];

fn faults(kind: Kind, rng: &mut Rng) -> Faults {
    let has = |these: Kind| kind == these || kind == Kind::Mixed;
    let scale = if kind == Kind::Mixed { 0.3 } else { 1.0 };
    let mut chance = |is_there: bool, most: f64| if is_there { rng.f64() * most * scale } else { 0.0 };
    let mut faults = Faults {
        frame_lost: chance(has(Kind::Loss), 0.25),
        frame_twice: chance(has(Kind::Twice), 0.5),
        frame_burst: chance(has(Kind::Bursts), 0.2),
        byte_lost: chance(has(Kind::Bytes), 0.004),
        byte_flipped: chance(has(Kind::Flips), 0.004),
        cut: Vec::new(),
    };
    if has(Kind::Cuts) {
        let from = rng.u64(..FAULTS_END_US - 500_000);
        faults.cut.push([from, from + rng.u64(10_000..500_000)]);
    }
    faults
}

/// Both ends at work on a line of this kind.
pub fn draw(kind: Kind, seed: u64) -> Sim {
    let mut rng = Rng::with_seed(seed ^ ((kind as u64) << 32));
    let bits_per_s = [19_200, 57_600, 115_200, 921_600][rng.usize(..4)];
    let latency = [0, 1_000, 16_000, 50_000][rng.usize(..4)];
    let jitter = rng.u64(..=latency / 2);
    let settings = LinkSettings { bits_per_s, ..LinkSettings::new(Role::Host, SCHEMA) };
    let mut way = || Direction::new(bits_per_s, [latency, jitter], faults(kind, &mut rng), rng.u64(..));
    let ways = [way(), way()];
    // The host's clock often passes 2^32 us on the way, where time stamps begin again.
    let start = if rng.bool() { (1 << 32) - rng.u64(..FAULTS_END_US) } else { rng.u64(..1 << 40) };
    let clocks = [(start, rng.i64(-200..=200)), (rng.u64(..10_000), rng.i64(-200..=200))];
    let mut sim = Sim::new(settings, ways, clocks);
    for end in &mut sim.ends {
        end.len = rng.usize(8..120);
        for _ in 0..rng.usize(1..4) {
            let ttl = Span::from_ms(rng.u32(20..300));
            end.offerings.push(Offering::new(rng.u64(5_000..50_000), ttl, rng.usize(16..60)));
        }
    }
    // Both ends send messages of the same make: their length is the schedule's.
    sim.ends[1].len = sim.ends[0].len;
    sim.ends[0].to_send = rng.u64(20..200);
    sim.ends[1].to_send = rng.u64(..50);
    if matches!(kind, Kind::Busy | Kind::Mixed) {
        let from = rng.u64(..FAULTS_END_US / 2);
        sim.ends[rng.usize(..2)].busy.push([from, from + rng.u64(10_000..FAULTS_END_US / 2)]);
    }
    sim
}

/// From now on the line is whole.
pub fn mend(sim: &mut Sim) {
    sim.ways.iter_mut().for_each(|way| way.faults = Faults::default());
}
