//! Progress along the example job from positions that are noisy, late and now and then missing, without a notification of
//! which segment is in work: what a board sees that only listens.

use std::collections::VecDeque;

use arcfeed::adapt::adapt;
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_control::{Control, ControlSettings};
use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::controller;
use arcfeed_firmware::progress::PositionFilter;
use arcfeed_firmware::queue::Follower;
use arcfeed_firmware::supervisor::Supervisor;
use arcfeed_firmware::supervisor::input::Input;
use arcfeed_firmware::supervisor::memory::Memory;
use arcfeed_firmware::supervisor::settings::Settings;
use arcfeed_model::job::Job;
use arcfeed_nc::block::Reading;
use arcfeed_nc::machining::ToolInSpindle;
use arcfeed_nc::modal::Pose;
use arcfeed_nc::segment::Segment;
use arcfeed_tests::{in_plane, root};
use arcfeed_units::{Micros, Nm, Span};
use fastrand::Rng;

const TICK: Micros = Micros::from_ms(1);
const SEEDS: std::ops::RangeInclusive<u64> = 1..=5;
/// Standard deviation of the position, nm.
const NOISE_NM: f64 = 5_000.0;
/// Ticks a sample is old when it arrives.
const DELAY_TICKS: usize = 4;
/// Part of the samples that never arrive.
const DROPOUT_RATIO: f64 = 0.02;
/// Largest error in the time of a change of segment: near a reversal the axes are within the noise for this long.
const CHANGE_TICKS: u64 = 12;

/// Distance before its end at which the queue ends a segment; the next one may have seen that part.
const END_TOLERANCE_MM: f64 = 0.01;

/// A tick of the machine: the move in work, counted from zero, and where the axes are.
#[derive(Clone, Copy)]
struct Truth {
    segment: usize,
    position: Pose,
}

fn gauss(random: &mut Rng) -> f64 {
    // Twelve uniforms: variance one, no tails to speak of.
    (0..12).map(|_| random.f64()).sum::<f64>() - 6.0
}

fn example() -> JobFile {
    JobFile::load(&root().join("examples/ibr-slot/job.toml")).expect("the example's job is sound")
}

fn example_program() -> String {
    std::fs::read_to_string(example().program).expect("the example has a program")
}

/// Runs a program, adapted as the example is, at 100 % and records every tick, with the moves in order.
fn record(program: &str) -> (Job, Vec<Segment>, Vec<Truth>) {
    let file = example();
    let program = Program::parse(&file.program, program.as_bytes(), file.job.unit, Reading::Lenient);
    assert!(!program.has_errors(), "{:?}", program.diagnostics);
    let text = adapt(&program, &file.job).text;
    let mut control = Control::from_memory(ControlSettings::fanuc_16i(file.job.unit), &text);
    let (mut now, mut last, mut segments, mut truth) = (Micros(0), None, Vec::new(), Vec::new());
    while !control.is_over() {
        now = now.after(TICK);
        control.step(now, TICK, 100);
        let Some((count, segment)) = control.active() else { continue };
        if last != Some(count) {
            segments.push(*segment);
            last = Some(count);
        }
        truth.push(Truth { segment: segments.len() - 1, position: control.position() });
    }
    (file.job, segments, truth)
}

fn active(segment: &Segment, job: &Job) -> ActiveSegment {
    let rule = job.rule_for(segment, ToolInSpindle::Unstated).map(|(_, rule)| rule);
    ActiveSegment::new(segment, rule, job)
}

/// State of the supervisor at each tick: segment, path travelled, override.
fn follow(
    job: &Job,
    segments: &[Segment],
    filter: PositionFilter,
    samples: impl Iterator<Item = Option<Pose>>,
) -> Vec<(usize, f32, u8)> {
    let supervisor = Supervisor::new(job, Settings::default()).expect("the limits are sound").with_filter(filter);
    let (mut follower, mut memory) = (Follower::default(), Memory::armed());
    let mut ahead = segments.iter().map(|segment| active(segment, job)).peekable();
    let mut said = Vec::new();
    for position in samples {
        let work @ Some((count, _)) = follower.in_work(ahead.peek()) else { break };
        let measured = controller::Measurement { position, spindle: job.tools.first().spindle, dt: TICK.into() };
        let output = supervisor.tick(&mut memory, work, &Input::of(measured));
        said.push((count as usize, memory.progress().travelled_mm(), output.feed_override.percent));
        if ahead.peek().is_some_and(|front| follower.follow(supervisor.controller(), front, &measured)) {
            ahead.next();
        }
    }
    said
}

fn corrupt(truth: &[Truth], seed: u64) -> impl Iterator<Item = Option<Pose>> + '_ {
    let mut random = Rng::with_seed(seed);
    let mut late: VecDeque<Pose> = VecDeque::new();
    truth.iter().map(move |tick| {
        late.push_back(tick.position);
        let mut position = if late.len() > DELAY_TICKS { late.pop_front()? } else { *late.front()? };
        for axis in &mut position.linear {
            axis.0 += (NOISE_NM * gauss(&mut random)) as i64;
        }
        (random.f64() >= DROPOUT_RATIO).then_some(position)
    })
}

/// Ticks from the true change of segment nearest to `tick`.
fn from_change(changes: &[usize], tick: usize) -> u64 {
    changes.iter().map(|change| change.abs_diff(tick) as u64).min().unwrap_or(u64::MAX)
}

/// Errors due to noise, delay and gaps, away from the changes of segment.
#[derive(Default)]
struct Errors {
    compared: usize,
    wrong: usize,
    position_mm: f32,
    override_percent: u8,
}

fn errors(truth: &[Truth], exact: &[(usize, f32, u8)], corrupted: &[(usize, f32, u8)]) -> Errors {
    let changes: Vec<usize> = (1..truth.len()).filter(|&tick| truth[tick].segment != truth[tick - 1].segment).collect();
    let mut errors = Errors::default();
    for (tick, (corrupted, exact)) in corrupted.iter().zip(exact).enumerate() {
        if from_change(&changes, tick) <= CHANGE_TICKS {
            continue;
        }
        errors.compared += 1;
        errors.wrong += usize::from(corrupted.0 != truth[tick].segment);
        errors.position_mm = errors.position_mm.max((corrupted.1 - exact.1).abs());
        errors.override_percent = errors.override_percent.max(corrupted.2.abs_diff(exact.2));
    }
    errors
}

/// Follows a program with every seed and holds each to the bounds.
fn assert_followed(name: &str, program: &str) {
    let (job, segments, truth) = record(program);
    let exact = follow(&job, &segments, PositionFilter::Exact, truth.iter().map(|tick| Some(tick.position)));
    let filter = PositionFilter::new(0.3, Span::from_ms(DELAY_TICKS as u32)).expect("a sound gain");
    for seed in SEEDS {
        let corrupted = follow(&job, &segments, filter, corrupt(&truth, seed));
        let Errors { compared, wrong, position_mm, override_percent } = errors(&truth, &exact, &corrupted);
        println!(
            "{name}, seed {seed}: {compared} of {} ticks on {} segments, {wrong} on the wrong one; position off by \
             {position_mm:.3} mm at most, override by {override_percent} %",
            truth.len(),
            segments.len()
        );
        assert_eq!(wrong, 0);
        assert!(corrupted.len().abs_diff(truth.len()) as u64 <= CHANGE_TICKS && compared * 10 > truth.len() * 9);
        assert!(override_percent <= 1 && position_mm < 0.1, "{override_percent} %, {position_mm} mm");
    }
}

#[test]
fn noise_delay_and_gaps_never_put_it_on_the_wrong_segment() {
    assert_followed("G17", &example_program());
}

/// The example with every first arc of a level down by 1.27 mm and every second one up again.
fn as_helices(program: &str) -> String {
    const DEPTH_INCH: f64 = 0.05;
    let mut level = 0.0;
    let mut line = |line: &str| {
        if let Some((_, z)) = line.split_once('Z') {
            let number: String = z.chars().take_while(|c| !c.is_ascii_alphabetic()).collect();
            level = number.parse::<f64>().expect("a number");
        }
        match line.split_once('J') {
            Some(_) if line.contains("G3") => format!("{line}Z{:.4}", level - DEPTH_INCH),
            Some(_) => format!("{line}Z{level:.4}"),
            None => line.to_owned(),
        }
    };
    let lines: Vec<String> = program.lines().map(&mut line).collect();
    lines.join("\n") + "\n"
}

#[test]
fn helices_in_every_plane_are_followed_as_their_arcs_are() {
    let helices = as_helices(&example_program());
    let (job, segments, truth) = record(&helices);
    let count = segments.iter().filter(|segment| segment.rise() != Nm(0)).count();
    assert!(count >= 24, "{count} helices");
    // Exact samples: what is travelled is the angle turned in the plane, times the radius.
    let exact = follow(&job, &segments, PositionFilter::Exact, truth.iter().map(|tick| Some(tick.position)));
    for ((of, travelled_mm, _), tick) in exact.iter().zip(&truth).filter(|((of, ..), tick)| *of == tick.segment) {
        let Some(arc) = segments[*of].arc() else { continue };
        let [x, y] = [0, 1].map(|axis| tick.position.linear[axis].to_mm() - arc.center[axis].to_mm());
        let [from_x, from_y] = arc.from.map(Nm::to_mm);
        let turned = libm::atan2(from_x * y - from_y * x, from_x * x + from_y * y) * f64::from(arc.turn.sign());
        let off_mm = (f64::from(*travelled_mm) - arc.radius_mm() * turned).abs();
        assert!(off_mm < END_TOLERANCE_MM, "{off_mm} mm off at {turned} rad");
    }
    for (plane, letters) in [("G17", "XYZIJK"), ("G18", "ZXYKIJ"), ("G19", "YZXJKI")] {
        assert_followed(plane, &in_plane(&helices, plane, letters));
    }
}
