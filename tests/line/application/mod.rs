//! The board application (`firmware::application`) in process, between a host at the other end of its link and a machine.
//!
//! `host_data.rs` has the example job with tables that come with its moves. `example.rs` runs the example job through it, `along.rs`
//! one whose engaged arcs come with each move, `feeds.rs` one whose feeds do. `restarts.rs` restarts either side at random points,
//! `schedules.rs` corrupts the line, `faults.rs` measures the times that `docs/board-safety.md` quotes, `copies.rs` replays recorded
//! frames, `command_handler.rs` asks for what is refused, `document.rs` compares `docs/protocol.md` with the messages.

mod world;

mod host_data;

mod example;

mod along;
mod feeds;

mod command_handler;

mod restarts;

mod schedules;

mod faults;

mod copies;

mod document;
