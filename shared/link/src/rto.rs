//! Time-out after which an unacknowledged message is sent again: RFC 6298.
//!
//! ```text
//! first sample     SRTT = R, RTTVAR = R/2                                            (1)
//! any other        RTTVAR = 3/4 RTTVAR + 1/4 |SRTT - R|, SRTT = 7/8 SRTT + 1/8 R     (2)
//! always           RTO = SRTT + max(G, 4 RTTVAR), within floor and ceiling           (3)
//! timeout          RTO = 2 RTO, within the ceiling                                   (4)
//! ```
//!
//! Differences: the floor is a setting (the RFC's one second is too long for a line; Klipper's fixed 25 ms caused
//! needless retransmissions over USB, issue 690). The first time-out is the ceiling. G is the time of two longest
//! frames on the line, because a message may be longer than those before it and its acknowledgement may wait for a
//! long frame. Karn's rule applies: no sample from a retransmitted message. Heartbeats carry time stamps that identify
//! the answered frame (as in RFC 7323), so they are sampled too, and the next heartbeat ends a doubled time-out.

use arcfeed_units::Span;

/// Estimate of the round-trip time, and the time-out after which an unacknowledged message is sent again.
#[derive(Clone, Copy, Debug)]
pub struct Rto {
    floor: Span,
    ceiling: Span,
    granularity: Span,
    srtt: Option<u32>,
    rttvar: u32,
    rto: Span,
}

impl Rto {
    /// Estimate before the first round trip. `granularity` is the least time that the time-out is above the smoothed
    /// round trip.
    pub const fn new(floor: Span, ceiling: Span, granularity: Span) -> Self {
        Rto { floor, ceiling, granularity, srtt: None, rttvar: 0, rto: ceiling }
    }

    /// Updates the estimate with the time of a round trip.
    pub fn sample(&mut self, Span(r): Span) {
        let srtt = match self.srtt {
            None => {
                self.rttvar = r / 2; // (1)
                r
            }
            Some(srtt) => {
                self.rttvar = self.rttvar.saturating_sub(self.rttvar / 4).saturating_add(srtt.abs_diff(r) / 4); // (2)
                srtt.saturating_sub(srtt / 8).saturating_add(r / 8) // (2)
            }
        };
        self.srtt = Some(srtt);
        let rto = srtt.saturating_add(self.rttvar.saturating_mul(4).max(self.granularity.0)); // (3)
        self.rto = Span(rto).max(self.floor).min(self.ceiling);
    }

    /// Doubles the time-out after the timer has expired.
    pub fn back_off(&mut self) {
        self.rto = Span(self.rto.0.saturating_mul(2)).min(self.ceiling); // (4)
    }

    /// Current time-out for sending again.
    pub const fn rto(&self) -> Span {
        self.rto
    }

    /// Smoothed round-trip time; zero before the first sample.
    pub fn srtt(&self) -> Span {
        Span(self.srtt.unwrap_or(0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rto() -> Rto {
        Rto::new(Span(1), Span::from_ms(60_000), Span(1_000))
    }

    #[test]
    fn the_first_sample_sets_and_the_next_ones_smooth() {
        let mut rto = rto();
        rto.sample(Span(80_000));
        assert_eq!((rto.srtt(), rto.rto()), (Span(80_000), Span(240_000)));
        // RTTVAR = 3/4 40 + 1/4 40 ms, SRTT = 7/8 80 + 1/8 120 ms.
        rto.sample(Span(120_000));
        assert_eq!((rto.srtt(), rto.rto()), (Span(85_000), Span(245_000)));
    }

    #[test]
    fn a_steady_round_trip_leaves_the_granularity() {
        let mut rto = rto();
        (0..200).for_each(|_| rto.sample(Span(8_000)));
        assert_eq!(rto.rto(), Span(9_000));
    }

    #[test]
    fn floor_and_ceiling_hold_and_each_timeout_doubles() {
        let mut rto = Rto::new(Span(100_000), Span(350_000), Span(1_000));
        assert_eq!(rto.rto(), Span(350_000));
        rto.sample(Span(2_000));
        assert_eq!(rto.rto(), Span(100_000));
        rto.back_off();
        assert_eq!(rto.rto(), Span(200_000));
        rto.back_off();
        assert_eq!(rto.rto(), Span(350_000));
        rto.sample(Span(u32::MAX));
        assert_eq!(rto.rto(), Span(350_000));
    }
}
