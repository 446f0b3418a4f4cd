use super::*;
use crate::rfc2217::seven_even as settings;

const SECOND: Micros = Micros::from_ms(1_000);

fn options() -> Rfc2217Options {
    Rfc2217Options { ign_set_control: false, poll_modem: false, timeout_s: 3.0, logging: None }
}

fn sent(client: &mut Rfc2217Client) -> String {
    let mut out = Vec::new();
    client.poll_transmit(&mut out);
    out.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn takes(client: &mut Rfc2217Client, hex: &str) {
    let bytes: Vec<u8> =
        (0..hex.len()).step_by(2).map(|at| u8::from_str_radix(&hex[at..at + 2], 16).unwrap()).collect();
    client.on_bytes(SECOND, &bytes);
}

/// A client that waits for the answers to its settings.
fn in_settings(options: &Rfc2217Options) -> Rfc2217Client {
    let mut client = Rfc2217Client::new(&RequestedLine::new(&settings()), options, Micros(0));
    assert_eq!(sent(&mut client), "fffb2cfffd2cfffb00fffd00fffb03fffd03");
    takes(&mut client, "fffb01fffb03fffd00fffb2cfffd03fffd2c");
    // ECHO is not wanted; then 9600, 7, E, 2 in the bytes that pyserial's client sends.
    assert_eq!(sent(&mut client), "fffe01fffa2c0100002580fff0fffa2c0207fff0fffa2c0303fff0fffa2c0402fff0");
    client
}

/// A client that is open.
fn open() -> Rfc2217Client {
    let mut client = in_settings(&options());
    takes(&mut client, "fffa2c6500002580fff0fffa2c6607fff0fffa2c6703fff0fffa2c6802fff0");
    for (asked, answer) in [("0501", "6901"), ("0508", "6908"), ("050b", "690b"), ("0c02", "7002")] {
        assert!(!client.is_open());
        assert_eq!(sent(&mut client), format!("fffa2c{asked}fff0"));
        takes(&mut client, &format!("fffa2c{answer}fff0"));
    }
    assert!(client.is_open() && client.check(SECOND).is_ok());
    client
}

#[test]
fn a_line_is_agreed_on_step_by_step_in_pyserials_bytes() {
    open();
}

#[test]
fn a_server_that_wants_no_com_port_option_is_refused() {
    let mut client = Rfc2217Client::new(&RequestedLine::new(&settings()), &options(), Micros(0));
    takes(&mut client, "fffe2c");
    assert_eq!(client.check(SECOND), Err(NegotiationError::NotSpoken { silent: false }));
    let mut silent = Rfc2217Client::new(&RequestedLine::new(&settings()), &options(), Micros(0));
    assert_eq!(silent.check(Micros(2_999_999)), Ok(()));
    assert_eq!(silent.check(Micros(3_000_000)), Err(NegotiationError::NotSpoken { silent: true }));
}

#[test]
fn another_value_in_the_answer_is_a_refusal_by_name() {
    let mut client = in_settings(&options());
    takes(&mut client, "fffa2c6500002580fff0fffa2c6608fff0");
    let refusal = client.check(SECOND).unwrap_err();
    assert_eq!(refusal, NegotiationError::Setting { name: "bytesize", wanted: vec![7], has: vec![8] });
    assert!(refusal.to_string().contains("bytesize"), "{refusal}");
}

#[test]
fn no_answer_is_late_and_controls_may_be_left_unanswered() {
    let mut client = in_settings(&options());
    assert_eq!(client.check(Micros(4_000_000)), Err(NegotiationError::Late { name: "baudrate", is_control: false }));
    let mut client = in_settings(&Rfc2217Options { ign_set_control: true, ..options() });
    takes(&mut client, "fffa2c6500002580fff0fffa2c6607fff0fffa2c6703fff0fffa2c6802fff0");
    assert_eq!(sent(&mut client), "fffa2c0501fff0fffa2c0508fff0fffa2c050bfff0fffa2c0c02fff0");
    takes(&mut client, "fffa2c7002fff0");
    assert!(client.is_open());
}

#[test]
fn the_server_suspends_and_resumes_in_both_codings() {
    let mut client = open();
    for (suspend, resume) in [("08", "09"), ("6c", "6d")] {
        takes(&mut client, &format!("fffa2c{suspend}fff0"));
        assert!(client.is_suspended());
        takes(&mut client, &format!("fffa2c{resume}fff0"));
        assert!(!client.is_suspended());
    }
}

#[test]
fn what_the_control_says_early_is_kept_and_doubled_iac_is_one_byte() {
    let mut client = in_settings(&options());
    takes(&mut client, "11fffa2c6500002580fff0ffff");
    let mut found = [0; 8];
    assert_eq!((client.take_data(&mut found), &found[..2]), (2, &[0x11, 0xff][..]));
}

#[test]
fn modem_lines_are_requested_only_if_the_url_sets_it() {
    let mut client = open();
    assert!(client.check(Micros(9_000_000)).is_ok());
    assert_eq!((sent(&mut client), client.modem_state()), (String::new(), None));
    client.poll_modem = true;
    assert!(client.check(Micros(9_000_000)).is_ok() && client.check(Micros(9_100_000)).is_ok());
    assert_eq!(sent(&mut client), "fffa2c07fff0");
    takes(&mut client, "fffa2c6bb0fff0");
    assert_eq!(client.modem_state(), Some(0xb0));
}

#[test]
fn other_options_are_declined_and_a_refused_one_may_come_back() {
    let mut client = open();
    takes(&mut client, "fffd18fffb1ffffe18");
    assert_eq!(sent(&mut client), "fffc18fffe1f");
    takes(&mut client, "fffe03");
    assert_eq!(sent(&mut client), "fffc03");
    takes(&mut client, "fffd03");
    assert_eq!(sent(&mut client), "fffb03");
}
