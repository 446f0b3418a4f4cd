//! Tool and spindle speed as the program has commanded them so far. A feed law governs a move only if both match the
//! job.
//!
//! T selects a tool; M6 puts it into the spindle and stops the spindle. If the block of the M6 has a T that differs
//! from the one selected before, it is unknown which of the two is loaded. M3, M4, M13 and M14 start the spindle; M5,
//! M19, M2 and M30 stop it. Other M codes depend on the machine's ladder and change nothing here.

use super::block::Block;

/// Tool in the spindle, as far as the program has commanded it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ToolInSpindle {
    /// No M6 so far: the tool that the operator has loaded.
    #[default]
    Unstated,
    /// The tool with this T number.
    Number(i64),
    /// Not known: the program has commanded M6 without a T before it, or with a T in the block of the M6 that differs
    /// from the one selected before.
    Unknown,
}

/// Spindle speed that the program has commanded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpindleCommand {
    /// The program has stated no S so far, and has not stopped the spindle: the operator sets the speed.
    #[default]
    Unstated,
    /// Stopped: by an M code, by S0, or because the program has given an S but has not started the spindle.
    Stopped,
    /// Running at this speed, rev/min, in either sense.
    RevPerMin(i64),
}

/// Tool in the spindle and spindle speed at a block, as the program has commanded them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Machining {
    /// Tool in the spindle.
    pub tool: ToolInSpindle,
    /// Commanded spindle speed.
    pub spindle: SpindleCommand,
}

/// State commanded by the T and M words of the program so far: the selected tool, the tool in the spindle, and
/// whether the spindle turns. The speed is stored in [`super::modal::Modal::spindle`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MachiningState {
    selected: Option<i64>,
    tool: ToolInSpindle,
    is_on: Option<bool>,
}

impl MachiningState {
    /// Applies the T and M words of a block.
    pub(super) fn apply(&mut self, block: &Block) {
        let waiting = self.selected;
        if let Some(word) = block.word(b'T') {
            self.selected = Some(word.number.scaled(1));
        }
        let codes = || block.words.iter().filter(|word| word.letter == b'M').filter_map(|word| word.number.as_whole());
        if codes().any(|code| code == 6) {
            // With two T words since the last tool change, the machine's ladder decides which one is loaded.
            let is_clear = waiting.is_none() || waiting == self.selected;
            let selected = self.selected.take().filter(|_| is_clear);
            self.tool = selected.map_or(ToolInSpindle::Unknown, ToolInSpindle::Number);
            self.is_on = Some(false);
        }
        for code in codes() {
            match code {
                3 | 4 | 13 | 14 => self.is_on = Some(true),
                2 | 5 | 19 | 30 => self.is_on = Some(false),
                _ => {}
            }
        }
    }

    /// Tool and spindle at present; `speed` is the last S of the program, rev/min.
    pub fn with_speed(&self, speed: Option<i64>) -> Machining {
        let spindle = match (self.is_on, speed) {
            (Some(false), _) | (_, Some(..=0)) | (None, Some(_)) => SpindleCommand::Stopped,
            (Some(true), Some(speed)) => SpindleCommand::RevPerMin(speed),
            (None | Some(true), None) => SpindleCommand::Unstated,
        };
        Machining { tool: self.tool, spindle }
    }
}

#[cfg(test)]
mod tests {
    use super::super::block::{Reading, parse_line};
    use super::super::modal::Modal;
    use super::super::settings::{Preset, Settings, Tables};
    use super::SpindleCommand::{RevPerMin, Stopped, Unstated};
    use super::*;
    use arcfeed_units::LengthUnit;

    fn after(lines: &str) -> Machining {
        let settings = Settings::preset(Preset::Fanuc16i, LengthUnit::Mm, Reading::Lenient);
        let modal = lines.lines().fold(Modal::at_power_on(LengthUnit::Mm), |modal, line| {
            let block = parse_line(line.as_bytes(), Reading::Lenient).unwrap().block;
            modal.interpret(&block, &settings, &Tables::default()).unwrap().0
        });
        modal.machining()
    }

    #[test]
    fn a_speed_counts_while_the_spindle_is_on() {
        for (lines, spindle) in [
            ("G0X1.", Unstated),
            ("S1000", Stopped),
            ("M3", Unstated),
            ("S1000M3", RevPerMin(1_000)),
            ("M3\nS500", RevPerMin(500)),
            ("S1000M13", RevPerMin(1_000)),
            ("S1000M3\nM5", Stopped),
            ("S1000M3\nM19", Stopped),
            ("S1000M3\nM5\nM3", RevPerMin(1_000)),
            ("S0M3", Stopped),
            ("S1000M3\nS0", Stopped),
            ("S1000M3\nT2M6", Stopped),
            ("S1000M3\nT2M6S800M3", RevPerMin(800)),
            ("S1000M3\nM30", Stopped),
        ] {
            assert_eq!(after(lines).spindle, spindle, "{lines}");
        }
    }

    #[test]
    fn a_tool_counts_from_its_change_on_and_not_from_its_selection() {
        for (lines, tool) in [
            ("T3", ToolInSpindle::Unstated),
            ("T3\nM6", ToolInSpindle::Number(3)),
            ("M6T3", ToolInSpindle::Number(3)),
            ("T3M6\nT7", ToolInSpindle::Number(3)),
            ("T3M6\nT7\nM6", ToolInSpindle::Number(7)),
            ("M6", ToolInSpindle::Unknown),
            ("T3M6\nT7M6", ToolInSpindle::Number(7)),
            ("T3M6\nT7\nT7M6", ToolInSpindle::Number(7)),
            ("T3M6\nT7\nM6T3", ToolInSpindle::Unknown),
            ("T3M6\nM6", ToolInSpindle::Unknown),
        ] {
            assert_eq!(after(lines).tool, tool, "{lines}");
        }
    }
}
