//! Commands of a host, and refusals.

use arcfeed_board_app::application::control_task::Supply;
use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::supervisor::Output;
use arcfeed_firmware::supervisor::signals::{Request, Signals};
use arcfeed_firmware::supervisor::state::State;
use arcfeed_link::message::codes::{RefusalCode, RequestCode, SettingCode};
use arcfeed_link::message::page::{self, TappedLine};
use arcfeed_link::message::schema::{FieldType, Optional};
use arcfeed_link::message::{Message, SCHEMA, moves, parameters, table};
use arcfeed_nc::segment::Segment;

use crate::application::world::{Channel, World, standing};
use arcfeed_tests::recording::ibr_slot;

fn all_moves() -> Vec<(Segment, Option<usize>)> {
    crate::application::example::moves(ibr_slot())
}

/// A board that stands at the program's zero.
fn world(segments: usize) -> World {
    let run = ibr_slot();
    World::new(&run.job, &all_moves()[..segments], [1, 2].map(|seed| Channel::new(0, 0, seed)))
}

/// The same, the host's set taken.
fn ready(segments: usize) -> World {
    let mut world = world(segments);
    world.until("the parameters", |world| world.host.is_accepted);
    world
}

fn output(world: &World) -> Output {
    world.output.expect("a tick")
}

fn say(world: &mut World, message: impl Into<Message>) -> Vec<(u8, RefusalCode)> {
    world.host.refusals.clear();
    world.host.say(message);
    world.run(20);
    world.host.refusals.clone()
}

fn send_set(world: &mut World, set: u32) -> Vec<(u8, RefusalCode)> {
    world.host.refusals.clear();
    let mut all = Vec::new();
    parameters::messages(&ibr_slot().job, set, &mut |message| all.push(message)).expect("a job");
    all.into_iter().for_each(|message| world.host.say(message));
    world.run(50);
    world.host.refusals.clone()
}

fn segment(count: u32) -> table::Segment {
    let (segment, rule) = all_moves()[count as usize - 1];
    moves::encode(&segment, count, rule.map(|rule| rule as u8)).expect("it can be encoded")
}

const COMMIT: u8 = 0x1C;
const SEGMENT: u8 = 0x20;
const REQUEST: u8 = 0x22;
const SET_SETTING: u8 = 0x25;

#[test]
fn parameters_are_refused_while_segments_are_in_work_under_the_laws_and_taken_after_disarming() {
    let mut world = world(4);
    world.arm();
    let executed = world.board.task.executed();
    assert_eq!(send_set(&mut world, 9), [(COMMIT, RefusalCode::Busy)]);
    assert_eq!(world.host.report.expect("a report").set, 1);
    assert!(output(&world).state.is_engaged(), "unchanged");
    world.host.ask(RequestCode::Disarm);
    world.until("the disarming", |world| !output(world).state.is_engaged());
    assert_eq!(send_set(&mut world, 10), []);
    world.run(100);
    let report = world.host.report.expect("a report");
    assert_eq!((report.set, report.in_work, report.executed), (10, None, executed), "segments are forgotten");
}

#[test]
fn a_board_that_has_nothing_in_work_takes_parameters_armed_or_not() {
    let mut world = world(0);
    world.arm();
    assert_eq!(send_set(&mut world, 9), []);
    assert!(output(&world).state.is_engaged());
    world.run(60);
    assert_eq!(world.host.report.expect("a report").set, 9);
}

#[test]
fn segments_need_parameters_of_this_session_their_order_and_a_rule_that_is_there() {
    let mut world = ready(0);
    assert_eq!(say(&mut world, segment(1)), []);
    assert_eq!(say(&mut world, segment(3)), [(SEGMENT, RefusalCode::Order)]);
    assert_eq!(say(&mut world, table::Segment { rule: Some(4), ..segment(2) }), [(SEGMENT, RefusalCode::Value)]);
    let torn = table::Segment { center: Some([0, 0]), ..segment(2) };
    assert_eq!(say(&mut world, torn), [(SEGMENT, RefusalCode::Value)]);
    assert_eq!(say(&mut world, segment(2)), [], "the one that comes next is still welcome");
    assert_eq!(say(&mut world, table::Clear {}), []);
    assert_eq!(say(&mut world, segment(7)), [], "a run begins with any count");
    world.host.link.close();
    world.run(20);
    assert_eq!(world.board.host_link.handler().report().expect("a report").set, 1, "the set stays in force");
    world.host = crate::application::world::Host::new(2, &ibr_slot().job, &[]);
    world.host.is_silent = true;
    world.run(200);
    assert_eq!(say(&mut world, segment(1)), [(SEGMENT, RefusalCode::NoParameters)], "but not for this session");
    assert_eq!(
        say(&mut world, table::Request { what: RequestCode::Arm, epoch: 1 }),
        [(REQUEST, RefusalCode::NoParameters)]
    );
}

#[test]
fn an_arming_of_before_the_override_was_taken_away_is_outdated() {
    let mut world = world(0);
    world.arm();
    let seen = world.host.report.expect("a report").epoch;
    world.host.ask(RequestCode::Disarm);
    world.run(100);
    let outdated = table::Request { what: RequestCode::Arm, epoch: seen };
    assert_eq!(say(&mut world, outdated), [(REQUEST, RefusalCode::Outdated)]);
    assert!(!output(&world).state.is_engaged());
    world.host.ask(RequestCode::Arm);
    assert_eq!(say(&mut world, table::AskInfo {}), []);
    assert!(output(&world).state.is_engaged());
}

#[test]
fn the_reason_why_arming_is_refused_comes_back() {
    let mut world = world(0);
    world.until("a report", |world| world.host.is_accepted && world.host.report.is_some());
    world.run(2_500);
    for (turn, why) in [
        ((|world| world.sensors.signals = Signals::CUTTER_COMPENSATION) as fn(&mut World), RefusalCode::Condition),
        (|world| world.sensors.operator_percent = 40, RefusalCode::Operator),
        (|world| world.sensors.freshness.invalid_in_row = 5, RefusalCode::NotFresh),
    ] {
        let sound = world.sensors;
        turn(&mut world);
        world.run(60);
        world.host.ask(RequestCode::Arm);
        let refusals = say(&mut world, table::AskInfo {});
        assert_eq!(refusals, [(REQUEST, why)]);
        world.sensors = sound;
    }
}

#[test]
fn a_button_at_the_board_arms_as_well() {
    let mut world = world(0);
    world.until("the parameters", |world| world.host.is_accepted);
    world.sensors.signals = Signals::of_request(Request::Arm);
    world.step();
    assert!(output(&world).state.is_engaged());
}

#[test]
fn settings_are_reported_and_set_one_by_one_but_not_under_the_laws() {
    let mut world = world(0);
    world.until("the parameters", |world| world.host.is_accepted);
    let set = |setting, value| table::SetSetting { setting, value };
    assert_eq!(say(&mut world, set(SettingCode::LinkLost, 150_000)), []);
    let expected = table::Setting { setting: SettingCode::LinkLost, value: 150_000 };
    assert_eq!(world.host.others.pop(), Some(expected.into()));
    assert_eq!(say(&mut world, table::AskSetting { setting: SettingCode::LinkLost }), []);
    assert_eq!(world.host.others.pop(), Some(expected.into()));
    assert_eq!(say(&mut world, set(SettingCode::LinkLost, 1)), [(SET_SETTING, RefusalCode::Value)]);
    world.arm();
    assert_eq!(say(&mut world, set(SettingCode::LinkLost, 200_000)), [(SET_SETTING, RefusalCode::Busy)]);
    // It is in effect: after 150 ms of silence the host is lost.
    world.until("a word", |world| world.board.host_link.link().age(world.now).0 == 0);
    world.down.is_open = false;
    let lost = world.until("the loss", |world| matches!(output(world).state, State::Fallback { .. }));
    assert_eq!(lost, 151);
}

#[test]
fn the_board_says_what_it_is() {
    let mut world = ready(0);
    assert_eq!(say(&mut world, table::AskInfo {}), []);
    let Some(Message::Info(info)) = world.host.others.pop() else { panic!("no answer") };
    assert_eq!((info.name.bytes(), info.starts, info.capacity, info.set), (&b"in process"[..], 1, 16, 1));
}

#[test]
fn what_is_no_message_for_a_board_is_refused_by_its_kind() {
    let mut world = ready(0);
    let setpoint = table::Accepted { set: 1 };
    assert_eq!(say(&mut world, setpoint), [(0x41, RefusalCode::Message)]);
    world.host.refusals.clear();
    world.host.link.send(0x99, b"what is this").expect("there is room");
    world.host.link.send(SEGMENT, b"and this").expect("there is room");
    world.run(20);
    assert_eq!(world.host.refusals, [(0x99, RefusalCode::Message), (SEGMENT, RefusalCode::Message)]);
}

#[test]
fn a_request_gets_through_while_as_many_segments_are_ahead_as_there_is_room_for() {
    let mut world = world(40);
    world.arm();
    world.until("a full queue", |world| world.host.report.is_some_and(|report| report.room == 0));
    world.host.ask(RequestCode::Disarm);
    let ticks = world.until("the disarming", |world| !output(world).state.is_engaged());
    assert!(ticks <= 2, "{ticks}");
}

#[test]
fn a_host_that_sends_more_segments_than_there_is_room_for_loses_none() {
    let run = ibr_slot();
    let mut world = world(0);
    world.arm();
    (1..=all_moves().len()).for_each(|count| world.host.say(segment(count as u32)));
    for (position, ..) in &run.ticks {
        world.sensors = standing(*position, run.job.tools.first().spindle);
        world.step();
    }
    assert_eq!(world.host.refusals, []);
    assert_eq!(world.board.task.executed() as usize, run.segments.len());
}

#[test]
fn a_host_that_comes_and_goes_at_a_tapped_line_looks_on_and_changes_nothing() {
    let run = ibr_slot();
    let mut world = world(0);
    world.host.is_silent = true;
    world.board = crate::application::world::Board::supplied(Supply::Tap, 1, None);
    let handler = world.board.host_link.handler_mut();
    let page = page::write(&run.job, TappedLine::default()).expect("the job can be encoded");
    handler.load_page(&page, 7).expect("the job is sound");
    let (first, rule) = all_moves()[0];
    let rule = rule.map(|rule| &run.job.rules[rule]);
    assert!(handler.push(1, ActiveSegment::new(&first, rule, &run.job)));
    world.run(2_500);
    assert_eq!(world.host.report.map(|report| (report.in_work, report.set)), Some((Some(1), 7)));
    assert_eq!(say(&mut world, table::Begin { set: 9 }), [(0x10, RefusalCode::Message)]);
    assert_eq!(say(&mut world, table::Clear {}), [(0x21, RefusalCode::Message)]);
    assert_eq!(say(&mut world, segment(2)), [(SEGMENT, RefusalCode::Message)]);
    world.host.ask(RequestCode::Arm);
    world.until("the arming", |world| output(world).state.is_engaged());
    world.host.link.close();
    world.run(1_000);
    assert!(output(&world).state.is_engaged(), "a missing host is no loss");
    assert_eq!(world.board.host_link.handler().report().expect("a report").in_work, Some(1));
}

/// A payload that the schema allows, or nearly.
fn random_payload(fields: &[(&'static str, FieldType)], random: &mut fastrand::Rng) -> Vec<u8> {
    let mut payload = Vec::new();
    for (_, field) in fields {
        for _ in 0..field.count {
            let is_there = field.optional == Optional::Never || random.bool();
            if field.optional != Optional::Never {
                payload.push(u8::from(is_there));
            }
            let width = match field.name {
                "u16" | "i16" => 2,
                "u32" => 4,
                "u64" | "i64" | "Q40" | "Q46" | "Q62" => 8,
                _ => 1,
            };
            if is_there {
                let small = random.bool();
                payload.extend((0..width).map(|at| if small && at > 0 { 0 } else { random.u8(..) % 8 }));
            }
        }
    }
    payload
}

#[test]
fn whatever_a_host_says_the_board_answers_and_only_a_person_arms_it() {
    let mut random = fastrand::Rng::with_seed(7);
    let mut world = world(3);
    world.until("the parameters", |world| world.host.is_accepted);
    let mut answers = 0;
    for round in 0..20_000_u32 {
        let entry = &SCHEMA[random.usize(..SCHEMA.len())];
        let fields: Vec<_> = entry.fields.iter().map(|field| (field.name, field.field_type)).collect();
        // All but the one message that is a person's.
        if entry.kind != REQUEST {
            let _full = world.host.link.send(entry.kind, &random_payload(&fields, &mut random));
        }
        if round % 500 == 0 {
            send_set(&mut world, 1 + round);
        }
        let percent = world.step().feed_override.percent;
        assert!(percent <= 100 && !output(&world).state.is_engaged(), "{percent} %, {:?}", output(&world).state);
        answers += world.host.refusals.len() + world.host.others.len();
        (world.host.refusals, world.host.others) = (Vec::new(), Vec::new());
    }
    println!("{answers} answers");
    assert!(answers > 5_000);
}
