//! The host's end of a link, as much of it as a run takes: parameters, then segments as fast as the board takes them.

use std::collections::VecDeque;

use arcfeed_hil_sim::override_source::board::{AttachedDevices, Traffic, Wire};
use arcfeed_law::move_table::MoveTable;
use arcfeed_link::frame::ENCODED_MAX;
use arcfeed_link::link::{Link, LinkState};
use arcfeed_link::message::codes::SettingCode;
use arcfeed_link::message::fixed::Q46;
use arcfeed_link::message::table::{Report, SetSetting, StockDisc};
use arcfeed_link::message::{Message, link_settings, moves, parameters};
use arcfeed_link::settings::Role;
use arcfeed_model::job::Job;
use arcfeed_nc::machining::ToolInSpindle;
use arcfeed_nc::segment::Segment;
use arcfeed_units::{Micros, Span};

/// Bytes that the line carries in a millisecond: 115 200 Bd, ten bits a byte. In hundredths.
const HUNDREDTH_BYTES_PER_MS: i64 = 1_152;
/// As often as a board can be asked to report: that fills the line towards the host.
const REPORT_EVERY_US: u32 = 5_000;
/// A part of a set, which the board drops where no set has begun.
pub const FILLER: Message = Message::StockDisc(StockDisc { center: [Q46(1); 2], radius: Q46(1) });
/// Long enough to go out.
const FILLER_TTL: Span = Span::from_ms(100);
/// The host's number of the set.
pub const SET: u32 = 1;
/// Session of a host that starts once.
const SESSION: u32 = 0x4051_0001;

/// A host. Keeps its state between calls.
#[derive(Debug)]
pub struct Host {
    link: Link,
    to_send: VecDeque<Message>,
    /// Fill the line to so many hundredths of what it carries, if there is nothing else to say.
    load_percent: i64,
    room: i64,
    bytes: [u64; 2],
    /// All that the board sent reliably.
    pub heard: Vec<Message>,
    /// The board's last report.
    pub report: Option<Report>,
}

impl Host {
    /// A host with a job and the moves of its program.
    pub fn new(job: &Job, segments: &[Segment]) -> Self {
        let mut host = Host::begun_anew(job, SESSION);
        host.give(job, segments);
        host
    }

    /// A host with a job, and with no move before it gets the first move of the rest. Each start has a session of its own.
    pub fn begun_anew(job: &Job, session: u32) -> Self {
        let mut to_send = VecDeque::new();
        parameters::messages(job, SET, &mut |message| to_send.push_back(message)).expect("the job can be encoded");
        Host::of(to_send, session)
    }

    /// Gives it the moves of its one run.
    pub fn give(&mut self, job: &Job, segments: &[Segment]) {
        for (count, segment) in (1..).zip(segments) {
            let rule = job.rule_for(segment, ToolInSpindle::Unstated).map(|(index, _)| index as u8);
            self.to_send.push_back(moves::encode(segment, count, rule).expect("the move can be encoded").into());
        }
    }

    /// The same, with this table before each move for which it may stand: engaged arcs where a rule speaks of the move,
    /// feeds where none does.
    #[must_use]
    pub fn with_table_ahead(mut self, table: &MoveTable) -> Self {
        let is_of_rules = table.engaged().is_some();
        for message in std::mem::take(&mut self.to_send) {
            if matches!(message, Message::Segment(segment) if segment.rule.is_some() == is_of_rules) {
                self.to_send.extend(table_messages(table));
            }
            self.to_send.push_back(message);
        }
        self
    }

    /// A host with just this to say.
    pub fn saying(messages: impl IntoIterator<Item = Message>) -> Self {
        Host::of(messages.into_iter().collect(), SESSION)
    }

    fn of(to_send: VecDeque<Message>, session: u32) -> Self {
        let link = Link::new(link_settings(Role::Host), session).expect("the settings are sound");
        Host { link, to_send, load_percent: 0, room: 0, bytes: [0; 2], heard: Vec::new(), report: None }
    }

    /// Says this behind all else.
    pub fn say_later(&mut self, message: impl Into<Message>) {
        self.to_send.push_back(message.into());
    }

    /// The same host on a line that it keeps busy to this part of its bit rate, and the board with reports the other way.
    #[must_use]
    pub fn with_load(mut self, load_percent: i64) -> Self {
        self.to_send.push_front(SetSetting { setting: SettingCode::ReportEvery, value: REPORT_EVERY_US }.into());
        Host { load_percent, ..self }
    }

    /// The link.
    pub fn link(&self) -> &Link {
        &self.link
    }

    /// Whether everything is sent and acknowledged.
    pub fn is_through(&self) -> bool {
        self.to_send.is_empty() && self.link.unacknowledged() == 0
    }

    /// Bytes to the board and from it.
    pub fn bytes(&self) -> [u64; 2] {
        self.bytes
    }

    fn say(&mut self, message: &Message) -> bool {
        let mut payload = [0; ENCODED_MAX];
        let length = message.encode(&mut payload).expect("a payload has room");
        self.link.send(message.kind(), &payload[..length]).is_ok()
    }
}

/// Messages of a table.
pub fn table_messages(table: &MoveTable) -> Vec<Message> {
    let arcs = table
        .engaged()
        .into_iter()
        .flat_map(|arcs| arcs.knots())
        .map(|knot| moves::encode_arcs(knot).map(Message::from));
    let feeds = table
        .feeds()
        .into_iter()
        .flat_map(|feeds| feeds.knots())
        .map(|knot| moves::encode_feed(knot).map(Message::from));
    arcs.chain(feeds).collect::<Result<_, _>>().expect("it can be encoded")
}

impl AttachedDevices for Host {
    fn send(&mut self, at: Micros, traffic: &mut Traffic) {
        while let Some(message) = self.to_send.front().copied() {
            if !self.say(&message) {
                break;
            }
            self.to_send.pop_front();
        }
        self.room = (self.room + HUNDREDTH_BYTES_PER_MS * self.load_percent / 100).min(100 * ENCODED_MAX as i64);
        loop {
            if self.room > 0 && self.link.state() == LinkState::Up {
                let mut payload = [0; ENCODED_MAX];
                let length = FILLER.encode(&mut payload).expect("a payload has room");
                self.link.offer(FILLER.kind(), at, FILLER_TTL, &payload[..length]).expect("the link is up");
            }
            let mut frame = [0; ENCODED_MAX];
            let length = self.link.poll_transmit(at, &mut frame);
            if length == 0 {
                break;
            }
            self.room -= 100 * length as i64;
            self.bytes[0] += length as u64;
            traffic.link.extend(&frame[..length]);
        }
    }

    fn receive(&mut self, at: Micros, wire: Wire, bytes: &[u8]) {
        assert_eq!(wire, Wire::Link, "nothing else is attached");
        self.bytes[1] += bytes.len() as u64;
        let Host { link, heard, report, .. } = self;
        link.on_bytes(at, bytes, &mut |received| match Message::decode(received.kind, received.payload)
            .expect("the board sends messages")
        {
            Message::Report(latest) => *report = Some(latest),
            message => heard.push(message),
        });
    }
}
