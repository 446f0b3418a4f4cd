//! Messages of which only the newest counts (class latest-wins): a value has a kind and a time to live, and replaces
//! one of its kind that has not been sent.

use heapless::Vec;

use super::frame::PAYLOAD_MAX;
use super::state::SendError;
use arcfeed_units::{Micros, Span, US_PER_MS};

/// Value of one kind (a latest-wins message) that waits to be sent or was sent.
#[derive(Clone, Debug)]
pub struct Offer {
    /// Kind of the message.
    pub kind: u8,
    /// Payload of the message.
    pub payload: Vec<u8, PAYLOAD_MAX>,
    expires: Micros,
    /// Position in the queue; `None` if it was sent.
    turn: Option<u32>,
}

/// Sender's side of latest-wins messages (values of which only the newest of each kind matters): one slot for each
/// kind.
#[derive(Clone, Debug)]
pub struct Offers<const KINDS: usize> {
    places: Vec<Offer, KINDS>,
    turns: u32,
}

impl<const KINDS: usize> Default for Offers<KINDS> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const KINDS: usize> Offers<KINDS> {
    /// Sender's side without values.
    pub const fn new() -> Self {
        Offers { places: Vec::new(), turns: 0 }
    }

    /// Offers a value to be sent before the instant `expires`. Returns whether it replaced one of its kind that was
    /// not sent yet; it then keeps that one's position in the queue, so that a kind with frequent updates is sent,
    /// too.
    ///
    /// # Errors
    /// No slot is free for another kind, or the payload is too long.
    pub fn put(&mut self, kind: u8, expires: Micros, payload: &[u8]) -> Result<bool, SendError> {
        let payload = Vec::from_slice(payload).map_err(|_| SendError::TooLong(payload.len()))?;
        self.turns = self.turns.wrapping_add(1);
        let mut offer = Offer { kind, payload, expires, turn: Some(self.turns) };
        let own = self.places.iter().position(|place| place.kind == kind);
        let place = own.or_else(|| self.places.iter().position(|place| place.turn.is_none()));
        let Some(place) = place.and_then(|place| self.places.get_mut(place)) else {
            return self.places.push(offer).map(|()| false).map_err(|_| SendError::Full);
        };
        let waited = place.turn;
        offer.turn = waited.or(offer.turn);
        *place = offer;
        Ok(waited.is_some())
    }

    /// Discards waiting values that have expired, or would within a millisecond; returns their number.
    pub fn expire(&mut self, now: Micros) -> u32 {
        let mut count = 0;
        for place in &mut self.places {
            if place.turn.is_some() && milliseconds_left(now, place.expires) == 0 {
                place.turn = None;
                count += 1;
            }
        }
        count
    }

    /// The value to be sent next, with its remaining time to live in milliseconds, rounded down; `None` if none waits.
    pub fn next(&self, now: Micros) -> Option<(&Offer, u16)> {
        let waiting = self.places.iter().filter_map(|place| place.turn.map(|turn| (turn, place)));
        // The counter wraps around: compare ages, not values.
        let (_, offer) = waiting.max_by_key(|(turn, _)| self.turns.wrapping_sub(*turn))?;
        Some((offer, milliseconds_left(now, offer.expires)))
    }

    /// Records that the waiting value of this kind was sent.
    pub fn sent(&mut self, kind: u8) {
        if let Some(place) = self.places.iter_mut().find(|place| place.kind == kind) {
            place.turn = None;
        }
    }

    /// Whether a value waits to be sent.
    pub fn any(&self) -> bool {
        self.places.iter().any(|place| place.turn.is_some())
    }
}

fn milliseconds_left(now: Micros, expires: Micros) -> u16 {
    u16::try_from(expires.since(now).0 / US_PER_MS).unwrap_or(u16::MAX)
}

/// Receiver's side of latest-wins messages: sequence number of the newest value so far, of all kinds together.
#[derive(Clone, Copy, Debug, Default)]
pub struct Newest {
    seq: Option<u16>,
}

impl Newest {
    /// Whether a value with this sequence number is newer than all before it; if so, it becomes the newest.
    pub fn accept_newer(&mut self, seq: u16) -> bool {
        let is_news = self.seq.is_none_or(|last| (1..u16::MAX / 2).contains(&seq.wrapping_sub(last)));
        if is_news {
            self.seq = Some(seq);
        }
        is_news
    }
}

/// Instant, by our clock, at which a received value expires that the peer sent at `sent` or later with `left_ms`
/// remaining.
pub fn expiry(sent: Micros, left_ms: u16) -> Micros {
    sent.after(Micros::from_ms(u64::from(left_ms)))
}

/// Instant at which a value offered now with this time to live expires.
pub fn deadline(now: Micros, ttl: Span) -> Micros {
    now.after(Micros(u64::from(ttl.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const END: Micros = Micros(50_000);

    #[test]
    fn a_newer_value_replaces_the_one_that_waits_and_keeps_its_turn() {
        let mut offers = Offers::<2>::new();
        assert_eq!(offers.put(1, END, b"a"), Ok(false));
        assert_eq!(offers.put(2, END, b"b"), Ok(false));
        assert_eq!(offers.put(1, END, b"c"), Ok(true));
        let next = |offers: &Offers<2>| offers.next(Micros(0)).map(|(offer, left)| (offer.payload.to_vec(), left));
        assert_eq!(next(&offers), Some((b"c".to_vec(), 50)));
        offers.sent(1);
        assert_eq!(offers.put(1, END, b"d"), Ok(false));
        assert_eq!(next(&offers), Some((b"b".to_vec(), 50)));
    }

    #[test]
    fn the_place_of_a_kind_that_has_gone_out_is_free_for_another() {
        let mut offers = Offers::<1>::new();
        assert_eq!(offers.put(1, END, b"a"), Ok(false));
        assert_eq!(offers.put(2, END, b"b"), Err(SendError::Full));
        offers.sent(1);
        assert_eq!(offers.put(2, END, b"b"), Ok(false));
    }

    #[test]
    fn what_has_less_than_a_millisecond_left_does_not_go_out() {
        let mut offers = Offers::<1>::new();
        offers.put(1, END, b"a").unwrap();
        assert_eq!(offers.expire(Micros(49_000)), 0);
        assert_eq!(offers.expire(Micros(49_001)), 1);
        assert!(!offers.any());
    }

    #[test]
    fn what_is_older_or_the_same_is_no_news_also_around_the_wrap() {
        let mut newest = Newest::default();
        for (seq, is_news) in [(65_534, true), (65_534, false), (65_533, false), (1, true), (65_535, false), (2, true)]
        {
            assert_eq!(newest.accept_newer(seq), is_news, "{seq}");
        }
    }
}
