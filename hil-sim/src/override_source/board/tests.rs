use arcfeed_units::RevPerMin;

use super::*;

/// A board that answers each sample with the setpoint that `answer` makes of it.
struct Answering<F> {
    line: PlainLine,
    answer: F,
    out: Vec<u8>,
}

impl<F: FnMut(&Sample) -> Option<Setpoint>> Wires for Answering<F> {
    fn put(&mut self, wire: Wire, bytes: &[u8]) -> Result<(), BoardFailure> {
        assert_eq!(wire, Wire::Machine);
        let samples = bytes.iter().filter_map(|byte| self.line.on_byte(*byte));
        let answers: Vec<Setpoint> = samples
            .filter_map(|message| match message {
                Message::Sample(sample) => (self.answer)(&sample),
                _ => None,
            })
            .collect();
        for setpoint in answers {
            let mut frame = [0; ENCODED_MAX];
            let length = self.line.encode(Micros(0), &Message::Setpoint(setpoint), &mut frame);
            self.out.extend(&frame[..length]);
        }
        Ok(())
    }

    fn take(&mut self, wire: Wire, bytes: &mut [u8]) -> Result<(), BoardFailure> {
        let length = self.take_waiting(wire, bytes)?;
        if length == bytes.len() { Ok(()) } else { Err(BoardFailure::Silent(wire)) }
    }

    fn take_waiting(&mut self, wire: Wire, bytes: &mut [u8]) -> Result<usize, BoardFailure> {
        let length = if wire == Wire::Machine { self.out.len().min(bytes.len()) } else { 0 };
        bytes.iter_mut().zip(self.out.drain(..length)).for_each(|(place, byte)| *place = byte);
        Ok(length)
    }
}

/// *FV0 to *FV7 of 100 %.
const HUNDRED: u8 = 0b0110_0100;

fn setpoint(sample: &Sample) -> Setpoint {
    Setpoint { at: sample.at, lines: HUNDRED, state: StateCode::Armed, link_bytes: 0, tap_bytes: 0 }
}

fn board<F: FnMut(&Sample) -> Option<Setpoint>>(mode: ModeCode, answer: F) -> Board<Answering<F>> {
    Board::new(Answering { line: PlainLine::new(), answer, out: Vec::new() }, (), mode)
}

fn shown(ms: u64) -> MachineSignals {
    let signals = Signals::NONE;
    MachineSignals {
        at: Micros::from_ms(ms),
        position: Pose::ORIGIN,
        spindle: RevPerMin(1_000.0),
        operator_percent: 100,
        signals,
    }
}

#[test]
fn the_lines_of_the_answer_are_the_override() {
    let mut board = board(ModeCode::Lockstep, |sample| Some(setpoint(sample)));
    for ms in 1..4 {
        assert_eq!(board.decide(&shown(ms)).percent, 100);
    }
    assert_eq!((board.state(), board.failure()), (Some(StateCode::Armed), None));
}

#[test]
fn lockstep_board_with_a_wrong_answer_stays_at_0_percent() {
    type Answer = fn(&Sample) -> Option<Setpoint>;
    let cases: [(Answer, BoardFailure); 4] = [
        (|sample| (sample.at != 3_000).then(|| setpoint(sample)), BoardFailure::Silent(Wire::Machine)),
        (
            |sample| Some(Setpoint { at: sample.at - u64::from(sample.at == 3_000), ..setpoint(sample) }),
            BoardFailure::OutOfStep(Micros(2_999)),
        ),
        (
            |sample| Some(Setpoint { link_bytes: u32::from(sample.at == 3_000), ..setpoint(sample) }),
            BoardFailure::Silent(Wire::Link),
        ),
        (
            |sample| Some(Setpoint { tap_bytes: u32::from(sample.at == 3_000), ..setpoint(sample) }),
            BoardFailure::Tap(1),
        ),
    ];
    for (answer, why) in cases {
        let mut board = board(ModeCode::Lockstep, answer);
        let percents: Vec<u8> = (1..6).map(|ms| board.decide(&shown(ms)).percent).collect();
        assert_eq!((percents, board.failure()), (vec![100, 100, 0, 0, 0], Some(why)));
    }
}

#[test]
fn free_running_the_last_setpoint_stays_in_force() {
    let mut board = board(ModeCode::Free, |sample| (sample.at == 2_000).then(|| setpoint(sample)));
    let percents: Vec<u8> = (1..5).map(|ms| board.decide(&shown(ms)).percent).collect();
    // Before the first one no line is low: 0 %.
    assert_eq!(percents, [0, 100, 100, 100]);
    assert_eq!(board.failure(), None);
}

#[test]
fn a_restarted_board_counts_from_the_beginning() {
    /// Sends a fixed number of bytes each period.
    struct Talker;
    impl AttachedDevices for Talker {
        fn send(&mut self, _at: Micros, traffic: &mut Traffic) {
            traffic.link.extend([1; 3]);
        }
        fn receive(&mut self, _at: Micros, _wire: Wire, _bytes: &[u8]) {}
    }
    /// Answers on the line to the machine, discards bytes on the line to the host.
    struct Both<F>(Answering<F>);
    impl<F: FnMut(&Sample) -> Option<Setpoint>> Wires for Both<F> {
        fn put(&mut self, wire: Wire, bytes: &[u8]) -> Result<(), BoardFailure> {
            if wire == Wire::Machine { self.0.put(wire, bytes) } else { Ok(()) }
        }
        fn take(&mut self, wire: Wire, bytes: &mut [u8]) -> Result<(), BoardFailure> {
            self.0.take(wire, bytes)
        }
        fn take_waiting(&mut self, wire: Wire, bytes: &mut [u8]) -> Result<usize, BoardFailure> {
            self.0.take_waiting(wire, bytes)
        }
    }
    let mut counted = Vec::new();
    let answer = |sample: &Sample| {
        counted.push(sample.link_bytes);
        (counted.len() != 3).then(|| setpoint(sample))
    };
    let wires = Both(Answering { line: PlainLine::new(), answer, out: Vec::new() });
    let mut board = Board::new(wires, Talker, ModeCode::Lockstep);
    let percents: Vec<u8> = (1..4).map(|ms| board.decide(&shown(ms)).percent).collect();
    assert_eq!((percents, board.failure()), (vec![100, 100, 0], Some(BoardFailure::Silent(Wire::Machine))));
    board.restart(|_| {});
    assert_eq!((board.state(), board.failure()), (None, None));
    assert_eq!((4..6).map(|ms| board.decide(&shown(ms)).percent).collect::<Vec<u8>>(), [100, 100]);
    drop(board);
    assert_eq!(counted, [0, 3, 6, 0, 3]);
}
