use super::*;
use crate::deframer::Deframer;
use crate::frame::{ENCODED_MAX, FrameClass, Header, NO_SALT, VERSION, encode};
use crate::settings::Role;

const SCHEMA: u32 = 0x5EED_0001;
type End4 = Link<4, 2>;
/// Messages that an end received: kind, payload, delivery.
type Taken = Vec<(u8, Vec<u8>, Delivery)>;

fn settings(role: Role) -> LinkSettings {
    LinkSettings { bits_per_s: 0, ..LinkSettings::new(role, SCHEMA) }
}

fn ends() -> (End4, End4) {
    (Link::new(settings(Role::Host), 11).unwrap(), Link::new(settings(Role::Board), 22).unwrap())
}

fn frames(link: &mut End4, now: Micros) -> Vec<Vec<u8>> {
    let mut frames = Vec::new();
    let mut out = [0; ENCODED_MAX];
    loop {
        match link.poll_transmit(now, &mut out) {
            0 => return frames,
            len => frames.push(out[..len].to_vec()),
        }
        assert!(frames.len() < 100, "it never stops");
    }
}

fn class_of(frame: &[u8]) -> FrameClass {
    let mut deframer = Deframer::new();
    let class = frame.iter().find_map(|byte| deframer.push(*byte).map(|frame| frame.unwrap().header.class));
    class.unwrap()
}

fn take(link: &mut End4, now: Micros, bytes: &[u8]) -> Taken {
    let mut taken = Vec::new();
    link.on_bytes(now, bytes, &mut |message| taken.push((message.kind, message.payload.to_vec(), message.delivery)));
    taken
}

/// A millisecond at a time, whatever `passes`, from the first to the second end (true) and back; what each was handed.
fn run(
    (a, b): (&mut End4, &mut End4),
    [from, until]: [u64; 2],
    mut passes: impl FnMut(bool, &[u8]) -> bool,
) -> [Taken; 2] {
    let mut taken = [Vec::new(), Vec::new()];
    for now in (from..until).map(Micros::from_ms) {
        for frame in frames(a, now).iter().filter(|frame| passes(true, frame)) {
            taken[1].extend(take(b, now, frame));
        }
        for frame in frames(b, now).iter().filter(|frame| passes(false, frame)) {
            taken[0].extend(take(a, now, frame));
        }
    }
    taken
}

fn up() -> (End4, End4) {
    let (mut a, mut b) = ends();
    run((&mut a, &mut b), [0, 5], |_, _| true);
    assert_eq!([a.state(), b.state()], [LinkState::Up; 2]);
    (a, b)
}

#[test]
fn both_come_up_whichever_of_the_first_frames_is_lost() {
    for lost in 0..6 {
        let (mut a, mut b) = ends();
        let mut count = 0;
        run((&mut a, &mut b), [0, 300], |_, _| {
            count += 1;
            count != lost
        });
        assert_eq!([a.state(), b.state()], [LinkState::Up; 2], "frame {lost} lost");
        assert_eq!((a.peer_session(), b.peer_session()), (Some(22), Some(11)));
    }
}

#[test]
fn messages_arrive_once_and_in_order_though_frames_are_lost() {
    let (mut a, mut b) = up();
    let (mut taken, mut next, mut count) = (Vec::new(), 0_u8, 0_u32);
    for ms in (5..6_000).step_by(5) {
        while next < 200 && a.room() > 0 {
            a.send(7, &[next]).unwrap();
            next += 1;
        }
        let [_, more] = run((&mut a, &mut b), [ms, ms + 5], |_, _| {
            count += 1;
            // One in six, in no order.
            count.wrapping_mul(0x9E37_79B1) >> 24 > 42
        });
        taken.extend(more.into_iter().map(|(kind, payload, delivery)| {
            assert_eq!((kind, delivery), (7, Delivery::Reliable));
            payload[0]
        }));
    }
    assert_eq!(taken, (0..200).collect::<Vec<u8>>());
    assert_eq!((a.unacknowledged(), a.state()), (0, LinkState::Up));
    assert!(a.counters().retransmissions > 20 && a.counters().naks > 0 && b.counters().gaps > 0);
}

#[test]
fn the_newest_value_arrives_with_the_time_it_may_be_used_until() {
    let (mut a, mut b) = up();
    a.offer(1, Micros(5_000), Span::from_ms(40), b"old").unwrap();
    a.offer(1, Micros(8_000), Span::from_ms(40), b"new").unwrap();
    let [_, taken] = run((&mut a, &mut b), [10, 12], |_, _| true);
    let [(1, payload, Delivery::Latest { expires })] = taken.as_slice() else { panic!("{taken:?}") };
    assert_eq!((payload.as_slice(), a.counters().replaced), (b"new".as_slice(), 1));
    assert!((47_000..=48_000).contains(&expires.0), "{expires:?}");
}

#[test]
fn a_value_held_up_on_the_way_is_dropped_at_its_end() {
    let (mut a, mut b) = up();
    a.offer(1, Micros(5_000), Span::from_ms(20), b"x").unwrap();
    let held_up = frames(&mut a, Micros(5_000)).concat();
    assert_eq!(take(&mut b, Micros(24_980), &held_up).len(), 1);
    a.offer(1, Micros(25_000), Span::from_ms(20), b"y").unwrap();
    let held_up = frames(&mut a, Micros(25_000)).concat();
    assert_eq!(take(&mut b, Micros(45_000), &held_up), []);
    assert_eq!(b.counters().expired_in, 1);
    a.offer(1, Micros(45_000), Span::from_ms(20), b"z").unwrap();
    assert!(frames(&mut a, Micros(65_000)).iter().all(|frame| class_of(frame) != FrameClass::Latest));
    assert_eq!(a.counters().expired_out, 1);
}

#[test]
fn neither_class_holds_the_other_back() {
    let (mut a, _) = up();
    let mut out = [0; ENCODED_MAX];
    frames(&mut a, Micros::from_ms(10));
    (0..4).for_each(|n| a.send(7, &[n]).unwrap());
    let mut classes = Vec::new();
    for n in 0..6 {
        a.offer(n % 2, Micros::from_ms(10), Span::from_ms(50), &[n]).unwrap();
        let len = a.poll_transmit(Micros::from_ms(10), &mut out);
        classes.push(class_of(&out[..len]));
    }
    use FrameClass::{Latest, Reliable};
    assert_eq!(classes, [Latest, Reliable, Latest, Reliable, Latest, Reliable]);
}

#[test]
fn an_end_that_is_not_ready_holds_messages_back_and_loses_none() {
    let (mut a, mut b) = up();
    b.set_ready(false);
    let mut taken = Vec::new();
    for ms in (5..4_005).step_by(10) {
        while a.send(7, &[0]).is_ok() {}
        taken.extend(run((&mut a, &mut b), [ms, ms + 10], |_, _| true)[1].clone());
    }
    assert_eq!((taken.len(), a.state(), a.is_peer_busy()), (0, LinkState::Up, true));
    assert!(a.counters().retransmissions == 0, "{:?}", a.counters());
    b.set_ready(true);
    let taken = run((&mut a, &mut b), [4_005, 4_020], |_, _| true);
    assert_eq!((taken[1].len(), a.unacknowledged()), (4, 0));
}

#[test]
fn silence_is_noticed_after_exactly_its_time() {
    let (mut a, mut b) = up();
    run((&mut a, &mut b), [5, 100], |_, _| true);
    let heard = Micros(99_000).since(Micros(u64::from(a.age(Micros(99_000)).0)));
    let end = heard.after(Micros(250_000));
    assert!(frames(&mut a, Micros(end.0 - 1)).len() < 9 && a.state() == LinkState::Up);
    let _due = a.poll_at(Micros(end.0 - 1)).filter(|at| *at <= end).expect("it wants to be asked by then");
    frames(&mut a, end);
    assert_eq!(a.state(), LinkState::Lost(Loss::Silence));
    assert_eq!((a.poll_at(end), a.send(1, &[])), (None, Err(SendError::Down)));
    assert_eq!(take(&mut a, end, &frames(&mut b, end).concat()), []);
}

#[test]
fn recorded_frames_that_come_again_and_again_are_no_sign_of_life() {
    for to_board in [true, false] {
        let (mut a, mut b) = up();
        let mut recorded = Vec::new();
        for ms in 5..200 {
            a.send(7, &[1]).unwrap_or_default();
            b.offer(1, Micros::from_ms(ms), Span::from_ms(50), &[2]).unwrap_or_default();
            run((&mut a, &mut b), [ms, ms + 1], |is_down, frame| {
                recorded.extend((is_down == to_board).then(|| frame.to_vec()));
                true
            });
        }
        let end = if to_board { &mut b } else { &mut a };
        let latest = Micros(199_000).since(Micros(u64::from(end.age(Micros(199_000)).0)));
        let lost = (200..2_000).find(|ms| {
            let frame = &recorded[*ms as usize % recorded.len()];
            assert_eq!(take(end, Micros::from_ms(*ms), frame), [], "a message arrived twice");
            end.state() != LinkState::Up
        });
        assert_eq!((end.state(), lost), (LinkState::Lost(Loss::Silence), Some(latest.0 / 1_000 + 250)));
        assert!(end.counters().copies > 0);
    }
}

#[test]
fn first_frame_of_a_restarted_peer_ends_the_old_session() {
    let (mut a, mut b) = up();
    a.send(7, b"before").unwrap();
    let before = frames(&mut a, Micros::from_ms(6)).concat();
    let mut b_again: End4 = Link::new(settings(Role::Board), 23).unwrap();
    assert_eq!(take(&mut b_again, Micros::from_ms(7), &before), []);
    take(&mut a, Micros::from_ms(7), &frames(&mut b_again, Micros::from_ms(7)).concat());
    assert_eq!(a.state(), LinkState::Lost(Loss::PeerRestarted));
    a.restart(12);
    assert_eq!((a.room(), a.session()), (4, 12));
    take(&mut a, Micros::from_ms(8), &frames(&mut b, Micros::from_ms(60)).concat());
    assert_eq!((a.state(), a.counters().stale_sessions > 0), (LinkState::Greeting, true));
    let taken = run((&mut a, &mut b_again), [60, 200], |_, _| true);
    assert_eq!((a.state(), b_again.state(), taken[1].len()), (LinkState::Up, LinkState::Up, 0));
}

#[test]
fn a_peer_that_hears_but_does_not_acknowledge_is_given_up() {
    let (mut a, mut b) = up();
    a.send(7, b"x").unwrap();
    run((&mut a, &mut b), [5, 3_004], |to_b, frame| !(to_b && class_of(frame) == FrameClass::Reliable));
    assert_eq!(a.state(), LinkState::Up);
    run((&mut a, &mut b), [3_004, 3_010], |to_b, frame| !(to_b && class_of(frame) == FrameClass::Reliable));
    assert_eq!(a.state(), LinkState::Lost(Loss::Unacknowledged));
    assert!(a.counters().timeouts > 2);
}

#[test]
fn garbage_in_a_row_is_the_end_and_between_frames_it_is_counted() {
    let (mut a, mut b) = up();
    for ms in 5..60 {
        take(&mut a, Micros::from_ms(ms), &[1, 2, 3, 0]);
        run((&mut a, &mut b), [ms, ms + 1], |_, _| true);
        a.send(7, &[]).unwrap_or_default();
        b.offer(1, Micros::from_ms(ms), Span::from_ms(5), &[]).unwrap();
    }
    assert_eq!((a.state(), a.counters().framing_errors), (LinkState::Up, 55));
    take(&mut a, Micros::from_ms(60), &[1, 2, 3, 0].repeat(19));
    assert_eq!(a.state(), LinkState::Up);
    take(&mut a, Micros::from_ms(60), &[1, 2, 3, 0]);
    assert_eq!(a.state(), LinkState::Lost(Loss::Garbled));
}

#[test]
fn goodbye_is_said_once_and_understood() {
    let (mut a, mut b) = up();
    a.close();
    assert_eq!(a.poll_at(Micros(9_000)), Some(Micros(9_000)));
    let last = frames(&mut a, Micros(9_000));
    assert_eq!((last.len(), class_of(&last[0]), a.poll_at(Micros(9_000))), (1, FrameClass::Bye, None));
    take(&mut b, Micros(9_500), &last[0]);
    assert_eq!((a.state(), b.state()), (LinkState::Lost(Loss::Closed), LinkState::Lost(Loss::PeerClosed)));
}

#[test]
fn an_incompatible_peer_is_distinguished_and_the_right_one_is_still_accepted() {
    let other = |settings: LinkSettings| Link::<4, 2>::new(settings, 22).unwrap();
    let board = settings(Role::Board);
    let slow = Span::from_ms(126);
    let strangers = [
        (other(LinkSettings { schema: 9, ..board }), Refusal::Schema(9)),
        (other(LinkSettings { heartbeat: slow, lost_after: Span::from_ms(300), ..board }), Refusal::Heartbeat(slow)),
        (other(settings(Role::Host)), Refusal::Role(Role::Host as u8)),
    ];
    for (mut stranger, refusal) in strangers {
        let (mut a, mut b) = ends();
        run((&mut a, &mut stranger), [0, 200], |_, _| true);
        assert_eq!(a.state(), LinkState::Refused(refusal));
        run((&mut a, &mut b), [200, 300], |_, _| true);
        assert_eq!([a.state(), b.state()], [LinkState::Up; 2], "after {refusal:?}");
    }
}

#[test]
fn another_version_is_named_by_its_number() {
    let (mut a, mut b) = ends();
    let hello = frames(&mut b, Micros(0)).concat();
    let mut deframer = Deframer::new();
    let frame = hello.iter().find_map(|byte| deframer.push(*byte).map(|frame| frame.unwrap().payload.to_vec()));
    let header = Header { class: FrameClass::Hello, is_busy: false, kind: 0, seq: 0, ack: 0, t_us: 0 };
    let mut out = [0; ENCODED_MAX];
    let len = encode(&header, [&frame.unwrap(), &[]], NO_SALT, &mut out).unwrap();
    // The version is the first byte of the body; the next version's checksum is made anew.
    let mut body = cobs::decode_vec(&out[..len - 1]).unwrap();
    body[0] = (VERSION + 1) << 4;
    let at = body.len() - 4;
    let check = crate::frame::checksum(&body[..at]).to_le_bytes();
    body[at..].copy_from_slice(&check);
    let mut bytes = cobs::encode_vec(&body);
    bytes.push(0);
    take(&mut a, Micros(0), &bytes);
    assert_eq!(a.state(), LinkState::Refused(Refusal::Version(VERSION + 1)));
}

#[test]
fn restarted_peer_is_noticed_within_a_heartbeat_even_if_two_hellos_are_lost() {
    for lost in 0..4 {
        let (mut a, _) = up();
        let (mut anew, heartbeat) = (Link::new(settings(Role::Board), 33).unwrap(), settings(Role::Board).heartbeat);
        let (mut hellos, began) = (0, 5);
        let until = began + u64::from(heartbeat.0) / 1_000;
        run((&mut a, &mut anew), [began, until], |is_down, _| {
            hellos += usize::from(!is_down);
            hellos > lost
        });
        assert_eq!(a.state() == LinkState::Lost(Loss::PeerRestarted), lost < 3, "{lost} lost");
    }
}

#[test]
fn an_end_that_hears_itself_never_comes_up() {
    let (mut a, _) = ends();
    for ms in 0..500 {
        let own = frames(&mut a, Micros::from_ms(ms)).concat();
        take(&mut a, Micros::from_ms(ms), &own);
    }
    assert_eq!(a.state(), LinkState::Refused(Refusal::Role(Role::Host as u8)));
}

#[test]
fn asked_when_it_wants_to_be_it_always_has_something_to_do() {
    let (mut a, mut b) = up();
    let (mut now, mut polls) = (Micros::from_ms(5), 0);
    while now < Micros::from_ms(3_000) {
        let was = a.state();
        for frame in frames(&mut a, now) {
            take(&mut b, now, &frame);
        }
        for frame in frames(&mut b, now) {
            take(&mut a, now, &frame);
        }
        if polls % 3 == 0 {
            a.send(1, &[]).unwrap_or_default();
        }
        let next = [a.poll_at(now), b.poll_at(now)].into_iter().flatten().min().expect("both are up");
        polls += 1;
        now = if next == now && polls % 3 != 1 { panic!("idle at {now:?}, {was:?}") } else { next };
    }
    // Two heartbeats every 50 ms, and messages with their acknowledgements.
    assert!((100..400).contains(&polls), "{polls}");
}
