//! Corrupted frames by the hundred thousand: what is accepted is what was sent.
//!
//! Each case is one corrupted frame on an otherwise quiet line, then an intact one. Accepted is what fits the salt of the session, or a
//! hello. What is accepted must be one of the frames that were sent, byte for byte: a swap of equal bytes, or a splice of one frame
//! with itself, is what was sent, and is counted as such.

use arcfeed_link::deframer::Deframer;
use arcfeed_link::frame::{ENCODED_MAX, Frame, FrameClass, Header, NO_SALT, encode};
use arcfeed_link::session::salt;
use arcfeed_link::settings::Role;
use arcfeed_tests::of_full_set;
use fastrand::Rng;

/// A way to corrupt a frame, without the delimiter that ends it; another frame to take from.
type Corruption = fn(&mut Rng, &mut Vec<u8>, &[u8]);

const WAYS: [(&str, Corruption); 8] = [
    ("flips", |rng, frame, _| flips(rng, frame)),
    ("burst", |rng, frame, _| burst(rng, frame)),
    ("swap", |rng, frame, _| swap(rng, frame)),
    ("splice", splice),
    ("truncation", truncation),
    ("loss", loss),
    ("insertion", insertion),
    ("delimiter", delimiter),
];

/// One to eight bits.
fn flips(rng: &mut Rng, frame: &mut [u8]) {
    for _ in 0..rng.usize(1..9) {
        let at = rng.usize(..frame.len());
        frame[at] ^= 1 << rng.u8(..8);
    }
}

/// Two to 64 bytes of anything.
fn burst(rng: &mut Rng, frame: &mut [u8]) {
    let from = rng.usize(..frame.len());
    let until = (from + rng.usize(2..65)).min(frame.len());
    frame[from..until].iter_mut().for_each(|byte| *byte = rng.u8(..));
}

/// Two bytes, mostly neighbours.
fn swap(rng: &mut Rng, frame: &mut [u8]) {
    let at = rng.usize(..frame.len() - 1);
    let with = if rng.bool() { at + 1 } else { rng.usize(..frame.len()) };
    frame.swap(at, with);
}

/// The beginning of one, the end of another.
fn splice(rng: &mut Rng, frame: &mut Vec<u8>, other: &[u8]) {
    frame.truncate(rng.usize(..=frame.len()));
    frame.extend_from_slice(&other[rng.usize(..=other.len())..]);
}

/// The beginning, or the end.
fn truncation(rng: &mut Rng, frame: &mut Vec<u8>, _: &[u8]) {
    let at = rng.usize(1..frame.len());
    if rng.bool() {
        frame.truncate(at);
    } else {
        frame.drain(..at);
    }
}

/// One to four bytes are gone.
fn loss(rng: &mut Rng, frame: &mut Vec<u8>, _: &[u8]) {
    for _ in 0..rng.usize(1..5) {
        frame.remove(rng.usize(..frame.len()));
    }
}

/// One to four bytes more, some of them there already.
fn insertion(rng: &mut Rng, frame: &mut Vec<u8>, _: &[u8]) {
    for _ in 0..rng.usize(1..5) {
        let at = rng.usize(..frame.len());
        frame.insert(at, if rng.bool() { frame[at] } else { rng.u8(..) });
    }
}

/// The delimiter to the next frame is lost, and that frame perhaps cut.
fn delimiter(rng: &mut Rng, frame: &mut Vec<u8>, other: &[u8]) {
    frame.extend_from_slice(&other[rng.usize(..other.len())..]);
    if rng.bool() {
        let at = rng.usize(..frame.len());
        frame[at] = 0;
    }
}

/// Frames of one session in all classes and lengths, without the delimiter that ends each, and their bodies.
struct Sent {
    salt: u32,
    frames: Vec<Vec<u8>>,
    bodies: Vec<(Header, Vec<u8>)>,
}

fn sent(rng: &mut Rng) -> Sent {
    use FrameClass::{Ack, Bye, Heartbeat, Hello, Latest, Nak, Reliable};
    let salt = salt(Role::Host, [rng.u32(..), rng.u32(..), rng.u32(..)]);
    let mut sent = Sent { salt, frames: Vec::new(), bodies: Vec::new() };
    for count in 0..200_u16 {
        let (class, len) = match count % 8 {
            0 => (Hello, 23),
            1 => (Heartbeat, 8),
            2 => ([Ack, Nak, Bye][rng.usize(..3)], 0),
            3 => (Latest, rng.usize(2..40)),
            _ => (Reliable, rng.usize(1..200)),
        };
        // Zeros are what stuffing is about; small differences between frames what splices could live on.
        let payload: Vec<u8> = (0..len).map(|_| if rng.u8(..3) == 0 { 0 } else { rng.u8(..) }).collect();
        let header = Header { class, is_busy: rng.bool(), kind: rng.u8(..4), seq: count, ack: 7, t_us: rng.u32(..) };
        let mut out = [0; ENCODED_MAX];
        let salt = if class == Hello { NO_SALT } else { salt };
        let len = encode(&header, [&payload, &[]], salt, &mut out).expect("it fits");
        sent.frames.push(out[..len - 1].to_vec());
        sent.bodies.push((header, payload));
    }
    sent
}

fn is_accepted(frame: &Frame<'_>, salt: u32) -> bool {
    frame.salt == salt || (frame.salt == NO_SALT && frame.header.class == FrameClass::Hello)
}

/// Number of accepted frames in `bytes`: equal to a sent one, and different.
fn accepted(deframer: &mut Deframer, bytes: &[u8], sent: &Sent) -> [u64; 2] {
    let mut counts = [0; 2];
    for byte in bytes {
        if let Some(Ok(frame)) = deframer.push(*byte)
            && is_accepted(&frame, sent.salt)
        {
            let was_sent = sent.bodies.iter().any(|(header, payload)| {
                *header == frame.header && payload.as_slice() == frame.payload && frame.version == 1
            });
            counts[usize::from(!was_sent)] += 1;
        }
    }
    counts
}

#[test]
fn no_corrupted_frame_is_accepted() {
    let cases = of_full_set(10_000_000, 100_000);
    let mut rng = Rng::with_seed(0x0BAD_F4A3);
    let (mut deframer, mut bytes) = (Deframer::new(), Vec::new());
    for (name, corrupt) in WAYS {
        let (mut as_sent, mut changed, mut set) = (0, 0, sent(&mut rng));
        for case in 0..cases {
            if case % 10_000 == 0 {
                set = sent(&mut rng);
            }
            let (one, other) = (&set.frames[rng.usize(..200)], &set.frames[rng.usize(..200)]);
            bytes.clear();
            bytes.extend_from_slice(one);
            corrupt(&mut rng, &mut bytes, other);
            let is_as_it_was = bytes == *one || bytes == *other;
            bytes.push(0);
            let [same, other] = accepted(&mut deframer, &bytes, &set);
            // A delimiter put in may leave a whole frame beside it.
            assert!(same == 0 || is_as_it_was || matches!(name, "delimiter" | "insertion"), "{name}");
            (as_sent, changed) = (as_sent + same, changed + other);
        }
        println!("{name}: {cases} corrupted, {changed} accepted; {as_sent} were as sent");
        assert_eq!(changed, 0, "{name}");
        // The following frame is read again.
        let mut whole = set.frames[1].clone();
        whole.push(0);
        assert_eq!(accepted(&mut deframer, &whole, &set), [1, 0], "{name}");
    }
}

#[test]
fn every_flip_of_one_two_or_three_bits_of_a_body_is_seen() {
    // Before stuffing, where the checksum's own promise holds: all of them, no seed.
    let salt = 0x1234_5678;
    let header = Header { class: FrameClass::Ack, is_busy: false, kind: 0, seq: 0, ack: 300, t_us: 99 };
    let mut out = [0; ENCODED_MAX];
    let len = encode(&header, [&[], &[]], salt, &mut out).expect("it fits");
    let mut body = cobs_decoded(&out[..len - 1]);
    let bits = body.len() * 8;
    let mut count = 0;
    for (a, b, c) in (0..bits).flat_map(|a| (a..bits).flat_map(move |b| (b..bits).map(move |c| (a, b, c)))) {
        // a = b or b = c cancel: one bit is left; a = b = c is one bit.
        for bit in [a, b, c] {
            body[bit / 8] ^= 1 << (bit % 8);
        }
        let frame = arcfeed_link::frame::parse(&body).expect("as long as before");
        assert_ne!(frame.salt, salt, "bits {a}, {b}, {c}");
        for bit in [a, b, c] {
            body[bit / 8] ^= 1 << (bit % 8);
        }
        count += 1;
    }
    println!("{count} sets of bits in a body of {bits}");
}

fn cobs_decoded(stuffed: &[u8]) -> Vec<u8> {
    let mut body = Vec::new();
    let mut rest = stuffed;
    while let Some((code, after)) = rest.split_first() {
        let (run, next) = after.split_at(usize::from(*code) - 1);
        body.extend_from_slice(run);
        if *code < 255 && !next.is_empty() {
            body.push(0);
        }
        rest = next;
    }
    body
}
