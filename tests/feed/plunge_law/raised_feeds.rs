//! The override along plunges and ramps, millisecond by millisecond: the machine's speed at each place against the law there, also if the
//! controller stops, or its position or its host is lost.

use std::path::Path;

use arcfeed::adapt::{Adapted, Known, adapt_with};
use arcfeed::axial_law::{AxialLaw, Edges, Inclination, floor_mm2, torque_max_n_m};
use arcfeed::commands::job_input::load_text;
use arcfeed::commands::simulate::control::control_settings;
use arcfeed::commands::simulate::foreseen;
use arcfeed::engagement::sections::{MappedDescent, MappedSection};
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_model::governed::Descent;
use arcfeed_model::job::ToolAxis;
use arcfeed_model::tool::Tool;
use arcfeed_nc::segment::Segment;
use arcfeed_tests::{of_full_set, run};
use arcfeed_units::{Nm, S_PER_MIN};
use fastrand::Rng;

use crate::plunge_law::plunge_job::PlungeJob;
use crate::plunge_law::random::RandomPlunges;

/// Runs of each program with each fault, at random times at which the override is raised.
const TIMES: usize = 3;
/// From the last tick of a controller to its watchdog, which sets 0 %.
const WATCHDOG_MS: u64 = 100;
/// Rounding of the halvings, and of the step of F.
const ROUNDING_RATIO: f64 = 1.0 + 1e-6;

/// A plunge beside a shallower one: below that its section is several times as large.
const STEPPED: &str =
    "%\nG21G17G90G94\nS3000M3\nN1G0X0.Y3.Z5.\nN2G1Z-15.F160.\nN3G0Z5.\nN4X3.\nN5G1Z-30.F160.\nN6G0Z5.\nN7M30\n%\n";
/// What a controller may lose, at a tick.
const LOSSES: [fn(u64) -> ControllerFault; 3] =
    [ControllerFault::FrozenAfter, ControllerFault::PositionLostAfter, ControllerFault::HostLostAfter];

/// A program with the law's own quantities on each of its descents.
struct Plunges {
    file: JobFile,
    program: Program,
    adapted: Adapted,
    law: AxialLaw,
}

/// What a run finds.
#[derive(Clone, Debug, Default)]
struct Found {
    time_ms: u64,
    descending_ms: u64,
    /// Times on descents at which the override was above 100 %.
    raised_at_ms: Vec<u64>,
    most_ratio: f64,
}

impl Plunges {
    fn load(job: &str) -> Self {
        let (file, source, _) = load_text(Path::new(job)).unwrap_or_else(|failure| panic!("{failure:?}"));
        let program = source.whole().expect("it is short");
        let adapted = adapt_with(&program, &file.job, Known::of(&file));
        let (plunge, setup) = (file.plunge.expect("a table"), file.job.tools.first());
        let radius = match &setup.tool {
            Tool::CupMill(cup) => cup.outer_radius,
            Tool::EndMill(mill) => mill.radius,
        };
        let law = AxialLaw {
            feed_per_tooth_mm: plunge.feed_per_tooth_mm,
            edges: Edges::of(&setup.tool),
            diameter_mm: 2.0 * radius.to_mm(),
            force: file.map.as_ref().expect("a map").descents.force,
            torque_max_n_m: torque_max_n_m(file.spindle.torque_n_m, file.spindle.power_w, f64::from(setup.spindle.0)),
            floor_mm2: floor_mm2(&setup.tool),
        };
        Plunges { file, program, adapted, law }
    }

    /// The governed descent on the path of a move of the machine, the next one behind these.
    fn descent(&self, segment: &Segment, behind: &mut usize) -> Option<&MappedDescent> {
        let mut blocks = self.adapted.blocks.iter().enumerate().skip(*behind);
        let path = |of: &Segment| (of.start, of.end, of.path);
        let (at, block) = blocks.find(|(_, block)| path(&block.segment) == path(segment))?;
        *behind = at + 1;
        block.demand.filter(|_| block.is_descent)?;
        self.file.map.as_ref()?.descents.moves.iter().find(|moved| moved.line == block.line)
    }

    /// Largest of chip and torque over their limits at a place, with this path per tooth.
    fn excess(&self, moved: &MappedDescent, descent: &Descent, at_mm: f64, path_mm: f64) -> f64 {
        let inclination = Inclination::of_sine(descent.sine_ratio);
        let next = moved.sections.partition_point(|section| section.at_mm <= at_mm);
        let around = &moved.sections[next.saturating_sub(1)..(next + 1).min(moved.sections.len())];
        let torque = |section: &MappedSection| self.law.torque_n_m(path_mm, section, inclination);
        let torque_n_m = around.iter().map(torque).fold(0.0, f64::max);
        // In front of the first contact a plunge has half of the chip.
        let is_in_air = around.iter().all(|section| section.end_mm2 <= 0.0)
            && moved.sections[..next].iter().all(|section| section.end_mm2 <= 0.0);
        let gentle = if descent.is_plunge() && is_in_air { 0.5 } else { 1.0 };
        (path_mm / (gentle * self.law.feed_per_tooth_mm)).max(torque_n_m / self.law.torque_max_n_m)
    }

    fn run(&self, fault: ControllerFault) -> Found {
        let text = [&self.adapted.text[..], b"\n"].concat();
        let simulation = Simulation::from_memory(control_settings(&self.file), &text, &self.file.job, fault);
        let mut simulation = simulation.expect("the limits of the override make sense");
        simulation.set_planned_conditions(foreseen(&self.program, &self.adapted, &self.file));
        let setup = self.file.job.tools.first();
        let teeth_per_s = f64::from(setup.spindle.0) * f64::from(setup.tool.active_teeth()) / S_PER_MIN;
        let (mut found, mut begun, mut behind, mut moved) = (Found::default(), None, 0, None);
        let ends_ms = if let ControllerFault::FrozenAfter(ticks) = fault { ticks + WATCHDOG_MS } else { u64::MAX };
        while !simulation.is_done() && found.time_ms < ends_ms {
            simulation.step();
            found.time_ms += 1;
            let Some((count, segment)) = simulation.control().active() else {
                begun = None;
                continue;
            };
            if begun != Some(count) {
                begun = Some(count);
                moved = self.descent(segment, &mut behind);
            }
            let (Some(moved), Some(descent)) = (moved, Descent::of(segment, ToolAxis::Z)) else { continue };
            let position = simulation.control().position();
            let parts =
                position.linear.iter().zip(&segment.start.linear).map(|(at, from)| Nm::to_mm(Nm(at.0 - from.0)));
            let at_mm = libm::sqrt(parts.map(|part| part * part).sum());
            let path_mm = simulation.control().speed_mm_per_s() / teeth_per_s;
            found.most_ratio = found.most_ratio.max(self.excess(moved, &descent, at_mm, path_mm / ROUNDING_RATIO));
            found.descending_ms += 1;
            if simulation.override_output().percent > 100 {
                found.raised_at_ms.push(found.time_ms);
            }
        }
        found
    }
}

#[test]
fn the_override_keeps_every_descent_within_the_law_also_when_the_board_is_lost() {
    let (mut descending_ms, mut raised_ms, mut most_ratio, mut faults) = (0, 0, 0.0_f64, 0);
    for seed in 0..of_full_set(60, 12) {
        let mut random = Rng::with_seed(0x0226 + seed);
        let sample = RandomPlunges::sample(&mut random);
        let name = format!("raised-{seed}");
        let (_scratch, job) = sample.job(&name, "mode = \"safe-base\"\nmax = 200").written();
        let made = run(&["engage", &job]);
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
        let plunges = Plunges::load(&job);
        let mut judge = |fault: ControllerFault| {
            let found = plunges.run(fault);
            let ratio = found.most_ratio;
            assert!(ratio <= 1.0, "program {seed}, {fault:?}: {ratio}\n{}\n{}", sample.tool, sample.program);
            descending_ms += found.descending_ms;
            raised_ms += found.raised_at_ms.len() as u64;
            most_ratio = most_ratio.max(ratio);
            found.raised_at_ms
        };
        let raised_at_ms = judge(ControllerFault::None);
        for _ in 0..TIMES {
            // Elsewhere a loss leaves the least feed in force.
            let Some(at) = random.choice(&raised_at_ms) else { continue };
            for fault in LOSSES {
                judge(fault(*at));
                faults += 1;
            }
        }
    }
    println!(
        "{faults} faults, {descending_ms} ms on descents, {raised_ms} ms above 100 %, {most_ratio} of the limits at most"
    );
    assert!(raised_ms > descending_ms / 20 && faults > 0);
}

#[test]
fn a_loss_in_front_of_a_larger_section_finds_the_override_low_enough_for_it() {
    let job = PlungeJob {
        name: "stepped",
        tool: "kind = \"end-mill\"\ndiameter = 10\nteeth = 3\nheight = 40",
        workpiece: "round = { from = [-20, 0, -40], to = [30, 0, -40], radius = 40 }\nstep = 0.25",
        cutting: "material = \"Ti-6Al-4V\"\nradial = 0.4\naxial = 0.2\naxial_depth = 2\nlayers = 2",
        spindle: "rev_per_min = 3000\nmax_power = \"2.25 kW\"\nmax_torque = \"9 Nm\"",
        mode: "mode = \"safe-base\"\nmax = 200",
        feed_per_tooth_mm: 0.08,
        max_raise: 4.0,
        program: STEPPED,
    };
    let (_scratch, job) = job.written();
    let made = run(&["engage", &job]);
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let plunges = Plunges::load(&job);
    let raised_at_ms = plunges.run(ControllerFault::None).raised_at_ms;
    assert!(raised_at_ms.len() > 500, "{} ms above 100 %", raised_at_ms.len());
    let mut most_ratio = 0.0_f64;
    for at in raised_at_ms.iter().step_by(20) {
        for fault in LOSSES {
            let ratio = plunges.run(fault(*at)).most_ratio;
            assert!(ratio <= 1.0, "{:?}: {ratio}", fault(*at));
            most_ratio = most_ratio.max(ratio);
        }
    }
    println!("{} ms above 100 %, {most_ratio} of the limits at most", raised_at_ms.len());
}
