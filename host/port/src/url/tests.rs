use super::*;

fn parsed(text: &str) -> PortUrl {
    text.parse().unwrap_or_else(|error: UrlError| panic!("{text}: {error}"))
}

fn refused(text: &str) -> (String, String) {
    match text.parse::<PortUrl>() {
        Ok(url) => panic!("{text} is accepted as {url:?}"),
        Err(UrlError { part, message }) => (part, message),
    }
}

#[test]
fn what_is_no_url_is_a_native_name() {
    for name in ["/dev/ttyUSB0", "COM3", "\\\\.\\COM12", "/dev/serial/by-id/a?b&c"] {
        assert_eq!(parsed(name).base, Base::Native(name.into()));
    }
    assert_eq!((parsed("sim:").base, parsed("loop://").base), (Base::Sim, Base::Loop(None)));
    assert_eq!(parsed("linuxcnc:").base, Base::LinuxCnc);
}

#[test]
fn options_have_pyserials_names_and_defaults() {
    let default = Rfc2217Options { ign_set_control: false, poll_modem: false, timeout_s: 3.0, logging: None };
    let at = |host: &str, port| Address { host: host.into(), port };
    assert_eq!(parsed("rfc2217://Server:4001").base, Base::Rfc2217(at("server", 4001), default));
    let all = Rfc2217Options { ign_set_control: true, poll_modem: true, timeout_s: 0.5, logging: Some(Level::Debug) };
    let text = "RFC2217://[::1]:4001/?timeout=.5&poll_modem&timeout=9&logging=debug&ign_set_control";
    assert_eq!(parsed(text).base, Base::Rfc2217(at("::1", 4001), all));
    assert_eq!(
        parsed("socket://10.0.0.7:7000?logging=error").base,
        Base::Socket(at("10.0.0.7", 7000), Some(Level::Error))
    );
    assert_eq!(parsed("alt:///dev/ttyS0?class=PosixPollSerial").base, Base::Native("/dev/ttyS0".into()));
}

#[cfg(feature = "hwgrep")]
#[test]
fn hwgrep_has_an_expression_and_options() {
    let found = Hwgrep { regexp: "0403:6001".into(), n: 2, skip_busy: true };
    assert_eq!(parsed("hwgrep://0403:6001&n=2&skip_busy").base, Base::Hwgrep(found));
}

#[test]
fn wrappers_nest_and_know_their_own_options() {
    let url = parsed("spy://spy://rfc2217://h:1?timeout=5?file=a%20b&all?color");
    let inner = SpyOptions { file: Some("a b".into()), all: true, ..SpyOptions::default() };
    let outer = SpyOptions { color: true, ..SpyOptions::default() };
    assert_eq!(url.wrappers, [Wrapper::Spy(outer), Wrapper::Spy(inner)]);
    assert!(matches!(url.base, Base::Rfc2217(_, Rfc2217Options { timeout_s: 5.0, .. })));
    // Without options of its own the spy leaves them to the port.
    assert!(matches!(parsed("spy://rfc2217://h:1?timeout=5").base, Base::Rfc2217(..)));
    let (part, message) = refused("spy://rfc2217://h:1?timeout=5&file=x");
    assert_eq!(part, "?timeout=5&file=x");
    assert!(message.contains("?timeout=5?file="), "{message}");
    assert!(refused(&("spy://".repeat(12) + "loop://")).1.contains("wrappers"));
}

#[test]
fn faults_are_set_both_ways_or_one_way() {
    let url = parsed("fault://drop=0.01,seed=7,rx.drop=.5,tx.delay=20,disconnect=9/spy:///dev/ttyS0?file=x");
    let Wrapper::Fault(plan) = &url.wrappers[0] else { panic!("{url:?}") };
    let ms = |ms| arcfeed_units::Micros::from_ms(ms);
    assert_eq!((plan.seed, plan.tx.drop, plan.rx.drop, plan.tx.delay, plan.rx.delay), (7, 0.01, 0.5, ms(20), ms(0)));
    assert_eq!((plan.disconnect, url.wrappers.len(), url.base), (Some(9), 2, Base::Native("/dev/ttyS0".into())));
}

#[test]
fn a_refusal_names_the_part_and_what_to_write() {
    let cases = [
        ("", "", "port is missing"),
        ("foo://x", "foo://", "no such protocol"),
        ("tcp://h:1", "tcp://", "socket://"),
        ("sim://", "sim://", "`sim:`"),
        ("loop://?logging=loud", "logging=loud", "debug"),
        ("loop://x", "x", "loop://"),
        ("socket://host", "host", "host:port"),
        ("socket://host:70000", "70000", "65535"),
        ("socket://::1:7000", "::1:7000", "brackets"),
        ("socket://me@host:7000", "@host:7000", "host:port"),
        ("socket://h:1?timeout=1", "timeout", "logging="),
        ("rfc2217://h:1?timeout=soon", "timeout=soon", "SECONDS"),
        ("rfc2217://h:1?poll_modem=0", "poll_modem=0", "leave it out"),
        #[cfg(feature = "hwgrep")]
        ("hwgrep://tty&n=0", "n=0", "from 1"),
        #[cfg(feature = "hwgrep")]
        ("hwgrep://tty&m=2", "m=2", "skip_busy"),
        #[cfg(feature = "hwgrep")]
        ("hwgrep://(", "(", "regular expression"),
        ("alt:///dev/ttyS0?class=Foo", "Foo", "Serial"),
        ("alt:///dev/ttyS0?class=VTIMESerial", "VTIMESerial", "without alt://"),
        ("spy:///dev/ttyS0?dev=x", "dev", "file=NAME"),
        ("spy:///dev/ttyS0?file", "file", "name is missing"),
        ("spy://", "spy://", "port is missing"),
        ("fault://loop://", "loop:", "no such fault"),
        ("fault://drop=2/loop://", "drop=2", "0 to 1"),
        ("fault://drop=0.1", "fault://drop=0.1", "/PORT"),
        ("fault://tx.seed=1/loop://", "tx.seed=1", "no such fault"),
    ];
    for (text, part, hint) in cases {
        let (found, message) = refused(text);
        assert_eq!(found, part, "{text}: {message}");
        assert!(message.contains(hint), "{text}: {message}");
    }
}
