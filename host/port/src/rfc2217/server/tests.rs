use super::*;
use crate::rfc2217::client::{RequestedLine, Rfc2217Client};
use crate::rfc2217::seven_even as line;
use crate::settings::Parity;
use crate::url::Rfc2217Options;

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn said(server: &mut Server) -> String {
    let mut out = Vec::new();
    server.poll_transmit(&mut out);
    hex(&out)
}

/// Answer of the server to a subnegotiation of these bytes behind COM-PORT-OPTION.
fn answer(server: &mut Server, request: &[u8]) -> String {
    let mut bytes = Vec::new();
    subnegotiate(COM_PORT, request[0], &request[1..], &mut bytes);
    server.on_bytes(Micros(0), &bytes);
    said(server)
}

#[test]
fn settings_are_taken_and_questions_answered_with_what_is_set() {
    let mut server = Server::new(&line());
    assert_eq!(answer(&mut server, &[1, 0, 0, 0x4b, 0]), "fffa2c6500004b00fff0");
    assert_eq!(answer(&mut server, &[1, 0, 0, 0, 0]), "fffa2c6500004b00fff0");
    // Nine data bits are not supported; the port keeps its seven.
    assert_eq!(answer(&mut server, &[2, 9]), "fffa2c6607fff0");
    assert_eq!(answer(&mut server, &[3, 0]), "fffa2c6703fff0");
    assert_eq!(answer(&mut server, &[4, 1]), "fffa2c6801fff0");
    assert_eq!(answer(&mut server, &[5, 0]), "fffa2c6901fff0");
    assert_eq!(answer(&mut server, &[5, 2]), "fffa2c6902fff0");
    assert_eq!(answer(&mut server, &[5, 0]), "fffa2c6902fff0");
    assert_eq!(answer(&mut server, &[7]), "fffa2c6bb0fff0");
    let has = server.settings();
    assert_eq!((has.baudrate, has.bytesize, has.parity, has.stopbits, has.flow), (19_200, 7, 3, 1, Flow::XonXoff));
    assert!(!has.is_understood_by(&line()));
}

#[test]
fn options_are_agreed_on_once_and_others_refused() {
    let mut server = Server::new(&line());
    // pyserial: DO ECHO, WILL SGA, DO SGA, DO 44, WILL 44.
    server.on_bytes(Micros(0), &[255, 253, 1, 255, 251, 3, 255, 253, 3, 255, 253, 44, 255, 251, 44]);
    assert_eq!(said(&mut server), "fffc01fffd03fffb03fffb2cfffa2c6bb0fff0fffd2c");
    server.on_bytes(Micros(0), &[255, 253, 44, 255, 251, 44, 255, 252, 1]);
    assert_eq!(said(&mut server), "");
    server.on_bytes(Micros(0), &[255, 254, 3]);
    assert_eq!(said(&mut server), "fffc03");
}

#[test]
fn a_server_with_xonxoff_obeys_the_control_and_one_without_passes_its_word_on() {
    let mut server = Server::new(&line());
    server.on_bytes(Micros(0), b"G1X");
    server.on_line(DC3);
    assert_eq!((said(&mut server), server.next_for_line()), ("13".into(), Some(b'G')));
    answer(&mut server, &[5, 2]);
    // With even parity in the eighth bit.
    server.on_line(DC3 | 0x80);
    assert_eq!((said(&mut server), server.next_for_line()), (String::new(), None));
    server.on_line(DC1);
    assert_eq!((server.next_for_line(), server.waiting()), (Some(b'1'), 1));
    // Switched off, the server continues.
    server.on_line(DC3);
    answer(&mut server, &[5, 1]);
    assert_eq!(server.next_for_line(), Some(b'X'));
}

#[test]
fn the_line_opens_when_the_client_has_stopped_asking() {
    let mut server = Server::new(&line());
    assert!(!server.is_open(Micros::from_ms(10_000)));
    server.on_bytes(Micros::from_ms(100), &[255, 251, 44]);
    assert!(!server.is_open(Micros::from_ms(299)) && server.is_open(Micros::from_ms(300)));
    server.on_bytes(Micros::from_ms(299), &[255, 250, 44, 12, 3, 255, 240]);
    assert!(!server.is_open(Micros::from_ms(300)));
    server.on_bytes(Micros::from_ms(301), b"%");
    assert!(server.is_open(Micros::from_ms(301)));
}

#[test]
fn a_suspended_client_hears_nothing_and_everything_once_it_resumes() {
    let mut server = Server::new(&line());
    answer(&mut server, &[8]);
    server.on_line(DC1);
    server.on_line(255);
    assert_eq!(said(&mut server), "");
    assert_eq!(answer(&mut server, &[9]), "11ffff");
}

#[test]
fn a_break_is_counted_and_a_purge_forgets_what_was_to_be_sent() {
    let mut server = Server::new(&line());
    server.on_bytes(Micros(0), b"G1");
    assert_eq!(answer(&mut server, &[5, 5]), "fffa2c6905fff0");
    assert_eq!((server.take_breaks(), server.take_breaks()), (1, 0));
    assert_eq!(answer(&mut server, &[12, 2]), "fffa2c7002fff0");
    assert_eq!(server.waiting(), 0);
}

#[test]
fn garbage_is_no_request() {
    let mut server = Server::new(&line());
    for request in [&[1, 2, 3][..], &[2], &[3, 1, 1], &[5], &[12, 0], &[12, 9], &[13, 1], &[200, 0]] {
        assert_eq!(answer(&mut server, request), "", "{request:?}");
    }
}

#[test]
fn our_client_and_our_server_agree_and_pass_every_byte_both_ways() {
    let options = Rfc2217Options { ign_set_control: false, poll_modem: true, timeout_s: 3.0, logging: None };
    let mut client = Rfc2217Client::new(&RequestedLine::new(&line()), &options, Micros(0));
    let mut server = Server::new(&SerialSettings { baudrate: 300, parity: Parity::None, ..line() });
    let exchange = |client: &mut Rfc2217Client, server: &mut Server| {
        let mut bytes = Vec::new();
        client.poll_transmit(&mut bytes);
        server.on_bytes(Micros(0), &bytes);
        bytes.clear();
        server.poll_transmit(&mut bytes);
        client.on_bytes(Micros(0), &bytes);
    };
    for _ in 0..10 {
        exchange(&mut client, &mut server);
    }
    assert!(client.is_open() && client.check(Micros(0)).is_ok());
    assert!(server.settings().is_understood_by(&line()) && server.settings().flow == Flow::None);
    let every: Vec<u8> = (0..=255).collect();
    let mut bytes = Vec::new();
    escape(&every, &mut bytes);
    server.on_bytes(Micros(0), &bytes);
    assert_eq!(std::iter::from_fn(|| server.next_for_line()).collect::<Vec<_>>(), every);
    every.iter().for_each(|byte| server.on_line(*byte));
    exchange(&mut client, &mut server);
    let mut back = [0; 300];
    let len = client.take_data(&mut back);
    assert_eq!(back[..len], every);
}
