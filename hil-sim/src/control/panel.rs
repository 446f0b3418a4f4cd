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
//! Feed hold lies across: axes come to rest and a dwell stands still until cycle start.

use arcfeed_shared::nc::macros::variables::Ignored;
use arcfeed_shared::nc::modal::Stop;
use arcfeed_shared::units::Micros;

use super::Control;
use super::executive::Executive;
use super::restart::RestartList;
use super::search::Search;
use super::settings::Switches;

/// Where operation stands, alarms and the program's end apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Blocks are executed as they come.
    Running,
    /// The block before is done, the next waits for cycle start.
    Stopped {
        /// When it stopped.
        since: Micros,
    },
    /// Axes come to rest.
    Resetting,
    /// Nothing is there to execute: cycle start begins a program.
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

    /// Cycle start: goes on after feed hold and stops; begins the next program after a reset.
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

    /// Whether the next block waits for cycle start.
    pub fn is_stopped(&self) -> bool {
        matches!(self.phase, Phase::Stopped { .. })
    }

    /// Reset: axes come to rest, what was read ahead and what is in the buffer is lost, the alarm is off. Of a program in
    /// memory nothing is left either: a new control has to be made for the next one.
    pub fn reset(&mut self) {
        self.port.reset();
        self.alarm = None;
        self.ended = false;
        self.held = false;
        self.search = None;
        self.driven.end(Stop::End);
        self.phase = Phase::Resetting;
    }

    /// Whether it waits for cycle start after a reset.
    pub fn is_ready(&self) -> bool {
        self.phase == Phase::Ready
    }

    /// Looks for a block in what comes next, before anything is executed.
    pub fn search(&mut self, search: Search) {
        if let Search::Restart(_) = search {
            self.reader.list_for_restart();
            self.executive.iter_mut().for_each(Executive::list_for_restart);
        }
        self.search = Some(search);
    }

    /// What a restart has found: the functions given before its block, which the operator has to give again, and the
    /// state that the block meets.
    pub fn restart_list(&self) -> Option<&RestartList> {
        self.restart_list.as_ref()
    }

    /// The switches, to turn.
    pub fn switches_mut(&mut self) -> &mut Switches {
        &mut self.switches
    }

    /// What happens by itself: the simulated operator's cycle start, the end of a reset.
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
                self.dwell_left = Micros(0);
                self.after_move = None;
                self.course = None;
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
