//! Reading ahead: from the tape or the program in memory into the look-ahead.

use arcfeed_nc::alarm::{Alarm, Fault};
use arcfeed_nc_macro::print::Output;
use arcfeed_units::{Micros, US_PER_MS};

use super::action::{Action, ReadBlock};
use super::executive::{Executive, NextBlock};
use super::panel::Phase;
use super::reader::{OpenedBlock, sequence_of};
use super::search::{Approach, Search, SearchResult, never};
use super::tape::ReceivedBlock;
use super::{AlarmRecord, Control};

impl Control {
    /// Fills the look-ahead, up to a block that must be executed before the next one is read. A block with a fault
    /// stops the control when it is executed, not when it is read.
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
                let ready = self.contour_queue.pass(block);
                self.queue_all(ready);
            }
        }
        // An idle reader has saved the time of one block, not more, when the next step begins.
        if self.has_moved && self.reading_time >= cost {
            self.reading_time = cost.since(dt);
        }
    }

    fn queue_all(&mut self, blocks: Vec<ReadBlock>) {
        for block in blocks {
            self.reads_no_further |= matches!(block.action, Action::Fault(_));
            self.interpolator.queue(block);
        }
    }

    /// When a restart has found its block, the control shows the list of functions not sent and waits for cycle start.
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

    /// Whether no block is left to read.
    pub(super) fn has_nothing_to_read(&self) -> bool {
        self.executive.as_ref().map_or_else(|| self.port.is_exhausted(), Executive::is_over)
    }

    /// Raises an alarm if the program ends without M30; counts the time without a block to execute.
    pub(super) fn check_end(&mut self, dt: Micros) {
        if !self.is_starved() {
            return;
        }
        let rest = if self.has_nothing_to_read() { self.contour_queue.end() } else { Vec::new() };
        if !rest.is_empty() {
            self.queue_all(rest);
            return;
        }
        if self.has_nothing_to_read() {
            let alarm = if self.search.is_some() { Alarm::SequenceNotFound } else { Alarm::EndOfRecord };
            self.stop_with(AlarmRecord { line: self.reader.line(), fault: Fault::alarm(alarm, 0) });
        }
        if self.has_moved {
            self.starved_ms += dt.0 / US_PER_MS;
        }
    }

    /// Blocks that the next line gives, often one; `None` if there is no line yet.
    fn next_blocks(&mut self, now: Micros) -> Option<Vec<ReadBlock>> {
        let approach = Approach { position: self.interpolator.position(), feed: self.settings.dry_run_feed };
        let found = match (&mut self.executive, self.search) {
            (Some(_), Some(search)) if self.is_in_dnc => self.search_line(search, now, &approach)?,
            (Some(_), None) => {
                let block = self.next_block(now)?;
                let outputs = self.executive.as_mut().map(Executive::take_outputs).unwrap_or_default();
                self.punch(&outputs);
                return Some(block.into_iter().collect());
            }
            (Some(executive), Some(search)) => executive.search(search, now, &self.switches, &approach)?,
            (None, None) => {
                let received = self.port.take_block()?;
                return Some(self.reader.read(received, &self.switches).into_iter().collect());
            }
            (None, Some(search)) => {
                let received = self.port.take_block()?;
                search.apply(received, &mut self.reader, &self.switches, &approach)
            }
        };
        Some(match found {
            // Output before the searched block is not sent again.
            SearchResult::NotYet => {
                self.executive.iter_mut().for_each(|executive| drop(executive.take_outputs()));
                Vec::new()
            }
            SearchResult::Here(blocks) => {
                self.search = None;
                self.ignored = self.executive.as_ref().map(Executive::ignored).unwrap_or_default();
                self.offer_restart(now);
                blocks
            }
            SearchResult::Never(fault) => {
                self.search = None;
                vec![*fault]
            }
        })
    }

    /// Result of the interpreter for the next line of memory or of the DNC line: a block, or nothing for a line without
    /// code; `None` if there is no line yet.
    fn next_block(&mut self, now: Micros) -> Option<Option<ReadBlock>> {
        let executive = self.executive.as_mut()?;
        match executive.next(now, &self.switches) {
            NextBlock::Block(block) => return Some(Some(*block)),
            NextBlock::Busy | NextBlock::Over => return None,
            NextBlock::Starved => {}
        }
        let received = self.port.take_block()?;
        match self.reader.open(received, &self.switches) {
            None => return Some(None),
            Some(OpenedBlock::Refused(block)) => return Some(Some(*block)),
            Some(OpenedBlock::Text(text)) => executive.feed(text, self.reader.line()),
        }
        match executive.next(now, &self.switches) {
            NextBlock::Block(block) => Some(Some(*block)),
            NextBlock::Busy | NextBlock::Over | NextBlock::Starved => Some(None),
        }
    }

    /// Applies a search to the next line of the DNC line.
    fn search_line(&mut self, search: Search, now: Micros, approach: &Approach) -> Option<SearchResult> {
        let executive = self.executive.as_mut()?;
        if let Search::Sequence(wanted) = search {
            let received = self.port.take_block()?;
            let is_end = self.reader.skip(&received);
            return Some(match received {
                ReceivedBlock::Block(text) if sequence_of(&text) == Some(wanted) => {
                    executive.feed(text, self.reader.line());
                    SearchResult::Here(Vec::new())
                }
                _ if is_end => SearchResult::Never(Box::new(never(self.reader.line()))),
                _ => SearchResult::NotYet,
            });
        }
        let start = executive.end();
        let Some(block) = self.next_block(now)? else { return Some(SearchResult::NotYet) };
        let Search::Restart(wanted) = search else { return None };
        Some(approach.restart_at(wanted, block, start))
    }

    fn punch(&mut self, outputs: &[Output]) {
        for output in outputs {
            self.output.extend(output.bytes());
            self.port.put(output);
        }
    }
}
