//! What is fed, and what must hold.

use std::path::Path;

use arcfeed::job::JobFile;
use arcfeed_hil_sim::control::{Control, ControlSettings};
use arcfeed_shared::nc::block::{Reading, parse_line};
use arcfeed_shared::nc::word::Words;
use arcfeed_shared::reader::Reader;
use arcfeed_shared::units::{LengthUnit, Micros};
use fastrand::Rng;

/// The control's step.
const STEP: Micros = Micros::from_ms(1);

/// Every token and every complaint has its place in the line, in order.
pub fn lexer(input: &[u8], _: u64) {
    for line in input.split(|byte| *byte == b'\n') {
        let mut last = 0;
        for piece in Words::new(line) {
            match piece {
                Ok(piece) => {
                    assert!(last <= piece.start && piece.start < piece.end && piece.end <= line.len(), "{piece:?}");
                    last = piece.end;
                }
                Err(fault) => assert!(usize::from(fault.column) <= line.len() + 1, "{fault:?}"),
            }
        }
    }
}

/// Both readings; strict accepts nothing that lenient refuses.
pub fn blocks(input: &[u8], _: u64) {
    for line in input.split(|byte| *byte == b'\n') {
        let (lenient, strict) = (parse_line(line, Reading::Lenient), parse_line(line, Reading::Strict));
        assert!(strict.is_err() || lenient.is_ok(), "{:?}", String::from_utf8_lossy(line));
    }
}

/// A program line by line: whatever became of one line, the next is read.
pub fn program(input: &[u8], seed: u64) {
    let unit = if seed.is_multiple_of(2) { LengthUnit::Inch } else { LengthUnit::Mm };
    let mut reader = Reader::new(unit, Reading::Lenient);
    for line in input.split(|byte| *byte == b'\n') {
        if let Ok(understood) = reader.read(line)
            && let Some(segment) = understood.segment
        {
            assert!(segment.length_mm().is_finite() && segment.feed_length_mm() >= 0.0, "{segment:?}");
        }
    }
}

/// Bytes in bursts and at leisure; the control moves on, stops with an alarm, or waits.
pub fn port(input: &[u8], seed: u64) {
    let mut random = Rng::with_seed(seed);
    let mut control = Control::on_line(ControlSettings::fanuc_16i(LengthUnit::Mm));
    let (mut now, mut left) = (Micros(0), input);
    for _ in 0..400 {
        let (burst, rest) = left.split_at(random.usize(..=left.len().min(40)));
        control.port().on_bytes(burst);
        left = rest;
        now = now.after(STEP);
        control.step(now, STEP, random.u8(..));
        while control.port().poll_transmit().is_some() {}
    }
}

/// A job file, or something like one.
pub fn job(input: &[u8], _: u64) {
    let _refused_or_not = JobFile::parse(Path::new("job.toml"), &String::from_utf8_lossy(input));
}
