use super::*;

const RTO: Span = Span(100_000);

fn outbox(messages: u8) -> Outbox<4> {
    let mut outbox = Outbox::new();
    (0..messages).for_each(|kind| outbox.push(kind, &[kind]).unwrap());
    outbox
}

fn send_all(outbox: &mut Outbox<4>, now: Micros) -> Vec<u16, 8> {
    let mut sent = Vec::new();
    while let Some((seq, ..)) = outbox.next() {
        sent.push(seq).unwrap();
        outbox.next_was_sent(now, RTO);
    }
    sent
}

#[test]
fn what_is_acknowledged_makes_room_and_gives_a_round_trip() {
    let mut outbox = outbox(4);
    assert_eq!(outbox.push(9, &[]), Err(SendError::Full));
    assert_eq!(send_all(&mut outbox, Micros(1_000)), [0, 1, 2, 3]);
    assert_eq!(outbox.on_ack(Micros(9_000), 3, RTO), Acked::Some(Some(Span(8_000))));
    assert_eq!((outbox.len(), outbox.timer()), (1, Some(Micros(109_000))));
    assert_eq!(outbox.on_ack(Micros(9_500), 4, RTO), Acked::Some(Some(Span(8_500))));
    assert_eq!((outbox.len(), outbox.timer()), (0, None));
}

#[test]
fn acknowledging_what_was_never_sent_changes_nothing() {
    let mut outbox = outbox(2);
    outbox.next_was_sent(Micros(0), RTO);
    for ack in [2, 3, 40_000, u16::MAX] {
        assert_eq!(outbox.on_ack(Micros(1), ack, RTO), Acked::Impossible, "{ack}");
    }
    assert_eq!((outbox.len(), outbox.on_ack(Micros(1), 0, RTO)), (2, Acked::Nothing));
}

#[test]
fn the_timer_sends_all_of_it_again_and_a_repetition_gives_no_round_trip() {
    let mut outbox = outbox(3);
    send_all(&mut outbox, Micros(0));
    assert!(!outbox.on_time(Micros(99_999)));
    assert!(outbox.on_time(Micros(100_000)));
    assert_eq!(send_all(&mut outbox, Micros(100_000)), [0, 1, 2]);
    assert_eq!(outbox.on_ack(Micros(101_000), 3, RTO), Acked::Some(None));
}

#[test]
fn two_requests_are_followed_until_something_is_acknowledged() {
    let (mut outbox, trip) = (outbox(3), Span(5_000));
    send_all(&mut outbox, Micros(0));
    assert!(outbox.on_nak(Micros(10_000), 0, trip));
    assert!(!outbox.on_nak(Micros(10_001), 0, trip), "it is being sent");
    assert_eq!(send_all(&mut outbox, Micros(10_002)), [0, 1, 2]);
    assert!(!outbox.on_nak(Micros(14_999), 0, trip), "the repetition cannot have shown yet");
    assert!(outbox.on_nak(Micros(15_000), 0, trip));
    send_all(&mut outbox, Micros(15_001));
    assert!(!outbox.on_nak(Micros(90_000), 0, trip), "the third is the timer's");
    assert_ne!(outbox.on_ack(Micros(90_000), 1, RTO), Acked::Nothing);
    assert!(outbox.on_nak(Micros(90_001), 1, trip));
    assert_eq!(send_all(&mut outbox, Micros(90_002)), [1, 2]);
    assert!(!outbox.on_nak(Micros(100_000), 2, trip), "about another one");
}

#[test]
fn busy_peer_stops_the_timer_and_gets_all_messages_when_ready() {
    let mut outbox = outbox(3);
    send_all(&mut outbox, Micros(0));
    outbox.on_busy(Micros(1_000), true);
    assert_eq!((outbox.next().is_none(), outbox.timer(), outbox.waiting_since()), (true, None, None));
    outbox.on_busy(Micros(900_000), false);
    assert_eq!(outbox.waiting_since(), Some(Micros(900_000)));
    assert_eq!(send_all(&mut outbox, Micros(900_000)), [0, 1, 2]);
}

#[test]
fn sequence_numbers_go_on_beyond_their_wrap() {
    let (mut outbox, mut inbox) = (outbox(0), Inbox::default());
    for count in 0..70_000_u32 {
        outbox.push(0, &count.to_le_bytes()).unwrap();
        let (seq, ..) = outbox.next().unwrap();
        assert_eq!((seq, inbox.classify(seq)), (count as u16, Arrival::Next));
        assert_eq!(
            (inbox.classify(seq.wrapping_add(1)), inbox.classify(seq.wrapping_sub(1))),
            (Arrival::Gap, Arrival::Again)
        );
        outbox.next_was_sent(Micros(0), RTO);
        inbox.delivered();
        assert_ne!(outbox.on_ack(Micros(1), inbox.expected(), RTO), Acked::Impossible);
    }
    assert!(outbox.is_empty());
}
