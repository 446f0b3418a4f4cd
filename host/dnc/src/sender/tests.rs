use super::*;
use crate::transmission::Wire;

const CHAR: Micros = Micros(1_146);
const PROGRAM: &str = "%\nG0X1.\n\nM30\n%\n";

fn line(xonxoff: bool) -> LineUse {
    LineUse {
        pace: Pace::new(11, 9_600, xonxoff.then_some(Micros(0))),
        xonxoff,
        eight_bits: false,
        start_timeout: Some(Micros::from_ms(60_000)),
        xoff_timeout: Some(Micros::from_ms(600_000)),
    }
}

fn transmission(program: &str) -> Transmission {
    let wire = Wire { encode: Some, filters: false, tv_check: false };
    Transmission::new(program.as_bytes(), |_| 1, &wire).unwrap()
}

fn sender() -> Sender {
    Sender::new(transmission(PROGRAM), line(true))
}

/// Polls every character time; returns the characters sent.
fn run(sender: &mut Sender, start: Micros, chars: u64) -> Vec<u8> {
    let mut out = [0; CHUNK];
    let mut sent = Vec::new();
    for char in 0..chars {
        let len = sender.poll_transmit(Micros(start.0 + char * CHAR.0), &mut out);
        sent.extend_from_slice(&out[..len]);
    }
    sent
}

const LATER: Micros = Micros::from_ms(1_000);

#[test]
fn nothing_goes_out_before_the_control_asks() {
    let mut sender = sender();
    assert_eq!(run(&mut sender, Micros(0), 20), b"");
    sender.on_bytes(LATER, &[DC1]);
    assert_eq!(run(&mut sender, LATER, 20), PROGRAM.as_bytes());
    assert_eq!((sender.state(), sender.blocks_sent()), (State::Sent, 2));
}

#[test]
fn xoff_stops_it_within_what_is_already_out_and_xon_resumes() {
    let mut sender = sender();
    sender.on_bytes(LATER, &[DC1]);
    assert_eq!(run(&mut sender, LATER, 1), b"%\nG0");
    sender.on_bytes(LATER, &[DC3, DC3]);
    assert_eq!((run(&mut sender, LATER, 20), sender.state()), (vec![], State::Stopped));
    sender.on_bytes(LATER.after(LATER), &[DC1, DC1]);
    assert_eq!(run(&mut sender, LATER.after(LATER), 20), b"X1.\n\nM30\n%\n");
    assert_eq!(sender.counters(), Counters { xoff_count: 1, repeated_xon: 1, ignored: 0 });
}

#[test]
fn dc3_with_a_parity_bit_stops_a_line_of_eight_bits() {
    let mut sender = Sender::new(transmission(PROGRAM), LineUse { eight_bits: true, ..line(true) });
    sender.on_bytes(LATER, &[DC1]);
    sender.on_bytes(LATER, &[DC3 | PARITY]);
    assert_eq!(sender.state(), State::Stopped);
}

#[test]
fn without_xonxoff_control_codes_are_only_noise() {
    let mut sender = Sender::new(transmission(PROGRAM), line(false));
    sender.on_bytes(Micros(0), &[DC3]);
    assert_eq!(run(&mut sender, Micros(0), 20), PROGRAM.as_bytes());
    assert_eq!(sender.counters().ignored, 1);
}

#[test]
fn dc1_within_noise_does_not_start_the_sender_and_dc1_after_noise_does() {
    let mut sender = sender();
    sender.on_bytes(Micros(0), &[0xFF, DC1, 0x41]);
    assert_eq!((run(&mut sender, Micros(0), 200), sender.state()), (vec![], State::Waiting));
    sender.on_bytes(LATER, &[0x55, DC1]);
    assert_eq!(run(&mut sender, LATER, 10), b"");
    assert_eq!(sender.poll_at(), Some(LATER.after(SETTLE)));
    assert_eq!(run(&mut sender, LATER.after(SETTLE), 20), PROGRAM.as_bytes());
}

#[test]
fn waiting_has_an_end_and_a_reason() {
    let mut sender = sender();
    let limit = sender.poll_at().unwrap();
    assert_eq!(run(&mut sender, limit, 1), b"");
    let State::Failed(why) = sender.state() else { panic!("{:?}", sender.state()) };
    assert!(why.to_string().contains("no DC1"), "{why}");
    sender.on_bytes(limit.after(LATER), &[DC1]);
    assert_eq!(run(&mut sender, limit.after(LATER), 20), b"");
}

#[test]
fn an_xoff_without_an_xon_has_an_end_and_a_reason() {
    let mut sender = sender();
    sender.on_bytes(LATER, &[DC1]);
    sender.on_bytes(LATER, &[DC3]);
    let limit = sender.poll_at().unwrap();
    assert_eq!(limit, LATER.after(Micros::from_ms(600_000)));
    run(&mut sender, limit, 1);
    assert!(matches!(sender.state(), State::Failed(FailureReason::NoXon(_))));
}

#[test]
fn a_hold_sends_nothing_and_survives_a_dc1() {
    let mut sender = sender();
    sender.on_bytes(LATER, &[DC1]);
    run(&mut sender, LATER, 1);
    sender.hold();
    sender.on_bytes(LATER, &[DC3, DC1]);
    assert_eq!((run(&mut sender, LATER, 50), sender.state()), (vec![], State::Held));
    sender.resume();
    assert_eq!(run(&mut sender, LATER.after(LATER), 20), b"X1.\n\nM30\n%\n");
}

#[test]
fn an_abort_ends_with_the_block_under_way() {
    let mut sender = sender();
    sender.on_bytes(LATER, &[DC1]);
    assert_eq!(run(&mut sender, LATER, 1), b"%\nG0");
    sender.abort(LATER);
    assert_eq!(run(&mut sender, LATER, 20), b"X1.\n");
    assert_eq!((sender.state(), sender.half_block()), (State::Aborted, None));
}

#[test]
fn abort_within_a_block_reports_the_part_already_sent() {
    let mut sender = sender();
    sender.on_bytes(LATER, &[DC1]);
    run(&mut sender, LATER, 1);
    sender.on_bytes(LATER, &[DC3]);
    sender.abort(LATER);
    assert_eq!((run(&mut sender, LATER, 20), sender.state()), (vec![], State::Stopped));
    run(&mut sender, LATER.after(ABORT_MAX), 1);
    assert_eq!((sender.state(), sender.half_block()), (State::Aborted, Some(b"G0".as_slice())));
}

#[test]
fn nothing_leaves_before_it_is_permitted() {
    let mut sender = sender();
    sender.permit(Gate::Journal, 0);
    sender.on_bytes(LATER, &[DC1]);
    assert_eq!((run(&mut sender, LATER, 20), sender.wants_permit(Gate::Journal)), (vec![], true));
    sender.permit(Gate::Journal, 8);
    assert_eq!(run(&mut sender, LATER, 20), b"%\nG0X1.\n");
    assert!(sender.wants_permit(Gate::Journal));
}
