//! Tables of feeds that come with moves that no rule governs, as plunges have them: the same overrides as by tables in rules, and
//! what is refused.

use arcfeed_law::move_table::MoveTable;
use arcfeed_law::table::Table;
use arcfeed_link::message::codes::RefusalCode;
use arcfeed_link::message::fixed::Q40;
use arcfeed_link::message::{Message, parameters, table};
use arcfeed_model::cut::CutRule;
use arcfeed_model::job::{Job, LawKind};
use arcfeed_model::knots::{Knot, Knots, TABLE_KNOTS_MAX};
use arcfeed_nc::modal::Feed;
use arcfeed_tests::recording::ibr_slot;
use arcfeed_units::{Mm, MmPerTooth};
use fastrand::Rng;

use crate::application::host_data::{HostData, say, segment, trace};

/// Tables that a job has room for.
const TABLES: usize = 2;
/// Longer than the arcs of the example, mm.
const REACH_MM: f32 = 60.0;
const SEGMENT: u8 = 0x20;
const ARCS: u8 = 0x26;
const FEED: u8 = 0x27;

/// Feeds from that of the slowest arc up to three times of it.
fn knots(random: &mut Rng) -> Vec<Knot> {
    let setup = ibr_slot().job.tools.first();
    let feeds =
        ibr_slot().segments.iter().filter(|segment| segment.arc().is_some()).filter_map(|segment| match segment.feed {
            Feed::PerMinute(feed) => Some(feed.to_mm() as f32),
            _ => None,
        });
    let least = feeds.fold(f32::INFINITY, f32::min) / (setup.spindle.0 * f32::from(setup.tool.active_teeth()));
    let knot = |at| (Mm(REACH_MM * at as f32 / TABLE_KNOTS_MAX as f32), MmPerTooth(least * (1.0 + 2.0 * random.f32())));
    (0..TABLE_KNOTS_MAX).map(knot).collect()
}

/// The example's moves, its arcs governed by one table or the other; the tables in rules, or sent with the moves.
fn host_data(is_along: bool) -> HostData {
    let run = ibr_slot();
    let mut random = Rng::with_seed(26);
    let tables: [Vec<Knot>; TABLES] = std::array::from_fn(|_| knots(&mut random));
    let mut all = Knots::default();
    let ranges = tables.each_ref().map(|table| all.add(table).expect("there is room"));
    let rules = ranges.map(|range| CutRule { table: Some(range), ..run.job.rules[0].clone() });
    let mut job = Job { rules: rules.into_iter().collect(), knots: all, ..run.job.clone() };
    job.tools.first_mut().law = LawKind::Table;
    let indices = run.segments.iter().scan(0, |governed, segment| {
        let index = run.rule(segment).map(|_| *governed % TABLES);
        *governed += usize::from(index.is_some());
        Some(index)
    });
    let indices: Vec<Option<usize>> = indices.collect();
    let moves = run.segments.iter().zip(&indices).map(|(segment, index)| (*segment, index.filter(|_| !is_along)));
    let sent = |index: usize| MoveTable::Feeds(Table::new(&tables[index]).expect("a table"));
    let moves = moves.collect();
    HostData { job, moves, tables: indices.iter().map(|index| index.filter(|_| is_along).map(sent)).collect() }
}

#[test]
fn feeds_sent_with_each_move_give_the_overrides_of_the_same_feeds_in_rules() {
    let in_rules = trace(host_data(false).world(0, 0));
    let found = trace(host_data(true).world(0, 0));
    let first = (0..found.len()).find(|at| found[*at] != in_rules[*at]);
    assert_eq!(first, None, "the first tick with another override");
    let mut values = found.clone();
    values.sort_unstable();
    values.dedup();
    println!("{} ticks, {} overrides up to {:?} %", found.len(), values.len(), values.last());
    assert!(values.len() > 50, "the tables govern: {values:?}");
    assert!(trace(host_data(true).world(20, 50)) == in_rules, "a slow line that loses every twentieth frame");
    let mut flooded = host_data(true).world(0, 0);
    flooded.host.say_all_moves();
    assert!(trace(flooded) == in_rules, "a move that waits for room keeps its feeds");
}

#[test]
fn without_feeds_a_move_without_a_rule_has_no_law() {
    assert!(trace(host_data(true).without_tables().world(0, 0)).iter().all(|percent| *percent == 100));
}

fn feed(travelled_mm: i64, feed_per_tooth: i64) -> Message {
    table::SegmentFeed { travelled: Q40(travelled_mm << 40), feed_per_tooth: Q40(feed_per_tooth) }.into()
}

#[test]
fn half_a_table_is_refused_and_so_is_its_move() {
    let mut world = host_data(true).ready();
    let arcs: Message = table::SegmentArcs { travelled: Q40(1 << 40), outer: [0, 8_100], inner: [0, 0] }.into();
    let many: Vec<Message> = (0..=TABLE_KNOTS_MAX as i64).map(|at| feed(at, 1 << 36)).collect();
    for (bad, kind, why) in [
        (&[feed(1, 1), feed(1, 1)][..], FEED, RefusalCode::Order),
        (&[feed(2, 1), feed(1, 1)], FEED, RefusalCode::Order),
        (&[feed(0, 1), feed(1, 0)], FEED, RefusalCode::Value),
        (&[feed(0, -1)], FEED, RefusalCode::Value),
        (&[feed(0, 1), arcs], ARCS, RefusalCode::Order),
        (&[arcs, feed(2, 1)], FEED, RefusalCode::Order),
        (&many, FEED, RefusalCode::Full),
    ] {
        let both = [bad, &[feed(99, 1), feed(0, -1), segment(1, None)]].concat();
        // The rest after a refused knot is ignored.
        assert_eq!(say(&mut world, &both)[..], [(kind, why), (SEGMENT, RefusalCode::Incomplete)], "{bad:?}");
    }
    let sound = [&many[..TABLE_KNOTS_MAX], &[segment(1, None)]].concat();
    assert_eq!(say(&mut world, &sound), [], "the move that comes next is still welcome");
}

#[test]
fn feeds_belong_to_the_next_move_only_and_to_one_without_a_rule() {
    let mut world = host_data(true).ready();
    assert_eq!(say(&mut world, &[feed(0, 1 << 36), segment(1, Some(0))]), [(SEGMENT, RefusalCode::Value)]);
    // Those of a refused move went with it: of this one they would be refused.
    assert_eq!(say(&mut world, &[segment(1, Some(0))]), []);
    assert_eq!(say(&mut world, &[feed(0, 1 << 36), segment(2, None), segment(3, Some(0))]), [], "used up");
    assert_eq!(say(&mut world, &[feed(0, 1 << 36), table::Clear {}.into(), segment(5, Some(0))]), [], "a new run");
    let mut set = vec![feed(0, 1 << 36)];
    parameters::messages(&host_data(true).job, 9, &mut |message| set.push(message)).expect("a job");
    set.push(segment(5, Some(0)));
    assert_eq!(say(&mut world, &set), [], "a new set");
}

#[test]
fn a_tapped_board_receives_none() {
    let mut world = host_data(true).tapped();
    assert_eq!(say(&mut world, &[feed(0, 1 << 36)]), [(FEED, RefusalCode::Message)]);
}
