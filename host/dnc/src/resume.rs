//! Restart of a program in its middle: at which line, with which blocks before it, and which cuts are repeated or left
//! out.
//!
//! *Sent* is not *executed*: between the two lie the control's buffer and its look-ahead, with which a control
//! continues when its sender is gone. Unless the control reported its progress and had stopped then, only a person at
//! the machine can name the block, and cuts that may be repeated or left out are given as a range.

use arcfeed_nc::modal::MotionKind;
use arcfeed_units::Nm;
use serde::Serialize;

use super::journal::History;
use super::restored_state::{PowerOn, StateBefore};
use super::transmission::Transmission;

/// Plan of a restart, shown to the operator before anything moves. Lines are those of the program's file, counted from
/// 1.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RestartPlan {
    /// Line of the program at which the restart begins.
    pub line: usize,
    /// First and last line in which the last character sent before the break can lie.
    pub sent: [usize; 2],
    /// Line of the block that was under way at the control's last report; `None` without a report.
    pub executed: Option<usize>,
    /// The control had stopped at that report, therefore it has started no later block.
    pub stopped: bool,
    /// Blocks that arcfeed sends before the line of the restart, to restore the control's state.
    pub blocks: Vec<String>,
    /// Cutting blocks that the control has executed and that are cut again.
    pub repeated: CutRange,
    /// Cutting blocks that are cut again and that the control may have executed before.
    pub possibly_repeated: CutRange,
    /// Cutting blocks that the control has certainly not executed and that the restart leaves out.
    pub skipped: CutRange,
    /// Cutting blocks that the restart leaves out and that the control may not have executed.
    pub possibly_skipped: CutRange,
    /// Number of the tool that must be in the spindle; `None` if the part before has no M6 with a T.
    pub tool: Option<i64>,
    /// M codes defined by the machine's builder in the part before the restart; the operator has to restore their
    /// effect.
    pub other_m: Vec<i64>,
    /// Index in the transmission of the line at which the restart begins.
    #[serde(skip)]
    pub index: usize,
}

/// Cutting blocks between two places of a program: their number, and their first and last line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct CutRange {
    /// Number of cutting blocks.
    pub count: usize,
    /// First and last line with a cutting block, in the program's file; `None` if there is none.
    pub lines: Option<[usize; 2]>,
}

/// Request for a restart, by the operator.
#[derive(Clone, Copy, Debug)]
pub struct RestartRequest {
    /// Line of the program's file at which to restart; `None`: at the block that was under way, if the control's report
    /// shows which.
    pub line: Option<usize>,
    /// Z of the clearance plane, over which the tool approaches, in the program's coordinates; `None`: the highest Z to
    /// which a rapid has led.
    pub clearance: Option<Nm>,
}

impl RestartPlan {
    /// Plans a restart of the transmission `sent`; `history` is the journal of the interrupted one, `control` the state
    /// after power-on.
    ///
    /// # Errors
    /// It is unknown how far the control came and no line is given, the line does not exist, or the state before it
    /// cannot be restored; with the reason.
    pub fn new(
        sent: &Transmission,
        history: &History,
        wanted: &RestartRequest,
        control: &PowerOn,
    ) -> Result<Self, String> {
        let under_way = history.executed.map(|blocks| sent.line_of_block(blocks.max(1)).unwrap_or(1));
        let index = match (wanted.line, under_way.filter(|_| history.stopped)) {
            (Some(line), _) => sent.lines().iter().position(|sent| sent.source == line).filter(|index| *index > 0),
            (None, Some(under_way)) => Some(under_way),
            (None, None) => {
                let [low, high] = history.sent.map(|at| source(sent, at));
                return Err(format!(
                    "how far the control came is not known: characters up to line {low} are out, at most up to line {high}{}, \
                     and it continues with the blocks it has. Look at the control for the block it stopped in, press RESET there, and \
                     give its line in the file with --from LINE",
                    under_way.map_or(String::new(), |at| format!(
                        ", executed at least up to line {}",
                        sent.lines()[at].source
                    ))
                ));
            }
        };
        let index = index.ok_or("no such line in the program, or one that a restart cannot begin with")?;
        let before = StateBefore::line(sent, index, control)?;
        let line = sent.lines()[index].source;
        let blocks = before.blocks(line, wanted.clearance, control)?;
        let cuts = cutting(sent, control);
        let among = |from: usize, to: usize| CutRange::of(sent, &cuts, from, to);
        // It is unknown how much of the line under way is cut: it counts as repeated, and as left out if it does not
        // come.
        let out = sent.line_at(history.sent[1].saturating_sub(1)) + 1;
        let least = under_way.unwrap_or(0);
        let most = if history.stopped { least } else { out.max(least) };
        let repeated = among(index, under_way.map_or(0, |under_way| under_way + 1));
        let possibly_repeated = among(index.max(under_way.map_or(0, |under_way| under_way + 1)), most);
        let (possibly_skipped, skipped) = (among(least, index.min(most)), among(most.max(least), index));
        Ok(RestartPlan {
            line,
            sent: history.sent.map(|at| source(sent, at)),
            executed: under_way.map(|index| sent.lines()[index].source),
            stopped: history.stopped,
            blocks: blocks.lines().map(str::to_owned).collect(),
            repeated,
            possibly_repeated,
            skipped,
            possibly_skipped,
            tool: before.functions.tool,
            other_m: before.functions.others,
            index,
        })
    }

    /// Text of the blocks that are sent before the rest of the program, one per line.
    pub fn preamble(&self) -> String {
        self.blocks.iter().map(|block| format!("{block}\n")).collect()
    }
}

impl CutRange {
    fn of(sent: &Transmission, cuts: &[bool], from: usize, to: usize) -> Self {
        let lines = (from..to.min(cuts.len())).filter(|index| cuts[*index]);
        let found: Vec<usize> = lines.map(|index| sent.lines()[index].source).collect();
        let ends = found.first().zip(found.last());
        CutRange { count: found.len(), lines: ends.map(|(first, last)| [*first, *last]) }
    }
}

/// Line of the file that a character belongs to.
fn source(sent: &Transmission, at: usize) -> usize {
    let index = sent.line_at(at).min(sent.lines().len().saturating_sub(1));
    sent.lines().get(index).map_or(0, |line| line.source)
}

/// Lines that cut: moves at a feed, and cycles.
fn cutting(sent: &Transmission, control: &PowerOn) -> Vec<bool> {
    let mut reader = control.reader();
    let mut cuts = vec![false; sent.lines().len()];
    for (index, cuts) in cuts.iter_mut().enumerate().skip(1).filter(|(index, _)| !sent.is_of_report(*index)) {
        let text = sent.line_text(index).unwrap_or_default();
        let Ok(understood) = reader.read(text.strip_suffix(b"\n").unwrap_or(text)) else { continue };
        let moves = understood.step.motion.is_some_and(|motion| motion.kind != MotionKind::Rapid);
        let drills = understood.step.series.is_some() && reader.modal().cycle.is_some();
        *cuts = moves || drills;
    }
    cuts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::journal::Start;
    use crate::transmission::Wire;
    use arcfeed_nc::block::Reading;
    use arcfeed_nc::settings::{Preset, Settings, Tables};
    use arcfeed_units::LengthUnit;

    const PROGRAM: &str = "%\nG21G0X0Y0Z5.\nG1Z-1.F100.\nX1.\nX2.\nX3.\nX4.\nG0Z5.\nM30\n%\n";

    fn plan(executed: Option<usize>, sent: [usize; 2], line: Option<usize>) -> Result<RestartPlan, String> {
        let wire = Wire { encode: Some, filters: false, tv_check: false };
        let source = |at: usize| 1 + PROGRAM.as_bytes()[..at].iter().filter(|byte| **byte == b'\n').count();
        let transmission = Transmission::new(PROGRAM.as_bytes(), source, &wire).unwrap();
        let history =
            History { start: Start::default(), sent, executed, stopped: executed.is_some(), ended: None, torn: 0 };
        let settings = Settings::preset(Preset::Fanuc16i, LengthUnit::Mm, Reading::Lenient);
        let control = PowerOn { settings, tables: Tables::default() };
        RestartPlan::new(&transmission, &history, &RestartRequest { line, clearance: None }, &control)
    }

    fn cuts(count: usize, first: usize, last: usize) -> CutRange {
        CutRange { count, lines: Some([first, last]) }
    }

    #[test]
    fn the_block_that_was_under_way_is_repeated_and_nothing_else() {
        let plan = plan(Some(4), [40, 44], None).unwrap();
        assert_eq!((plan.line, plan.executed), (5, Some(5)));
        assert_eq!(
            (plan.repeated, plan.skipped, plan.possibly_repeated, plan.possibly_skipped.count),
            (cuts(1, 5, 5), CutRange::default(), CutRange::default(), 0)
        );
    }

    #[test]
    fn another_line_repeats_or_skips_and_says_so() {
        let earlier = plan(Some(4), [40, 44], Some(3)).unwrap();
        assert_eq!((earlier.repeated, earlier.skipped.count), (cuts(3, 3, 5), 0));
        let later = plan(Some(4), [40, 44], Some(7)).unwrap();
        assert_eq!((later.repeated.count, later.skipped), (0, cuts(2, 5, 6)));
    }

    #[test]
    fn where_nothing_is_known_of_execution_a_line_must_be_given_and_the_range_is_shown() {
        let refusal = plan(None, [31, 36], None).unwrap_err();
        assert!(refusal.contains("line 5") && refusal.contains("line 6") && refusal.contains("--from"), "{refusal}");
        let plan = plan(None, [31, 36], Some(5)).unwrap();
        assert_eq!((plan.possibly_repeated, plan.possibly_skipped), (cuts(2, 5, 6), cuts(2, 3, 4)));
        assert_eq!((plan.repeated.count, plan.skipped.count), (0, 0));
    }
}
