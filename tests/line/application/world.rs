//! A host, a line, a board, a machine that stands or moves as given; time passes by the tick.

use std::collections::VecDeque;

use arcfeed_board_app::application::command_handler::{CommandHandler, Identity};
use arcfeed_board_app::application::control_task::{ControlTask, Supply};
use arcfeed_board_app::application::host_link::HostLink;
use arcfeed_board_app::application::messages::Queues;
use arcfeed_board_app::application::sensors::Sensors;
use arcfeed_firmware::supervisor::Output;
use arcfeed_firmware::supervisor::input::Freshness;
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_firmware::supervisor::signals::{BoardFault, Signals};
use arcfeed_law::move_table::MoveTable;
use arcfeed_link::frame::ENCODED_MAX;
use arcfeed_link::link::{Link, LinkState, Loss};
use arcfeed_link::message::codes::{RefusalCode, RequestCode, ResetCode};
use arcfeed_link::message::field::PAYLOAD_MAX;
use arcfeed_link::message::{self, Message, moves, parameters, table};
use arcfeed_link::settings::{LinkSettings, Role};
use arcfeed_model::job::Job;
use arcfeed_nc::modal::Pose;
use arcfeed_nc::segment::Segment;
use arcfeed_tests::emulation::host::table_messages;
use arcfeed_units::{Micros, RevPerMin};

/// The tick of everything.
pub const TICK: Micros = Micros::from_ms(1);
/// Room of the board's queue, and one place that a queue loses.
const AHEAD: usize = 17;
/// Frames that a line can replay.
const RECORDED: usize = 60;

/// One direction of the line.
pub struct Channel {
    pub latency: Micros,
    /// Lost frames per thousand.
    pub lost_per_mille: u64,
    random: u64,
    /// When it corrupted a frame.
    pub corrupted: Vec<Micros>,
    on_its_way: VecDeque<(Micros, Vec<u8>)>,
    /// Whether the line is connected.
    pub is_open: bool,
    /// The last frames that it carried; while it replays, they are all that comes out, over and over.
    recorded: VecDeque<Vec<u8>>,
    pub replays: bool,
}

/// The host: sends a job and its segments, and notes what comes back.
pub struct Host {
    pub link: Link,
    outbox: VecDeque<Message>,
    job: Job,
    set: u32,
    has_begun: bool,
    /// Sends no parameters by itself.
    pub is_silent: bool,
    /// Still to be sent: moves, each behind its table.
    segments: VecDeque<Vec<Message>>,
    sent: u32,
    executed_before: Option<u32>,
    pub is_accepted: bool,
    pub report: Option<table::Report>,
    pub refusals: Vec<(u8, RefusalCode)>,
    pub others: Vec<Message>,
}

/// The board: what an image holds.
pub struct Board {
    pub host_link: HostLink<'static>,
    pub task: ControlTask<'static>,
}

/// All of it.
pub struct World {
    pub now: Micros,
    pub host: Host,
    pub board: Board,
    pub down: Channel,
    pub up: Channel,
    pub sensors: Sensors,
    pub output: Option<Output>,
    /// Whether the board's main loop still runs.
    pub is_main_loop_running: bool,
}

impl Channel {
    pub fn new(latency_ms: u64, lost_per_mille: u64, seed: u64) -> Self {
        let random = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        Channel {
            latency: Micros::from_ms(latency_ms),
            lost_per_mille,
            random,
            corrupted: Vec::new(),
            on_its_way: VecDeque::new(),
            is_open: true,
            recorded: VecDeque::new(),
            replays: false,
        }
    }

    fn bits(&mut self) -> u64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        self.random
    }

    fn send(&mut self, now: Micros, frame: &[u8]) {
        let is_corrupted = self.bits() % 1_000 < self.lost_per_mille;
        let mut frame = frame.to_vec();
        if is_corrupted {
            self.corrupted.push(now);
            let at = self.bits() as usize % frame.len();
            // Half of the corrupted frames are gone, half have a wrong byte.
            match self.bits() % 2 {
                0 => frame.clear(),
                _ => frame[at] ^= 1 << (self.bits() % 8),
            }
        }
        if self.is_open && !self.replays {
            self.recorded.push_back(frame.clone());
            if self.recorded.len() > RECORDED {
                self.recorded.pop_front();
            }
            self.on_its_way.push_back((now.after(self.latency), frame));
        }
    }

    fn receive(&mut self, now: Micros) -> Vec<u8> {
        let mut bytes = Vec::new();
        if self.replays {
            self.recorded.rotate_left(1);
            bytes.extend(self.recorded.back().into_iter().flatten());
        }
        while self.on_its_way.front().is_some_and(|(at, _)| *at <= now) {
            bytes.extend(self.on_its_way.pop_front().expect("just seen").1);
        }
        bytes
    }
}

fn link_settings(role: Role) -> LinkSettings {
    LinkSettings { bits_per_s: 0, ..message::link_settings(role) }
}

impl Host {
    /// A host that will send this job and these segments once its link is up.
    pub fn new(session: u32, job: &Job, segments: &[(Segment, Option<usize>)]) -> Self {
        let message = |(count, (segment, rule)): (u32, &(Segment, Option<usize>))| {
            let encoded = moves::encode(segment, count, rule.map(|rule| rule as u8));
            vec![encoded.expect("the example's moves can be encoded").into()]
        };
        Host {
            link: Link::new(link_settings(Role::Host), session).expect("the settings work"),
            outbox: VecDeque::new(),
            job: job.clone(),
            set: session,
            has_begun: false,
            is_silent: false,
            segments: (1..).zip(segments).map(message).collect(),
            sent: 0,
            executed_before: None,
            is_accepted: false,
            report: None,
            refusals: Vec::new(),
            others: Vec::new(),
        }
    }

    /// Adds something to say.
    pub fn say(&mut self, message: impl Into<Message>) {
        self.outbox.push_back(message.into());
    }

    /// A person looks at the last report, and asks.
    pub fn ask(&mut self, what: RequestCode) {
        let epoch = self.report.expect("a report to look at").epoch;
        self.say(table::Request { what, epoch });
    }

    /// Cause of the loss, if the link is lost.
    pub fn loss(&self) -> Option<Loss> {
        match self.link.state() {
            LinkState::Lost(loss) => Some(loss),
            LinkState::Greeting | LinkState::Refused(_) | LinkState::Up => None,
        }
    }

    fn step(&mut self, now: Micros, bytes: &[u8]) {
        let mut received = Vec::new();
        self.link.on_bytes(now, bytes, &mut |message| received.push(Message::decode(message.kind, message.payload)));
        received.into_iter().for_each(|message| self.take(message.expect("the board sends messages")));
        if self.link.state() != LinkState::Up {
            return;
        }
        if !self.has_begun && !self.is_silent {
            self.has_begun = true;
            let outbox = &mut self.outbox;
            parameters::messages(&self.job, self.set, &mut |message| outbox.push_back(message)).expect("a job");
        }
        self.send_segments();
        while let Some(message) = self.outbox.front() {
            let mut buffer = [0; PAYLOAD_MAX];
            let length = message.encode(&mut buffer).expect("there is room");
            if self.link.send(message.kind(), &buffer[..length]).is_err() {
                break;
            }
            self.outbox.pop_front();
        }
    }

    /// Never more than the board has room for.
    fn send_segments(&mut self) {
        let (Some(report), Some(before), true) = (self.report, self.executed_before, self.is_accepted) else { return };
        let ahead = self.sent.wrapping_sub(report.executed.wrapping_sub(before));
        for _ in ahead..AHEAD as u32 - 1 {
            let Some(messages) = self.segments.pop_front() else { return };
            self.sent += 1;
            self.outbox.extend(messages);
        }
    }

    /// Puts its table, where it has one, before each move.
    pub fn add_tables(&mut self, tables: &[Option<MoveTable>]) {
        for (messages, table) in self.segments.iter_mut().zip(tables) {
            messages.splice(..0, table.iter().flat_map(table_messages));
        }
    }

    /// Says all that is still to be sent at once, whatever the board has room for.
    pub fn say_all_moves(&mut self) {
        self.outbox.extend(self.segments.drain(..).flatten());
    }

    fn take(&mut self, message: Message) {
        match message {
            Message::Report(report) => {
                self.report = Some(report);
                if self.is_accepted && self.executed_before.is_none() {
                    self.executed_before = Some(report.executed);
                }
            }
            Message::Accepted(accepted) => self.is_accepted = accepted.set == self.set,
            Message::Refused(refused) => self.refusals.push((refused.kind, refused.why)),
            other => self.others.push(other),
        }
    }
}

impl Board {
    /// A start of the board; what was before it is gone.
    pub fn boot(starts: u32, fault: Option<BoardFault>) -> Self {
        Board::supplied(Supply::Link, starts, fault)
    }

    /// The same, its segments from here or there.
    pub fn supplied(supply: Supply, starts: u32, fault: Option<BoardFault>) -> Self {
        let queues: &'static mut Queues<AHEAD> = Box::leak(Box::default());
        let (at_host, at_tick) = queues.split();
        let identity = Identity { name: "in process", version: [0, 1, 0], reset: ResetCode::Power, starts };
        let handler = CommandHandler::new(at_host, identity, Settings::default()).expect("the settings are sound");
        let handler = if supply == Supply::Tap { handler.tapped() } else { handler };
        let host_link = HostLink::new(link_settings(Role::Board), starts << 16, handler).expect("the settings work");
        let task = ControlTask::new(at_tick, supply, Settings::default(), fault).expect("the settings are sound");
        Board { host_link, task }
    }
}

impl World {
    /// A host with these segments at one end, a board that just started at the other.
    pub fn new(job: &Job, segments: &[(Segment, Option<usize>)], channels: [Channel; 2]) -> Self {
        let [down, up] = channels;
        World {
            now: Micros(0),
            host: Host::new(1, job, segments),
            board: Board::boot(1, None),
            down,
            up,
            sensors: standing(Pose::default(), job.tools.first().spindle),
            output: None,
            is_main_loop_running: true,
        }
    }

    /// One tick of everything; what the board put out.
    pub fn step(&mut self) -> Output {
        self.now = self.now.after(TICK);
        let now = self.now;
        let bytes = self.up.receive(now);
        self.host.step(now, &bytes);
        let mut frame = [0; ENCODED_MAX];
        loop {
            let length = self.host.link.poll_transmit(now, &mut frame);
            if length == 0 {
                break;
            }
            self.down.send(now, &frame[..length]);
        }
        let Board { host_link, task } = &mut self.board;
        let bytes = self.down.receive(now);
        if self.is_main_loop_running {
            host_link.on_link_bytes(now, &bytes);
            host_link.run(now);
        }
        let output = task.tick(now, &self.sensors);
        while self.is_main_loop_running {
            let length = host_link.poll_link(now, &mut frame);
            if length == 0 {
                break;
            }
            self.up.send(now, &frame[..length]);
        }
        self.output = Some(output);
        output
    }

    /// Several ticks.
    pub fn run(&mut self, ticks: usize) {
        for _ in 0..ticks {
            self.step();
        }
    }

    /// Until something holds; how many ticks that took.
    pub fn until(&mut self, what: &str, holds: impl Fn(&World) -> bool) -> u32 {
        for ticks in 0..20_000 {
            if holds(self) {
                return ticks;
            }
            self.step();
        }
        panic!("waited in vain for {what}: {:?}, {:?} {:?}", self.output, self.host.link.state(), self.host.refusals);
    }

    /// From the start to armed at 100 %, as a person would.
    pub fn arm(&mut self) {
        self.until("the parameters", |world| world.host.is_accepted);
        self.until("100 %", |world| world.output.is_some_and(|output| output.feed_override.percent == 100));
        self.host.ask(RequestCode::Arm);
        self.until("the arming", |world| world.output.is_some_and(|output| output.state.is_engaged()));
    }
}

/// Nothing moves, all is well.
pub fn standing(position: Pose, spindle: RevPerMin) -> Sensors {
    Sensors {
        position: Some(position),
        freshness: Freshness::NOW,
        spindle,
        operator_percent: 100,
        signals: Signals::NONE,
    }
}
