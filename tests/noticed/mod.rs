//! Delay until the other side notices a restart; the properties of the line explain all of it.
//!
//! The restarted side sends a hello in its first period and then with each third of a heartbeat, and nothing but hellos until it gets
//! an answer. One corrupted byte or frame is therefore one corrupted hello. A delimiter before each hello keeps it independent of the
//! others. The other side notices the restart in the period
//!
//! ```text
//! noticed = way + k * hello     (1)
//! ```
//!
//! way: periods until an uncorrupted hello is received, its own period included; k: corrupted hellos before the first uncorrupted
//! one. Up to k = 3 this is within a heartbeat plus `way`.

use arcfeed_link::message::link_settings;
use arcfeed_link::settings::Role;
use arcfeed_units::US_PER_MS;

/// Result of a restart, in periods of a millisecond.
#[derive(Clone, Copy, Debug)]
pub struct Noticed {
    /// Until the other side knew.
    pub after: usize,
    /// Until it hears a hello that nothing corrupts.
    pub way: usize,
    /// Hellos that were corrupted before; `None` on a line that corrupts none.
    pub corrupted: Option<usize>,
}

/// A third of the heartbeat of host and board, and the heartbeat.
fn hello_and_heartbeat() -> [usize; 2] {
    let settings = link_settings(Role::Board);
    [settings.hello_every(), settings.heartbeat].map(|span| span.0 as usize / US_PER_MS as usize)
}

/// Each one is just as late as its line explains; prints the median and the worst of each kind of line, and who began anew.
///
/// # Panics
/// Something else cost time.
pub fn assert_explained(who: &str, points: &[Noticed]) {
    let [hello, heartbeat] = hello_and_heartbeat();
    assert_eq!(3 * hello, heartbeat);
    for point in points {
        let explained = point.way + hello * point.corrupted.unwrap_or_default(); // (1)
        assert_eq!(point.after, explained, "{point:?}");
    }
    let corrupted_max = points.iter().filter_map(|point| point.corrupted).max();
    print_kind(&format!("{who}, line that corrupts nothing"), points.iter().filter(|point| point.corrupted.is_none()));
    for corrupted in 0..=corrupted_max.unwrap_or_default() {
        let kind = format!("{who}, line that corrupts, {corrupted} hellos corrupted");
        print_kind(&kind, points.iter().filter(|point| point.corrupted == Some(corrupted)));
    }
    print_kind(&format!("{who}, all"), points.iter());
    let is_within = |point: &&Noticed| point.after <= heartbeat + point.way;
    println!("{who}, within {heartbeat} ms: {}", points.iter().filter(|point| point.after <= heartbeat).count());
    println!("{who}, within {heartbeat} ms and the way: {}", points.iter().filter(is_within).count());
}

fn print_kind<'a>(kind: &str, points: impl Iterator<Item = &'a Noticed>) {
    let mut after: Vec<usize> = points.map(|point| point.after).collect();
    after.sort_unstable();
    if let Some(worst) = after.last() {
        let median = after[after.len() / 2];
        println!("{kind}: {} points, noticed after {median} ms at the median, {worst} at worst", after.len());
    }
}
