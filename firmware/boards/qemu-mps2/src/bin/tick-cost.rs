//! Instructions per tick over the whole example job, and those of the source's own route on the same ticks.
//!
//! Prints one line a figure, `NAME count N median M worst W`, for `tests/board.rs` to judge. The tick is
//! [`Task::run`], from the measured inputs to the override; interrupts are masked. Stack: the bytes that the ticks used
//! below this function's own frame.
#![no_std]
#![no_main]

use core::hint::black_box;

use arcfeed_bench::cabinet::Cabinet;
use arcfeed_bench::thesis::{self, Movement};
use arcfeed_firmware::board::Task;
use arcfeed_firmware::controller::{self, ActiveSegment};
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::input::Input;
use arcfeed_firmware::supervisor::report::Reason;
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::{Output, Supervisor};
use arcfeed_qemu_mps2::clock::InstructionCounter;
use arcfeed_qemu_mps2::example::{self, Block, TICK};
use arcfeed_qemu_mps2::figures::Costs;
use arcfeed_qemu_mps2::stack::Painted;
use arcfeed_shared::cut::Work;
use arcfeed_shared::job::Job;
use arcfeed_shared::nc::modal::{Pose, Turn};
use arcfeed_shared::tool::Tool;
use arcfeed_shared::units::Nm;
use cortex_m_semihosting::{debug, hprintln};

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    hprintln!("{}", info);
    arcfeed_qemu_mps2::leave(debug::EXIT_FAILURE)
}

/// What is counted.
#[derive(Default)]
struct Figures {
    /// Ticks on which the law spoke; the first of each block too.
    governed: Costs,
    /// All others.
    ungoverned: Costs,
    /// Taking up a block: [`ActiveSegment::new`], outside the tick.
    prepare: Costs,
    /// Equations (11)-(26) and (8)-(29) of the source in f32, then in f64, on the governed ticks.
    thesis: [Costs; 4],
}

#[inline(never)]
fn tick(task: &mut Task, supervisor: &Supervisor, board: &mut Cabinet) -> Output {
    task.run(supervisor, board)
}

#[cortex_m_rt::entry]
fn main() -> ! {
    cortex_m::interrupt::disable();
    let counter = InstructionCounter::start();
    let mut job = example::job();
    example::add_rules(&mut job);
    let Ok(supervisor) = Supervisor::new(&job, Settings::default()) else { arcfeed_qemu_mps2::leave(debug::EXIT_FAILURE) };
    let measured = controller::Input { position: None, spindle: job.spindle, dt: TICK };
    let mut board = Cabinet { segment: None, input: Input::of(measured), output: FeedOverride::PROGRAMMED };
    let (mut task, mut figures, mut stack_bytes) = (Task::from(Memory::armed()), Figures::default(), 0);
    let mut block = None;
    for (position, new) in example::run() {
        if let Some((count, next)) = new {
            block = Some(next);
            let segment = next.segment.as_ref();
            let (cost, active) =
                counter.of(|| segment.map(|segment| ActiveSegment::new(segment, next.cut(&job), &job)));
            figures.prepare.add(cost);
            board.segment = active.map(|active| (count, active));
        }
        board.input.measured.position = Some(position);
        let painted = Painted::below_here();
        let (cost, output) = counter.of(|| tick(&mut task, black_box(&supervisor), &mut board));
        stack_bytes = stack_bytes.max(painted.used());
        if matches!(output.reason, Reason::Law | Reason::Floor { .. } | Reason::Limited(_)) {
            figures.governed.add(cost);
            if let Some(movement) = block.and_then(|block| movement(block, &position, &job)) {
                count_thesis(&counter, &mut figures.thesis, &movement);
            }
        } else {
            figures.ungoverned.add(cost);
        }
    }
    print(&mut figures, stack_bytes)
}

fn print(figures: &mut Figures, stack_bytes: usize) -> ! {
    let names = ["thesis-11-26-f32", "thesis-8-29-f32", "thesis-11-26-f64", "thesis-8-29-f64"];
    let [a, b, c, d] = &mut figures.thesis;
    for (name, costs) in names.into_iter().zip([a, b, c, d]) {
        costs.print(name);
    }
    figures.governed.print("tick-governed");
    figures.ungoverned.print("tick-ungoverned");
    figures.prepare.print("prepare-block");
    hprintln!("tick-stack bytes {}", stack_bytes);
    arcfeed_qemu_mps2::leave(debug::EXIT_SUCCESS)
}

fn count_thesis(counter: &InstructionCounter, costs: &mut [Costs; 4], movement: &Movement<f64>) {
    let [step_f32, tooth_f32, step_f64, tooth_f64] = costs;
    let narrow = narrow(movement);
    let (line, narrow_line) = (thesis::line(movement.limits), thesis::line(narrow.limits));
    step_f32.add(counter.of(|| black_box(thesis::step(black_box(&narrow), black_box(narrow_line)))).0);
    tooth_f32.add(counter.of(|| black_box(thesis::tooth(black_box(&narrow)))).0);
    step_f64.add(counter.of(|| black_box(thesis::step(black_box(movement), black_box(line)))).0);
    tooth_f64.add(counter.of(|| black_box(thesis::tooth(black_box(movement)))).0);
}

/// What the source's equations take at this position: the stock limit in the frame at O, by two points a tool's radius
/// either side of the foot of the perpendicular from O.
fn movement(block: &Block, position: &Pose, job: &Job) -> Option<Movement<f64>> {
    let (arc, rule) = (block.segment.as_ref()?.arc()?, block.cut(job)?);
    let [x, y, _] = position.linear.map(Nm::to_mm);
    let [center_x, center_y] = arc.center.map(Nm::to_mm);
    let path_radius = arc.radius_mm();
    let (ex, ey) = ((x - center_x) / path_radius, (y - center_y) / path_radius);
    let turn = if arc.turn == Turn::Ccw { 1.0 } else { -1.0 };
    let (Tool::CupMill(tool), Work::Ring(edge, stock)) = (&job.tool, &rule.work) else { return None };
    let line = stock.line()?;
    let [nx, ny] = line.normal;
    let (normal_x, normal_y) = (turn * (ny * ex - nx * ey), -(nx * ex + ny * ey));
    let distance = line.distance_mm([x, y]);
    let edge_radius = tool.radius(*edge).to_mm();
    let limit = |along: f64| [distance * normal_x - along * normal_y, distance * normal_y + along * normal_x];
    Some(Movement {
        limits: [limit(-edge_radius), limit(edge_radius)],
        edge_radius,
        path_radius,
        advance: f64::from(edge.advance()),
        feed_per_tooth: f64::from(job.feed_per_tooth.0),
    })
}

fn narrow(movement: &Movement<f64>) -> Movement<f32> {
    Movement {
        limits: movement.limits.map(|point| point.map(|mm| mm as f32)),
        edge_radius: movement.edge_radius as f32,
        path_radius: movement.path_radius as f32,
        advance: movement.advance as f32,
        feed_per_tooth: movement.feed_per_tooth as f32,
    }
}
