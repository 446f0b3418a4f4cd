//! The DNC sender and its journal, fed with whatever comes.

use arcfeed::dnc::Sender;
use arcfeed::dnc::journal::{Record, Start, first_line, line, read};
use arcfeed::dnc::pace::{AFTER_DC3_MAX, Pace};
use arcfeed::dnc::sender::{CHUNK, Gate, LineUse, State};
use arcfeed::dnc::transmission::{Transmission, Wire};
use arcfeed_units::Micros;
use fastrand::Rng;

const WIRE: Wire = Wire { encode: Some, filters: true, tv_check: true };

/// Whatever a control says, whenever: characters leave once and in order, none under DC3 or hold, and it ends.
pub fn sender(input: &[u8], seed: u64) {
    let mut rng = Rng::with_seed(seed);
    let Ok(transmission) = Transmission::new(input, |_| 1, &WIRE)
        .or_else(|_| Transmission::new(b"%\nO1\nG1X1.F1.\nX2.\nX3.\nX4.\nM30\n%\n", |_| 1, &WIRE))
    else {
        panic!("a plain program is refused")
    };
    let line = LineUse {
        pace: Pace::new(11, [4_800, 9_600, 115_200][rng.usize(..3)], Some(Micros(rng.u64(..5_000)))),
        xonxoff: rng.u8(..8) > 0,
        eight_bits: rng.bool(),
        start_timeout: Some(Micros::from_ms(5_000)),
        xoff_timeout: Some(Micros::from_ms(5_000)),
    };
    let frames = transmission.frames().to_vec();
    let (mut sender, mut now, mut out, mut sent) = (Sender::new(transmission, line), Micros(0), [0; CHUNK], Vec::new());
    let meaningful = [0x11, 0x11, 0x11, 0x13, 0x93, 0x12, 0x14, b'A', 0xFF];
    for _ in 0..rng.usize(10..400) {
        let bytes: Vec<u8> = (0..rng.usize(..4)).map(|_| meaningful[rng.usize(..meaningful.len())]).collect();
        sender.on_bytes(now, &bytes);
        match rng.u8(..30) {
            0 => sender.hold(),
            1 | 2 => sender.resume(),
            3 => sender.permit(Gate::Journal, rng.usize(..frames.len() + 9)),
            4 if rng.u8(..9) == 0 => sender.abort(now),
            _ => {}
        }
        let before = sender.state();
        let len = sender.poll_transmit(now, &mut out);
        assert!(
            len == 0
                || !matches!(before, State::Stopped | State::Held | State::Sent | State::Aborted | State::Failed(_))
        );
        assert!(len <= AFTER_DC3_MAX);
        sent.extend_from_slice(&out[..len]);
        assert_eq!((sender.progress().0, sent.as_slice()), (sent.len(), &frames[..sent.len()]));
        assert!(sender.poll_at().is_none_or(|at| at < Micros::from_ms(3_600_000)));
        now = now.after(Micros(rng.u64(..8_000)));
    }
    // Left alone, it ends.
    sender.resume();
    sender.permit(Gate::Journal, usize::MAX);
    for _ in 0..3 * frames.len() + 10 {
        let Some(at) = sender.poll_at() else { break };
        now = now.max(at);
        sender.poll_transmit(now, &mut out);
    }
    assert!(matches!(sender.state(), State::Sent | State::Aborted | State::Failed(_)), "{:?}", sender.state());
}

/// A journal, cut and corrupted: what it says lies within what was written, or it is refused.
pub fn journal(input: &[u8], seed: u64) {
    let mut rng = Rng::with_seed(seed);
    let _history_or_damage = read(input);
    let bytes = rng.usize(1..5_000);
    let start = Start {
        program: rng.u64(..),
        bytes,
        from: rng.usize(..99),
        restart_bytes: rng.usize(..bytes),
        ..Start::default()
    };
    let (mut text, mut sent, mut latest) = (first_line(&start).into_bytes(), 0, [[0; 2]].to_vec());
    for number in 1..rng.u32(2..30) {
        let until = (sent + rng.usize(..300)).min(bytes);
        text.extend(line(number, &Record::Out { sent, until }).bytes());
        latest.push([sent, until].map(|out| start.from + out.saturating_sub(start.restart_bytes)));
        sent = until;
    }
    let whole = text.len();
    match rng.u8(..3) {
        0 => text.truncate(rng.usize(..=whole)),
        1 => {
            let at = rng.usize(..whole);
            text[at] ^= 1 << rng.u8(..8);
        }
        _ => text.extend(input.iter().take(50)),
    }
    if let Ok(history) = read(&text) {
        let is_empty = history.sent == [start.from; 2] || history.sent == [0; 2];
        assert!(is_empty || latest.contains(&history.sent), "{history:?} of {latest:?}");
        assert!(history.torn <= text.len());
    }
}
