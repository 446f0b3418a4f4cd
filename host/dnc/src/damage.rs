//! Warnings of damaged characters from the control: watches the operating system's counters of a serial port.

use arcfeed_line_errors::Counts;
use arcfeed_units::Micros;

/// Time between two looks at the counters.
const PERIOD: Micros = Micros::from_ms(200);

/// Watch on the system's counters of damaged characters: produces a warning as soon as one of them has risen.
#[derive(Clone, Copy, Debug, Default)]
pub struct DamageMonitor {
    seen: Counts,
    due: Micros,
}

impl DamageMonitor {
    /// Checks the counters at most every 200 ms: calls `count` and returns a warning if characters were damaged since
    /// the check before. `None` if the next check is not due, if nothing was damaged, and if `count` knows no counters.
    pub fn check(&mut self, now: Micros, count: impl FnOnce() -> Option<Counts>) -> Option<String> {
        if now < self.due {
            return None;
        }
        self.due = now.after(PERIOD);
        let counts = count()?;
        let new = counts.since(&std::mem::replace(&mut self.seen, counts));
        (new.total() > 0).then(|| {
            format!(
                "warning: the operating system counts damaged characters from the control: {}. All that a control sends is \
                 DC1, DC3 and what it prints: one of these may be lost. What is sent to it goes the same way: check cable, \
                 earthing, baud rate and parity",
                in_words(&new)
            )
        })
    }
}

/// Text that lists the kinds of damage with their numbers, for instance "3 with wrong parity, 1 breaks"; "none" if all
/// counts are 0.
pub fn in_words(counts: &Counts) -> String {
    let Counts { frame, overrun, parity, breaks, buffer_overrun } = *counts;
    let kinds = [
        (parity, "with wrong parity"),
        (frame, "without stop bits"),
        (breaks, "breaks"),
        (overrun, "lost in the chip"),
        (buffer_overrun, "lost in the driver"),
    ];
    let found: Vec<String> =
        kinds.iter().filter(|(count, _)| *count > 0).map(|(count, kind)| format!("{count} {kind}")).collect();
    if found.is_empty() { "none".into() } else { found.join(", ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_increase_is_reported_once_and_not_more_often_than_counters_are_read() {
        let mut damage = DamageMonitor::default();
        let parity = |parity| Some(Counts { parity, ..Counts::default() });
        let at = Micros::from_ms;
        assert_eq!(damage.check(at(0), || parity(0)), None);
        assert_eq!(damage.check(at(100), || panic!("too soon")), None);
        let warning = damage.check(at(200), || parity(2)).expect("two damaged characters");
        assert!(warning.contains("2 with wrong parity.") && warning.contains("DC3"), "{warning}");
        assert_eq!(damage.check(at(400), || parity(2)), None);
        let both = Counts { parity: 3, breaks: 1, ..Counts::default() };
        assert!(
            damage
                .check(at(600), || Some(both))
                .is_some_and(|warning| warning.contains("1 with wrong parity, 1 breaks."))
        );
    }

    #[test]
    fn a_port_that_cannot_say_is_no_reason_for_a_warning() {
        assert_eq!(DamageMonitor::default().check(Micros(0), || None), None);
    }
}
