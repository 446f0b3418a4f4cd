//! A long deterministic run of the supervisor under each law, and the hash of everything that it puts out.
//!
//! The same code makes the inputs on the host and on the chip: scenes drawn from a seed, with rests between blocks.

use core::fmt::{self, Display, Formatter};
use core::hash::{Hash, Hasher};

use arcfeed_firmware::controller;
use arcfeed_firmware::progress::PositionFilter;
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::input::{Input, Work};
use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::report::Reason;
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_firmware::supervisor::signals::{Request, Signals};
use arcfeed_firmware::supervisor::{Output, Supervisor};
use arcfeed_model::job::LawKind;
use arcfeed_model::stock::Stock;
use arcfeed_units::{MmPerTooth, Span};

use crate::random::Random;
use crate::random_case::{LawChoice, RandomCase};

/// Number of control ticks of a run.
pub const TICKS: u32 = 120_000;
/// Laws that are run, one after the other, with their names.
pub const LAWS: [(&str, LawChoice); 9] = [
    ("circumference", LawChoice::Job(LawKind::Circumference)),
    ("engaged-arc-one-edge", LawChoice::Job(LawKind::EngagedArc { both_edges: false })),
    ("engaged-arc-both-edges", LawChoice::Job(LawKind::EngagedArc { both_edges: true })),
    ("contour", LawChoice::Job(LawKind::Contour { inside_only: false, floor_ratio: 0.0 })),
    ("contour-floor", LawChoice::Job(LawKind::Contour { inside_only: false, floor_ratio: 0.5 })),
    ("contour-inside-only", LawChoice::Job(LawKind::Contour { inside_only: true, floor_ratio: 0.3 })),
    ("engagement", LawChoice::Job(LawKind::Engagement)),
    ("table", LawChoice::Table),
    ("programmed", LawChoice::Job(LawKind::Programmed)),
];

const SEED: u64 = 0x5eed_0fa2_cfee_d001;
const TICKS_PER_BLOCK: u64 = 400;

/// Result of a run: a hash of all outputs, and the number of ticks of certain kinds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Trace {
    /// FNV-1a hash (64 bits) of all outputs.
    pub hash: u64,
    /// Ticks at which the law had a demand.
    pub governed: u32,
    /// Ticks at which a law governed the segment but had no demand.
    pub refused: u32,
    /// Ticks with a demand on a straight move.
    pub on_lines: u32,
    /// Ticks with a demand of a cup mill, by its stock: half plane, polygon, round blank.
    pub in_stock: [u32; 3],
    /// Ticks with a demand at which positions were filtered.
    pub filtered: u32,
    /// Ticks with a demand and a filtered position at which no new position arrived.
    pub missing: u32,
}

impl Trace {
    fn count(&mut self, case: &RandomCase, input: &controller::Measurement, output: &Output) {
        let is_refused = matches!(output.reason, Reason::NoDemand(_));
        self.refused += u32::from(is_refused);
        if output.ipt_center.is_some() {
            self.governed += 1;
            self.on_lines += u32::from(case.is_line());
            let is_filtered = case.filter != PositionFilter::Exact;
            self.filtered += u32::from(is_filtered);
            self.missing += u32::from(is_filtered && input.position.is_none());
            let [half_plane, polygon, disc] = &mut self.in_stock;
            match case.stock() {
                Some(Stock::Disc { .. }) => *disc += 1,
                Some(stock) if stock.line().is_none() => *polygon += 1,
                Some(_) => *half_plane += 1,
                None => {}
            }
        }
    }
}

impl Display for Trace {
    /// Names and numbers in turn, on one line.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Trace { hash, governed, refused, on_lines, in_stock: [half_plane, polygon, disc], filtered, missing } =
            self;
        write!(f, "hash {hash:016x} governed {governed} refused {refused} on-lines {on_lines} ")?;
        write!(f, "half-plane {half_plane} polygon {polygon} disc {disc} filtered {filtered} missing {missing}")
    }
}

/// Runs [`TICKS`] ticks under a law with two supervisors: one without any event, and one with random losses, signals
/// and dial movements.
pub fn run(choice: LawChoice) -> Trace {
    let mut random = Random::new(SEED);
    let mut hash = Fnv::default();
    let mut trace = Trace::default();
    let (mut quiet, mut disturbed) = (Memory::armed(), Memory::armed());
    let mut case = RandomCase::draw(&mut random, choice);
    let mut work = None;
    for count in 0..TICKS {
        if random.below(TICKS_PER_BLOCK) == 0 {
            case = RandomCase::draw(&mut random, choice);
            work = (random.below(4) != 0).then(|| (count, case.active()));
        }
        let measured = case.advance(&mut random);
        let work: Work<'_> = work.as_ref().map(|(count, segment)| (*count, segment));
        let supervisor = Supervisor::new(&case.job, Settings::default()).expect("the limits are sound");
        let supervisor = supervisor.with_filter(case.filter);
        let output = supervisor.tick(&mut quiet, work, &Input::of(measured));
        trace.count(&case, &measured, &output);
        fields(&output, &quiet).hash(&mut hash);
        let output = supervisor.tick(&mut disturbed, work, &surroundings(&mut random, measured));
        fields(&output, &disturbed).hash(&mut hash);
    }
    Trace { hash: hash.finish(), ..trace }
}

/// Nearly always quiet, with somebody who arms again before long.
fn surroundings(random: &mut Random, measured: controller::Measurement) -> Input {
    let mut input = Input::of(measured);
    match random.below(400) {
        0..=3 => input.signals = Signals::of_request(Request::Arm),
        4 => input.signals = Signals::of_request(*random.one_of(&[Request::Disarm, Request::Reset])),
        5 => input.signals = *random.one_of(&[Signals::FEED_HOLD, Signals::TAPPING, Signals::CUTTER_COMPENSATION]),
        6 => input.operator_percent = random.below(200) as u8,
        7 => input.position.age = Span(random.below(100_000) as u32),
        _ => {}
    }
    input
}

fn fields(output: &Output, memory: &Memory) -> (FeedOverride, Option<u32>, u32, Reason) {
    (output.feed_override, output.ipt_center.map(bits), memory.level().ratio().to_bits(), output.reason)
}

fn bits(MmPerTooth(mm): MmPerTooth) -> u32 {
    mm.to_bits()
}

/// FNV-1a, 64 bits. Sizes and discriminants are hashed as 64 bits: they are shorter on the chip.
struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Fnv(0xcbf2_9ce4_8422_2325)
    }
}

impl Hasher for Fnv {
    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn write_isize(&mut self, number: isize) {
        self.write(&(number as i64).to_le_bytes());
    }

    fn write_usize(&mut self, number: usize) {
        self.write(&(number as u64).to_le_bytes());
    }

    fn finish(&self) -> u64 {
        self.0
    }
}
