//! Settings of the control, and presets.
//!
//! A value marked assumed is not published, as far as we know; docs/control.md lists all of them.

use arcfeed_model::machine::ArcClamp;
use arcfeed_nc::settings as nc;
use arcfeed_units::{LengthUnit, Micros, MmPerMin};

use crate::drives::limits::DriveLimits;
use crate::drives::servo::Servo;
use crate::drives::spindle::SpindleDrive;

use super::dynamics::Dynamics;
use super::line::LineSettings;

/// Settings of the simulated control and its machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlSettings {
    /// Settings for reading blocks, canned cycles and reference points.
    pub nc: nc::Settings,
    /// Work offsets and tool lengths at power-on.
    pub tables: nc::Tables,
    /// Settings of the serial (DNC) line.
    pub line: LineSettings,
    /// Number of blocks that the control reads ahead of the one in execution.
    pub look_ahead: usize,
    /// Time that the control takes to read one block ahead; 0 for blocks read before the axes start.
    pub block_processing: Micros,
    /// Limits of the axes along the path, used without data of the drives.
    pub dynamics: Dynamics,
    /// Limits of each axis, and the corner tolerance; `None` without data of the drives.
    pub drives: Option<DriveLimits>,
    /// Position loops of the axes; without them the axes have their commanded positions.
    pub servo: Option<Servo>,
    /// Spindle drive; without it the spindle turns at the job's speed, whatever the program says.
    pub spindle: Option<SpindleDrive>,
    /// The control's own clamp of the feed on arcs; a control without the function has none.
    pub arc_clamp: Option<ArcClamp>,
    /// Feed of cutting moves in dry run (parameter 1410).
    pub dry_run_feed: MmPerMin,
    /// Steps from the override input to its effect: the scan of the machine's ladder (8 ms, assumed).
    pub ladder_delay_steps: usize,
    /// Time after a stop at which the simulated operator presses cycle start; `None` without an operator.
    pub operator_restart: Option<Micros>,
    /// The panel's switches at power-on.
    pub switches: Switches,
}

/// Switches of the operator's panel; true is on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Switches {
    /// Single block: every block waits for cycle start.
    pub single_block: bool,
    /// Optional stop: M01 stops the program.
    pub optional_stop: bool,
    /// Block delete: the switches `/n` that are on, as bits n - 1; evaluated when a block is read ahead, not when it is executed.
    pub block_delete: u16,
    /// Dry run: cutting moves run at the dry run feed.
    pub dry_run: bool,
    /// Override cancel (OVC, G006 bit 4): the override counts as 100 %.
    pub override_cancel: bool,
}

/// Model of control for which settings are built in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// Series 16i.
    Fanuc16i,
    /// Series 0i.
    Fanuc0i,
    /// Series 31i.
    Fanuc31i,
}

impl Preset {
    fn of_reader(self) -> nc::Preset {
        match self {
            Preset::Fanuc16i => nc::Preset::Fanuc16i,
            Preset::Fanuc0i => nc::Preset::Fanuc0i,
            Preset::Fanuc31i => nc::Preset::Fanuc31i,
        }
    }

    /// Settings of this control on a mid-size five-axis machine.
    pub fn settings(self, unit: LengthUnit) -> ControlSettings {
        let line = LineSettings::default();
        let (line, look_ahead, block_processing) = match self {
            Preset::Fanuc16i => (line, 15, Micros(2_000)),
            Preset::Fanuc0i => {
                (LineSettings { buffer: 512, xoff_below: 128, xon_above: 384, ..line }, 12, Micros(4_000))
            }
            Preset::Fanuc31i => {
                (LineSettings { buffer: 4_096, xoff_below: 1_024, xon_above: 3_072, ..line }, 200, Micros(1_000))
            }
        };
        let nc = nc::Settings::preset(self.of_reader(), unit, nc::Reading::Lenient);
        ControlSettings {
            nc: nc::Settings { scope: nc::Scope::Everything, ..nc },
            tables: nc::Tables::default(),
            line,
            look_ahead,
            block_processing,
            dynamics: Dynamics::default(),
            drives: None,
            servo: None,
            spindle: None,
            arc_clamp: None,
            dry_run_feed: MmPerMin(2_000.0),
            ladder_delay_steps: 8,
            operator_restart: Some(Micros::from_ms(1_000)),
            switches: Switches::default(),
        }
    }
}

impl ControlSettings {
    /// Settings of a 16i-like control on a mid-size five-axis machine.
    pub fn fanuc_16i(unit: LengthUnit) -> Self {
        Preset::Fanuc16i.settings(unit)
    }
}

impl Switches {
    /// Whether the block delete switch of this number (`/n`) is on.
    pub fn deletes(&self, switch: u8) -> bool {
        self.block_delete.checked_shr(u32::from(switch.saturating_sub(1))).is_some_and(|bits| bits & 1 == 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_block_delete_has_its_switch() {
        let switches = Switches { block_delete: 0b10, ..Switches::default() };
        assert_eq!([1, 2, 3, 9].map(|switch| switches.deletes(switch)), [false, true, false, false]);
    }

    #[test]
    fn every_preset_stops_its_sender_before_its_buffer_is_full_and_restarts_it_later() {
        for preset in [Preset::Fanuc16i, Preset::Fanuc0i, Preset::Fanuc31i] {
            let line = preset.settings(LengthUnit::Mm).line;
            assert!(line.after_dc3_max as usize <= line.xoff_below, "{preset:?}");
            assert!(line.xoff_below < line.xon_above && line.xon_above < line.buffer, "{preset:?}");
        }
    }
}
