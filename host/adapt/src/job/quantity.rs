//! Lengths as they are written in job files.

use arcfeed_units::LengthUnit;
use serde::Deserialize;
use serde::de::{Deserializer, Error};

use crate::toml_values::is_possible;

/// Length: a number in the file's units, or a string with a unit of its own (`"0.004 in"`, `"0.1 mm"`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    value: f64,
    unit: Option<LengthUnit>,
}

impl Quantity {
    /// Length in millimetres; `unit` applies if the quantity names none.
    pub fn to_mm(self, unit: LengthUnit) -> f64 {
        self.value * self.unit.unwrap_or(unit).mm()
    }

    /// The number, if it is written without a unit of its own.
    pub fn bare(self) -> Option<f64> {
        self.unit.is_none().then_some(self.value)
    }
}

/// Target feed of a law, as a job file gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TargetFeed {
    /// This feed per tooth for all moves.
    PerTooth(Quantity),
    /// `"programmed"`: the programmed F of each block is the target.
    Programmed,
}

impl<'de> Deserialize<'de> for TargetFeed {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match Written::deserialize(deserializer)? {
            Written::Text(text) if text == "programmed" => Ok(TargetFeed::Programmed),
            written => written.length().map(TargetFeed::PerTooth),
        }
    }
}

impl<'de> Deserialize<'de> for Quantity {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Written::deserialize(deserializer)?.length()
    }
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "a length must be a number or a string such as \"0.004 in\" or \"0.1 mm\"")]
enum Written {
    Whole(i64),
    Decimal(f64),
    Text(String),
}

impl Written {
    fn length<E: Error>(self) -> Result<Quantity, E> {
        match self {
            Written::Whole(value) => Ok(Quantity { value: value as f64, unit: None }),
            Written::Decimal(value) => Ok(Quantity { value, unit: None }),
            Written::Text(text) => with_unit(&text).ok_or_else(|| {
                E::custom(format!("`{text}` is no length; write for example \"0.004 in\" or \"0.1 mm\""))
            }),
        }
    }
}

fn with_unit(text: &str) -> Option<Quantity> {
    let (number, unit) = match text.trim() {
        text if text.ends_with("in") => (text.trim_end_matches("in"), LengthUnit::Inch),
        text if text.ends_with("mm") => (text.trim_end_matches("mm"), LengthUnit::Mm),
        _ => return None,
    };
    let value = number.trim().parse().ok().filter(|value| is_possible(*value))?;
    Some(Quantity { value, unit: Some(unit) })
}
