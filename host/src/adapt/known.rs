//! Input of the plan beside program and job: from the job's files, and from a plan before whose feeds leaked.

use std::collections::BTreeSet;

use arcfeed_kinematics::machine::Machine;

use crate::engagement::EngagementMap;
use crate::job::rule_scope::RuleScope;
use crate::job::{JobFile, Plunge, SpindleLimits};
use crate::program::ExecutedPlaces;

/// Governed blocks that may keep their feed because it would leak, one by one.
const LEAKS_MAX: usize = 64;

/// Input of the feed plan besides program and job: machine, engagement map, plunge law, scopes of rules.
#[derive(Clone, Copy, Debug, Default)]
pub struct Known<'a> {
    /// The machine: laws also govern straight moves under G43.4, within what all of its axes can follow.
    pub machine: Option<&'a Machine>,
    /// Engaged arcs of the tool's circles, for rules that expect engagement per move.
    pub map: Option<&'a EngagementMap>,
    /// Accelerations of X, Y and Z.
    pub accelerations_mm_per_s2: Option<[f64; 3]>,
    /// The plunge law, with the limits of the spindle.
    pub plunge: Option<(Plunge, SpindleLimits)>,
    /// Scopes of the cut rules.
    pub scopes: &'a [RuleScope],
    /// Places of the lines in the program's file, if they are its blocks as executed.
    pub places: Option<&'a ExecutedPlaces>,
}

impl<'a> Known<'a> {
    /// All further input that the files of a job give.
    pub fn of(file: &'a JobFile) -> Self {
        let drives = file.machine.as_ref().and_then(|named| named.drives.as_ref());
        Known {
            machine: file.machine.as_ref().map(|named| &named.machine),
            map: file.map.as_ref(),
            accelerations_mm_per_s2: drives
                .map(|drives| drives.linear.each_ref().map(|axis| axis.acceleration_mm_per_s2)),
            plunge: file.plunge.map(|plunge| (plunge, file.spindle)),
            scopes: &file.rule_scopes,
            places: None,
        }
    }
}

/// Lines that keep their programmed feed, because another feed would stay in force for other lines.
#[derive(Clone, Debug, Default)]
pub struct KeptLines {
    one_by_one: BTreeSet<usize>,
    /// First line from which all blocks keep their feed, if there were too many leaks.
    all_from: Option<usize>,
}

impl KeptLines {
    /// Whether this line keeps its feed.
    pub fn contains(&self, line: usize) -> bool {
        self.all_from.is_some_and(|first| line >= first) || self.one_by_one.contains(&line)
    }

    /// Adds the line from which a feed would leak, if there is one.
    pub fn with(mut self, line: Option<usize>) -> Self {
        match line {
            Some(line) if self.one_by_one.len() < LEAKS_MAX => drop(self.one_by_one.insert(line)),
            _ => self.all_from = Some(self.one_by_one.first().copied().unwrap_or(0)),
        }
        self
    }
}
