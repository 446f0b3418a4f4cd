//! The example job with tables that the host sends with its moves.

use arcfeed_board_app::application::control_task::Supply;
use arcfeed_law::move_table::MoveTable;
use arcfeed_link::message::codes::RefusalCode;
use arcfeed_link::message::{Message, moves};
use arcfeed_model::job::Job;
use arcfeed_nc::segment::Segment;
use arcfeed_tests::recording::ibr_slot;

use crate::application::world::{Board, Channel, Host, World, standing};

/// Data that a host sends.
pub struct HostData {
    pub job: Job,
    /// Moves, each with the index of its rule.
    pub moves: Vec<(Segment, Option<usize>)>,
    /// Tables sent before the moves.
    pub tables: Vec<Option<MoveTable>>,
}

impl HostData {
    /// An armed board with this data behind channels of this latency, which lose so many frames of a thousand.
    pub fn world(&self, latency_ms: u64, lost_per_mille: u64) -> World {
        let channels = [1, 2].map(|seed| Channel::new(latency_ms, lost_per_mille, seed));
        let mut world = World::new(&self.job, &self.moves, channels);
        world.host.add_tables(&self.tables);
        world.arm();
        world
    }

    /// A board with the set, and with nothing to do.
    pub fn ready(&self) -> World {
        let mut world = World::new(&self.job, &[], [1, 2].map(|seed| Channel::new(0, 0, seed)));
        world.until("the parameters", |world| world.host.is_accepted);
        world
    }

    /// A board that taps its line, behind a host that says nothing by itself.
    pub fn tapped(&self) -> World {
        let mut world = self.ready();
        world.host = Host::new(2, &ibr_slot().job, &[]);
        world.host.is_silent = true;
        world.board = Board::supplied(Supply::Tap, 2, None);
        world.run(1_000);
        world
    }

    /// The same without the tables.
    pub fn without_tables(self) -> Self {
        HostData { tables: vec![None; self.tables.len()], ..self }
    }
}

/// Overrides of the example's positions.
pub fn trace(mut world: World) -> Vec<u8> {
    let run = ibr_slot();
    let mut trace = Vec::new();
    for (position, ..) in &run.ticks {
        world.sensors = standing(*position, run.job.tools.first().spindle);
        trace.push(world.step().feed_override.percent);
    }
    assert_eq!(world.host.refusals, []);
    assert_eq!(world.board.task.executed() as usize, run.segments.len());
    trace
}

/// An arc of the example, under a rule or none.
pub fn segment(count: u32, rule: Option<u8>) -> Message {
    let segment = ibr_slot().segments.iter().find(|segment| segment.arc().is_some()).expect("an arc");
    moves::encode(segment, count, rule).expect("it can be encoded").into()
}

/// What the board refuses of these messages: kind and reason.
pub fn say(world: &mut World, messages: &[Message]) -> Vec<(u8, RefusalCode)> {
    world.host.refusals.clear();
    messages.iter().for_each(|message| world.host.say(*message));
    world.run(20);
    world.host.refusals.clone()
}
