//! Input of the feed plan in addition to program and job: data from the files of the job, and lines that must keep
//! their feed.

use std::collections::BTreeSet;

use arcfeed_kinematics::machine::Machine;

use crate::engagement::EngagementMap;
use crate::job::rule_scope::RuleScope;
use crate::job::{JobFile, Plunge, SpindleLimits};
use crate::program::ExecutedPlaces;

/// Governed blocks that may keep their feed because it would leak, one by one.
const LEAKS_MAX: usize = 64;

/// Input of the feed plan in addition to program and job. Parts that are `None` are not known or not used.
#[derive(Clone, Copy, Debug, Default)]
pub struct Known<'a> {
    /// Machine kinematics and axis limits; with them, laws also govern straight moves under G43.4, within what all axes
    /// can follow.
    pub machine: Option<&'a Machine>,
    /// Engagement map: the engaged arcs of the tool on each move, for cut rules that expect engagement per move.
    pub map: Option<&'a EngagementMap>,
    /// Accelerations of X, Y and Z, mm/s2; `None`: not given.
    pub accelerations_mm_per_s2: Option<[f64; 3]>,
    /// Plunge law of the job, with the spindle's limits of torque and power.
    pub plunge: Option<(Plunge, SpindleLimits)>,
    /// Whether the program has the feeds that are sent already, because it is the text that the control gets.
    pub has_sent_feeds: bool,
    /// Part of the program to which each cut rule applies, in the order of the rules.
    pub scopes: &'a [RuleScope],
    /// For a program given as its executed blocks: place of each block in the program's file. `None` if the blocks are
    /// the lines of the file.
    pub places: Option<&'a ExecutedPlaces>,
}

impl<'a> Known<'a> {
    /// All of this that the files of a job contain.
    pub fn of(file: &'a JobFile) -> Self {
        let drives = file.machine.as_ref().and_then(|named| named.drives.as_ref());
        Known {
            machine: file.machine.as_ref().map(|named| &named.machine),
            map: file.map.as_ref(),
            accelerations_mm_per_s2: drives
                .map(|drives| drives.linear.each_ref().map(|axis| axis.acceleration_mm_per_s2)),
            plunge: file.plunge.map(|plunge| (plunge, file.spindle)),
            has_sent_feeds: false,
            scopes: &file.rule_scopes,
            places: None,
        }
    }
}

/// Lines that keep their programmed feed: a feed set by a law would stay in force (F is modal) for a later line that
/// needs another one.
#[derive(Clone, Debug, Default)]
pub struct KeptLines {
    one_by_one: BTreeSet<usize>,
    /// First line from which all blocks keep their feed, if there were too many leaks.
    all_from: Option<usize>,
}

impl KeptLines {
    /// Whether the line with this number keeps its feed.
    pub fn contains(&self, line: usize) -> bool {
        self.all_from.is_some_and(|first| line >= first) || self.one_by_one.contains(&line)
    }

    /// These lines, and `line`, whose feed would stay in force too long. If there are too many, or the line is `None`,
    /// all lines from the first of them on keep their feed.
    pub fn with(mut self, line: Option<usize>) -> Self {
        match line {
            Some(line) if self.one_by_one.len() < LEAKS_MAX => drop(self.one_by_one.insert(line)),
            _ => self.all_from = Some(self.one_by_one.first().copied().unwrap_or(0)),
        }
        self
    }
}
