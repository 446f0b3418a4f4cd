//! Sets of parameters: a job in messages and back, what a set that was corrupted on its way or makes no sense is.

use super::super::parameters::{SetSum, messages};
use super::super::tests::{Random, encoded, mill_job, ring_job, two_tool_job};
use super::super::*;
use super::Staging;
use crate::frame;
use arcfeed_model::cut::Work;
use arcfeed_model::job::{Job, LawKind, TOOLS_MAX};
use arcfeed_model::stock::Stock;
use arcfeed_model::tool::Edge;
use codes::RefusalCode;

fn set_of(job: &Job, set: u32) -> Vec<Message> {
    let mut all = Vec::new();
    messages(job, set, &mut |message| all.push(message)).unwrap();
    all
}

/// Job that a board commits from a set, or the refusal.
fn staged(staging: &mut Staging, all: &[Message]) -> Result<Job, RefusalCode> {
    for message in all {
        match message {
            Message::Begin(begin) => staging.begin(begin.set)?,
            Message::Commit(commit) => return staging.commit(commit).cloned(),
            part => staging.add(part)?,
        }
    }
    panic!("a set without an end")
}

#[test]
fn a_job_arrives_as_it_was_to_the_bit() {
    let laws = [LawKind::Contour { inside_only: true, floor_ratio: 0.3 }, LawKind::Engagement, LawKind::Programmed];
    let with_law = |mut job: Job, law| {
        job.tools.first_mut().law = law;
        job
    };
    let others = laws.map(|law| with_law(mill_job(), law));
    let mut staging = Staging::new();
    let mut along = with_law(mill_job(), LawKind::EngagedArc { both_edges: false });
    along.rules[0].work = Work::Ring(Edge::Outer, Stock::PerMove);
    let jobs = [ring_job(), mill_job(), two_tool_job(), with_law(ring_job(), LawKind::Circumference), along];
    for job in jobs.iter().chain(&others) {
        assert_eq!(staged(&mut staging, &set_of(job, 5)).as_ref(), Ok(job));
    }
}

#[test]
fn the_sum_of_a_set_is_the_frames_own_over_kind_and_payload() {
    let all = set_of(&ring_job(), 9);
    let (parts, commit) = (&all[1..all.len() - 1], all[all.len() - 1]);
    let bytes: Vec<u8> = parts.iter().flat_map(|part| [vec![part.kind()], encoded(part)].concat()).collect();
    let expected = table::Commit { set: 9, messages: parts.len() as u16, checksum: frame::checksum(&bytes) };
    assert_eq!(commit, Message::from(expected));
    assert_eq!(SetSum::NONE.commit(9).checksum, frame::checksum(&[]));
}

#[test]
fn a_set_that_lost_gained_or_swapped_a_message_is_no_set() {
    let all = set_of(&ring_job(), 3);
    let mut staging = Staging::new();
    for at in 1..all.len() - 1 {
        let mut torn = all.clone();
        torn.remove(at);
        assert!(staged(&mut staging, &torn).is_err(), "without {:?}", all[at]);
        let mut twice = all.clone();
        twice.insert(at, all[at]);
        assert!(staged(&mut staging, &twice).is_err(), "twice {:?}", all[at]);
        if at + 2 < all.len() && all[at] != all[at + 1] {
            let mut swapped = all.clone();
            swapped.swap(at, at + 1);
            assert!(staged(&mut staging, &swapped).is_err(), "swapped {:?}", all[at]);
        }
    }
    assert_eq!(staged(&mut staging, &all), Ok(ring_job()), "and the next whole one is one");
}

#[test]
fn nothing_of_a_refused_set_stays() {
    let mut staging = Staging::new();
    let (good, other) = (set_of(&ring_job(), 3), set_of(&mill_job(), 4));
    assert_eq!(staging.add(&good[1]), Err(RefusalCode::NoSet));
    staging.begin(3).unwrap();
    staging.add(&good[1]).unwrap();
    assert_eq!(staging.add(&good[1]), Err(RefusalCode::Incomplete));
    assert_eq!((staging.set(), staging.add(&good[2])), (0, Err(RefusalCode::NoSet)));
    assert_eq!(staged(&mut staging, &other), Ok(mill_job()));
    let Message::Commit(commit) = other[other.len() - 1] else { unreachable!() };
    assert_eq!(staging.commit(&commit), Err(RefusalCode::NoSet), "a set counts once");
    assert_eq!(staging.begin(0), Err(RefusalCode::Value));
}

/// The set of a job with one message replaced, its sum true.
fn altered(job: &Job, alter: impl Fn(Message) -> Option<Message>) -> Vec<Message> {
    let mut all: Vec<Message> = set_of(job, 3);
    let mut sum = SetSum::NONE;
    let mut altered = 0;
    let last = all.len() - 1;
    for message in &mut all[1..last] {
        if let Some(other) = alter(*message) {
            *message = other;
            altered += 1;
        }
        sum.add(message);
    }
    assert!(altered > 0);
    all[last] = sum.commit(3).into();
    all
}

#[test]
fn values_that_make_no_sense_are_refused() {
    use Message as M;
    use fixed::{Q40, Q46, Q62};
    type Alter = fn(Message) -> Option<Message>;
    let ring: [Alter; 12] = [
        |m| if let M::Tool(t) = m { Some(table::Tool { spindle: Q40(0), ..t }.into()) } else { None },
        |m| if let M::Tool(t) = m { Some(table::Tool { feed_per_tooth: Q40(-1), ..t }.into()) } else { None },
        |m| if let M::Tool(t) = m { Some(table::Tool { teeth: 0, ..t }.into()) } else { None },
        |m| if let M::Tool(t) = m { Some(table::Tool { inner_radius: t.outer_radius, ..t }.into()) } else { None },
        |m| if let M::Tool(t) = m { Some(table::Tool { outer_radius: i64::MIN, ..t }.into()) } else { None },
        |m| if let M::Tool(t) = m { Some(table::Tool { shape: codes::ToolCode::EndMill, ..t }.into()) } else { None },
        |m| if let M::Axes(a) = m { Some(table::Axes { linear: [Some(Q40(-5)); 3], ..a }.into()) } else { None },
        |m| if let M::ArcClamp(c) = m { Some(table::ArcClamp { radius: Q40(0), ..c }.into()) } else { None },
        |m| {
            if let M::StockLine(l) = m {
                Some(table::StockLine { normal: [Q62(1 << 61); 2], ..l }.into())
            } else {
                None
            }
        },
        |m| if let M::StockDisc(d) = m { Some(table::StockDisc { radius: Q46(0), ..d }.into()) } else { None },
        |m| if let M::Rule(r) = m { Some(table::Rule { table: Some([60, 10]), ..r }.into()) } else { None },
        |m| if let M::Rule(r) = m { Some(table::Rule { sequence: Some([2, 1]), ..r }.into()) } else { None },
    ];
    let mut staging = Staging::new();
    for (at, alter) in ring.into_iter().enumerate() {
        assert_eq!(staged(&mut staging, &altered(&ring_job(), alter)), Err(RefusalCode::Value), "ring {at}");
    }
    let mill: [Alter; 4] = [
        |m| if let M::Knot(k) = m { Some(table::Knot { feed_per_tooth: Q40(0), ..k }.into()) } else { None },
        |m| if let M::Knot(k) = m { Some(table::Knot { travelled: Q40(0), ..k }.into()) } else { None },
        |m| if let M::Rule(r) = m { Some(table::Rule { radial_depth: -1, ..r }.into()) } else { None },
        |m| if let M::Rule(r) = m { Some(table::Rule { table: None, ..r }.into()) } else { None },
    ];
    for (at, alter) in mill.into_iter().enumerate() {
        assert_eq!(staged(&mut staging, &altered(&mill_job(), alter)), Err(RefusalCode::Value), "mill {at}");
    }
}

#[test]
fn a_tool_comes_before_its_law_and_both_before_its_rules() {
    let all = set_of(&two_tool_job(), 3);
    let tool = all.iter().position(|message| matches!(message, Message::Tool(_))).unwrap();
    let rule = rule_of(&all).into();
    let mut staging = Staging::new();
    for (parts, expected) in [
        (vec![all[tool], all[tool + 1], rule], Ok(())),
        (vec![rule], Err(RefusalCode::Order)),
        (vec![all[tool + 1]], Err(RefusalCode::Incomplete)),
        (vec![all[tool], all[tool]], Err(RefusalCode::Incomplete)),
        (vec![all[tool], rule], Err(RefusalCode::Incomplete)),
        (vec![all[tool], all[tool + 1], all[tool + 1]], Err(RefusalCode::Incomplete)),
        ([all[tool], all[tool + 1]].repeat(TOOLS_MAX), Ok(())),
        ([all[tool], all[tool + 1]].repeat(TOOLS_MAX + 1), Err(RefusalCode::Full)),
    ] {
        staging.begin(3).unwrap();
        assert_eq!(parts.iter().try_for_each(|part| staging.add(part)), expected, "{parts:?}");
    }
    let unnumbered = altered(&two_tool_job(), |m| {
        if let Message::Tool(t) = m { Some(table::Tool { number: None, ..t }.into()) } else { None }
    });
    assert_eq!(staged(&mut staging, &unnumbered), Err(RefusalCode::Value), "several tools without a number");
}

#[test]
fn engaged_arcs_of_a_rule_are_refused_by_what_is_wrong_with_them() {
    let all = set_of(&ring_job(), 3);
    let arcs = |travelled, outer| table::EngagedArcs { travelled: fixed::Q40(travelled), outer, inner: [0, 0] };
    let tool: Vec<Message> =
        all.iter().filter(|message| matches!(message, Message::Tool(_) | Message::Law(_))).copied().collect();
    let rule = table::Rule { index: 0, stock: codes::StockCode::Engaged, stock_parts: 20, ..rule_of(&all) };
    let mut staging = Staging::new();
    let mut take = |rule: table::Rule, knots: &[table::EngagedArcs]| {
        staging.begin(3)?;
        tool.iter().try_for_each(|message| staging.add(message))?;
        staging.add(&rule.into())?;
        knots.iter().try_for_each(|knot| staging.add(&(*knot).into()))
    };
    let many: Vec<table::EngagedArcs> = (0..17).map(|at| arcs(at << 40, [0, 8_100])).collect();
    assert_eq!(take(rule, &many[..16]), Ok(()));
    assert_eq!(take(rule, &many), Err(RefusalCode::Full));
    assert_eq!(take(rule, &[many[1], many[1]]), Err(RefusalCode::Value), "no further on");
    assert_eq!(take(rule, &[arcs(0, [0, 32_401])]), Err(RefusalCode::Value), "no arc");
    assert_eq!(take(table::Rule { stock_parts: 1, ..rule }, &many[..2]), Err(RefusalCode::Order), "one too many");
    let along = table::Rule { stock: codes::StockCode::Along, stock_parts: 0, ..rule };
    assert_eq!(take(along, &[]), Ok(()));
    assert_eq!(take(along, &many[..1]), Err(RefusalCode::Order), "they come with segments");
    assert_eq!(take(table::Rule { stock_parts: 1, ..along }, &[]), Err(RefusalCode::Value));
}

/// The first rule of a set.
fn rule_of(all: &[Message]) -> table::Rule {
    let rule = |message: &Message| if let Message::Rule(rule) = message { Some(*rule) } else { None };
    all.iter().find_map(rule).unwrap()
}

#[test]
fn whatever_comes_staging_never_ends_but_in_a_sound_job_or_a_refusal() {
    let mut random = Random(42);
    let mut staging = Staging::new();
    let (mut accepted, mut refused) = (0, 0);
    for round in 0..3_000 {
        let job = [ring_job, mill_job, two_tool_job][round as usize % 3]();
        let mut all = set_of(&job, 1 + round);
        for _ in 0..random.below(3) {
            // The payload of one message gets a flipped bit, and the sum is made to fit.
            let at = 1 + random.below(all.len() - 2);
            let mut payload = encoded(&all[at]);
            let bit = random.below(payload.len() * 8);
            payload[bit / 8] ^= 1 << (bit % 8);
            all[at] = Message::decode(all[at].kind(), &payload).unwrap_or(all[at]);
        }
        let mut sum = SetSum::NONE;
        let last = all.len() - 1;
        all[1..last].iter().for_each(|message| sum.add(message));
        all[last] = sum.commit(1 + round).into();
        match staged(&mut staging, &all) {
            Ok(job) => {
                assert!(validation::is_valid(&job));
                accepted += 1;
            }
            Err(_) => refused += 1,
        }
    }
    println!("{accepted} sets accepted, {refused} refused");
    assert!(accepted > 500 && refused > 300);
}
