//! Seeded schedules: nothing reliable is lost, doubled or reordered, no value is used beyond its time, and it ends.
//!
//! Every schedule ends in one of two ways: both ends up, with all that was to be sent acknowledged; or both lost, the second within
//! the time its settings name.

use arcfeed_tests::of_full_set;
use std::collections::BTreeMap;

use arcfeed_link::link::LinkState;

use crate::wire::schedule::{FAULTS_END_US, KINDS, Kind, draw, mend};
use crate::wire::sim::Sim;

/// By when all is done after the faults: slowest line, longest latency, 200 messages of 130 bytes, values between them.
const END_US: u64 = FAULTS_END_US + 40_000_000;
/// Until silence is noticed, the longest way of the line and a step.
const NOTICED_US: u64 = 250_000 + 75_000 + 60_000;

/// End of a schedule: whether the link is up.
fn end(sim: &mut Sim) -> Result<bool, String> {
    let is_lost = |sim: &Sim| sim.ends.iter().any(|end| end.lost.is_some());
    let is_done = |sim: &Sim| sim.are_up() && sim.ends.iter().all(crate::wire::sim::End::is_done);
    sim.run(FAULTS_END_US, is_lost);
    mend(sim);
    sim.run(END_US, |sim| is_lost(sim) || is_done(sim));
    if is_lost(sim) {
        sim.run(sim.now + NOTICED_US, |sim| sim.ends.iter().all(|end| end.lost.is_some()));
    }
    if let Some(what) = sim.broken() {
        return Err(what.to_owned());
    }
    let got = [sim.ends[1].got, sim.ends[0].got];
    let states = sim.ends.each_ref().map(|end| end.link.state());
    match states {
        [LinkState::Up, LinkState::Up] if is_done(sim) => {
            let sent = sim.ends.each_ref().map(|end| end.sent);
            if got == sent { Ok(true) } else { Err(format!("{sent:?} sent and acknowledged, {got:?} taken")) }
        }
        [LinkState::Lost(_), LinkState::Lost(_)] => Ok(false),
        // One had not come up when the other, which had, lost it.
        [LinkState::Lost(_), LinkState::Greeting] | [LinkState::Greeting, LinkState::Lost(_)] => Ok(false),
        states => Err(format!("ended as {states:?} at {}", sim.now)),
    }
}

#[test]
fn nothing_reliable_is_lost_doubled_or_reordered_and_no_value_outlives_its_time() {
    let seeds = of_full_set(1_200, 120);
    let mut counts: BTreeMap<Kind, [u64; 5]> = BTreeMap::new();
    for (kind, seed) in KINDS.iter().flat_map(|kind| (0..seeds).map(move |seed| (*kind, seed))) {
        let mut sim = draw(kind, seed);
        let is_up = end(&mut sim).unwrap_or_else(|what| panic!("{kind:?}, seed {seed}: {what}\n{}", sim.summary()));
        let count = counts.entry(kind).or_default();
        count[usize::from(!is_up)] += 1;
        count[2] += sim.ends.iter().map(|end| end.got).sum::<u64>();
        count[3] += sim.ends.iter().map(|end| u64::from(end.link.counters().retransmissions)).sum::<u64>();
        count[4] += sim.ends.iter().map(|end| end.latest_taken).sum::<u64>();
    }
    println!("{} schedules; done, lost; messages, sent again; values:", seeds * KINDS.len() as u64);
    for (kind, [up, lost, got, again, latest]) in &counts {
        println!("{kind:?}: {up} {lost}; {got} {again}; {latest}");
    }
    let [clean, twice, busy] = [Kind::Clean, Kind::Twice, Kind::Busy].map(|kind| counts[&kind]);
    assert_eq!([clean[1], twice[1], busy[1]], [0; 3], "lost without a fault that loses");
    assert_eq!(clean[3], 0, "sent again on a clean line");
}
