//! Engaged arcs that come with each move: the same overrides as by tables in the rules, and what is refused.

use arcfeed_law::move_table::MoveTable;
use arcfeed_link::message::codes::RefusalCode;
use arcfeed_link::message::fixed::Q40;
use arcfeed_link::message::{Message, parameters, table};
use arcfeed_model::cut::{CutRule, Work};
use arcfeed_model::engaged::{ENGAGED_KNOTS_MAX, EngagedInterval, EngagedKnot, EngagedTable};
use arcfeed_model::job::{Job, LawKind};
use arcfeed_model::stock::Stock;
use arcfeed_model::tool::Edge;
use arcfeed_units::Mm;
use fastrand::Rng;

use crate::application::host_data::{HostData, say, segment, trace};
use crate::application::world::Host;
use arcfeed_tests::recording::ibr_slot;

/// Tables that fit into the rules of a job.
const TABLES: usize = 16;
/// Longer than the arcs of the example, mm.
const REACH_MM: f32 = 60.0;
const ARCS: u8 = 0x26;
const SEGMENT: u8 = 0x20;

fn interval(random: &mut Rng) -> EngagedInterval {
    let (from, to) = (random.f64() * 60.0, random.f64() * 90.0);
    EngagedInterval::from_degrees(from, to).expect("an arc, or nothing")
}

fn tables() -> Vec<EngagedTable> {
    let mut random = Rng::with_seed(11);
    let mut table = |index: usize| {
        let knots = 1 + index % ENGAGED_KNOTS_MAX;
        let knot = |at| EngagedKnot {
            travelled: Mm(REACH_MM * at as f32 / knots as f32),
            outer: interval(&mut random),
            inner: interval(&mut random),
        };
        EngagedTable::new(&(0..knots).map(knot).collect::<Vec<_>>()).expect("a table")
    };
    (0..TABLES).map(&mut table).collect()
}

fn rule(like: &CutRule, stock: Stock) -> CutRule {
    CutRule { work: Work::Ring(Edge::Outer, stock), ..like.clone() }
}

/// The example's moves, each governed one by one of the tables; the tables in rules, or sent with the moves.
fn host_data(is_along: bool) -> HostData {
    let run = ibr_slot();
    let (tables, like) = (tables(), &run.job.rules[0]);
    let rules = match is_along {
        true => vec![rule(like, Stock::PerMove), rule(like, Stock::everywhere())],
        false => tables.iter().map(|table| rule(like, Stock::Engaged(table.clone()))).collect(),
    };
    let mut job = Job { rules: rules.into_iter().collect(), ..run.job.clone() };
    job.tools.first_mut().law = LawKind::EngagedArc { both_edges: true };
    let mut governed = 0;
    let (mut moves, mut arcs) = (Vec::new(), Vec::new());
    for segment in &run.segments {
        let index = run.rule(segment).map(|_| governed % TABLES);
        governed += usize::from(index.is_some());
        moves.push((*segment, index.map(|index| if is_along { 0 } else { index })));
        arcs.push(index.filter(|_| is_along).map(|index| MoveTable::Engaged(tables[index].clone())));
    }
    HostData { job, moves, tables: arcs }
}

#[test]
fn arcs_sent_with_each_move_give_the_overrides_of_the_same_arcs_in_rules() {
    let in_rules = trace(host_data(false).world(0, 0));
    let along = host_data(true);
    let found = trace(along.world(0, 0));
    let first = (0..found.len()).find(|at| found[*at] != in_rules[*at]);
    assert_eq!(first, None, "the first tick with another override");
    let mut values: Vec<u8> = found.clone();
    values.sort_unstable();
    values.dedup();
    let knots = along.tables.iter().flatten().filter_map(MoveTable::engaged).map(|table| table.knots().len());
    println!("{} ticks, {} knots sent, {} overrides", found.len(), knots.sum::<usize>(), values.len());
    assert!(values.len() > 50, "the tables govern: {values:?}");
    assert!(trace(along.world(20, 50)) == in_rules, "a slow line that loses every twentieth frame");
}

#[test]
fn a_move_that_waits_for_room_keeps_its_arcs() {
    let mut flooded = host_data(true).world(0, 0);
    flooded.host.say_all_moves();
    assert!(trace(flooded) == trace(host_data(false).world(0, 0)));
}

#[test]
fn without_arcs_a_move_of_such_a_rule_has_no_law() {
    assert!(trace(host_data(true).without_tables().world(0, 0)).iter().all(|percent| *percent == 100));
}

fn arcs(travelled_mm: i64, to: i16) -> Message {
    table::SegmentArcs { travelled: Q40(travelled_mm << 40), outer: [0, to], inner: [0, 0] }.into()
}

#[test]
fn half_a_table_is_refused_and_so_is_its_move() {
    let mut world = host_data(true).ready();
    let many: Vec<Message> = (0..=16).map(|at| arcs(at, 8_100)).collect();
    for (bad, why) in [
        (&[arcs(1, 8_100), arcs(1, 8_100)][..], RefusalCode::Order),
        (&[arcs(2, 8_100), arcs(1, 8_100)], RefusalCode::Order),
        (&[arcs(0, 8_100), arcs(1, 32_401)], RefusalCode::Value),
        (&many, RefusalCode::Full),
    ] {
        let both = [bad, &[arcs(99, 8_100), arcs(0, 32_401), segment(1, Some(0))]].concat();
        // The rest after a refused knot is ignored.
        let expected = [(ARCS, why), (SEGMENT, RefusalCode::Incomplete)];
        assert_eq!(say(&mut world, &both)[..], expected, "{bad:?}");
    }
    let sound = [&many[..16], &[segment(1, Some(0))]].concat();
    assert_eq!(say(&mut world, &sound), [], "the move that comes next is still welcome");
    assert_eq!(say(&mut world, &[arcs(0, 8_100), segment(2, Some(0))]), [], "a table of its own");
}

#[test]
fn arcs_belong_to_the_next_move_only_and_to_one_whose_rule_asks_for_them() {
    let mut world = host_data(true).ready();
    for rule in [Some(1), None] {
        assert_eq!(say(&mut world, &[arcs(0, 8_100), segment(1, rule)]), [(SEGMENT, RefusalCode::Value)]);
    }
    // Those of a refused move went with it: of this one they would be refused.
    assert_eq!(say(&mut world, &[segment(1, Some(1))]), []);
    assert_eq!(say(&mut world, &[arcs(0, 8_100), segment(9, Some(0))]), [(SEGMENT, RefusalCode::Order)]);
    assert_eq!(say(&mut world, &[segment(2, Some(1))]), []);
    assert_eq!(say(&mut world, &[arcs(0, 8_100), segment(3, Some(0)), segment(4, Some(1))]), [], "used up");
}

#[test]
fn a_new_run_a_new_set_and_a_new_session_forget_arcs() {
    let mut world = host_data(true).ready();
    assert_eq!(say(&mut world, &[arcs(0, 8_100), table::Clear {}.into(), segment(5, Some(1))]), []);
    let mut set = vec![arcs(0, 8_100)];
    parameters::messages(&host_data(true).job, 9, &mut |message| set.push(message)).expect("a job");
    set.push(segment(5, None));
    assert_eq!(say(&mut world, &set), []);
    assert_eq!(say(&mut world, &[arcs(0, 8_100)]), []);
    world.host = Host::new(2, &host_data(true).job, &[]);
    world.host.is_silent = true;
    world.run(200);
    let early = [arcs(0, 8_100), segment(1, Some(0))];
    assert_eq!(say(&mut world, &early), [(SEGMENT, RefusalCode::NoParameters)]);
    assert_eq!(say(&mut world, &set[1..]), []);
}

#[test]
fn a_tapped_board_receives_none() {
    let mut world = host_data(true).tapped();
    assert_eq!(say(&mut world, &[arcs(0, 8_100)]), [(ARCS, RefusalCode::Message)]);
}
