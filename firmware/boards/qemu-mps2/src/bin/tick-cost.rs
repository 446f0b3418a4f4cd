//! Instructions per tick of each law over whole example jobs, and those of the source's own formulas on the same
//! ticks.
//!
//! Prints a line for each figure, `NAME count N median M worst W`, which `tests/board/figures.rs` checks:
//!
//! ```text
//! tick-LAW      ticks on which the law has a demand, the first of each block too; all ticks where it never has one
//! rest-LAW      the others: rapids, blocks without a rule, refusals
//! prepare-LAW   taking up a block, outside the tick
//! stack-LAW     `bytes N`: stack that a tick used, below this program's own frames
//! ```
//!
//! The positions are those of a run under the job's own law; the feed under another law has no influence on the cost
//! of its tick. Interrupts are masked.
#![no_std]
#![no_main]

use core::hint::black_box;

use arcfeed_bench::board_io::BoardIo;
use arcfeed_bench::random::Random;
use arcfeed_firmware::active::{ActiveSegment, Conditions};
use arcfeed_firmware::board::Task;
use arcfeed_firmware::controller;
use arcfeed_firmware::progress::PositionFilter;
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::input::Input;
use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_firmware::supervisor::{Output, Supervisor};
use arcfeed_law::table::Table;
use arcfeed_law::{FeedLaw, Place, SegmentLaw};
use arcfeed_model::job::{Job, LawKind};
use arcfeed_model::knots::{Knot, TABLE_KNOTS_MAX};
use arcfeed_nc::modal::Pose;
use arcfeed_qemu_mps2::baseline::Baseline;
use arcfeed_qemu_mps2::clock::InstructionCounter;
use arcfeed_qemu_mps2::example::{Block, Example, TICK, ibr_slot, pocket_contour, pocket_engagement};
use arcfeed_qemu_mps2::figures::Costs;
use arcfeed_qemu_mps2::leave;
use arcfeed_qemu_mps2::stack::Painted;
use arcfeed_units::{Mm, MmPerTooth, Span};
use cortex_m_semihosting::{debug, hprintln};

/// Gain of the filter; one of `MISSING` samples is missing.
const FILTER_GAIN_RATIO: f32 = 0.3;
const MISSING: u64 = 50;
const SEED: u64 = 0x0ddb_a115_5eed_0001;

/// A counted run of an example under a law.
struct Case {
    name: &'static str,
    example: Example,
    job: Job,
    /// Law of a block if it is not the job's.
    other_law: fn(&Block, &Job) -> Option<SegmentLaw>,
    filter: PositionFilter,
}

/// Results.
#[derive(Default)]
struct Figures {
    governed: Costs,
    others: Costs,
    prepare: Costs,
    stack_bytes: usize,
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    hprintln!("{}", info);
    leave(debug::EXIT_FAILURE)
}

/// The counted part of a tick.
#[inline(never)]
fn tick(task: &mut Task, supervisor: &Supervisor, board: &mut BoardIo) -> Output {
    task.run(supervisor, board)
}

#[cortex_m_rt::entry]
fn main() -> ! {
    cortex_m::interrupt::disable();
    let counter = InstructionCounter::start();
    count_circumference(&counter);
    let slot = |name, law| {
        let mut job = ibr_slot::whole_job();
        job.tools.first_mut().law = law;
        case(name, ibr_slot::EXAMPLE, job)
    };
    let filter = PositionFilter::new(FILTER_GAIN_RATIO, Span(0)).expect("a sound gain");
    let filtered = Case { filter, ..slot("circumference-filtered", LawKind::Circumference) };
    let knots = Case { other_law: table, ..slot("table", LawKind::Circumference) };
    for case in [
        filtered,
        slot("engaged-arc-one-edge", LawKind::EngagedArc { both_edges: false }),
        slot("engaged-arc-both-edges", LawKind::EngagedArc { both_edges: true }),
        knots,
        slot("programmed", LawKind::Programmed),
        case("contour", pocket_contour::EXAMPLE, pocket_contour::whole_job()),
        case("engagement", pocket_engagement::EXAMPLE, pocket_engagement::whole_job()),
    ] {
        count(&case, &counter, |_, _| {}).print(case.name);
    }
    leave(debug::EXIT_SUCCESS)
}

/// The example under its own law, with exact positions.
fn case(name: &'static str, example: Example, job: Job) -> Case {
    Case { name, example, job, other_law: |_, _| None, filter: PositionFilter::Exact }
}

/// Counts the law that is compared with the source's own formulas.
#[inline(never)]
fn count_circumference(counter: &InstructionCounter) {
    let case = case("circumference", ibr_slot::EXAMPLE, ibr_slot::whole_job());
    let mut baseline = Baseline::default();
    let mut figures = count(&case, counter, |block, position| baseline.add(counter, block, position, &case.job));
    baseline.print();
    figures.print(case.name);
}

/// Runs a case; `also` is called on each governed tick.
#[inline(never)]
fn count(case: &Case, counter: &InstructionCounter, mut also: impl FnMut(&Block, &Pose)) -> Figures {
    let Ok(supervisor) = Supervisor::new(&case.job, Settings::default()) else { leave(debug::EXIT_FAILURE) };
    let supervisor = supervisor.with_filter(case.filter);
    let measured = controller::Measurement { position: None, spindle: case.job.tools.first().spindle, dt: TICK };
    let mut board = BoardIo { segment: None, input: Input::of(measured), output: FeedOverride::PROGRAMMED };
    let (mut task, mut figures, mut random) = (Task::from(Memory::armed()), Figures::default(), Random::new(SEED));
    let mut block = None;
    for (position, new) in case.example.run() {
        if let Some((count, next)) = new {
            block = Some(next);
            let rule = next.cut(&case.job);
            board.segment = next.segment.as_ref().map(|segment| {
                let conditions = Conditions::of(segment, rule, &case.job);
                let other_law = (case.other_law)(next, &case.job);
                let (cost, active) = counter.of(|| match &other_law {
                    Some(law) => ActiveSegment::with_law(segment, law, &conditions, &case.job),
                    None => ActiveSegment::with_conditions(segment, &conditions, &case.job),
                });
                figures.prepare.add(cost);
                (count, active)
            });
        }
        let is_missing = case.filter != PositionFilter::Exact && random.below(MISSING) == 0;
        board.input.measured.position = (!is_missing).then_some(position);
        let painted = Painted::below_here();
        let (cost, output) = counter.of(|| tick(&mut task, black_box(&supervisor), &mut board));
        figures.stack_bytes = figures.stack_bytes.max(painted.used());
        if output.ipt_center.is_some() {
            figures.governed.add(cost);
            if let Some(block) = block {
                also(block, &position);
            }
        } else {
            figures.others.add(cost);
        }
    }
    figures
}

/// Table law of an arc with a rule: the maximum number of knots, with the demands of the job's law.
fn table(block: &Block, job: &Job) -> Option<SegmentLaw> {
    let (segment, rule) = (block.segment.as_ref()?, block.cut(job)?);
    let arc = segment.arc()?;
    let law = SegmentLaw::for_segment(segment, Some(rule), job);
    let (radius_mm, turn) = (arc.radius_mm() as f32, f32::from(arc.turn.sign()));
    let mut knots: [Knot; TABLE_KNOTS_MAX] = [(Mm(0.0), MmPerTooth(0.0)); TABLE_KNOTS_MAX];
    for (index, knot) in knots.iter_mut().enumerate() {
        let ratio = index as f64 / (TABLE_KNOTS_MAX - 1) as f64;
        let travelled_mm = (segment.length_mm() * ratio) as f32;
        let direction = arc.direction_at(ratio).map(|component| component as f32);
        let demand = law.demand(&Place::on_arc(direction, turn, radius_mm, travelled_mm));
        *knot = (
            Mm(travelled_mm),
            demand.map_or(job.tools.first().feed_per_tooth, |demand| MmPerTooth(demand.path_mm_per_tooth)),
        );
    }
    let table = Table::new(&knots).expect("the knots are in order and positive");
    Some(SegmentLaw::Table(table))
}

impl Figures {
    fn print(&mut self, law: &str) {
        let Figures { governed, others, prepare, stack_bytes } = self;
        if governed.is_empty() {
            others.print("tick-", law);
        } else {
            governed.print("tick-", law);
            others.print("rest-", law);
        }
        prepare.print("prepare-", law);
        hprintln!("stack-{} bytes {}", law, stack_bytes);
    }
}
