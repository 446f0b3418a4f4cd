//! The examples of docs/protocol.md, made anew and read back byte for byte.

use std::collections::HashMap;

use arcfeed_link::deframer::Deframer;
use arcfeed_link::frame::{ENCODED_MAX, FrameClass, Header, checksum, encode};
use arcfeed_link::link::{Link, LinkState};
use arcfeed_link::message::field::PAYLOAD_MAX;
use arcfeed_link::message::fixed::Q40;
use arcfeed_link::message::{Message, table};
use arcfeed_link::session::{Echo, Hello, salt};
use arcfeed_link::settings::{LinkSettings, Role};
use arcfeed_tests::root;
use arcfeed_units::Micros;

const CLASSES: [FrameClass; 8] = [
    FrameClass::Hello,
    FrameClass::Heartbeat,
    FrameClass::Ack,
    FrameClass::Nak,
    FrameClass::Bye,
    FrameClass::Reliable,
    FrameClass::Latest,
    FrameClass::Plain,
];

pub fn document() -> String {
    std::fs::read_to_string(root().join("docs/protocol.md")).expect("the document is there")
}

/// The fenced blocks marked with `mark`.
pub fn blocks(document: &str, mark: &str) -> Vec<String> {
    let fence = format!("\n```{mark}\n");
    document.split(&fence).skip(1).map(|rest| rest.split("\n```").next().expect("a block ends").to_owned()).collect()
}

/// A block of lines with a name and a value.
struct Example(HashMap<String, String>);

impl Example {
    fn new(block: &str) -> Self {
        let line = |line: &str| {
            let (name, value) = line.split_once(' ').unwrap_or((line, ""));
            (name.to_owned(), value.trim().to_owned())
        };
        Example(block.lines().map(line).collect())
    }

    fn number(&self, name: &str) -> u32 {
        let text = self.0.get(name).unwrap_or_else(|| panic!("no {name} in {:?}", self.0));
        let number = text.strip_prefix("0x").map_or_else(|| text.parse(), |hex| u32::from_str_radix(hex, 16));
        number.unwrap_or_else(|_| panic!("{name} {text}"))
    }

    fn small<T: TryFrom<u32>>(&self, name: &str) -> T {
        T::try_from(self.number(name)).unwrap_or_else(|_| panic!("{name} is too large"))
    }

    /// As many whole numbers of either sign.
    fn numbers<const N: usize>(&self, name: &str) -> [i64; N] {
        let numbers: Vec<i64> = self.0[name].split_whitespace().map(|word| word.parse().expect("a number")).collect();
        numbers.try_into().unwrap_or_else(|numbers| panic!("{name}: {numbers:?}"))
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        self.0.get(name).map_or_else(Vec::new, |text| bytes(text))
    }

    fn header(&self) -> Header {
        Header {
            class: CLASSES[self.small::<usize>("class")],
            is_busy: self.number("busy") == 1,
            kind: self.small("kind"),
            seq: self.small("seq"),
            ack: self.small("ack"),
            t_us: self.number("t"),
        }
    }

    fn echo(&self) -> Echo {
        Echo { t_us: self.number("echo"), held_us: self.number("held") }
    }

    /// Bytes between header and check.
    fn payload(&self) -> Vec<u8> {
        match self.header().class {
            FrameClass::Hello => Hello {
                role: self.small("role"),
                schema: self.number("schema"),
                session: self.number("session"),
                peer_session: self.number("peer"),
                heartbeat_ms: self.small("heartbeat"),
                echo: self.echo(),
            }
            .encode()
            .to_vec(),
            FrameClass::Heartbeat => self.echo().encode().to_vec(),
            FrameClass::Latest => [self.small::<u16>("left").to_le_bytes().to_vec(), self.bytes("payload")].concat(),
            _ => self.bytes("payload"),
        }
    }
}

fn bytes(text: &str) -> Vec<u8> {
    text.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).expect("a byte")).collect()
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().join(" ")
}

fn role(number: u32) -> Role {
    [Role::Host, Role::Board].into_iter().find(|role| *role as u32 == number).expect("a role")
}

#[test]
fn every_frame_of_the_document_is_made_and_read_byte_for_byte() {
    let document = document();
    let examples = blocks(&document, "frame");
    for block in &examples {
        let example = Example::new(block);
        let mut out = [0; ENCODED_MAX];
        let payload = example.payload();
        let (header, salt) = (example.header(), example.number("salt"));
        let len = encode(&header, [&payload, &[]], salt, &mut out).expect("it fits");
        assert_eq!(hex(&out[..len]), hex(&example.bytes("line")), "{block}");
        let mut deframer = Deframer::new();
        let (last, before) = out[..len].split_last().expect("not empty");
        assert!(before.iter().all(|byte| deframer.push(*byte).is_none()), "{block}");
        let frame = deframer.push(*last).expect("a frame ends").expect("and is whole");
        assert_eq!((frame.version, frame.header, frame.salt), (1, header, salt), "{block}");
        assert_eq!(frame.payload, payload, "{block}");
        if header.class == FrameClass::Hello {
            assert_eq!(Hello::decode(frame.payload).expect("a hello").encode().to_vec(), payload);
        }
    }
    assert!(examples.len() >= 8, "{}", examples.len());
    let of_all_classes = CLASSES.iter().all(|class| examples.iter().any(|e| Example::new(e).header().class == *class));
    assert!(of_all_classes, "a class without an example");
}

#[test]
fn the_message_of_the_document_is_made_and_read_byte_for_byte() {
    let document = document();
    let examples = blocks(&document, "message");
    for block in &examples {
        let example = Example::new(block);
        assert_eq!(example.0["message"], "SegmentArcs", "the only one that is written out");
        let [travelled] = example.numbers("travelled");
        let [outer, inner] = ["outer", "inner"].map(|name| example.numbers(name).map(|end: i64| end as i16));
        let message = Message::from(table::SegmentArcs { travelled: Q40(travelled), outer, inner });
        let mut payload = [0; PAYLOAD_MAX];
        let length = message.encode(&mut payload).expect("it fits");
        assert_eq!(hex(&payload[..length]), hex(&example.bytes("payload")), "{block}");
        assert_eq!(Message::decode(example.small("kind"), &payload[..length]), Ok(message), "{block}");
    }
    assert_eq!(examples.len(), 1);
}

#[test]
fn the_salts_of_the_document_are_those_of_its_sessions() {
    let document = document();
    let examples = blocks(&document, "salt");
    for block in &examples {
        let example = Example::new(block);
        let numbers = ["session", "peer", "schema"].map(|name| example.number(name));
        assert_eq!(salt(role(example.number("role")), numbers), example.number("salt"), "{block}");
    }
    assert_eq!((examples.len(), checksum(b"123456789")), (2, 0xE306_9283));
}

/// Two ends that greet, and a message; one frame a row.
fn talk() -> String {
    let end = |role, session| Link::<16, 4>::new(LinkSettings::new(role, 0x00C0_FFEE), session).expect("settings");
    let (mut host, mut board) = (end(Role::Host, 0xA000_0001), end(Role::Board, 0xB000_0001));
    let (mut rows, mut out, mut sent) = (String::new(), [0; ENCODED_MAX], false);
    for now in (1_000..60_000).step_by(1_000).map(Micros) {
        for name in ["host", "board"] {
            let (from, to) = if name == "host" { (&mut host, &mut board) } else { (&mut board, &mut host) };
            loop {
                let len = from.poll_transmit(now, &mut out);
                if len == 0 {
                    break;
                }
                rows += &format!("{:<6} {name:<6} {}\n", now.0, hex(&out[..len]));
                to.on_bytes(now, &out[..len], &mut |_| {});
            }
        }
        if !sent && host.state() == LinkState::Up && board.state() == LinkState::Up {
            host.send(2, b"segment").expect("there is room");
            sent = true;
        }
    }
    assert_eq!(host.unacknowledged(), 0);
    rows
}

#[test]
fn the_talk_of_the_document_is_what_two_ends_say() {
    let document = document();
    let written = blocks(&document, "talk");
    let said = talk();
    let is_same = written.len() == 1 && written[0].trim_end() == said.trim_end();
    assert!(is_same, "docs/protocol.md should have\n{said}");
}
