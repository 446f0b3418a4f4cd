use super::*;

/// Line without an end: accepts everything and returns what was written; its clock moves while a caller waits.
#[derive(Default)]
struct Echo {
    held: VecDeque<u8>,
    now: Micros,
}

impl Port for Echo {
    fn now(&self) -> Micros {
        self.now
    }

    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        let len = buffer.len().min(self.held.len());
        buffer.iter_mut().zip(self.held.drain(..len)).for_each(|(slot, byte)| *slot = byte);
        Ok(len)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<usize, PortError> {
        self.held.extend(bytes);
        Ok(bytes.len())
    }

    fn wait(&mut self, deadline: Micros) {
        self.now = self.now.max(deadline);
    }
}

fn plan(text: &str) -> FaultPlan {
    let url: crate::url::PortUrl = format!("fault://{text}/loop://").parse().unwrap();
    let crate::url::Wrapper::Fault(plan) = &url.wrappers[0] else { panic!("{url:?}") };
    plan.clone()
}

fn program(len: usize) -> Vec<u8> {
    (0..len).map(|at| (at % 251) as u8).collect()
}

/// Bytes that come back of `sent`, written and read `at_once` bytes at a time.
fn back(text: &str, sent: &[u8], at_once: usize) -> Vec<u8> {
    let mut port = Fault::new(Box::new(Echo::default()), &plan(text));
    let (mut left, mut back, mut buffer) = (sent, Vec::new(), vec![0; at_once]);
    for round in 0..sent.len() * 20 {
        let taken = port.write(&left[..left.len().min(at_once)]).unwrap();
        left = &left[taken..];
        port.wait(Micros(round as u64 * 1_000));
        let len = port.read(&mut buffer).unwrap();
        back.extend(&buffer[..len]);
        if left.is_empty() && len == 0 && port.out_waiting().unwrap() == 0 && port.rx.queue.is_empty() {
            break;
        }
    }
    back
}

fn dropped_bytes(text: &str, sent: &[u8]) -> usize {
    sent.len() - back(text, sent, 16).len()
}

#[test]
fn without_faults_nothing_changes() {
    let sent = program(5_000);
    assert_eq!(back("seed=1", &sent, 7), sent);
    assert_eq!(back("seed=1,delay=5", &sent, 7), sent);
    assert_eq!(back("seed=1,short=0.5", &sent, 7), sent);
}

#[test]
fn the_same_seed_corrupts_the_same_bytes_however_they_are_cut() {
    let sent = program(3_000);
    let all = "drop=0.01,flip=0.01,dup=0.01,burst=0.002,delay=3,garbage=40,lost_xon=0.5,lost_xoff=0.5";
    let first = back(&format!("{all},seed=7"), &sent, 1);
    for at_once in [3, 16, 64] {
        assert_eq!(back(&format!("{all},seed=7"), &sent, at_once), first, "{at_once} at once");
    }
    assert_ne!(back(&format!("{all},seed=8"), &sent, 1), first);
}

#[test]
fn chances_are_met() {
    // Both ways; 100 000 bytes, five standard deviations: sqrt(2e5 * 0.01 * 0.99) = 44.5.
    let sent = vec![b'X'; 100_000];
    let dropped = dropped_bytes("drop=0.01,seed=3", &sent);
    assert!((2_000 - 10_i64 - 223..=2_000 + 223).contains(&(dropped as i64)), "{dropped}");
    let doubled = back("dup=0.01,seed=3", &sent, 16).len() - sent.len();
    assert!((1_777..=2_243).contains(&doubled), "{doubled}");
    let one_way = dropped_bytes("tx.drop=0.01,seed=3", &sent);
    assert!((1_000 - 158..=1_000 + 158).contains(&one_way), "{one_way}");
}

#[test]
fn a_flip_changes_one_bit_and_a_burst_2_to_16_bytes() {
    let sent = vec![b'X'; 20_000];
    let flipped = back("tx.flip=0.01,seed=5", &sent, 16);
    let bits: Vec<u32> = flipped.iter().map(|byte| (byte ^ b'X').count_ones()).filter(|bits| *bits > 0).collect();
    assert!((130..=270).contains(&bits.len()) && bits.iter().all(|bits| *bits == 1), "{} flips", bits.len());
    let burst = back("tx.burst=0.0005,seed=5", &sent, 16);
    let noisy = burst.iter().filter(|byte| **byte != b'X').count();
    assert!(burst.len() == sent.len() && (40..=200).contains(&noisy), "{noisy} bytes of noise");
}

#[test]
fn only_what_the_control_says_is_lost_of_xon_and_xoff() {
    let sent: Vec<u8> = [DC1, b'X', DC3, b'Y'].repeat(1_000);
    let found = back("lost_xon=1,seed=2", &sent, 16);
    assert_eq!(found, [b'X', DC3, b'Y'].repeat(1_000));
    let half = back("lost_xoff=0.5,seed=2", &sent, 16).iter().filter(|byte| **byte == DC3).count();
    assert!((420..=580).contains(&half), "{half} of 1000");
}

#[test]
fn garbage_comes_first() {
    let sent = program(10);
    let found = back("garbage=100,seed=4", &sent, 16);
    assert_eq!((found.len(), &found[100..]), (110, &sent[..]));
}

#[test]
fn a_dead_line_stays_dead_and_took_what_it_said() {
    let mut port = Fault::new(Box::new(Echo::default()), &plan("disconnect=10"));
    assert_eq!(port.write(&program(8)).unwrap(), 8);
    assert_eq!(port.write(&program(8)).unwrap(), 2);
    for _ in 0..2 {
        assert_eq!(port.write(b"X").unwrap_err().source.kind(), ErrorKind::BrokenPipe);
        assert_eq!(port.read(&mut [0; 4]).unwrap_err().source.kind(), ErrorKind::BrokenPipe);
    }
}

#[test]
fn late_bytes_are_late_in_order_and_known_to_be_under_way() {
    let mut port = Fault::new(Box::new(Echo::default()), &plan("tx.delay=100,seed=1"));
    assert_eq!(port.write(&program(50)).unwrap(), 50);
    assert!(port.out_waiting().unwrap() > 40);
    port.wait(Micros::from_ms(100));
    let mut waits = 1;
    while port.now() < Micros::from_ms(100) {
        port.wait(Micros::from_ms(100));
        waits += 1;
    }
    assert!(waits > 2, "nothing was late");
    assert_eq!(port.out_waiting().unwrap(), 0);
    let mut found = [0; 64];
    assert_eq!((port.read(&mut found).unwrap(), &found[..50]), (50, &program(50)[..]));
}
