//! The lines of a spy, as users see them.

use std::fs;

use arcfeed::job::{Parity, SerialSettings};
use arcfeed::port::open::open;
use arcfeed_tests::Scratch;

use arcfeed_tests::python::{output, python_or_skip};

const SETTINGS: SerialSettings = SerialSettings {
    baudrate: 9_600,
    bytesize: 8,
    parity: Parity::None,
    stopbits: 1,
    xonxoff: false,
    rtscts: false,
    write_timeout: None,
    exclusive: true,
};

/// Log of our spy while data passes through a loopback.
fn ours(file: &str, options: &str, data: &[Vec<u8>]) -> String {
    let url = format!("spy://loop://?file={file}{options}").parse().expect("a URL");
    let mut port = open(&url, &SETTINGS).expect("a loop opens");
    let mut buffer = [0; 512];
    for bytes in data {
        assert_eq!(port.write(bytes).expect("room"), bytes.len());
        assert_eq!(port.read(&mut buffer).expect("a loop stays"), bytes.len());
    }
    if options.contains("all") {
        assert_eq!(port.read(&mut buffer).expect("a loop stays"), 0);
    }
    drop(port);
    fs::read_to_string(file).expect("the spy's file")
}

/// Lines without their times, which must look like one.
fn without_times(text: &str) -> Vec<String> {
    let without = |line: &str| {
        let at = line.find(|c: char| c.is_ascii_digit() && !line.starts_with('\u{1b}')).unwrap_or(5);
        let (time, rest) = line[at..].split_at(10);
        assert!(time.len() == 10 && time.as_bytes()[6] == b'.', "{line:?}");
        format!("{}{rest}", &line[..at])
    };
    text.lines().map(without).collect()
}

#[test]
fn the_spy_writes_what_pyserials_spy_writes() {
    let Some(python) = python_or_skip("spy") else { return };
    let scratch = Scratch::new("spy");
    let data: Vec<Vec<u8>> = [1, 7, 8, 9, 15, 16, 17, 40, 256].map(|len| (0..len).map(|at| at as u8).collect()).into();
    let hex: Vec<String> = data.iter().map(|bytes| bytes.iter().map(|byte| format!("{byte:02x}")).collect()).collect();
    for options in ["", "&color", "&all"] {
        let (theirs, file) = (scratch.path("theirs"), scratch.path("ours"));
        let theirs_options = format!("?file={theirs}{options}");
        let arguments: Vec<&str> =
            std::iter::once(theirs_options.as_str()).chain(hex.iter().map(String::as_str)).collect();
        output(python, "spy.py", &arguments, "");
        let theirs = fs::read_to_string(theirs).expect("pyserial's file");
        // Calls of pyserial that close a port are not traffic.
        let traffic: Vec<String> =
            without_times(&theirs).into_iter().filter(|line| line.contains("TX  ") || line.contains("RX  ")).collect();
        assert_eq!(without_times(&ours(&file, options, &data)), traffic, "{options}");
        assert!(traffic.len() > 40, "{} lines", traffic.len());
    }
}

#[test]
fn a_raw_spy_writes_the_bytes() {
    let scratch = Scratch::new("raw-spy");
    assert_eq!(ours(&scratch.path("raw"), "&raw", &[b"G0X1.\n".to_vec()]), "G0X1.\nG0X1.\n");
}
