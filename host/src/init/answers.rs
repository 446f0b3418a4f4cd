//! Values that a program does not contain, from the command line.

use std::str::FromStr;

use arcfeed_units::LengthUnit;

/// Given values for the job of a program.
#[derive(Clone, Debug, Default)]
pub struct Answers {
    /// Diameters of the tools.
    pub diameters: Vec<ForTool<Length>>,
    /// Numbers of teeth of the tools.
    pub teeth: Vec<ForTool<u16>>,
    /// Target feeds per tooth of the tools; for a tool without one, the programmed F is the target.
    pub feeds_per_tooth: Vec<ForTool<Length>>,
    /// Spindle speed where the program states none, rev/min.
    pub rev_per_min: Option<u32>,
    /// Largest feed of an outside arc, % of its programmed F; `None`: outside arcs keep their feed.
    pub max_percent: Option<u16>,
    /// Feed mode, as `mode` in `[override]` of a job.
    pub mode: Option<String>,
    /// Side of the contour on which the tools run.
    pub milling: Milling,
    /// Unit at power-on, for programs without G20 or G21.
    pub units: Option<LengthUnit>,
}

impl Answers {
    /// Value for a tool (T number): one given for this tool, otherwise one given for all tools, otherwise `None`.
    pub fn of<T: Clone>(values: &[ForTool<T>], tool: Option<i64>) -> Option<T> {
        let named = values.iter().find(|value| value.tool.is_some() && value.tool == tool);
        named.or(values.iter().find(|value| value.tool.is_none())).map(|value| value.value.clone())
    }
}

/// Side of the contour on which the tool runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Milling {
    /// Climb milling: with a spindle that turns clockwise (M3) the material is on the right of the path. Counter-clockwise arcs
    /// run inside a contour, clockwise ones outside.
    #[default]
    Climb,
    /// Conventional milling: the material is on the left.
    Conventional,
}

/// A value for one tool or for all: `T3=10` or `10`.
#[derive(Clone, Debug, PartialEq)]
pub struct ForTool<T> {
    /// T number; `None` for all tools.
    pub tool: Option<i64>,
    /// The value.
    pub value: T,
}

impl<T: FromStr> FromStr for ForTool<T>
where
    T::Err: std::fmt::Display,
{
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (tool, value) = match text.split_once('=') {
            Some((tool, value)) => {
                let number = tool.strip_prefix(['T', 't']).and_then(|number| number.parse().ok());
                (Some(number.ok_or("write T3=VALUE for one tool, or VALUE for all")?), value)
            }
            None => (None, text),
        };
        value.parse().map(|value| ForTool { tool, value }).map_err(|error: T::Err| error.to_string())
    }
}

/// Length as written: a number in the program's unit, or with a unit of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Length {
    number: f64,
    unit: Option<LengthUnit>,
}

impl Length {
    /// The length in TOML.
    pub fn to_toml(&self) -> String {
        match self.unit {
            None => format!("{:?}", self.number),
            Some(unit) => format!("\"{} {}\"", self.number, unit.label()),
        }
    }

    /// The length in millimetres; `unit` applies if the length names none.
    pub fn to_mm(&self, unit: LengthUnit) -> f64 {
        self.number * self.unit.unwrap_or(unit).mm()
    }
}

impl FromStr for Length {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (number, unit) = match text.trim() {
            text if text.ends_with("mm") => (text.trim_end_matches("mm"), Some(LengthUnit::Mm)),
            text if text.ends_with("in") => (text.trim_end_matches("in"), Some(LengthUnit::Inch)),
            text => (text, None),
        };
        let number = number.trim().parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
        let number = number.ok_or("write a positive length: 10, 10mm or 0.5in")?;
        Ok(Length { number, unit })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_for_one_tool_or_for_all() {
        let values: Vec<ForTool<Length>> = ["T3=10mm", "6.5"].map(|text| text.parse().unwrap()).into();
        let of = |tool| Answers::of(&values, tool).map(|length| length.to_toml());
        assert_eq!(
            (of(Some(3)), of(Some(4)), of(None)),
            (Some("\"10 mm\"".into()), Some("6.5".into()), Some("6.5".into()))
        );
        for wrong in ["X3=1", "T=1", "0", "-1", "nan", "10ft", ""] {
            assert!(wrong.parse::<ForTool<Length>>().is_err(), "{wrong}");
        }
    }
}
