//! Reading ahead: from the tape or the program in memory into the look-ahead.

use arcfeed_shared::units::Micros;

use super::Control;
use super::action::ReadBlock;
use super::executive::{Executive, Next};
use super::panel::Phase;
use super::search::{Approach, Found};

impl Control {
    /// Fills the look-ahead, up to a block behind which nothing is read before it is executed. A block with a fault stops
    /// the control when its turn comes, not when it is read.
    pub(super) fn read_ahead(&mut self, now: Micros, dt: Micros) {
        let cost = self.settings.block_processing;
        self.reading_time = self.reading_time.after(dt);
        while self.interpolator.queued() < self.settings.look_ahead
            && self.reading_time >= cost
            && !self.reads_no_further
            && self.phase == Phase::Running
        {
            let Some(blocks) = self.next_blocks(now) else { break };
            self.reading_time = self.reading_time.since(cost);
            for block in blocks {
                self.reads_no_further = block.action.stops_reading();
                self.interpolator.queue(block);
            }
        }
        // An idle reader has one block's time saved up when the next step comes, and no more.
        if self.has_moved && self.reading_time >= cost {
            self.reading_time = cost.since(dt);
        }
    }

    /// Where a restart has found its block, the operator sees what was not sent and presses cycle start.
    fn offer_restart(&mut self, now: Micros) {
        let list = match &mut self.executive {
            Some(executive) => executive.take_restart_list(),
            None => self.reader.take_restart_list(),
        };
        if list.is_some() {
            self.restart_list = list;
            self.phase = Phase::Stopped { since: now };
        }
    }

    /// Whether nothing is left to read.
    pub(super) fn has_nothing_to_read(&self) -> bool {
        self.executive.as_ref().map_or_else(|| self.port.is_exhausted(), Executive::is_over)
    }

    /// What the next line gives to execute, often one block; `None` if there is none yet.
    fn next_blocks(&mut self, now: Micros) -> Option<Vec<ReadBlock>> {
        let approach = Approach { stands: self.interpolator.position(), feed: self.settings.dry_run_feed };
        let found = match (&mut self.executive, self.search) {
            (Some(executive), None) => match executive.next(now, &self.switches) {
                Next::Block(block) => return Some(vec![*block]),
                Next::Busy | Next::Over => return None,
            },
            (Some(executive), Some(search)) => executive.look(search, now, &self.switches, &approach)?,
            (None, None) => {
                let received = self.port.take_block()?;
                return Some(self.reader.read(received, &self.switches).into_iter().collect());
            }
            (None, Some(search)) => {
                let received = self.port.take_block()?;
                search.look(received, &mut self.reader, &self.switches, &approach)
            }
        };
        Some(match found {
            Found::NotYet => Vec::new(),
            Found::Here(blocks) => {
                self.search = None;
                self.offer_restart(now);
                blocks
            }
            Found::Never(fault) => {
                self.search = None;
                vec![*fault]
            }
        })
    }
}
