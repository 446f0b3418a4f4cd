//! Execution of the host's messages: each is checked, prepared and put into the queues to the control task. Answers to
//! the host wait in a queue of their own.
//!
//! Parameters take effect as a whole, and only while the laws do not have the override or no segment is in execution.
//! Segments are accepted only in the order of their counts and with parameters of the same session. A request arms the
//! board only if the person has seen the current state (epoch).

use arcfeed_link::message::codes::{PathCode, RefusalCode, RequestCode};
use arcfeed_link::message::field::Chunk;
use arcfeed_link::message::page::{PageError, TappedLine};
use arcfeed_link::message::{Message, table};
use arcfeed_model::job::{Job, OverrideLimits};
use arcfeed_units::{Micros, Nm};

use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::supervisor::Supervisor;
use arcfeed_firmware::supervisor::settings::{Settings, SettingsError};
use arcfeed_firmware::supervisor::signals::BoardFault;

use super::board_settings::BoardSettings;
use super::buffers::Buffers;
use super::dispatch::Dispatch;
pub use super::identity::Identity;
use super::messages::{HostQueues, Notice, TaskStatus};
use super::received_table::ReceivedTable;
use super::replies::Replies;
use super::report;

/// Checks and executes the host's messages, passes moves and settings to the control task, and holds the answers.
pub struct CommandHandler<'q> {
    dispatch: Dispatch<'q>,
    identity: Identity,
    settings: BoardSettings,
    buffers: &'q mut Buffers,
    /// Number of the set in force; 0 for none.
    set: u32,
    /// Whether that set was received in this session.
    is_current: bool,
    /// Whether segments come from the tapped line, with the board's own parameters; then the host cannot send segments
    /// or parameters.
    is_tapped: bool,
    /// Count of the next segment; `None` at the beginning of a run.
    next: Option<u32>,
    /// Whether this run's first segment is in the queue.
    has_first: bool,
    /// A segment for which there was no room; it is executed before any other message.
    parked: Option<table::Segment>,
    status: Option<TaskStatus>,
    replies: Replies,
}

impl<'q> CommandHandler<'q> {
    /// Handler without a job.
    ///
    /// # Errors
    /// The settings of the supervisor contradict each other.
    pub fn new(queues: HostQueues<'q>, identity: Identity, settings: Settings) -> Result<Self, SettingsError> {
        let HostQueues { commands, notices, status, buffers } = queues;
        Ok(CommandHandler {
            dispatch: Dispatch::new(commands, notices, status),
            identity,
            settings: BoardSettings::new(settings)?,
            buffers,
            set: 0,
            is_current: false,
            is_tapped: false,
            next: None,
            has_first: false,
            parked: None,
            status: None,
            replies: Replies::default(),
        })
    }

    /// The same handler for a board that reads its moves from the tapped DNC line: the host cannot send segments or
    /// parameters.
    #[must_use]
    pub fn tapped(self) -> Self {
        CommandHandler { is_tapped: true, ..self }
    }

    /// Whether the next message of the host can be executed now. While it cannot, the link holds messages back.
    pub fn is_ready(&self) -> bool {
        self.parked.is_none() && self.dispatch.is_done() && self.replies.has_room()
    }

    /// Executes a message of the host. Bytes that are not a valid message are answered by `Refused`.
    pub fn handle(&mut self, kind: u8, payload: &[u8]) {
        match Message::decode(kind, payload) {
            Ok(message) => self.execute(&message),
            Err(_) => self.replies.refuse(kind, 0, RefusalCode::Message),
        }
    }

    /// Reads the control task's status, and sends it what waits for a place in its queue.
    pub fn run(&mut self) {
        self.read_status();
        self.dispatch.flush();
        if self.dispatch.room() > 0
            && let Some(segment) = self.parked.take()
        {
            self.prepare(&segment);
        }
    }

    /// Reads the control task's newest status.
    pub fn read_status(&mut self) {
        while let Some(status) = self.dispatch.status() {
            if let Some(refusal) = status.refusal {
                let kind = table::Request { what: RequestCode::Arm, epoch: 0 };
                self.replies.refuse(Message::from(kind).kind(), u32::from(status.epoch), report::refusal_code(refusal));
            }
            self.status = Some(status);
        }
    }

    /// Answers to the host.
    pub fn replies(&mut self) -> &mut Replies {
        &mut self.replies
    }

    /// Status report for the host; `None` before the first tick.
    pub fn report(&self) -> Option<table::Report> {
        self.status.as_ref().map(|status| report::report(status, self.room(), self.set))
    }

    /// Settings that the host can change.
    pub fn settings(&self) -> &BoardSettings {
        &self.settings
    }

    /// Last status that the control task has sent; `None` before its first tick.
    pub fn status(&self) -> Option<&TaskStatus> {
        self.status.as_ref()
    }

    /// Records that a valid frame of the host arrived at the time `at`.
    pub fn host_alive(&mut self, at: Micros) {
        self.dispatch.host_alive(at);
    }

    /// Starts a session with a host: everything of the previous session is discarded.
    pub fn on_link_up(&mut self) {
        self.end_session();
        if !self.is_tapped {
            self.begin_run();
        }
    }

    /// Ends the session because no valid frames of the host arrive: the control task treats the link as lost.
    pub fn on_host_lost(&mut self) {
        self.end_session();
        self.dispatch.notify(Notice::HostLost);
    }

    /// Ends the session because the host has restarted or has closed the link: the control task does not keep the last
    /// override.
    pub fn on_host_left(&mut self) {
        self.end_session();
        self.dispatch.notify(Notice::HostChanged);
        if !self.is_tapped {
            self.begin_run();
        }
    }

    /// Reads the job from a flash page and puts it in force under the number `set`; returns the properties of the
    /// tapped line in the page. A page of erased flash changes nothing.
    ///
    /// # Errors
    /// Reason why the page is rejected. A corrupt or invalid page raises a fault.
    pub fn load_page(&mut self, page: &[u8], set: u32) -> Result<TappedLine, PageError> {
        let read = self.buffers.read_page(page, |job| self.settings.allow(&job.limits));
        match read {
            Ok(_) => self.take_effect(set),
            Err(PageError::Blank) => {}
            Err(_) => self.dispatch.notify(Notice::Fault(BoardFault::Parameters)),
        }
        read
    }

    /// The job in force; `None` if there is none.
    pub fn job(&self) -> Option<&Job> {
        self.buffers.job()
    }

    /// Starts a new run of segments: those that have not ended are discarded.
    pub fn begin_run(&mut self) {
        (self.next, self.parked, self.has_first) = (None, None, false);
        self.buffers.table = ReceivedTable::None;
        self.dispatch.begin_run();
    }

    /// Number of segments that can be added at present.
    pub fn room(&self) -> usize {
        self.dispatch.room()
    }

    /// Adds a prepared segment of the run, with its number `count`. Returns false, and changes nothing, if no slot is
    /// free.
    pub fn push(&mut self, count: u32, segment: ActiveSegment) -> bool {
        self.dispatch.put(count, segment, None)
    }

    fn end_session(&mut self) {
        self.buffers.staging.forget();
        self.is_current = false;
        self.replies.clear();
    }

    fn execute(&mut self, message: &Message) {
        let refused = match message {
            Message::Begin(_)
            | Message::SegmentArcs(_)
            | Message::SegmentFeed(_)
            | Message::Segment(_)
            | Message::Clear(_)
                if self.is_tapped =>
            {
                Err((0, RefusalCode::Message))
            }
            Message::Begin(begin) => self.buffers.staging.begin(begin.set).map_err(|why| (begin.set, why)),
            Message::Commit(commit) => self.commit(commit).map_err(|why| (commit.set, why)),
            // The table of a segment that waits for room is complete.
            Message::SegmentArcs(_) | Message::SegmentFeed(_) if self.parked.is_some() => Err((0, RefusalCode::Full)),
            Message::SegmentArcs(arcs) => self.buffers.table.add_arcs(arcs).map_err(|why| (0, why)),
            Message::SegmentFeed(feed) => self.buffers.table.add_feed(feed).map_err(|why| (0, why)),
            Message::Segment(segment) => self.segment(segment).map_err(|why| (segment.count, why)),
            Message::Request(request) => self.request(request).map_err(|why| (u32::from(request.epoch), why)),
            Message::SetSetting(set) => self.set(set).map_err(|why| (set.setting as u32, why)),
            Message::AskSetting(ask) => {
                self.replies.push(self.settings.value(ask.setting).into());
                Ok(())
            }
            Message::AskInfo(_) => {
                self.replies.push(self.info().into());
                Ok(())
            }
            Message::Clear(_) => {
                self.begin_run();
                Ok(())
            }
            Message::Basics(_) | Message::Tool(_) | Message::Law(_) | Message::Limits(_) => self.part_of_set(message),
            Message::Ceiling(_) | Message::Axes(_) | Message::ArcClamp(_) => self.part_of_set(message),
            Message::Rule(_) | Message::StockLine(_) | Message::StockDisc(_) => self.part_of_set(message),
            Message::EngagedArcs(_) | Message::Knot(_) => self.part_of_set(message),
            _ => Err((0, RefusalCode::Message)),
        };
        if let Err((reference, why)) = refused {
            self.replies.refuse(message.kind(), reference, why);
        }
    }

    /// Adds a message to a set. Only the first invalid message is answered; the later ones have no set.
    fn part_of_set(&mut self, part: &Message) -> Result<(), (u32, RefusalCode)> {
        let set = self.buffers.staging.set();
        match self.buffers.staging.add(part) {
            Ok(()) | Err(RefusalCode::NoSet) => Ok(()),
            Err(why) => {
                self.dispatch.notify(Notice::Fault(BoardFault::Parameters));
                Err((set, why))
            }
        }
    }

    fn commit(&mut self, commit: &table::Commit) -> Result<(), RefusalCode> {
        let is_busy = self.is_busy();
        let sound = self.buffers.staging.commit(commit).and_then(|job| {
            if is_busy {
                Err(RefusalCode::Busy)
            } else if self.settings.allow(&job.limits) {
                Ok(())
            } else {
                Err(RefusalCode::Value)
            }
        });
        match sound {
            Ok(()) => {
                self.buffers.put_in_force();
                self.take_effect(commit.set);
                self.is_current = true;
                self.replies.push(table::Accepted { set: commit.set }.into());
            }
            Err(RefusalCode::Busy | RefusalCode::NoSet) => {}
            Err(_) => self.dispatch.notify(Notice::Fault(BoardFault::Parameters)),
        }
        sound
    }

    /// Whether the laws are engaged and segments are in execution.
    fn is_busy(&self) -> bool {
        self.is_engaged() && self.has_segments()
    }

    fn is_engaged(&self) -> bool {
        self.status.as_ref().is_some_and(|status| status.state.is_engaged())
    }

    fn has_segments(&self) -> bool {
        !self.dispatch.is_empty() || self.parked.is_some()
    }

    fn take_effect(&mut self, set: u32) {
        self.set = set;
        self.begin_run();
        self.send_parameters();
    }

    fn send_parameters(&mut self) {
        let limits = self.buffers.job().map_or(OverrideLimits::default(), |job| job.limits);
        // Bounds and settings were checked when they were accepted.
        if let Ok(supervisor) = Supervisor::within(&limits, self.settings.settings) {
            self.dispatch.send_parameters(supervisor);
        }
    }

    fn segment(&mut self, segment: &table::Segment) -> Result<(), RefusalCode> {
        if self.parked.is_some() || !self.dispatch.is_done() {
            return Err(RefusalCode::Full);
        }
        if let Err(why) = self.check(segment) {
            // The next segment brings its own table.
            self.buffers.table = ReceivedTable::None;
            return Err(why);
        }
        self.next = Some(segment.count.wrapping_add(1));
        if self.dispatch.room() > 0 {
            self.prepare(segment);
        } else {
            self.parked = Some(*segment);
        }
        Ok(())
    }

    fn check(&self, segment: &table::Segment) -> Result<(), RefusalCode> {
        if !self.is_current {
            Err(RefusalCode::NoParameters)
        } else if self.next.is_some_and(|next| next != segment.count) {
            Err(RefusalCode::Order)
        } else {
            self.buffers.check(segment)
        }
    }

    /// Prepares a checked segment for which there is room.
    fn prepare(&mut self, message: &table::Segment) {
        if let Some(active) = self.buffers.prepare(message) {
            // The machine chooses the path of a rapid, from wherever the axes are.
            let waits = !self.has_first && message.path != PathCode::Rapid;
            let begins_at = waits.then_some(message.start.map(Nm));
            self.has_first = true;
            self.dispatch.put(message.count, active, begins_at);
        }
    }

    fn request(&mut self, request: &table::Request) -> Result<(), RefusalCode> {
        match request.what {
            RequestCode::Disarm => self.dispatch.notify(Notice::Disarm),
            // The parameters of a tapped line are the board's own.
            RequestCode::Arm if !(self.is_current || self.is_tapped && self.buffers.job().is_some()) => {
                return Err(RefusalCode::NoParameters);
            }
            RequestCode::Arm if self.status.as_ref().is_none_or(|status| status.epoch != request.epoch) => {
                return Err(RefusalCode::Outdated);
            }
            RequestCode::Arm => self.dispatch.notify(Notice::Arm(request.epoch)),
        }
        Ok(())
    }

    fn set(&mut self, set: &table::SetSetting) -> Result<(), RefusalCode> {
        // After queued segments they would take effect late.
        if self.is_engaged() || self.has_segments() {
            return Err(RefusalCode::Busy);
        }
        self.settings.set(set.setting, set.value)?;
        self.send_parameters();
        self.replies.push(self.settings.value(set.setting).into());
        Ok(())
    }

    fn info(&self) -> table::Info {
        let Identity { name, version, reset, starts } = self.identity;
        let capacity = u16::try_from(self.dispatch.capacity()).unwrap_or(u16::MAX);
        table::Info { version, reset, starts, capacity, set: self.set, name: Chunk::of(name.as_bytes()) }
    }
}
