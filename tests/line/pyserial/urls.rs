//! Each URL of a table as pyserial and as arcfeed parse it: the same, except for the differences listed here and in
//! docs/ports.md.

use arcfeed::port::list::{PortInfo, find};
use arcfeed::port::url::{Base, PortUrl, Wrapper};
use arcfeed_tests::root;

use arcfeed_tests::python::{output, python_or_skip};

/// URLs with the same result.
const SAME: [&str; 50] = [
    "/dev/ttyS0",
    "COM3",
    "/dev/serial/by-id/usb-x?y&z",
    "loop://",
    "LOOP://",
    "loop://?logging=debug",
    "loop://?logging=error&logging=info",
    "loop://?",
    "loop://?&",
    "loop://?logging=loud",
    "loop://?logging",
    "loop://?speed=1",
    "loop://?=",
    "socket://localhost:7000",
    "socket://LOCALHOST:7000",
    "socket://10.0.0.7:7000?logging=warning",
    "socket://[::1]:7000",
    "socket://host:65535",
    "socket://host:7000/",
    "socket://host",
    "socket://host:",
    "socket://host:65536",
    "socket://host:-1",
    "socket://host:x",
    "socket://host:7000?timeout=3",
    "socket://host:7000?logging=DEBUG",
    "rfc2217://host:4001",
    "rfc2217://host:4001?ign_set_control",
    "rfc2217://host:4001?poll_modem&timeout=0.5&ign_set_control&logging=info",
    "rfc2217://host:4001?timeout=1e1",
    "rfc2217://host:4001?timeout=%35",
    "rfc2217://host:4001?timeout",
    "rfc2217://host:4001?timeout=soon",
    "rfc2217://host:4001?baudrate=9600",
    "rfc2217://host",
    "spy:///dev/ttyS0",
    "spy:///dev/ttyS0?all&color",
    "spy://COM3?color",
    "spy:///dev/ttyS0?dev=/dev/pts/1",
    "spy:///dev/ttyS0?log=x",
    "alt:///dev/ttyS0",
    "alt:///dev/ttyS0?class=Serial",
    "alt:///dev/ttyS0?class=PosixPollSerial",
    "alt:///dev/ttyS0?class=Foo",
    "alt:///dev/ttyS0?speed=1",
    "hwgrep://ttyUSB",
    "hwgrep://0403:6001",
    "hwgrep://usb&n=2",
    "hwgrep://usb&m=2",
    "foo://x",
];

/// URLs that only arcfeed accepts.
const OURS_ONLY: [&str; 4] = [
    "hwgrep://ttyUSB&n=1",
    "spy:///dev/ttyS0?file=/no/such/folder/x",
    "fault://drop=0.01,seed=7//dev/ttyUSB0",
    "fault://seed=7/spy://loop://",
];

/// URLs that pyserial treats as names of native ports, and then does not find; arcfeed parses them as URLs.
const NAMES_TO_PYSERIAL: [&str; 3] = ["HWGREP://ttyUSB2", "spy://hwgrep://ttyUSB&n=2", "spy://socket://host:7000?all"];

/// URLs that only pyserial accepts.
const PYSERIALS_ONLY: [&str; 18] = [
    "",
    "spy://",
    "alt://",
    "loop://name",
    "socket://host:7000/path",
    "socket://user@host:7000",
    "socket://host:7000#part",
    "socket://host:0",
    "socket://:7000",
    "rfc2217://host:4001?timeout=-1",
    "rfc2217://host:4001?timeout=nan",
    "rfc2217://host:4001?timeout=inf",
    "rfc2217://host:4001?poll_modem=0",
    "spy:///dev/ttyS0?color=0",
    "alt:///dev/ttyS0?class=VTIMESerial",
    "hwgrep://tty&skip_busy=1x",
    "hwgrep://(?=tty)ttyUSB",
    "hwgrep://(tty)\\1?USB",
];

/// The ports that urls.py lets pyserial find.
fn ports() -> Vec<PortInfo> {
    let port = |device: &str, description: &str, hwid: &str| PortInfo {
        device: device.into(),
        name: device.rsplit('/').next().unwrap_or_default().into(),
        description: description.into(),
        hwid: hwid.into(),
        vid: None,
        pid: None,
        serial_number: None,
        location: None,
        manufacturer: None,
        product: None,
        interface: None,
    };
    vec![
        port("/dev/ttyS0", "ttyS0", "PNP0501"),
        port("/dev/ttyUSB2", "CP2102", "USB VID:PID=10C4:EA60 SER=B2 LOCATION=1-1"),
        port("/dev/ttyUSB10", "FT232R USB UART", "USB VID:PID=0403:6001 SER=A1 LOCATION=1-2"),
    ]
}

/// Meaning of a URL, as urls.py prints it.
fn meaning(url: &PortUrl) -> String {
    match &url.base {
        Base::Native(name) => name.clone(),
        Base::Socket(address, _) | Base::Rfc2217(address, _) => format!("{}:{}", address.host, address.port),
        Base::Hwgrep(wanted) => find(&ports(), wanted, |_| true).unwrap_or_default(),
        Base::Loop(_) | Base::Sim | Base::LinuxCnc => String::new(),
    }
}

#[test]
fn urls_mean_what_they_mean_to_pyserial_but_for_the_differences_listed() {
    let Some(python) = python_or_skip("URLs") else { return };
    let all: Vec<&str> = [&SAME[..], &OURS_ONLY, &NAMES_TO_PYSERIAL, &PYSERIALS_ONLY].concat();
    let said = output(python, "urls.py", &[], &(all.join("\n") + "\n"));
    assert_eq!(said.lines().count(), all.len());
    let mut accepted = 0;
    for (text, said) in all.iter().zip(said.lines()) {
        let (theirs, what) = said.split_once('\t').expect("a verdict and what it means");
        let ours = text.parse::<PortUrl>();
        println!("{text:55} pyserial: {theirs} {what:.60}; arcfeed: {}", ours.is_ok());
        let wanted = match text {
            text if OURS_ONLY.contains(text) => ("no", true),
            text if PYSERIALS_ONLY.contains(text) => ("ok", false),
            _ => (theirs, theirs == "ok"),
        };
        assert_eq!((theirs, ours.is_ok()), wanted, "{text}: pyserial says {what}, we {ours:?}");
        if let (Ok(url), "ok") = (&ours, theirs) {
            assert_eq!(meaning(url) == what, !NAMES_TO_PYSERIAL.contains(text), "{text}: {what}");
            accepted += 1;
        }
    }
    assert!(accepted >= 20, "{accepted} accepted by both");
}

#[test]
fn every_difference_stands_in_the_documentation() {
    let text = std::fs::read_to_string(root().join("docs/ports.md")).expect("docs/ports.md");
    for url in OURS_ONLY.iter().chain(&NAMES_TO_PYSERIAL).chain(&PYSERIALS_ONLY) {
        assert!(url.is_empty() || text.contains(&format!("`{url}`")), "{url} is not in docs/ports.md");
    }
}

#[test]
fn a_wrapper_of_ours_keeps_the_port_inside() {
    let url: PortUrl = "fault://drop=0.01,seed=7//dev/ttyUSB0".parse().expect("a URL");
    assert!(matches!(url.wrappers[..], [Wrapper::Fault(_)]));
    assert_eq!(meaning(&url), "/dev/ttyUSB0");
}
