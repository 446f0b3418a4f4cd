//! Fuzz targets and their required properties.

use std::path::Path;

use arcfeed::job::{JobFile, Parity, SerialSettings};
use arcfeed::port::rfc2217::client::{RequestedLine, Rfc2217Client};
use arcfeed::port::rfc2217::server::Server;
use arcfeed::port::url::{PortUrl, Rfc2217Options};
use arcfeed_control::code::TapeCode;
use arcfeed_control::dnc_port::DncPort;
use arcfeed_control::line::{LineSettings, SenderParity};
use arcfeed_control::tape::TapeSettings;
use arcfeed_control::{Control, ControlSettings};
use arcfeed_nc::block::{Reading, parse_line};
use arcfeed_nc::reader::Reader;
use arcfeed_nc::word::Words;
use arcfeed_units::{LengthUnit, Micros};
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

/// The port by itself, set in any way: every character is counted once, a block comes out for each end of block, and after
/// reset and cycle start it reads again.
pub fn line(input: &[u8], seed: u64) {
    let mut random = Rng::with_seed(seed);
    let mut port = DncPort::on_line(line_settings(&mut random));
    let (mut left, mut given, mut taken) = (input, 0, 0);
    for _ in 0..200 {
        let (burst, rest) = left.split_at(random.usize(..=left.len().min(60)));
        port.on_bytes(burst);
        given += burst.len();
        left = rest;
        match random.u8(..60) {
            0 => port.on_framing_error(),
            1 => port.set_ready(random.bool()),
            2 => port.exempt_bytes_on_wire(),
            3 => port.close(),
            4 => port.reset(),
            5 => port.restart(),
            6 => {
                let code = port.code();
                port.punch().open();
                port.punch().print(burst, code);
                port.punch().close();
            }
            _ => {}
        }
        let _alarm_or_not = port.step(Micros(random.u64(..5_000)));
        while random.u8(..3) > 0 && port.take_block().is_some() {
            taken += 1;
        }
        while random.u8(..5) > 0 && port.poll_transmit().is_some() {}
        assert!(
            port.counters().bytes <= given as u64 && taken <= port.counters().bytes,
            "{taken} blocks of {given} bytes"
        );
        assert!(port.buffered() as u64 <= port.counters().bytes);
    }
}

fn line_settings(random: &mut Rng) -> LineSettings {
    let buffer = random.usize(1..2_000);
    let xon_above = random.usize(..=buffer);
    LineSettings {
        baudrate: *random.choice(&[0, 50, 9_600, 115_200, u32::MAX]).expect("rates"),
        bits_per_char: random.u32(..13),
        sender: *random.choice(&[SenderParity::None, SenderParity::Even, SenderParity::Odd]).expect("parities"),
        buffer,
        xoff_below: random.usize(..=xon_above),
        xon_above,
        after_dc3_max: random.u32(..12),
        tape: TapeSettings {
            code: *random
                .choice(&[None, Some(TapeCode::Iso), Some(TapeCode::Eia), Some(TapeCode::Ascii)])
                .expect("codes"),
            label_skip: random.bool(),
            tv_check: random.bool(),
            strict_characters: random.bool(),
        },
    }
}

/// A job file, or something like one.
pub fn job(input: &[u8], _: u64) {
    let _refused_or_not = JobFile::parse(Path::new("job.toml"), &String::from_utf8_lossy(input));
}

/// Port URLs: read or refused, the same whatever stands around them.
pub fn url(input: &[u8], seed: u64) {
    const PIECES: [&str; 16] = [
        "spy://",
        "fault://seed=1,drop=0.5/",
        "loop://",
        "socket://h:1",
        "rfc2217://[::1]:2",
        "hwgrep://tty",
        "alt://x",
        "sim:",
        "?",
        "&",
        "=",
        "file=x",
        "timeout=1",
        "%41",
        "n=2",
        "://",
    ];
    let mut random = Rng::with_seed(seed);
    let text = String::from_utf8_lossy(&input[..input.len().min(random.usize(..40))]).into_owned();
    let mut url = String::new();
    for _ in 0..random.usize(..6) {
        url += PIECES[random.usize(..PIECES.len())];
    }
    url.insert_str(random.usize(..=url.len()), &text);
    let parsed = url.parse::<PortUrl>();
    if let Ok(port) = &parsed {
        let wrapped: PortUrl = format!("fault://seed=3/{url}").parse().unwrap_or_else(|error| panic!("{url}: {error}"));
        assert_eq!((&wrapped.base, &wrapped.wrappers[1..]), (&port.base, &port.wrappers[..]), "{url}");
    }
}

/// Random bytes of the other end, in pieces: a client continues, waits or gives up, a server reads them as settings and data,
/// and neither answers more than it received.
pub fn rfc2217(input: &[u8], seed: u64) {
    let settings = SerialSettings {
        baudrate: 9_600,
        bytesize: 7,
        parity: Parity::Even,
        stopbits: 2,
        xonxoff: true,
        rtscts: seed.is_multiple_of(2),
        write_timeout: None,
        exclusive: true,
    };
    let options =
        Rfc2217Options { ign_set_control: seed.is_multiple_of(3), poll_modem: true, timeout_s: 1.0, logging: None };
    let mut client = Rfc2217Client::new(&RequestedLine::new(&settings), &options, Micros(0));
    let (mut server, mut answered, mut on_line) = (Server::new(&settings), Vec::new(), 0);
    let (mut random, mut said, mut data) = (Rng::with_seed(seed), Vec::new(), [0; 64]);
    let mut bytes: Vec<u8> = input.iter().take(300).copied().collect();
    // Telnet's own, and the codes of RFC 2217 in both directions.
    let meaningful: Vec<u8> = (240..=255).chain(0..13).chain(100..113).chain([44, 44, 44, 37, 128]).collect();
    bytes.extend((0..200).map(|_| meaningful[random.usize(..meaningful.len())]));
    for _ in 0..random.u8(..4) {
        let at = random.usize(..=bytes.len());
        bytes.splice(at..at, [255, 253, 44, 255, 250, 44, 101, 0, 0, 37, 128, 255, 240]);
    }
    for (at, piece) in bytes.chunks(1 + random.usize(..30)).enumerate() {
        let now = Micros::from_ms(at as u64 * 20);
        client.on_bytes(now, piece);
        let _refused_or_not = client.check(now);
        client.poll_transmit(&mut said);
        while client.take_data(&mut data) > 0 {}
        server.on_bytes(now, piece);
        piece.iter().take(3).for_each(|byte| server.on_line(*byte));
        server.poll_transmit(&mut answered);
        on_line += std::iter::from_fn(|| server.next_for_line()).count() + server.take_breaks();
    }
    assert!(on_line + server.waiting() <= bytes.len());
    assert!(answered.len() <= 15 * bytes.len() + 300, "{} bytes answered to {}", answered.len(), bytes.len());
    assert!(said.len() <= 4 * bytes.len() + 300, "{} bytes said to {}", said.len(), bytes.len());
}
