//! A long deterministic run of the controller under each law, and the hash of everything that it puts out.
//!
//! The same code makes the inputs on the desk and on the chip: scenes drawn from a seed, with rests between blocks.

use core::fmt::{self, Display, Formatter};
use core::hash::{Hash, Hasher};

use arcfeed_firmware::board::Task;
use arcfeed_firmware::controller::{Controller, Input, Output, Reason};
use arcfeed_firmware::law::NoWish;
use arcfeed_firmware::progress::PositionFilter;
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_shared::job::LawKind;
use arcfeed_shared::stock::Stock;
use arcfeed_shared::units::{Micros, MmPerTooth, RevPerMin};

use crate::cabinet::Cabinet;
use crate::random::Random;
use crate::scene::{LawChoice, Scene};

/// Ticks of a run.
pub const TICKS: u32 = 120_000;
/// What a run is made for each of.
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

/// What came out of a run: a hash, and counts of ticks that tell what the hash speaks of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Trace {
    /// FNV-1a of all outputs.
    pub hash: u64,
    /// The law had a wish.
    pub governed: u32,
    /// The law had none, though there was one.
    pub refused: u32,
    /// Of the governed ones: on a line.
    pub on_lines: u32,
    /// Of the governed ones: a ring in stock that is a half plane, a polygon, a disc.
    pub in_stock: [u32; 3],
    /// Of the governed ones: the position filtered.
    pub filtered: u32,
    /// Of the filtered ones: without a sample.
    pub missing: u32,
}

impl Trace {
    fn count(&mut self, scene: &Scene, input: &Input, output: &Output) {
        let is_refused = matches!(output.reason, Reason::NoWish(refusal) if refusal != NoWish::NoLaw);
        self.refused += u32::from(is_refused);
        if output.ipt_center.is_some() {
            self.governed += 1;
            self.on_lines += u32::from(scene.is_line());
            let is_filtered = scene.filter != PositionFilter::Exact;
            self.filtered += u32::from(is_filtered);
            self.missing += u32::from(is_filtered && input.position.is_none());
            let [half_plane, polygon, disc] = &mut self.in_stock;
            match scene.stock() {
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

/// Runs [`TICKS`] ticks under a law.
pub fn run(choice: LawChoice) -> Trace {
    let mut random = Random::new(SEED);
    let mut hash = Fnv::default();
    let mut trace = Trace::default();
    let input = Input { position: None, spindle: RevPerMin(0.0), dt: Micros(0) };
    let (mut task, mut board) = (Task::default(), Cabinet { segment: None, input, output: FeedOverride::PROGRAMMED });
    let mut scene = Scene::draw(&mut random, choice);
    for tick in 0..TICKS {
        if random.below(TICKS_PER_BLOCK) == 0 {
            scene = Scene::draw(&mut random, choice);
            let rests = random.below(4) == 0;
            board.segment = (!rests).then(|| (tick, scene.active()));
        }
        board.input = scene.advance(&mut random);
        let controller = Controller::new(&scene.job).ok().map(|controller| controller.with_filter(scene.filter));
        let output = controller.and_then(|controller| task.run(&controller, &mut board));
        if let Some(output) = &output {
            trace.count(&scene, &board.input, output);
        }
        board.output.hash(&mut hash);
        output.map(fields).hash(&mut hash);
    }
    Trace { hash: hash.finish(), ..trace }
}

fn fields(output: Output) -> (FeedOverride, Option<u32>, u32, Reason) {
    let bits = output.ipt_center.map(|MmPerTooth(mm)| mm.to_bits());
    (output.feed_override, bits, output.wanted_ratio.to_bits(), output.reason)
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
