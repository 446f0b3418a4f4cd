//! Cost of loss and latency: delivered messages, age of the newest value, repeated messages. A golden table.

use arcfeed_link::settings::{LinkSettings, Role};
use arcfeed_tests::root;
use arcfeed_units::Span;

use crate::wire::sim::{Direction, Faults, Offering, SCHEMA, Sim};

const BITS_PER_S: u32 = 115_200;
/// Capacity of such a line, bytes per second.
const BYTES_PER_S: f64 = 11_520.0;
const LOSS: [f64; 5] = [0.0, 0.001, 0.01, 0.05, 0.1];
const LATENCY_MS: [u64; 4] = [0, 4, 16, 50];
/// Measured time, after a second for coming up.
const SECONDS: u64 = 30;
/// Length of a reliable message: a segment.
const LEN: usize = 100;

fn row(loss: f64, latency_ms: u64) -> String {
    let settings = LinkSettings { bits_per_s: BITS_PER_S, ..LinkSettings::new(Role::Host, SCHEMA) };
    let faults = Faults { frame_lost: loss, ..Faults::default() };
    let way = |seed| Direction::new(BITS_PER_S, [latency_ms * 1_000, 0], faults.clone(), seed);
    let mut sim = Sim::new(settings, [way(1), way(2)], [(0, 0), (5_000_000, 50)]);
    // The host sends segments without end and a position each 20 ms, the board a record each 10 ms.
    sim.ends[0].to_send = u64::MAX;
    sim.ends.iter_mut().for_each(|end| end.len = LEN);
    sim.ends[0].offerings.push(Offering::new(20_000, Span::from_ms(300), 24));
    sim.ends[1].offerings.push(Offering::new(10_000, Span::from_ms(300), 24));
    sim.run(1_000_000, |_| false);
    let before = (sim.ends[1].got, *sim.ends[0].link.counters());
    sim.ends.iter_mut().for_each(|end| end.worst_age_us = 0);
    sim.run(1_000_000 + SECONDS * 1_000_000, |_| false);
    assert_eq!(sim.broken(), None, "{loss} {latency_ms}");
    if let Some(lost) = sim.ends.iter().filter_map(|end| end.lost).min() {
        let states = sim.ends.each_ref().map(|end| end.link.state());
        return format!("{:>5.1} {latency_ms:>8}  lost after {:.1} s: {states:?}\n", loss * 100.0, lost as f64 / 1e6);
    }
    let counters = sim.ends[0].link.counters();
    let got = sim.ends[1].got - before.0;
    let again = counters.retransmissions.wrapping_sub(before.1.retransmissions);
    let used = f64::from(counters.bytes_out.wrapping_sub(before.1.bytes_out)) / SECONDS as f64 / BYTES_PER_S;
    let age = |end: usize| sim.ends[end].worst_age_us as f64 / 1_000.0;
    format!(
        "{:>5.1} {latency_ms:>8} {:>10.1} {:>9.0} {:>10.1} {:>12.1} {:>12.1}\n",
        loss * 100.0,
        got as f64 / SECONDS as f64,
        used * 100.0,
        f64::from(again) * 100.0 / got as f64,
        age(1),
        age(0),
    )
}

#[test]
fn what_loss_and_latency_cost_is_the_table() {
    let mut text = String::from(
        " loss  latency  delivered  line out  sent again    worst age    worst age\n   \
         %       ms        1/s         %           %  position ms    record ms\n",
    );
    for (loss, latency_ms) in LOSS.iter().flat_map(|loss| LATENCY_MS.map(|latency| (*loss, latency))) {
        text += &row(loss, latency_ms);
    }
    let golden = root().join("tests/cases/wire-link/expected.txt");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&golden, &text).expect("the golden can be written");
    }
    let expected = std::fs::read_to_string(&golden).expect("the golden is there");
    assert_eq!(text, expected, "UPDATE_GOLDEN=1 rewrites {}", golden.display());
    assert!(text.lines().count() <= 40);
}
