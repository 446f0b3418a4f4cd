//! A spindle with run-up and droop, compared with closed forms.

use arcfeed::commands::simulate::control::control_settings;
use arcfeed::job::JobFile;
use arcfeed_control::drives::spindle::{SpindleDrive, SpindleRotation, SpindleState};
use arcfeed_control::{Control, ControlSettings, Preset};
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_tests::root;
use arcfeed_units::{LengthUnit, Micros};

use crate::drives::motion::{STEP, drives, settings};

/// Largest distance that does not count as a move, mm.
const NEAR: f64 = 1e-8;

const DRIVE: SpindleDrive = SpindleDrive {
    run_up_rev_per_min_s: 2_000.0,
    run_down_rev_per_min_s: 4_000.0,
    droop_ratio: 0.05,
    droop_s: 0.1,
    arrival_ratio: 0.15,
    waits_for_arrival: false,
};

/// Milliseconds until the spindle has its speed to a millionth.
fn ms_to_speed(spindle: &mut SpindleState) -> u32 {
    let mut ms = 0;
    while (spindle.rev_per_min() - spindle.commanded_rev_per_min()).abs() > 1e-3 {
        spindle.step(STEP.to_s());
        ms += 1;
        assert!(ms < 60_000);
    }
    ms
}

/// A control with a spindle, after a program of some time: what it has done every millisecond.
fn run(program: &str, spindle: Option<SpindleDrive>) -> Vec<([f64; 2], f64)> {
    let settings = ControlSettings { spindle, ..settings(drives()) };
    let mut control = Control::from_memory(settings, format!("{program}\nM30\n").as_bytes());
    let (mut at, mut now) = (Vec::new(), Micros(0));
    while !control.is_over() {
        now = now.after(STEP);
        control.step(now, STEP, 100);
        let [x, y, ..] = *control.axes();
        at.push(([x, y], control.spindle().map_or(0.0, SpindleState::rev_per_min)));
        assert!(now < Micros::from_ms(600_000), "{program}");
    }
    assert_eq!(control.alarm(), None, "{program}");
    at
}

#[test]
fn it_runs_up_down_and_round_at_its_rates() {
    let mut spindle = SpindleState::new(DRIVE);
    spindle.set_speed(3_000.0);
    spindle.set_rotation(SpindleRotation::Clockwise);
    assert_eq!(ms_to_speed(&mut spindle), 1_500);
    spindle.set_rotation(SpindleRotation::CounterClockwise);
    assert_eq!(ms_to_speed(&mut spindle), 750 + 1_500);
    assert_eq!(spindle.rev_per_min(), -3_000.0);
    spindle.set_speed(1_000.0);
    assert_eq!(ms_to_speed(&mut spindle), 500);
    spindle.set_rotation(SpindleRotation::Stop);
    assert_eq!(ms_to_speed(&mut spindle), 250);
    assert!(spindle.has_arrived());
}

#[test]
fn the_rest_of_a_period_is_not_lost_where_it_turns_round() {
    let mut spindle = SpindleState::new(DRIVE);
    spindle.set_speed(1.0);
    spindle.set_rotation(SpindleRotation::Clockwise);
    spindle.step(1.0);
    spindle.set_speed(1_000.0);
    spindle.set_rotation(SpindleRotation::CounterClockwise);
    // Down from 1 in 0.25 ms, then 0.75 ms up.
    spindle.step(1e-3);
    assert!((spindle.rev_per_min() + 1.5).abs() < 1e-12, "{}", spindle.rev_per_min());
}

#[test]
fn under_load_it_gives_way_exponentially() {
    let mut spindle = SpindleState::new(DRIVE);
    spindle.set_speed(1_000.0);
    spindle.set_rotation(SpindleRotation::Clockwise);
    ms_to_speed(&mut spindle);
    spindle.set_load(0.8);
    for ms in 1..1_000 {
        spindle.step(STEP.to_s());
        let lost = 0.05 * 0.8 * (1.0 - libm::exp(-f64::from(ms) / 100.0));
        assert!((spindle.rev_per_min() - 1_000.0 * (1.0 - lost)).abs() < 1e-9, "{ms} ms");
    }
    assert!(spindle.has_arrived(), "4 % of droop is within 15 %");
    let mut stiff = SpindleState::new(SpindleDrive { droop_s: 0.0, ..DRIVE });
    stiff.set_speed(1_000.0);
    stiff.set_rotation(SpindleRotation::Clockwise);
    stiff.set_load(1.0);
    stiff.step(1.0);
    assert_eq!(stiff.rev_per_min(), 950.0);
}

#[test]
fn cutting_feed_waits_for_speed_arrival_and_a_rapid_does_not() {
    let program = "G0X1.\nS3000M3\nG0X2.\nG1Y10.F600\nS1000\nY20.\nG0X0\nG1Y0";
    let waiting = run(program, Some(SpindleDrive { waits_for_arrival: true, ..DRIVE }));
    let begins = |of: &dyn Fn(&[f64; 2]) -> bool| waiting.iter().position(|(at, _)| of(at)).expect("it gets there");
    let turns = waiting.iter().position(|(_, n)| *n > 0.0).expect("it turns");
    assert!(begins(&|at| at[0] > 1.0 + NEAR) <= turns + 1, "the rapid waits");
    // 85 % of 3000 is there after 1275 ms, the first of them counted.
    assert_eq!(begins(&|at| at[1] > NEAR) - turns, 1_275);
    let full = waiting.iter().position(|(_, n)| *n == 3_000.0).expect("it gets there");
    let slows = full + waiting[full..].iter().position(|(_, n)| *n < 3_000.0).expect("it slows down");
    // 1000 and 15 % are there after 462.5 ms.
    assert_eq!(begins(&|at| at[1] > 10.0 + NEAR) - slows, 463);
    let free = run(program, Some(DRIVE));
    let axes = |run: &[([f64; 2], f64)]| run.iter().map(|(at, _)| *at).collect::<Vec<_>>();
    assert_eq!(axes(&free), axes(&run(program, None)), "a spindle without waiting changes nothing");
}

#[test]
fn words_behind_a_switched_slash_and_the_end_of_the_program_count() {
    let turning = |program: &str, block_delete: u16| {
        let mut settings = Preset::Fanuc31i.settings(LengthUnit::Mm);
        settings.spindle = Some(DRIVE);
        settings.switches.block_delete = block_delete;
        let mut control = Control::from_memory(settings, program.as_bytes());
        (1..=20).for_each(|ms| control.step(Micros::from_ms(ms), STEP, 100));
        control.spindle().expect("there is one").commanded_rev_per_min()
    };
    assert_eq!(turning("S500M4\nG4X9.\nM30\n", 0), -500.0);
    assert_eq!(turning("S500M3\n/S700\nG4X9.\nM30\n", 1), 500.0);
    assert_eq!(turning("S500M3\n/S700\nG4X9.\nM30\n", 0), 700.0);
    assert_eq!(turning("S500M3(S900)\nG4X9.\nM30\n", 0), 500.0);
    assert_eq!(turning("#1=450\nS#1M3\nG4X9.\nM30\n", 0), 450.0);
    assert_eq!(turning("S500M3\nM30\n", 0), 0.0);
}

/// The feed stays, the teeth come later: chips grow as 1/(1 - D q).
#[test]
fn the_chips_are_those_of_the_actual_speed() {
    let file = JobFile::load(&root().join("examples/ibr-slot/job.toml")).expect("the example's job is sound");
    let text = std::fs::read(&file.program).expect("the program is there");
    let chips = |spindle: Option<SpindleDrive>, load: f64| {
        let settings = ControlSettings { spindle, ..control_settings(&file) };
        let simulation = Simulation::from_memory(settings, &text, &file.job, ControllerFault::LawOff);
        let mut simulation = simulation.expect("the limits of the override make sense");
        while !simulation.is_done() {
            if let Some(spindle) = simulation.control_mut().spindle_mut() {
                spindle.set_load(load);
            }
            simulation.step();
        }
        let moves = simulation.meter().moves().iter().filter(|chips| chips.contact.samples > 0);
        moves.map(|chips| [chips.contact.min_ratio, chips.contact.max_ratio]).collect::<Vec<_>>()
    };
    let quick = SpindleDrive { run_up_rev_per_min_s: 1e6, droop_s: 0.0, droop_ratio: 0.1, ..DRIVE };
    let programmed = chips(None, 0.0);
    assert_eq!(chips(Some(quick), 0.0), programmed);
    let loaded = chips(Some(quick), 0.5);
    assert_eq!(loaded.len(), programmed.len());
    for (loaded, programmed) in loaded.iter().flatten().zip(programmed.iter().flatten()) {
        assert!((loaded / programmed * 0.95 - 1.0).abs() < 1e-3, "{loaded} under load, {programmed} without");
    }
    println!("{} chips of moves, 1/(1 - D q) = {:.6}", loaded.len(), loaded[0][0] / programmed[0][0]);
}
