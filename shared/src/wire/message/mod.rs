//! What the ends of the link say to each other: kinds and payloads.
//!
//! Normative: `docs/protocol.md#messages`. Whole numbers only, little endian; no NaN can be encoded. What firmware and host call by
//! types of their own travels as small codes, so that neither end needs the other's. [`table`] is the
//! one place where a message is described; its codec and its line of the schema are made from that.

pub mod schema;

pub mod fixed;

pub mod field;

pub mod codes;

pub mod table;

pub mod moves;

mod tools;

pub mod parameters;

pub mod sound;

pub mod staging;

pub mod page;

use super::settings::{LinkSettings, Role};
use crate::units::Span;

pub use table::{Message, SCHEMA};

/// What both ends must agree on; the link's hello carries it.
pub const SCHEMA_HASH: u32 = schema::hash(SCHEMA);

/// What host and board tell their ends of the link. A heartbeat every 30 ms: two of them may be lost before the board's supervisor takes
/// the host's words for stale, after 100 ms.
pub const fn link_settings(role: Role) -> LinkSettings {
    LinkSettings { heartbeat: Span::from_ms(30), ..LinkSettings::new(role, SCHEMA_HASH) }
}

#[cfg(test)]
mod tests;
