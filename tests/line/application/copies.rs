//! A line that gives back for ever what it carried before: its frames are whole and of this session, and no host sends them.

use arcfeed_firmware::supervisor::input::Source;
use arcfeed_firmware::supervisor::report::Alarm;
use arcfeed_firmware::supervisor::state::State;
use arcfeed_link::link::Loss;

use crate::application::faults::settled;
use crate::application::world::World;

/// Silence of the link's default, and a period to hear and one to act in.
const NOTICED_MS: u32 = 250 + 2;

fn running() -> World {
    let world = settled();
    assert_eq!((world.host.loss(), world.output.map(|output| output.state)), (None, Some(State::Running)));
    world
}

#[test]
fn a_host_that_is_only_a_recording_is_lost_within_the_time_of_a_silence() {
    let mut world = running();
    world.down.replays = true;
    let ticks = world.until("the loss", |world| world.output.is_some_and(|output| output.state != State::Running));
    let output = world.output.expect("it ticks");
    println!("noticed after {ticks} ms");
    assert!(matches!(output.state, State::Fallback { source: Source::Link, .. }), "{output:?}");
    assert!(ticks <= NOTICED_MS && output.alarm == Alarm::Latched, "{ticks} {output:?}");
    // For as long as it lasts: no person arms, and the override is the fallback's.
    world.run(5_000);
    let output = world.output.expect("it ticks");
    assert!(matches!(output.state, State::Fallback { .. }) && output.feed_override.percent == 100, "{output:?}");
}

#[test]
fn a_board_that_is_only_a_recording_is_lost_within_the_time_of_a_silence() {
    let mut world = running();
    world.up.replays = true;
    let ticks = world.until("the loss", |world| world.host.loss().is_some());
    println!("noticed after {ticks} ms");
    assert_eq!(world.host.loss(), Some(Loss::Silence));
    assert!(ticks <= NOTICED_MS, "{ticks}");
}
