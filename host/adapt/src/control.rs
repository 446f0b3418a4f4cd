//! Settings of a control: a preset, and a TOML file with the differences of one machine.
//!
//! ```toml
//! unit = "mm"                          # of all lengths here, and in effect at power-on; "inch" or "mm"
//! decimals = "calculator"              # or "least-increment": X1000 is 1000 mm, or 1 mm
//! arc_centers = "absolute"             # G90.1 at power-on; "incremental": G91.1; without it the control has neither
//! delete = [1]                         # block-delete switches that are on
//! peck_return = 1.0                    # parameter 5114, G73
//! peck_clearance = 1.0                 # parameter 5115, G83
//! start_up = "A"                       # parameter 5003, SUP: start-up and cancel of G41 and G42, or "B"
//! compensation_blocks = 3              # parameter 19625, 3 to 8: blocks read together under G41 and G42
//! compensation = "control"             # D has the tool's radius; "wear": only its wear
//! inside_arc_least = 25                # parameter 1710, %: under G41 and G42 the control reduces F on inside arcs, down to this
//! [work]                               # origins in machine coordinates; EXT, G54 to G59, G54.1P1 to G54.1P48
//! "G54" = { X = -300.0, Y = -200.0, Z = -400.0 }
//! [length]                             # H number to length
//! 1 = 120.5
//! [radius]                             # D number to radius
//! 1 = 5.0
//! [radius_wear]                        # D number to what is added to the radius
//! 1 = -0.02
//! [reference]                          # machine coordinates of the first to fourth reference point
//! 1 = { Z = 0.0 }
//! ```

use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::path::Path;

use arcfeed_nc::block::Reading;
use arcfeed_nc::motion::Pose;
use arcfeed_nc::settings::{
    ArcCenters, COMPENSATION_BLOCKS_MAX, COMPENSATION_BLOCKS_MIN, CompensationSettings, CompensationType, Decimals,
    OFFSETS, Preset, SYSTEMS, Settings, StartUp, Tables,
};
use arcfeed_units::{LengthUnit, MicroDeg, Nm};
use serde::Deserialize;
use toml::Spanned;

use crate::files;
use crate::place::place;
use crate::toml_reader;
use crate::toml_values::with_key;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct SettingsFile {
    unit: Option<Unit>,
    decimals: Option<Convention>,
    arc_centers: Option<CenterConvention>,
    #[serde(default = "no_switches")]
    delete: Spanned<Vec<u8>>,
    peck_return: Option<f64>,
    peck_clearance: Option<f64>,
    start_up: Option<StartUpType>,
    compensation_blocks: Option<Spanned<u8>>,
    compensation: Option<RadiusConvention>,
    inside_arc_least: Option<Spanned<u8>>,
    #[serde(default)]
    work: BTreeMap<Spanned<String>, Axes>,
    #[serde(default)]
    length: BTreeMap<Spanned<String>, f64>,
    #[serde(default)]
    radius: BTreeMap<Spanned<String>, f64>,
    #[serde(default)]
    radius_wear: BTreeMap<Spanned<String>, f64>,
    #[serde(default)]
    reference: BTreeMap<Spanned<String>, Axes>,
}

fn no_switches() -> Spanned<Vec<u8>> {
    Spanned::new(0..0, Vec::new())
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Unit {
    Inch,
    Mm,
}

/// Start-up of cutter compensation, by its letter in the manuals.
#[derive(Clone, Copy, Debug, Deserialize)]
enum StartUpType {
    A,
    B,
}

/// Meaning of the radius of a D, with the words of CAM systems.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum RadiusConvention {
    Control,
    Wear,
}

/// Meaning of numbers without a decimal point.
#[derive(Clone, Copy, Debug, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Convention {
    /// X1000 is 1 mm
    LeastIncrement,
    /// X1000 is 1000 mm
    Calculator,
}

/// Point from which I, J, K are counted, on a control with G90.1 and G91.1.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CenterConvention {
    /// The arc's start.
    Incremental,
    /// The program's origin.
    Absolute,
}

/// Conventions of the control that a job or an option states; they replace those of the settings file. `None`: not stated.
#[derive(Clone, Copy, Debug, Default)]
pub struct Conventions {
    /// Meaning of numbers without a decimal point.
    pub decimals: Option<Convention>,
    /// Reference of I, J, K.
    pub arc_centers: Option<CenterConvention>,
}

impl Conventions {
    /// Changes the settings of a control.
    pub fn apply(self, settings: &mut Settings) {
        settings.decimals = self.decimals.map_or(settings.decimals, Decimals::from);
        settings.arc_centers = self.arc_centers.map_or(settings.arc_centers, ArcCenters::from);
    }
}

impl From<CenterConvention> for ArcCenters {
    fn from(convention: CenterConvention) -> Self {
        match convention {
            CenterConvention::Incremental => ArcCenters::Incremental,
            CenterConvention::Absolute => ArcCenters::Absolute,
        }
    }
}

impl Convention {
    /// Name of the convention in job and settings files.
    pub const fn name(self) -> &'static str {
        match self {
            Convention::LeastIncrement => "least-increment",
            Convention::Calculator => "calculator",
        }
    }
}

impl From<Convention> for Decimals {
    fn from(convention: Convention) -> Self {
        match convention {
            Convention::LeastIncrement => Decimals::LeastIncrement,
            Convention::Calculator => Decimals::Calculator,
        }
    }
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[allow(non_snake_case, reason = "axes are named as in a program")]
struct Axes {
    X: f64,
    Y: f64,
    Z: f64,
    A: f64,
    B: f64,
    C: f64,
}

/// Settings and offset tables of a control, as loaded from a preset and a file.
#[derive(Debug)]
pub struct LoadedSettings {
    /// Settings of the control (dialect, options).
    pub settings: Settings,
    /// Offsets stored in the control: work offsets, tool lengths and radii, reference points.
    pub tables: Tables,
    /// The settings file states the unit at power-on.
    pub states_unit: bool,
}

/// Settings and offsets of a preset, with the changes of the settings file if there is one.
///
/// # Errors
/// Describes the fault in the file.
pub fn load(preset: Preset, reading: Reading, file: Option<&Path>) -> Result<LoadedSettings, String> {
    let Some(path) = file else {
        let settings = Settings::preset(preset, LengthUnit::Inch, reading);
        return Ok(LoadedSettings { settings, tables: Tables::default(), states_unit: false });
    };
    let in_file = |error: String| format!("{}: {}", path.display(), error.trim_end());
    let text = files::read_to_string(path).map_err(|error| in_file(error.to_string()))?;
    parse(preset, reading, &text).map_err(|(offset, message)| {
        let [line, column] = place(&text, offset);
        format!("{}:{line}:{column}: {}", path.display(), with_key(&text, offset, &message))
    })
}

fn parse(preset: Preset, reading: Reading, text: &str) -> Result<LoadedSettings, (usize, String)> {
    let file: SettingsFile = toml_reader::read(text)?;
    let unit = match file.unit {
        Some(Unit::Mm) => LengthUnit::Mm,
        Some(Unit::Inch) | None => LengthUnit::Inch,
    };
    let length = |value: f64| Nm::from_mm(value * unit.mm());
    let pose = |axes: &Axes| Pose {
        linear: [axes.X, axes.Y, axes.Z].map(length),
        rotary: [axes.A, axes.B, axes.C].map(MicroDeg::from_deg),
    };
    let mut settings = Settings::preset(preset, unit, reading);
    let mut tables = Tables::default();
    Conventions { decimals: file.decimals, arc_centers: file.arc_centers }.apply(&mut settings);
    settings.peck_return = file.peck_return.map_or(settings.peck_return, length);
    settings.peck_clearance = file.peck_clearance.map_or(settings.peck_clearance, length);
    for &switch in file.delete.as_ref() {
        let bit = (1..=9).contains(&switch).then(|| 1 << switch);
        let offset = file.delete.span().start;
        settings.delete_switches |= bit.ok_or((offset, format!("no switch {switch}, they are 1 to 9")))?;
    }
    for (name, axes) in &file.work {
        let wrong = || (name.span().start, "no such coordinate system: EXT, G54 to G59, G54.1P1 to G54.1P48".into());
        *system(&mut tables, name.as_ref()).ok_or_else(wrong)? = pose(axes);
    }
    settings.compensation = compensation(&file, settings.compensation)?;
    for (name, value) in &file.length {
        tables.lengths[offset_index(name)?][0] = length(*value);
    }
    for (place, values) in [&file.radius, &file.radius_wear].into_iter().enumerate() {
        for (name, value) in values {
            tables.radii[offset_index(name)?][place] = length(*value);
        }
    }
    for (name, axes) in &file.reference {
        let slot: Option<usize> = name.as_ref().parse().ok().filter(|number| (1..=4).contains(number));
        let wrong = || (name.span().start, "no such reference point: they are 1 to 4".into());
        settings.reference[slot.ok_or_else(wrong)? - 1] = pose(axes);
    }
    Ok(LoadedSettings { settings, tables, states_unit: file.unit.is_some() })
}

fn compensation(file: &SettingsFile, preset: CompensationSettings) -> Result<CompensationSettings, (usize, String)> {
    const BLOCKS: RangeInclusive<u8> = COMPENSATION_BLOCKS_MIN..=COMPENSATION_BLOCKS_MAX;
    let start_up = match file.start_up {
        Some(StartUpType::A) => StartUp::A,
        Some(StartUpType::B) => StartUp::B,
        None => preset.start_up,
    };
    let blocks = file.compensation_blocks.as_ref();
    if let Some(wrong) = blocks.filter(|blocks| !BLOCKS.contains(blocks.as_ref())) {
        let found = wrong.as_ref();
        return Err((wrong.span().start, format!("{found} blocks: a control reads 3 to 8 of them together")));
    }
    let of_program = match file.compensation {
        Some(RadiusConvention::Control) => CompensationType::Control,
        Some(RadiusConvention::Wear) => CompensationType::Wear,
        None => preset.of_program,
    };
    let least = file.inside_arc_least.as_ref();
    if let Some(wrong) = least.filter(|least| !(1..=100).contains(least.as_ref())) {
        return Err((wrong.span().start, format!("{} %: parameter 1710 is 1 to 100 %", wrong.as_ref())));
    }
    Ok(CompensationSettings {
        start_up,
        blocks: blocks.map_or(preset.blocks, |blocks| *blocks.as_ref()),
        of_program,
        inside_arc_least_percent: least.map(|least| *least.as_ref()).or(preset.inside_arc_least_percent),
    })
}

/// Index of an offset number.
fn offset_index(name: &Spanned<String>) -> Result<usize, (usize, String)> {
    let number = name.as_ref().parse().ok().filter(|number: &usize| (1..=OFFSETS).contains(number));
    let wrong = || (name.span().start, format!("no such offset number: they are 1 to {OFFSETS}"));
    Ok(number.ok_or_else(wrong)? - 1)
}

fn system<'a>(tables: &'a mut Tables, name: &str) -> Option<&'a mut Pose> {
    if name == "EXT" {
        return Some(&mut tables.external);
    }
    let index = match name.strip_prefix("G54.1P") {
        Some(number) => 5 + number.parse::<usize>().ok().filter(|number| *number > 0)?,
        None => ["G54", "G55", "G56", "G57", "G58", "G59"].iter().position(|known| *known == name)?,
    };
    tables.systems.get_mut(index).filter(|_| index < SYSTEMS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_gives_offsets_lengths_and_conventions() {
        let text = "unit = 'mm'\nstart_up = 'B'\ncompensation_blocks = 5\ncompensation = 'wear'\ninside_arc_least = 25\ndecimals = 'calculator'\narc_centers = 'absolute'\ndelete = [1, 3]\n[work]\n'G54' = { X = -300.0 }\n\
                    'G54.1P48' = { B = 90.0 }\n[length]\n1 = 120.5\n[radius]\n7 = 5.0\n[radius_wear]\n7 = -0.02\n[reference]\n2 = { Z = 5.0 }\n";
        let loaded = parse(Preset::Fanuc0i, Reading::Lenient, text).unwrap();
        let LoadedSettings { settings, tables, states_unit } = loaded;
        assert!(states_unit);
        assert_eq!((settings.unit, settings.decimals), (LengthUnit::Mm, Decimals::Calculator));
        assert_eq!((settings.delete_switches, settings.arc_centers), (0b1010, ArcCenters::Absolute));
        assert_eq!(tables.systems[0].linear[0], Nm::from_mm(-300.0));
        assert_eq!(tables.systems[53].rotary[1], MicroDeg(90_000_000));
        assert_eq!((tables.length(1), tables.radius(7)), (Nm::from_mm(120.5), Nm::from_mm(4.98)));
        assert_eq!(
            settings.compensation,
            CompensationSettings {
                start_up: StartUp::B,
                blocks: 5,
                of_program: CompensationType::Wear,
                inside_arc_least_percent: Some(25)
            }
        );
        assert_eq!(settings.reference[1].linear[2], Nm::from_mm(5.0));
    }

    #[test]
    fn what_a_control_does_not_have_is_named() {
        for (text, named) in [
            ("[work]\nG60 = { X = 1.0 }", "G60"),
            ("[work]\n'G54.1P49' = { X = 1.0 }", "P49"),
            ("[length]\n401 = 1.0", "401"),
            ("[radius]\n0 = 1.0", "0"),
            ("[radius_wear]\nD1 = 1.0", "D1"),
            ("compensation_blocks = 9", "9"),
            ("start_up = 'C'", "C"),
            ("compensation = 'computer'", "computer"),
            ("inside_arc_least = 0", "1710"),
            ("inside_arc_least = 101", "1710"),
            ("delete = [0]", "0"),
            ("[reference]\n5 = { X = 1.0 }", "5"),
            ("colour = 1", "colour"),
            ("[length]\n1 = nan", "`length.1 = nan`"),
        ] {
            let (offset, message) = parse(Preset::Fanuc16i, Reading::Lenient, text).unwrap_err();
            let message = with_key(text, offset, &message);
            assert!(message.contains(named), "{message}");
        }
    }
}
