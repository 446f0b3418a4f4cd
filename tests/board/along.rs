//! Tables sent with each move, on the chip: engaged arcs, and the feeds of plunges. The same overrides as in this process, and what
//! tick and stack they take.

use arcfeed_board_app::application::command_handler::Identity;
use arcfeed_board_app::application::control_task::Supply;
use arcfeed_board_app::application::messages::Queues;
use arcfeed_board_app::assembly::{Config, assemble};
use arcfeed_board_app::main_loop::Untapped;
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_hil_sim::override_source::board::{Board, Wires};
use arcfeed_hil_sim::override_source::in_process::InProcess;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_law::move_table::MoveTable;
use arcfeed_law::table::Table;
use arcfeed_link::message::codes::{ModeCode, ResetCode};
use arcfeed_model::cut::Work;
use arcfeed_model::engaged::{ENGAGED_KNOTS_MAX, EngagedInterval, EngagedKnot, EngagedTable};
use arcfeed_model::job::LawKind;
use arcfeed_model::knots::TABLE_KNOTS_MAX;
use arcfeed_model::stock::Stock;
use arcfeed_tests::emulation::host::Host;
use arcfeed_tests::emulation::qemu::{Clock, Emulator};
use arcfeed_units::{Mm, MmPerTooth};

use crate::load::{STACK_MAX, costs};
use crate::runs::{AHEAD, Example, prepare};

/// From cycle start on: some loops, with more coming in behind them.
const PERIODS: usize = 12_000;
/// Most instructions of a whole tick. The engaged arcs are part of the prepared ratio and cost the tick nothing.
const TICK_MAX: u32 = 1_750;
/// More than the board has room for.
const LOOPS: usize = 12;
const IMAGE: &str = "feedboard";
/// To where the arcs of the example's four movements begin, and there in loops.
const APPROACH: &str = "%\nG20G90G17\nG0X-2.967Y11.3933Z-27.6626\n";
const LOOP: &str = "G3X-3.6044Y10.5358I3.2165J-3.0564F41.\nG2X-2.5752Y11.5549I4.0398J-3.0504\nG1X-2.6598Y11.491\n\
                    G3X-3.6044Y10.5358I3.0952J-4.0056\nG2X-3.0241Y11.3322I3.8539J-2.1989\nG1X-2.967Y11.3933\n";

/// The example's arcs under the engaged-arc law, with the engagement per move.
fn engaged() -> Example {
    let mut example = Example::load();
    example.text = [APPROACH, &LOOP.repeat(LOOPS), "M30\n%\n"].concat().into_bytes();
    let job = &mut example.file.job;
    job.tools.first_mut().law = LawKind::EngagedArc { both_edges: true };
    for rule in &mut job.rules {
        if let Work::Ring(_, stock) = &mut rule.work {
            *stock = Stock::PerMove;
        }
    }
    example
}

/// As many places as there may be, 2 mm apart, the arcs wider and narrower by turns.
fn arcs() -> MoveTable {
    let arc = |to_deg| EngagedInterval::from_degrees(0.0, to_deg).expect("an arc");
    let knot = |at| EngagedKnot {
        travelled: Mm(2.0 * at as f32),
        outer: arc(if at % 2 == 0 { 45.0 } else { 75.0 }),
        inner: arc(if at % 3 == 0 { 50.0 } else { 65.0 }),
    };
    MoveTable::Engaged(EngagedTable::new(&(0..ENGAGED_KNOTS_MAX).map(knot).collect::<Vec<_>>()).expect("a table"))
}

/// Plunges of the example's tool, beside each other, each longer than the one before.
fn plunges() -> Example {
    let mut example = Example::load();
    let plunge = |at: usize| format!("X{}.Y0.\nG1Z-{}.F20.\nG0Z0.\n", at, 1 + at % 3);
    example.text = ["%\nG20G90G17\nG0X0.Y0.Z0.\n".to_owned(), (0..LOOPS).map(plunge).collect(), "M30\n%\n".into()]
        .concat()
        .into_bytes();
    example
}

/// As many feeds as there may be, 1.5 mm apart, from the sent one up to 1.9 times of it.
fn feeds(example: &Example) -> MoveTable {
    let setup = example.file.job.tools.first();
    let sent = 20.0 * 25.4 / (setup.spindle.0 * f32::from(setup.tool.active_teeth()));
    let ratio = |at: usize| 1.0 + 0.9 * (at % 8) as f32 / 7.0;
    let knot = |at: usize| (Mm(1.5 * at as f32), MmPerTooth(sent * ratio(at)));
    MoveTable::Feeds(Table::new(&(0..TABLE_KNOTS_MAX).map(knot).collect::<Vec<_>>()).expect("a table"))
}

fn overrides<W: Wires>(example: &Example, table: &MoveTable, wires: W) -> (Vec<u8>, Simulation<Board<W, Host>>) {
    let mut simulation = example.simulation(wires, example.host().with_table_ahead(table), ModeCode::Lockstep);
    prepare(&mut simulation);
    simulation.control_mut().cycle_start();
    let mut step = || {
        simulation.step();
        simulation.override_output().percent
    };
    let overrides = (0..PERIODS).map(|_| step()).collect();
    assert_eq!(simulation.source().failure(), None);
    (overrides, simulation)
}

/// Runs an example with this table before each of its moves in this process and on the chip. The overrides are the same, and tick and
/// stack within their bounds.
fn govern_the_chip_as_they_do_here(example: &Example, table: &MoveTable) {
    let mut queues = Queues::<AHEAD>::new();
    let identity = Identity { name: "in process", version: [0, 1, 0], reset: ResetCode::Power, starts: 1 };
    let config = Config { supply: Supply::Link, settings: Settings::default(), identity, fault: None };
    let (host_link, task) = assemble(&mut queues, config).expect("the settings are sound");
    let (here, _) = overrides(example, table, InProcess::new(Untapped::new(host_link, None), task));
    let (chip, simulation) = overrides(example, table, Emulator::start(IMAGE, Clock::CountedLockstep));
    let costs = costs(IMAGE, &simulation.source().wires().console()).expect("it logs its figures");
    let governed = here.iter().filter(|percent| **percent != 100).count();
    println!("{governed} of {PERIODS} ticks not at 100 %, {costs:?}");
    assert!(chip == here, "first at {:?}", (0..PERIODS).find(|at| chip[*at] != here[*at]));
    assert!(governed > PERIODS / 4, "the tables govern");
    assert!(costs.worst <= TICK_MAX, "{} instructions", costs.worst);
    assert!(costs.stack <= STACK_MAX, "{} bytes of stack", costs.stack);
}

#[test]
fn arcs_sent_with_each_move_govern_the_chip_as_they_do_here_and_fit_it() {
    govern_the_chip_as_they_do_here(&engaged(), &arcs());
}

#[test]
fn feeds_sent_with_each_plunge_govern_the_chip_as_they_do_here_and_fit_it() {
    let example = plunges();
    govern_the_chip_as_they_do_here(&example, &feeds(&example));
}
