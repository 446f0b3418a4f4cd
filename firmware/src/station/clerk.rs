//! What each message of the host does: checked first, prepared, put into the queues; answers to the host wait in a queue of
//! their own.
//!
//! Parameters take effect as a whole, and only while the override is not the laws' or nothing is in work. Segments are taken
//! in the order of their counts only, under parameters of the same session. Nothing a host says arms the board but
//! the request of a person who has seen how things stand.

use arcfeed_shared::job::{Job, OverrideLimits};
use arcfeed_shared::units::{Micros, Nm};
use arcfeed_shared::wire::message::codes::{PathCode, RefusalCode, RequestCode};
use arcfeed_shared::wire::message::field::Chunk;
use arcfeed_shared::wire::message::page::{PageError, Tapped};
use arcfeed_shared::wire::message::{Message, table};
use heapless::Deque;

use crate::active::ActiveSegment;
use crate::supervisor::Supervisor;
use crate::supervisor::settings::{Settings, SettingsError};
use crate::supervisor::signals::BoardFault;

use super::arcs::Arcs;
use super::dispatch::Dispatch;
pub use super::identity::Identity;
use super::knobs::Knobs;
use super::order::{DeskQueues, Told, Word};
use super::papers::Papers;
use super::report;

/// Answers that may wait.
const REPLIES: usize = 8;

/// Obeys the host; state.
pub struct Clerk<'q> {
    dispatch: Dispatch<'q>,
    identity: Identity,
    knobs: Knobs,
    papers: &'q mut Papers,
    /// The set in force; 0 for none.
    set: u32,
    /// Whether that set came in this session.
    is_current: bool,
    /// Whether segments come from the tapped line, under parameters of the board's own: then a host has no say in them.
    is_tapped: bool,
    /// The count that the next segment must have; none at the beginning of a run.
    next: Option<u32>,
    /// Whether this run's first segment is with the tick.
    has_first: bool,
    /// A segment for which there was no room: nothing else is obeyed before it.
    parked: Option<table::Segment>,
    told: Option<Told>,
    replies: Deque<Message, REPLIES>,
}

impl<'q> Clerk<'q> {
    /// Without parameters.
    ///
    /// # Errors
    /// Settings that make no sense.
    pub fn new(queues: DeskQueues<'q>, identity: Identity, settings: Settings) -> Result<Self, SettingsError> {
        let DeskQueues { orders, words, told, papers } = queues;
        Ok(Clerk {
            dispatch: Dispatch::new(orders, words, told),
            identity,
            knobs: Knobs::new(settings)?,
            papers,
            set: 0,
            is_current: false,
            is_tapped: false,
            next: None,
            has_first: false,
            parked: None,
            told: None,
            replies: Deque::new(),
        })
    }

    /// A clerk whose segments come from the tapped line.
    #[must_use]
    pub fn tapped(self) -> Self {
        Clerk { is_tapped: true, ..self }
    }

    /// Whether another message of the host can be obeyed now. Until then the link holds them back.
    pub fn is_ready(&self) -> bool {
        self.parked.is_none() && self.dispatch.is_done() && self.replies.len() < REPLIES / 2
    }

    /// Obeys a message; what is none is refused.
    pub fn take(&mut self, kind: u8, payload: &[u8]) {
        match Message::decode(kind, payload) {
            Ok(message) => self.obey(&message),
            Err(_) => self.refuse(kind, 0, RefusalCode::Message),
        }
    }

    /// Goes through what the tick told, and tells it what waits.
    pub fn run(&mut self) {
        self.listen();
        self.dispatch.hand_on();
        if self.dispatch.room() > 0
            && let Some(segment) = self.parked.take()
        {
            self.prepare(&segment);
        }
    }

    /// Goes through what the tick told.
    pub fn listen(&mut self) {
        while let Some(told) = self.dispatch.told() {
            if let Some(refusal) = told.refusal {
                let kind = table::Request { what: RequestCode::Arm, epoch: 0 };
                self.refuse(Message::from(kind).kind(), u32::from(told.epoch), report::refusal_code(refusal));
            }
            self.told = Some(told);
        }
    }

    /// The next answer for the host.
    pub fn reply(&mut self) -> Option<Message> {
        self.replies.pop_front()
    }

    /// Puts an answer back that could not be sent.
    pub fn keep(&mut self, reply: Message) {
        let _room = self.replies.push_front(reply);
    }

    /// How things stand, once the tick has told.
    pub fn report(&self) -> Option<table::Report> {
        self.told.as_ref().map(|told| report::report(told, self.room(), self.set))
    }

    /// How often to report, and what else can be set.
    pub fn knobs(&self) -> &Knobs {
        &self.knobs
    }

    /// What the tick told last.
    pub fn told(&self) -> Option<&Told> {
        self.told.as_ref()
    }

    /// The host was heard.
    pub fn heard(&mut self, at: Micros) {
        self.dispatch.heard(at);
    }

    /// A host greets: whatever was of another session counts no more.
    pub fn welcome(&mut self) {
        self.part();
        if !self.is_tapped {
            self.begin_run();
        }
    }

    /// The host is heard no more, or not as it should.
    pub fn lose_host(&mut self) {
        self.part();
        self.dispatch.say(Word::Lost);
    }

    /// The host began anew, or left.
    pub fn see_host_off(&mut self) {
        self.part();
        self.dispatch.say(Word::Gone);
        if !self.is_tapped {
            self.begin_run();
        }
    }

    /// Parameters as they lie in flash; answers the line that they are for. Where none were ever written the board goes on without.
    ///
    /// # Errors
    /// What is wrong with the page. If it is broken, or makes no sense, the fault is raised.
    pub fn adopt_page(&mut self, page: &[u8], set: u32) -> Result<Tapped, PageError> {
        let read = self.papers.read_page(page, |job| self.knobs.suit(&job.limits));
        match read {
            Ok(_) => self.take_effect(set),
            Err(PageError::Blank) => {}
            Err(_) => self.dispatch.say(Word::Fault(BoardFault::Parameters)),
        }
        read
    }

    /// The job in force.
    pub fn job(&self) -> Option<&Job> {
        self.papers.job()
    }

    /// Begins a new run: segments that are not done are forgotten.
    pub fn begin_run(&mut self) {
        (self.next, self.parked, self.has_first) = (None, None, false);
        self.papers.arcs = Arcs::None;
        self.dispatch.begin_run();
    }

    /// How many segments there is room for.
    pub fn room(&self) -> usize {
        self.dispatch.room()
    }

    /// Adds a prepared segment of this run; false, and nothing changed, if there is no room.
    pub fn push(&mut self, count: u32, segment: ActiveSegment) -> bool {
        self.dispatch.put(count, segment, None)
    }

    fn part(&mut self) {
        self.papers.staging.forget();
        self.is_current = false;
        self.replies.clear();
    }

    fn obey(&mut self, message: &Message) {
        let refused = match message {
            Message::Begin(_) | Message::SegmentArcs(_) | Message::Segment(_) | Message::Clear(_) if self.is_tapped => {
                Err((0, RefusalCode::Message))
            }
            Message::Begin(begin) => self.papers.staging.begin(begin.set).map_err(|why| (begin.set, why)),
            Message::Commit(commit) => self.commit(commit).map_err(|why| (commit.set, why)),
            // Those of a segment that waits for room are all there.
            Message::SegmentArcs(_) if self.parked.is_some() => Err((0, RefusalCode::Full)),
            Message::SegmentArcs(arcs) => self.papers.arcs.take(arcs).map_err(|why| (0, why)),
            Message::Segment(segment) => self.segment(segment).map_err(|why| (segment.count, why)),
            Message::Request(request) => self.request(request).map_err(|why| (u32::from(request.epoch), why)),
            Message::SetSetting(set) => self.set(set).map_err(|why| (set.setting as u32, why)),
            Message::AskSetting(ask) => {
                self.answer(self.knobs.tell(ask.setting).into());
                Ok(())
            }
            Message::AskInfo(_) => {
                self.answer(self.info().into());
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
            self.refuse(message.kind(), reference, why);
        }
    }

    /// Only the first part that is not sound is answered; what comes behind it has no set to belong to.
    fn part_of_set(&mut self, part: &Message) -> Result<(), (u32, RefusalCode)> {
        let set = self.papers.staging.set();
        match self.papers.staging.take(part) {
            Ok(()) | Err(RefusalCode::NoSet) => Ok(()),
            Err(why) => {
                self.dispatch.say(Word::Fault(BoardFault::Parameters));
                Err((set, why))
            }
        }
    }

    fn commit(&mut self, commit: &table::Commit) -> Result<(), RefusalCode> {
        let is_busy = self.is_busy();
        let sound = self.papers.staging.commit(commit).and_then(|job| {
            if is_busy {
                Err(RefusalCode::Busy)
            } else if self.knobs.suit(&job.limits) {
                Ok(())
            } else {
                Err(RefusalCode::Value)
            }
        });
        match sound {
            Ok(()) => {
                self.papers.put_in_force();
                self.take_effect(commit.set);
                self.is_current = true;
                self.answer(table::Accepted { set: commit.set }.into());
            }
            Err(RefusalCode::Busy | RefusalCode::NoSet) => {}
            Err(_) => self.dispatch.say(Word::Fault(BoardFault::Parameters)),
        }
        sound
    }

    /// Whether the laws have the override, or may have it, and something is in work.
    fn is_busy(&self) -> bool {
        self.is_engaged() && self.has_segments()
    }

    fn is_engaged(&self) -> bool {
        self.told.as_ref().is_some_and(|told| told.state.is_engaged())
    }

    fn has_segments(&self) -> bool {
        !self.dispatch.is_empty() || self.parked.is_some()
    }

    fn take_effect(&mut self, set: u32) {
        self.set = set;
        self.begin_run();
        self.order_parameters();
    }

    fn order_parameters(&mut self) {
        let limits = self.papers.job().map_or(OverrideLimits::default(), |job| job.limits);
        // Bounds and settings were checked when they were taken.
        if let Ok(supervisor) = Supervisor::within(&limits, self.knobs.settings) {
            self.dispatch.order(supervisor);
        }
    }

    fn segment(&mut self, segment: &table::Segment) -> Result<(), RefusalCode> {
        if self.parked.is_some() || !self.dispatch.is_done() {
            return Err(RefusalCode::Full);
        }
        if let Err(why) = self.check(segment) {
            // The next one that comes has its own.
            self.papers.arcs = Arcs::None;
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
            self.papers.check(segment)
        }
    }

    /// A segment that was checked, and for which there is room.
    fn prepare(&mut self, message: &table::Segment) {
        if let Some(active) = self.papers.prepare(message) {
            // The way of a rapid is the machine's, from wherever it is.
            let waits = !self.has_first && message.path != PathCode::Rapid;
            let begins_at = waits.then_some(message.start.map(Nm));
            self.has_first = true;
            self.dispatch.put(message.count, active, begins_at);
        }
    }

    fn request(&mut self, request: &table::Request) -> Result<(), RefusalCode> {
        match request.what {
            RequestCode::Disarm => self.dispatch.say(Word::Disarm),
            // Those of a tapped line are the board's own.
            RequestCode::Arm if !(self.is_current || self.is_tapped && self.papers.job().is_some()) => {
                return Err(RefusalCode::NoParameters);
            }
            RequestCode::Arm if self.told.as_ref().is_none_or(|told| told.epoch != request.epoch) => {
                return Err(RefusalCode::Outdated);
            }
            RequestCode::Arm => self.dispatch.say(Word::Arm(request.epoch)),
        }
        Ok(())
    }

    fn set(&mut self, set: &table::SetSetting) -> Result<(), RefusalCode> {
        // Behind segments at hand they would take effect with delay.
        if self.is_engaged() || self.has_segments() {
            return Err(RefusalCode::Busy);
        }
        self.knobs.set(set.setting, set.value)?;
        self.order_parameters();
        self.answer(self.knobs.tell(set.setting).into());
        Ok(())
    }

    fn info(&self) -> table::Info {
        let Identity { name, version, reset, starts } = self.identity;
        let capacity = u16::try_from(self.dispatch.capacity()).unwrap_or(u16::MAX);
        table::Info { version, reset, starts, capacity, set: self.set, name: Chunk::of(name.as_bytes()) }
    }

    fn refuse(&mut self, kind: u8, reference: u32, why: RefusalCode) {
        self.answer(table::Refused { kind, reference, why }.into());
    }

    /// A host that asks faster than it listens loses answers.
    fn answer(&mut self, message: Message) {
        let _room = self.replies.push_back(message);
    }
}
