//! The board link, fed with whatever comes between its own frames.

use arcfeed_link::frame::{ENCODED_MAX, PAYLOAD_MAX};
use arcfeed_link::link::{Delivery, Link, LinkState};
use arcfeed_link::settings::{LinkSettings, Role};
use arcfeed_units::{Micros, Span};
use fastrand::Rng;

type End = Link<5, 3>;

/// An end and what it has done and seen: sent, taken.
struct Side {
    link: End,
    sent: u64,
    taken: u64,
}

impl Side {
    fn new(role: Role, rng: &mut Rng) -> Self {
        let bits_per_s = [0, 9_600, 115_200][rng.usize(..3)];
        let settings = LinkSettings { bits_per_s, lost_after: Span::from_ms(300), ..LinkSettings::new(role, 7) };
        Side { link: Link::new(settings, rng.u32(..)).expect("settings that work"), sent: 0, taken: 0 }
    }

    /// Random actions of an application.
    fn work(&mut self, now: Micros, input: &[u8], rng: &mut Rng) {
        let payload = &input[..rng.usize(..=input.len().min(PAYLOAD_MAX - 8))];
        match rng.u8(..12) {
            0..4 => {
                let message = [&self.sent.to_le_bytes(), payload].concat();
                if self.link.send(rng.u8(..), &message).is_ok() {
                    self.sent += 1;
                }
            }
            4..6 => drop(self.link.offer(rng.u8(..4), now, Span(rng.u32(..99_999)), payload)),
            6 => self.link.set_ready(rng.bool()),
            7 if rng.u8(..20) == 0 => self.link.close(),
            8 if rng.u8(..20) == 0 => {
                self.link.restart(rng.u32(..));
                (self.sent, self.taken) = (0, 0);
            }
            _ => {}
        }
    }

    fn say(&mut self, now: Micros) -> Vec<u8> {
        let (mut bytes, mut out) = (Vec::new(), [0; ENCODED_MAX]);
        for _ in 0..100 {
            let len = self.link.poll_transmit(now, &mut out);
            if len == 0 {
                assert!(self.link.poll_at(now).is_none_or(|at| at > now), "asked for, and nothing to say");
                return bytes;
            }
            assert!(out[len - 1] == 0 && !out[1..len - 1].contains(&0), "{:?}", &out[..len]);
            bytes.extend_from_slice(&out[..len]);
        }
        panic!("it never stops talking");
    }

    fn hear(&mut self, now: Micros, bytes: &[u8]) {
        let taken = &mut self.taken;
        self.link.on_bytes(now, bytes, &mut |received| match received.delivery {
            Delivery::Reliable => {
                let number = received.payload.first_chunk().map(|bytes| u64::from_le_bytes(*bytes));
                assert_eq!(number, Some(*taken), "lost, doubled or reordered");
                *taken += 1;
            }
            Delivery::Latest { expires } => assert!(expires > now),
        });
    }
}

/// Changes of the line to bytes: usually none.
fn corrupt(bytes: &mut Vec<u8>, input: &[u8], rng: &mut Rng) {
    let at = rng.usize(..=bytes.len());
    match rng.u8(..16) {
        0 => bytes.clear(),
        1 => bytes.truncate(at),
        2 => drop(bytes.splice(at..at, input.iter().copied())),
        3 => bytes.extend_from_within(at..),
        4 if at < bytes.len() => bytes[at] ^= 1 << rng.u8(..8),
        5 if at < bytes.len() => bytes[at] = input.first().copied().unwrap_or(0),
        _ => {}
    }
}

/// Two ends whose frames are corrupted with `input`: what is taken is what was sent, in order; an end that is lost says so.
pub fn link(input: &[u8], seed: u64) {
    let mut rng = Rng::with_seed(seed);
    let (mut host, mut board) = (Side::new(Role::Host, &mut rng), Side::new(Role::Board, &mut rng));
    let mut now = Micros(rng.u64(..1 << 40));
    for _ in 0..rng.usize(5..120) {
        now = now.after(Micros(rng.u64(..20_000)));
        host.work(now, input, &mut rng);
        board.work(now, input, &mut rng);
        let (mut there, mut back) = (host.say(now), board.say(now));
        corrupt(&mut there, input, &mut rng);
        corrupt(&mut back, input, &mut rng);
        host.hear(now, &back);
        board.hear(now, &there);
        // A restart of one end without the other leaves messages that were sent, and never more taken than that.
        if host.link.state() == LinkState::Up && board.link.state() == LinkState::Up {
            assert!(board.taken <= host.sent && host.taken <= board.sent);
        }
    }
}
