//! The limits of the machine bound the override, with their reason, and the reported feed is the actual one.

use arcfeed::adapt::{PlanReason, PlannedBlock, adapt};
use arcfeed::commands::simulate::control::control_settings;
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::controller;
use arcfeed_firmware::ramp::FeedOverride;
use arcfeed_firmware::supervisor::input::Input;
use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::report::{Limit, Reason};
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_firmware::supervisor::{Output, Supervisor};
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_model::job::FeedPolicy;
use arcfeed_model::machine::{ArcClamp, LimitedBy, MachineLimits};
use arcfeed_nc::block::Reading;
use arcfeed_nc::machining::ToolInSpindle;
use arcfeed_nc::modal::{Feed, Pose};
use arcfeed_tests::root;
use arcfeed_units::{Mm, MmPerMin, Nm, S_PER_MIN, Span};

const TICKS: u32 = 4_000;

fn example() -> (JobFile, Program) {
    let file = JobFile::load(&root().join("examples/ibr-slot/job.toml")).expect("the example's job is sound");
    let program = Program::load(&file.program, file.job.unit, Reading::Lenient).expect("the example has a program");
    (file, program)
}

/// Blocks that the law governs all along, without limits.
fn governed(file: &JobFile, program: &Program) -> Vec<PlannedBlock> {
    let blocks = adapt(program, &file.job).blocks;
    blocks.into_iter().filter(|block| block.reason == PlanReason::Law).collect()
}

/// Moves along a block at a steady speed, slowly; what the supervisor decides at each tick.
fn run(file: &JobFile, block: &PlannedBlock, sent: Nm) -> (ActiveSegment, Vec<Output>) {
    let mut segment = block.segment;
    segment.feed = Feed::PerMinute(sent);
    let active = ActiveSegment::new(&segment, block.rule.map(|rule| &file.job.rules[rule]), &file.job);
    let supervisor = Supervisor::new(&file.job, Settings::default()).expect("the example's limits are sound");
    let arc = *segment.arc().expect("an arc");
    let mut memory = Memory::armed();
    let tick = |tick: u32| {
        let [x, y] = arc.direction_at(f64::from(tick) / f64::from(TICKS));
        let at = |axis: usize, part: f64| Nm(arc.center[axis].0 + Nm::from_mm(arc.radius_mm() * part).0);
        let position = Some(Pose { linear: [at(0, x), at(1, y), Nm(0)], ..segment.start });
        let measured =
            controller::Measurement { position, spindle: file.job.tools.first().spindle, dt: Span::from_ms(1) };
        supervisor.tick(&mut memory, Some((1, &active)), &Input::of(measured))
    };
    let outputs = (1..TICKS).map(tick).collect();
    (active, outputs)
}

#[test]
fn the_override_stops_where_the_machine_does_and_says_why() {
    let (mut file, program) = example();
    let mut limited = 0;
    for block in governed(&file, &program) {
        let demand = block.demand.expect("it is governed");
        let sent = block.sent.expect("it is governed");
        // In the middle of what the law wants along the block.
        let feed = MmPerMin((0.5 * (demand.feed_min_mm_per_min + demand.feed_max_mm_per_min)) as f32);
        let radius = Mm(block.segment.arc().expect("an arc").radius_mm() as f32);
        for (by, limit) in [(LimitedBy::Axis, Limit::Axis), (LimitedBy::ArcClamp, Limit::ArcClamp)] {
            let clamp = ArcClamp { feed, radius, floor: MmPerMin(0.0) };
            file.job.machine = match by {
                LimitedBy::Axis => MachineLimits { linear: [Some(feed); 3], ..MachineLimits::default() },
                LimitedBy::ArcClamp => MachineLimits { arc_clamp: Some(clamp), ..MachineLimits::default() },
                LimitedBy::Ceiling => continue,
            };
            let most = file.job.machine.feed_limit(&block.segment).expect("it has a limit");
            assert_eq!(most.by, by);
            let (active, outputs) = run(&file, &block, sent);
            for output in &outputs {
                let asked = f64::from(output.feed_override.percent) / 100.0 * sent.to_mm();
                assert!(asked <= f64::from(most.feed.0) * (1.0 + 1e-5), "{asked} asked, {most:?} possible");
                let made = active.feed_at(output.feed_override).expect("it has a feed");
                assert!((f64::from(made.0) - asked).abs() < 1e-3 * asked, "{made:?} reported, {asked} made");
            }
            let reasons = |wanted: Reason| outputs.iter().filter(|output| output.reason == wanted).count();
            limited += reasons(Reason::Limited(limit));
            assert_eq!(reasons(Reason::Law) + reasons(Reason::Limited(limit)), outputs.len());
        }
    }
    println!("{limited} ticks at the machine's limit");
    assert!(limited > 1_000, "{limited}");
}

#[test]
fn a_block_without_a_law_keeps_its_hundred_per_cent() {
    let (mut file, program) = example();
    file.job.machine.linear = [Some(MmPerMin(10.0)); 3];
    let mut block = governed(&example().0, &program).remove(0);
    block.rule = None;
    let (active, outputs) = run(&file, &block, Nm(600_000_000));
    assert!(outputs.iter().all(|output| output.feed_override.percent == 100 && output.reason == Reason::NoLaw));
    let made = active.feed_at(FeedOverride::PROGRAMMED).expect("it has a feed");
    assert!(made.0 < 30.0, "{made:?}: the machine does what it can");
}

#[test]
fn reported_feed_under_an_arc_clamp_is_the_clamp() {
    let (mut file, program) = example();
    let block = governed(&file, &program).remove(0);
    file.job.policy = FeedPolicy::OverrideOnly;
    let radius = Mm(block.segment.arc().expect("an arc").radius_mm() as f32);
    file.job.machine.arc_clamp = Some(ArcClamp { feed: MmPerMin(500.0), radius, floor: MmPerMin(0.0) });
    let (active, _) = run(&file, &block, Nm(1_000_000_000));
    for (percent, feed) in [(20, 200.0), (50, 500.0), (51, 500.0), (100, 500.0), (200, 500.0)] {
        let made = active.feed_at(FeedOverride { percent }).expect("it has a feed");
        assert!((made.0 - feed).abs() < 1e-3, "{made:?} at {percent} %");
    }
}

#[test]
fn the_plan_sends_no_feed_that_the_machine_cannot_make_and_names_what_limits_it() {
    let (mut file, program) = example();
    let free = governed(&file, &program);
    file.job.machine.linear = [Some(MmPerMin(1_000.0)); 3];
    let blocks = adapt(&program, &file.job).blocks;
    let mut named = 0;
    for block in &free {
        let bounded = blocks.iter().find(|other| other.line == block.line).expect("the same blocks");
        let most = file.job.machine.feed_limit(&block.segment).expect("it has a limit").feed;
        let wanted = block.demand.expect("it is governed").feed_max_mm_per_min;
        let expected = if wanted > f64::from(most.0) { PlanReason::Axis } else { PlanReason::Law };
        assert_eq!(bounded.reason, expected, "line {}", block.line);
        assert!(bounded.sent.expect("it is governed").to_mm() <= f64::from(most.0));
        named += u32::from(expected == PlanReason::Axis);
    }
    assert!(named > 0 && named < free.len() as u32, "{named} of {}", free.len());
}

#[test]
fn under_the_controls_own_clamp_the_feed_reported_is_the_feed_driven() {
    let (mut file, program) = example();
    // Half of what the fastest arc is sent with, so that every arc is clamped.
    let fastest = governed(&file, &program).into_iter().filter_map(|block| block.sent).max().expect("governed blocks");
    let clamp = ArcClamp { feed: MmPerMin(fastest.to_mm() as f32 / 2.0), radius: Mm(120.0), floor: MmPerMin(0.0) };
    file.job.machine.arc_clamp = Some(clamp);
    file.job.policy = FeedPolicy::OverrideOnly;
    let text = [std::fs::read(&file.program).expect("the program is there"), b"\n".to_vec()].concat();
    let text = String::from_utf8(text).expect("text").replace("F25.", &format!("F{:.1}", fastest.to_mm() / 25.4));
    let simulation =
        Simulation::from_memory(control_settings(&file), text.as_bytes(), &file.job, ControllerFault::None);
    let mut simulation = simulation.expect("the limits of the override make sense");
    let (mut speed_before, mut compared, mut clamped) = (0.0, 0, 0);
    while !simulation.is_done() {
        simulation.step();
        let (control, speed) = (simulation.control(), simulation.control().speed_mm_per_s());
        let is_steady = speed > 0.0 && (speed - speed_before).abs() < 1e-9;
        speed_before = speed;
        let Some((_, segment)) = control.active().filter(|(_, segment)| is_steady && segment.arc().is_some()) else {
            continue;
        };
        let rule = file.job.rule_for(segment, ToolInSpindle::Unstated).map(|(_, rule)| rule);
        let feed_override = FeedOverride { percent: control.override_percent() };
        let reported = ActiveSegment::new(segment, rule, &file.job).feed_at(feed_override).expect("it has a feed");
        let driven = speed * S_PER_MIN;
        assert!((f64::from(reported.0) / driven - 1.0).abs() < 1e-4, "{reported:?} reported, {driven} mm/min driven");
        let asked = f64::from(feed_override.percent) / 100.0 * fastest.to_mm();
        compared += 1;
        clamped += u32::from(f64::from(reported.0) < asked * 0.999);
    }
    println!("{compared} steady ticks on arcs, {clamped} of them clamped");
    assert!(compared > 5_000 && clamped > 1_000);
}
