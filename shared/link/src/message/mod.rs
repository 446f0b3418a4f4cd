//! Messages of the link: kinds and payloads.
//!
//! Normative: `docs/protocol.md#messages`. Whole numbers only, little endian; NaN cannot be encoded. Types of firmware
//! and host are sent as small codes, so that neither end needs the types of the other. [`table`] is the only
//! description of the messages; it generates the codecs and the schema.

pub mod schema;

pub mod fixed;

pub mod field;

pub mod codes;

pub mod table;

pub mod moves;

mod tools;

pub mod parameters;

pub mod validation;

pub mod staging;

pub mod page;

pub mod prepared;

use super::settings::{LinkSettings, Role};
use arcfeed_units::Span;

pub use table::{Message, SCHEMA};

/// Hash of all messages and their fields, on which both ends must agree: the link's hello carries it.
pub const SCHEMA_HASH: u32 = schema::hash(SCHEMA);

/// Settings of the link between host and board, for this end. With a heartbeat of 30 ms, two may be lost before the
/// board considers the host stale, after 100 ms.
pub const fn link_settings(role: Role) -> LinkSettings {
    LinkSettings { heartbeat: Span::from_ms(30), ..LinkSettings::new(role, SCHEMA_HASH) }
}

#[cfg(test)]
mod tests;
