//! The application of a feed board, the same in process and on the chip.
//!
//! ```text
//! main loop:  bytes of the link -> HostLink -- commands (in order), notices (at once) --+      bytes of the link <- HostLink
//!                                                                                      v                             ^
//! each tick:  Sensors --------------------------------------------------------> ControlTask -> Output, to the lines   |
//!                                                                                      +---------- status ----------+
//! ```
//!
//! [`host_link::HostLink`] decodes, checks and prepares; [`control_task::ControlTask`] decides. Neither waits for the
//! other: three single-producer, single-consumer queues connect them. There is no clock and no I/O: `now` and bytes
//! are arguments. docs/board-safety.md lists each fault, its effect and its delay.

pub mod received_table;

pub mod buffers;

pub mod identity;

pub mod messages;

pub mod report;

pub mod replies;

pub mod sensors;

pub mod control_task;

pub mod board_settings;

pub mod dispatch;

pub mod command_handler;

pub mod host_link;
