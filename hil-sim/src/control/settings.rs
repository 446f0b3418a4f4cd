//! What a control is set to: presets, and what each is made of.
//!
//! A value marked assumed is published nowhere that we know of; docs/control.md lists all of them.

use arcfeed_shared::machine::ArcClamp;
use arcfeed_shared::nc::settings as nc;
use arcfeed_shared::units::{LengthUnit, Micros, MmPerMin};

use crate::drives::limits::DriveLimits;
use crate::drives::servo::Servo;
use crate::drives::spindle::SpindleDrive;

use super::dynamics::Dynamics;
use super::line::LineSettings;

/// Settings of the control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlSettings {
    /// How blocks are read, and what the machine's canned cycles and reference points are set to.
    pub nc: nc::Settings,
    /// Work offsets and tool lengths at power-on.
    pub tables: nc::Tables,
    /// The serial line.
    pub line: LineSettings,
    /// Blocks read ahead of the one being executed.
    pub look_ahead: usize,
    /// What reading a block ahead takes. What is read ahead before the axes start costs none.
    pub block_processing: Micros,
    /// What the axes can do along the path, where nothing is known of the drives.
    pub dynamics: Dynamics,
    /// What each drive can do.
    pub drives: Option<DriveLimits>,
    /// How the axes follow; without it they are where they are commanded to.
    pub servo: Option<Servo>,
    /// How the spindle follows; without it it turns as the job has it, whatever the program says.
    pub spindle: Option<SpindleDrive>,
    /// The control's own clamp of the feed on arcs; a control without the function has none.
    pub arc_clamp: Option<ArcClamp>,
    /// Feed of cutting moves in dry run (parameter 1410).
    pub dry_run_feed: MmPerMin,
    /// Steps from the override input to its effect: the scan of the machine's ladder (8 ms, assumed).
    pub ladder_delay_steps: usize,
    /// How long after a stop the simulated operator presses cycle start; `None` if nobody stands there.
    pub operator_restart: Option<Micros>,
    /// The panel's switches at power-on.
    pub switches: Switches,
}

/// The switches of the operator's panel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Switches {
    /// Every block waits for cycle start.
    pub single_block: bool,
    /// M01 stops.
    pub optional_stop: bool,
    /// Which `/n` are skipped, bit n - 1; read when a block is read ahead, not when its turn comes.
    pub block_delete: u16,
    /// Cutting moves run at the dry run feed.
    pub dry_run: bool,
    /// OVC (G006 bit 4): the override counts as 100 %.
    pub override_cancel: bool,
}

/// The controls there are.
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

    /// The settings of this control, on a mid-size five-axis machine.
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
    /// A 16i-like control on a mid-size five-axis machine.
    pub fn fanuc_16i(unit: LengthUnit) -> Self {
        Preset::Fanuc16i.settings(unit)
    }
}

impl Switches {
    /// Whether the switch of a `/n` is on.
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
