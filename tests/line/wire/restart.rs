//! Either end restarts in the middle of its work: the other one notices, in time, and nothing of before is taken after.

use arcfeed_link::link::{LinkState, Loss};
use arcfeed_link::settings::{LinkSettings, Role};
use arcfeed_tests::of_full_set;
use arcfeed_units::Span;
use fastrand::Rng;

use crate::wire::sim::{Direction, End, Faults, Offering, SCHEMA, Sim};

const LATENCY_US: u64 = 2_000;
/// Besides `lost_after`: the way, a frame on it, a step of each end.
const MORE_US: u64 = LATENCY_US + 25_000 + 1_000;

fn working(rng: &mut Rng) -> Sim {
    let settings = LinkSettings::new(Role::Host, SCHEMA);
    let mut way = || Direction::new(settings.bits_per_s, [LATENCY_US, 0], Faults::default(), rng.u64(..));
    let mut sim = Sim::new(settings, [way(), way()], [(rng.u64(..1 << 40), 40), (0, -40)]);
    load(&mut sim.ends[0], u64::MAX);
    load(&mut sim.ends[1], 0);
    sim
}

fn load(end: &mut End, to_send: u64) {
    end.to_send = to_send;
    end.offerings = vec![Offering::new(10_000, Span::from_ms(300), 24)];
}

/// Restarts an end at `at`, dead for `dead`: its clock begins anew too, if it is the board.
fn restart(sim: &mut Sim, index: usize, dead_us: u64, session: u32) {
    let settings = *sim.ends[index].link.settings();
    let clock = if index == 1 { (0, -40) } else { sim.ends[0].clock };
    let (to_send, now) = (sim.ends[index].to_send, sim.now);
    sim.ends[index] = End::new(settings, session, clock);
    load(&mut sim.ends[index], to_send);
    sim.ends[index].dead_until = now + dead_us;
}

#[test]
fn a_restart_at_any_point_is_noticed_in_time_and_both_take_up_again_from_the_start() {
    let (mut worst_us, mut by_hello, mut by_silence) = (0, 0, 0);
    for seed in 0..of_full_set(5_000, 200) {
        let mut rng = Rng::with_seed(seed);
        let mut sim = working(&mut rng);
        sim.run(300_000 + rng.u64(..2_000_000), |_| false);
        assert!(sim.are_up(), "seed {seed}");
        let (index, at) = (rng.usize(..2), sim.now);
        // Gone for a moment, or for longer than silence takes to be noticed.
        let dead_us = if rng.bool() { rng.u64(..20_000) } else { rng.u64(..600_000) };
        restart(&mut sim, index, dead_us, 0xC000_0000 | seed as u32);
        let other = 1 - index;
        let lost_after = u64::from(sim.ends[other].link.settings().lost_after.0);
        sim.run(at + lost_after + MORE_US, |sim| sim.ends[other].lost.is_some());
        let noticed = sim.ends[other].lost.unwrap_or_else(|| panic!("seed {seed}: not noticed\n{}", sim.summary()));
        worst_us = worst_us.max(noticed - at);
        match sim.ends[other].link.state() {
            LinkState::Lost(Loss::PeerRestarted) => by_hello += 1,
            LinkState::Lost(Loss::Silence) => by_silence += 1,
            state => panic!("seed {seed}: {state:?}"),
        }
        // A person looks, then the other end begins anew as well: from its first message.
        sim.run(at + 700_000, |_| false);
        assert!(sim.ends.iter().all(|end| end.link.state() != LinkState::Up), "seed {seed}: up by itself");
        sim.ends[other].begin_again(0xD000_0000 | seed as u32);
        sim.run(sim.now + 500_000, |_| false);
        assert_eq!((sim.broken(), sim.are_up()), (None, true), "seed {seed}");
        assert!(sim.ends[1].got > 10, "seed {seed}: {}", sim.ends[1].got);
    }
    println!("noticed by a hello {by_hello} times, by silence {by_silence} times, at worst after {worst_us} us");
    assert!(by_hello > 0 && by_silence > 0);
}
