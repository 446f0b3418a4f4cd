//! The operator's panel: feed hold, cycle start, reset, switches.
//!
//! ```text
//!            M00, M01, single block                    reset
//! Running ----------------------------> Stopped    any -------> Resetting
//!    ^                                     |                        | axes at rest
//!    +-------------------------------------+                        v
//!    |     cycle start, also by the        |                      Ready
//!    |     simulated operator              |                        |
//!    +--------------------------------------------------------------+
//!                                                     cycle start
//! ```
//! Feed hold is independent of these states: axes come to rest and a dwell waits until cycle start.

use arcfeed_nc::modal::ProgramStop;
use arcfeed_nc_macro::variables::Ignored;
use arcfeed_units::Micros;

use super::Control;
use super::executive::Executive;
use super::restart::RestartList;
use super::search::Search;
use super::settings::Switches;

/// State of the control's operation, apart from alarms and the end of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Blocks are executed as they are read.
    Running,
    /// The last block is done, and the next one waits for cycle start (M00, M01, single block).
    Stopped {
        /// Time of the stop.
        since: Micros,
    },
    /// After a reset the axes come to rest.
    Resetting,
    /// After a reset at rest: no program is running, and cycle start begins one.
    Ready,
}

impl Control {
    /// Feed hold: the axes come to rest and stay there.
    pub fn hold(&mut self) {
        self.held = true;
    }

    /// Whether feed hold is on.
    pub fn is_held(&self) -> bool {
        self.held
    }

    /// Cycle start: continues after feed hold and stops; begins the next program after a reset.
    pub fn cycle_start(&mut self) {
        self.held = false;
        match self.phase {
            Phase::Stopped { .. } => self.phase = Phase::Running,
            Phase::Ready => {
                self.settings.tables = *self.executive.as_ref().map_or(self.reader.tables(), Executive::tables);
                self.reader = super::BlockReader::new(&self.settings);
                self.reader.stand_at(self.interpolator.position());
                if let Some(executive) = &mut self.executive {
                    executive.reset(&self.settings, self.interpolator.position());
                }
                self.reading_time = super::read_before_start(&self.settings);
                self.port.restart();
                self.phase = Phase::Running;
            }
            Phase::Running | Phase::Resetting => {}
        }
    }

    /// Whether the next block waits for cycle start after M00, M01 or single block.
    pub fn is_stopped(&self) -> bool {
        matches!(self.phase, Phase::Stopped { .. })
    }

    /// Reset: axes come to rest, blocks read ahead and characters in the buffer are discarded, the alarm is cleared. A
    /// program in memory is discarded too: the next one needs a new control.
    pub fn reset(&mut self) {
        self.port.reset();
        self.alarm = None;
        self.ended = false;
        self.held = false;
        self.search = None;
        self.drive_state.end(ProgramStop::End);
        self.phase = Phase::Resetting;
    }

    /// Whether the control waits for cycle start after a reset.
    pub fn is_ready(&self) -> bool {
        self.phase == Phase::Ready
    }

    /// Starts a search for a block in the middle of the program; to be called before anything is executed.
    pub fn search(&mut self, search: Search) {
        if let Search::Restart(_) = search {
            self.reader.list_for_restart();
            self.executive.iter_mut().for_each(Executive::list_for_restart);
        }
        self.search = Some(search);
    }

    /// List for the operator after a program restart has found its block: the functions commanded before it, which the operator has to
    /// command again, and the modal state there. `None` without a restart, or before the block is found.
    pub fn restart_list(&self) -> Option<&RestartList> {
        self.restart_list.as_ref()
    }

    /// Switches of the panel, to change them.
    pub fn switches_mut(&mut self) -> &mut Switches {
        &mut self.switches
    }

    /// Applies M0, M1, M2 or M30.
    pub(super) fn apply_stop(&mut self, stop: ProgramStop, now: Micros) {
        self.reads_no_further = false;
        self.drive_state.end(stop);
        match stop {
            ProgramStop::Optional if !self.switches.optional_stop => {}
            ProgramStop::Program | ProgramStop::Optional => self.phase = Phase::Stopped { since: now },
            ProgramStop::End => self.ended = true,
        }
        self.halts_after &= self.phase == Phase::Running;
    }

    /// Handles the simulated operator's cycle start and the end of a reset.
    pub(super) fn operate(&mut self, now: Micros) {
        match self.phase {
            Phase::Stopped { since } => {
                let restart = self.settings.operator_restart;
                if !self.holds() && restart.is_some_and(|wait| now >= since.after(wait)) {
                    self.cycle_start();
                }
            }
            Phase::Resetting if self.interpolator.is_at_rest() => {
                self.interpolator.clear();
                self.contour_queue.clear();
                self.dwell_left = Micros(0);
                self.after_move = None;
                self.cycle_run = None;
                self.restart_list = None;
                self.halts_after = false;
                self.reads_no_further = false;
                self.has_moved = false;
                self.executed.clear();
                self.output.clear();
                self.ignored = Ignored::default();
                if !self.is_in_dnc {
                    self.executive = None;
                }
                self.phase = Phase::Ready;
            }
            Phase::Running | Phase::Resetting | Phase::Ready => {}
        }
    }
}

#[cfg(test)]
mod tests;
