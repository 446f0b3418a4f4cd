//! Random contours as the simulated control executes them, adapted.

use std::collections::{HashMap, HashSet};

use arcfeed::adapt::{Adapted, PlanReason};
use arcfeed::commands::simulate::control::control_settings;
use arcfeed::commands::simulate::foreseen;
use arcfeed::job::JobFile;
use arcfeed::program::Program;
use arcfeed_hil_sim::faults::ControllerFault;
use arcfeed_hil_sim::simulated_machine::STEP;
use arcfeed_hil_sim::simulation::Simulation;
use arcfeed_nc::segment::{Path, Segment};
use arcfeed_nc::settings::StartUp;
use arcfeed_tests::of_full_set;
use arcfeed_units::{Nm, S_PER_MIN};

use super::compensated_path::compensated;
use super::{Case, FEED, distance, point};

/// Last digit of an F word, mm/min.
const F_DIGIT: f64 = 0.1;
/// Lowest factor of the law without a floor in the job, and the largest raise of F.
const FACTORS: [f64; 2] = [0.2, 2.0];
/// Error of a feed that is measured over a millisecond: rounding of both positions to nanometres.
const MEASURED: f64 = 2e-6 / 1e-3 * S_PER_MIN;

/// Arc of the contour as programmed.
#[derive(Clone, Copy)]
struct ContourArc {
    center: [f64; 2],
    radius: f64,
}

/// Arcs in the plane, by N.
fn arcs(moves: &[Segment]) -> HashMap<i64, ContourArc> {
    let arc = |segment: &Segment| {
        let arc = segment.arc()?;
        Some((segment.sequence?, ContourArc { center: arc.center.map(Nm::to_mm), radius: arc.radius_mm() }))
    };
    moves.iter().filter_map(arc).collect()
}

#[derive(Debug, Default)]
struct Figures {
    contours: usize,
    /// Inside arcs whose F stays as programmed because the control reduces it.
    left_to_control: usize,
    samples: usize,
    even: usize,
    /// Largest difference from the programmed feed at the contour, in digits of F.
    worst_digits: f64,
    metered: u64,
    metered_max: f64,
}

/// Measurement of the feed at a contour.
struct Measurement {
    arcs: HashMap<i64, ContourArc>,
    /// N of the blocks that a law governs.
    governed: HashSet<i64>,
    /// N of the arcs behind moves around a corner.
    behind_corner: HashSet<i64>,
    /// The program as sent.
    text: String,
}

impl Measurement {
    fn of(program: &Program, adapted: &Adapted) -> Self {
        let programmed: Vec<Segment> = program.lines().filter_map(|line| line.segment()).collect();
        let governed = adapted.blocks.iter().filter(|block| block.demand.is_some());
        Measurement {
            arcs: arcs(&programmed),
            governed: governed.filter_map(|block| block.segment.sequence).collect(),
            behind_corner: HashSet::new(),
            text: String::from_utf8_lossy(&adapted.text).into_owned(),
        }
    }

    /// Judges the feed of the centre on a move, at this place; `before` is that of the millisecond before.
    fn add(&mut self, segment: &Segment, at: [f64; 2], [before, center_feed]: [f64; 2], figures: &mut Figures) {
        let number = segment.sequence.expect("each block has an N");
        let text = &self.text;
        figures.samples += 1;
        let Some(arc) = self.arcs.get(&number).filter(|_| segment.arc().is_some()) else {
            if self.arcs.contains_key(&number) {
                self.behind_corner.insert(number);
            }
            assert!(center_feed <= FEED + MEASURED, "N{number}: {center_feed}\n{text}");
            return;
        };
        let factor = distance(at, arc.center) / arc.radius;
        let is_governed = self.governed.contains(&number);
        let most = if is_governed { FEED * factor.clamp(FACTORS[0], FACTORS[1]) } else { FEED };
        assert!(center_feed <= most * 1.005 + MEASURED, "N{number}: {center_feed} above {most}\n{text}");
        let is_free = is_governed && (FACTORS[0]..FACTORS[1]).contains(&factor);
        let is_held_down = factor > 1.0 && self.behind_corner.contains(&number);
        let is_steady = (center_feed - before).abs() < MEASURED && center_feed > 0.9 * most;
        if is_free && is_steady && !is_held_down {
            let digits = (center_feed - FEED * factor).abs() / F_DIGIT;
            assert!(digits <= 1.0 + MEASURED / F_DIGIT, "N{number}: {center_feed}, factor {factor}\n{text}");
            figures.worst_digits = figures.worst_digits.max(digits);
            figures.even += 1;
        }
    }
}

/// Runs an adapted contour; measures the feed at the contour each millisecond.
fn run(case: &Case, (file, program, adapted): &(JobFile, Program, Adapted), figures: &mut Figures) {
    let mut measurement = Measurement::of(program, adapted);
    let settings = control_settings(file);
    let mut simulation =
        Simulation::from_memory(settings, &adapted.text, &file.job, ControllerFault::None).expect("a run");
    simulation.set_planned_conditions(foreseen(program, adapted, file));
    let (mut last, mut feed_before) = (None, 0.0);
    while !simulation.is_done() {
        simulation.step();
        let control = simulation.control();
        assert_eq!(control.alarm(), None, "{}", measurement.text);
        let at = point(&control.actual_position().linear);
        let now = control.active().map(|(count, segment)| (count, *segment));
        if let (Some((before, position)), Some((count, segment))) = (last, now)
            && before == (count, segment)
            && segment.path != Path::Rapid
        {
            let feed = distance(position, at) / STEP.to_s() * S_PER_MIN;
            measurement.add(&segment, at, [feed_before, feed], figures);
            feed_before = feed;
        }
        last = now.map(|now| (now, at));
    }
    let Measurement { arcs, governed, text, .. } = &measurement;
    for chips in simulation.meter().moves() {
        let number = chips.sequence.expect("each block has an N");
        assert!(governed.contains(&number), "N{number}\n{text}");
        let block = &simulation.control().executed()[chips.block as usize - 1];
        assert!(String::from_utf8_lossy(block).starts_with(&format!("N{number}G")), "N{number}");
        figures.metered += chips.any_contact.samples;
        // At the floor the feed at the contour is above its target, and the chip is not.
        if chips.any_contact.samples > 0 && case.contour.radius_mm() < 4.0 * arcs[&number].radius / 5.0 {
            figures.metered_max = figures.metered_max.max(chips.any_contact.max_ratio);
        }
    }
    figures.contours += 1;
}

#[test]
fn the_feed_at_the_contour_is_the_programmed_one_inside_and_outside() {
    let mut figures = Figures::default();
    for seed in 0..of_full_set(1_000, 120) {
        let case = Case::of_seed("compensated-run", seed);
        if compensated(&format!("G21G17\n{}", case.contour.text), StartUp::A).is_err() {
            continue;
        }
        // The job's sides are wrong for G42; the program's side counts.
        let job = case.job(&case.program(&case.contour.text), ["inside", "outside"], "rewrite-only", &case.radius());
        run(&case, &job, &mut figures);
    }
    println!("{figures:?}");
    assert!(figures.contours > 60 && figures.even > 10_000 && figures.metered > 1_000);
    assert!(figures.metered_max <= 1.005, "{figures:?}");
}

/// F words of a program, by N.
fn feed_words(text: &[u8]) -> HashMap<i64, f64> {
    let text = String::from_utf8_lossy(text).into_owned();
    let word = |line: &str| {
        let (number, rest) = line.strip_prefix('N')?.split_once('G')?;
        let (_, feed) = rest.rsplit_once('F')?;
        Some((number.parse().ok()?, feed.trim_end().parse().ok()?))
    };
    text.lines().filter_map(word).collect()
}

#[test]
fn arcs_that_the_control_slows_down_are_not_slowed_twice_and_keep_f() {
    let mut figures = Figures::default();
    for seed in 0..of_full_set(1_000, 120) {
        let case = Case::of_seed("compensated-reduced", seed);
        if compensated(&format!("G21G17\n{}", case.contour.text), StartUp::A).is_err() {
            continue;
        }
        let of = |settings: &str| {
            let settings = format!("{settings}{}", case.radius());
            case.job(&case.program(&case.contour.text), ["inside", "outside"], "rewrite-only", &settings)
        };
        // At 1 % the control keeps the feed at the contour of every arc that the tool fits with a hundredth of its radius.
        let least = [1, 40][seed as usize % 2];
        let (plain, job) = (of(""), of(&format!("inside_arc_least = {least}\n")));
        let [without, with] = [&plain, &job].map(|(_, _, adapted)| feed_words(&adapted.text));
        for (number, feed) in &with {
            let most = without.get(number).copied().unwrap_or(FEED).max(FEED);
            assert!(*feed <= most, "N{number}: F{feed} above {most}\n{}", case.contour.text);
        }
        let left = job.2.blocks.iter().filter(|block| block.reason == PlanReason::ControlReduces);
        figures.left_to_control += left.filter(|block| block.sent == Some(Nm::from_mm(FEED))).count();
        run(&case, &job, &mut figures);
    }
    println!("{figures:?}");
    assert!(figures.contours > 60 && figures.even > 5_000 && figures.left_to_control > 30, "{figures:?}");
    assert!(figures.metered_max <= 1.005, "{figures:?}");
}

#[test]
fn the_control_alone_keeps_the_feed_at_the_contour_of_inside_arcs_down_to_its_least_ratio() {
    let case = Case::of_seed("compensated-alone", 3);
    let r = case.contour.radius_mm();
    // An inside arc of twice the tool's radius, an outside one of it, and an inside arc of 1.1 times it.
    let [wide, tight] = [2.0 * r, 1.1 * r];
    let blocks = format!(
        "G0X-20.Y0Z0\nG41D{}G1X0F500.\nX40.\nG3X{:.3}Y{wide:.3}J{wide:.3}\nG1Y60.\nG2X{:.3}Y{:.3}I{r:.3}\nG1X120.\nG3X{:.3}Y{:.3}J{tight:.3}\nG1Y90.\nG40X150.\n",
        case.contour.d,
        40.0 + wide,
        40.0 + wide + r,
        60.0 + r,
        120.0 + tight,
        60.0 + r + tight
    );
    let text = case.program(&blocks);
    for (least, expected) in [(None, [1.0, 1.0, 1.0]), (Some(1), [0.5, 1.0, 0.1 / 1.1]), (Some(20), [0.5, 1.0, 0.2])] {
        let settings = least.map_or(String::new(), |least| format!("inside_arc_least = {least}\n"));
        let (file, ..) = case.job(&text, ["inside", "outside"], "rewrite-only", &(settings + &case.radius()));
        let mut simulation =
            Simulation::from_memory(control_settings(&file), text.as_bytes(), &file.job, ControllerFault::LawOff)
                .expect("a run");
        let mut fastest: HashMap<i64, f64> = HashMap::new();
        while !simulation.is_done() {
            simulation.step();
            let control = simulation.control();
            assert_eq!(control.alarm(), None, "{text}");
            if let Some(number) = control.active().and_then(|(_, segment)| segment.arc().and(segment.sequence)) {
                let entry = fastest.entry(number).or_default();
                *entry = f64::from(control.commanded().0).max(*entry);
            }
        }
        let found = [4, 6, 8].map(|number| fastest[&number] / FEED);
        println!("{least:?}: {found:?}");
        let is_close = |(found, expected): (&f64, &f64)| (found / expected - 1.0).abs() < 2e-5;
        assert!(found.iter().zip(&expected).all(is_close), "{least:?}: {found:?}, not {expected:?}");
    }
}
