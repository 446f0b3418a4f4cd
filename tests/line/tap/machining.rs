//! The example job through the tap: the same chips as with a controller notified of what the control executes.

use arcfeed_board_app::tap::settings::TapSettings;
use arcfeed_board_app::tap::status::TapState;
use arcfeed_control::Control;
use arcfeed_control::code::TapeCode;
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::override_source::controller::InProcessController;
use arcfeed_hil_sim::simulated_machine::STEP;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_milling::cutting::meter::MoveChips;

use crate::tap::bench::{Bench, control, encoded, example, moves};

/// By how much the chips of the two runs may differ: the control's step of the override is one per cent.
const DIFFERENCE_MAX: f64 = 0.011;

/// The chips, and least and largest override of each governed move, of a controller notified of each move.
pub fn in_process(job: &str) -> (Vec<MoveChips>, Vec<(u8, u8)>) {
    let (file, text) = example(job);
    let source = InProcessController::new(&file.job, ControllerFault::None, STEP.into()).expect("sound limits");
    let text = [&text[..], b"\n"].concat();
    let mut simulation = Simulation::new(Control::from_memory(control(&file, None), &text), &file.job, source);
    while !simulation.is_done() {
        simulation.step();
    }
    let overrides = simulation.overrides().iter().map(|figures| (figures.min_percent, figures.max_percent));
    (simulation.meter().moves().to_vec(), overrides.collect())
}

#[test]
fn the_chips_of_the_example_are_those_of_a_notified_controller() {
    let (file, text) = example("examples/ibr-slot/job.toml");
    let settings = TapSettings::new(file.job.unit);
    let mut bench = Bench::new(control(&file, None), settings, &file.job, encoded(&text, TapeCode::Iso));
    bench.simulation.source_mut().heard = moves(&text, file.job.unit);
    let ended = bench.run();
    println!("{ended:?}");
    assert!(bench.simulation.control().has_ended(), "{:?}", bench.simulation.control().alarm());
    let (notified, _) = in_process("examples/ibr-slot/job.toml");
    let moves = bench.simulation.meter().moves();
    assert_eq!(moves.len(), notified.len());
    for (ours, theirs) in moves.iter().zip(&notified) {
        let range = |chips: &MoveChips| (chips.contact.min_ratio, chips.contact.max_ratio);
        println!("{:?} {:?} {:?}", ours.sequence, range(ours), range(theirs));
        assert!((ours.contact.min_ratio - theirs.contact.min_ratio).abs() <= DIFFERENCE_MAX);
        assert!((ours.contact.max_ratio - theirs.contact.max_ratio).abs() <= DIFFERENCE_MAX);
    }
    assert_eq!((ended.counters.losses, ended.state), (0, TapState::Listening));
    assert!(ended.figures.governed > 20_000);
}
