//! The parts of the STM32F405's image that know no register, on the host: why it started, its panel, its guard.

use arcfeed_firmware::active::ActiveSegment;
use arcfeed_firmware::controller;
use arcfeed_firmware::supervisor::input::{Freshness, Input};
use arcfeed_firmware::supervisor::signals::{BoardFault, Request, Signals};
use arcfeed_firmware::supervisor::state::{Disarm, State};
use arcfeed_model::job::Job;
use arcfeed_nc::machining::ToolInSpindle;
use arcfeed_nc::modal::Pose;
use arcfeed_nc::segment::Segment;
use arcfeed_tests::recording::{Recording, ibr_slot};
use arcfeed_units::{Nm, Span};

use guard::{Guard, Prepared};
use heapless::spsc::{Producer, Queue};
use panel::{AT_START, ENCODERS_SOUND, Panel};

#[path = "../../firmware/boards/stm32f405/src/reset_cause.rs"]
mod reset_cause;

#[path = "../../firmware/boards/stm32f405/src/panel.rs"]
mod panel;

#[path = "../../firmware/boards/stm32f405/src/guard.rs"]
mod guard;

const TICK: Span = Span::from_ms(1);
/// From 0 % to 100 % by the slew of 50 %/s, and some time to arm.
const BEFORE: usize = 2_500;
/// An encoder counts whole micrometres.
const COUNT_NM: i64 = 1_000;

/// A position as an encoder has it.
fn counted(position: &Pose) -> Pose {
    Pose { linear: position.linear.map(|Nm(nm)| Nm(nm / COUNT_NM * COUNT_NM)), ..*position }
}

/// Only the position is an input.
fn quiet(job: &Job, position: Pose) -> Input {
    Input::of(controller::Measurement { position: Some(position), spindle: job.tools.first().spindle, dt: TICK })
}

fn request(request: Request) -> Signals {
    Signals::of_request(request)
}

/// Blocks ahead, as in the image.
type Blocks = Queue<Prepared, 8>;

/// Armed at the program's zero and at 100 %, no block yet.
fn armed<'q>(job: &Job, blocks: &'q mut Blocks) -> (Guard<'q>, Producer<'q, Prepared>) {
    let (ahead, blocks) = blocks.split();
    let mut guard = Guard::new(job, blocks).expect("the limits are sound");
    for tick in 0..BEFORE {
        let signals = if tick == BEFORE - 100 { request(Request::Arm) } else { Signals::NONE };
        guard.tick(&Input { signals, ..quiet(job, Pose::default()) });
    }
    assert!(guard.is_engaged());
    (guard, ahead)
}

fn prepared(segment: &Segment, job: &Job) -> ActiveSegment {
    let rule = job.rule_for(segment, ToolInSpindle::Unstated).map(|(_, rule)| rule);
    ActiveSegment::new(segment, rule, job)
}

#[test]
fn the_guard_finds_the_blocks_by_position_and_outputs_the_overrides_of_a_notified_controller() {
    let Recording { job, segments, ticks } = ibr_slot();
    let mut blocks = Blocks::new();
    let (mut guard, mut queue) = armed(job, &mut blocks);
    let mut ahead = segments.iter();
    let (mut same, mut highest, mut state) = (0, 0, State::Idle);
    for (position, given, _) in ticks {
        if queue.ready()
            && let Some(segment) = ahead.next()
        {
            queue.enqueue((0, prepared(segment, job))).expect("there is room");
        }
        let output = guard.tick(&quiet(job, counted(position)));
        let found = output.feed_override.percent;
        assert!(found <= given + 1, "{found} % where {given} % is right");
        same += usize::from(found == *given);
        highest = highest.max(found);
        state = output.state;
    }
    println!("{same} of {} ticks the same, none above by more than 1 %, highest {highest} %", ticks.len());
    assert!(ahead.next().is_none(), "blocks are left");
    assert_eq!((queue.len(), state), (0, State::Armed));
    assert!(highest > 100);
    // Only at a change of block, which the position shows some ticks from the notification.
    assert!(same * 1_000 > ticks.len() * 999);
}

#[test]
fn a_fault_is_0_percent_at_once_and_until_a_person_resets() {
    let Recording { job, segments, .. } = ibr_slot();
    let mut blocks = Blocks::new();
    let (mut guard, mut queue) = armed(job, &mut blocks);
    queue.enqueue((0, prepared(&segments[0], job))).expect("there is room");
    let at_zero = quiet(job, Pose::default());
    assert_eq!(guard.tick(&at_zero).feed_override.percent, 100);
    let signals = Signals::of_fault(BoardFault::Hardware);
    assert_eq!(guard.tick(&Input { signals, ..at_zero }).feed_override.percent, 0);
    assert!((0..1_000).all(|_| guard.tick(&at_zero).feed_override.percent == 0));
    guard.tick(&Input { signals: request(Request::Reset), ..at_zero });
    assert!((0..100).all(|_| guard.tick(&at_zero).state == State::Idle));
}

#[test]
fn a_program_begun_anew_is_taken_up_from_its_first_block() {
    let Recording { job, segments, .. } = ibr_slot();
    let mut blocks = Blocks::new();
    let (mut queue, consumer) = blocks.split();
    let mut guard = Guard::new(job, consumer).expect("the limits are sound");
    let at_zero = quiet(job, Pose::default());
    // As at power-on: the block is there before anybody said where the axes are.
    queue.enqueue((guard.run(), prepared(&segments[0], job))).expect("there is room");
    let nowhere = Freshness { age: Span(u32::MAX), invalid_in_row: 0 };
    guard.tick(&Input { position: nowhere, ..at_zero });
    guard.restart();
    guard.tick(&at_zero);
    assert_eq!(queue.len(), 0, "blocks of the run before are forgotten");
    queue.enqueue((guard.run(), prepared(&segments[0], job))).expect("there is room");
    guard.tick(&at_zero);
    let output = guard.tick(&Input { signals: request(Request::Arm), ..at_zero });
    assert_eq!((output.state, output.refusal), (State::Armed, None));
    assert!(matches!(guard.tick(&at_zero).state, State::Running | State::Inhibited { .. }));
}

#[test]
fn why_the_chip_started_is_read_from_its_flags() {
    // RM0090, RCC_CSR: after power-on 0x0E00_0000, after the reset pin 0x0400_0000; each adds its own to the pin's.
    for (csr, fault) in [
        (0x0E00_0000, None),
        (0x0400_0000, None),
        (0x1400_0000, None),
        (0x2400_0000, Some(BoardFault::Watchdog)),
        (0x4400_0000, Some(BoardFault::Watchdog)),
        (0x0600_0000, Some(BoardFault::Hardware)),
        (0x2E00_0000, Some(BoardFault::Watchdog)),
    ] {
        assert_eq!(reset_cause::fault(csr), fault, "{csr:#x}");
    }
}

/// The panel of the board's README: contacts by their pin on port B.
const ZERO: u16 = 1 << 1;
const ARM: u16 = 1 << 13;
const DISARM: u16 = 1 << 14;
const RESET: u16 = 1 << 15;
const LADDER: u16 = 0x1F00;
/// Nothing pressed, the ladder says nothing, the encoders are sound.
const QUIET: u16 = ENCODERS_SOUND | LADDER | DISARM;

#[test]
fn every_open_contact_of_the_ladder_is_its_condition() {
    let ladder = [
        (1 << 8, Signals::FEED_HOLD),
        (1 << 9, Signals::RAPID),
        (1 << 10, Signals::TAPPING),
        (1 << 11, Signals::THREADING),
        (1 << 12, Signals::CUTTER_COMPENSATION),
    ];
    assert_eq!(Panel::default().read(QUIET).signals, Signals::NONE);
    for (contact, condition) in ladder {
        assert_eq!(Panel::default().read(QUIET & !contact).signals, condition);
    }
    let all = ladder.iter().fold(Signals::NONE, |all, (_, condition)| all.with(*condition));
    // The wire of disarm is open as well.
    let all = all.with(request(Request::Disarm));
    assert_eq!(Panel::default().read(AT_START).signals, all);
}

#[test]
fn a_button_stuck_since_the_start_asks_for_nothing() {
    let mut panel = Panel::default();
    assert!(panel.read(AT_START).signals.asks(Request::Disarm));
    for _ in 0..10 {
        let said = panel.read(QUIET | ARM | RESET | ZERO);
        assert_eq!((said.signals, said.zero_now, said.reset_now), (Signals::NONE, false, false));
    }
    panel.read(QUIET);
    assert_eq!(panel.read(QUIET | ARM).signals, request(Request::Arm));
}

#[test]
fn buttons_are_signals_of_their_own_for_as_long_as_they_are_held() {
    let mut panel = Panel::default();
    panel.read(QUIET);
    let both = request(Request::Arm).with(request(Request::Reset));
    assert!((0..10).all(|_| panel.read(QUIET | ARM | RESET).signals == both));
    assert_eq!(panel.read(QUIET).signals, Signals::NONE);
}

#[test]
fn while_disarm_is_open_arm_does_not_count_and_must_be_let_go_first() {
    let mut panel = Panel::default();
    panel.read(QUIET);
    for closed in [QUIET | ARM, QUIET] {
        assert_eq!(panel.read(closed & !DISARM).signals, request(Request::Disarm));
    }
    assert_eq!(panel.read((QUIET | ARM) & !DISARM).signals, request(Request::Disarm));
    assert_eq!(panel.read(QUIET | ARM).signals, Signals::NONE);
    panel.read(QUIET);
    assert_eq!(panel.read(QUIET | ARM).signals, request(Request::Arm));
    // A cut wire of all contacts.
    assert!(panel.read(0).signals.asks(Request::Disarm));
}

#[test]
fn a_disarm_wire_that_stays_cut_keeps_the_guard_off() {
    let job = &ibr_slot().job;
    let mut blocks = Blocks::new();
    let ((mut guard, _), mut panel) = (armed(job, &mut blocks), Panel::default());
    let mut tick = |closed| {
        let signals = panel.read(closed).signals;
        guard.tick(&Input { signals, ..quiet(job, Pose::default()) }).state
    };
    tick(QUIET);
    for press in 0..10 {
        let arm = if press % 2 == 0 { ARM } else { 0 };
        assert_eq!(tick((QUIET | arm) & !DISARM), State::Disarmed { by: Disarm::Request }, "press {press}");
    }
    tick(QUIET);
    assert_eq!(tick(QUIET | ARM), State::Armed);
}

#[test]
fn zero_and_reset_count_once_a_press() {
    let mut panel = Panel::default();
    panel.read(QUIET);
    let presses = [QUIET | ZERO, QUIET | ZERO, QUIET, QUIET | RESET, QUIET | RESET | ZERO];
    let said = presses.map(|closed| panel.read(closed)).map(|said| (said.zero_now, said.reset_now));
    assert_eq!(said, [(true, false), (false, false), (false, false), (false, true), (true, false)]);
}
