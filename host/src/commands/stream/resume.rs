//! `--resume`: reads the journal, shows the restart, and sends nothing before a person has agreed to it.

use std::io::{BufRead, ErrorKind, IsTerminal};
use std::path::Path;

use arcfeed_units::Nm;
use serde::Serialize;

use super::super::outcome::{Failure, file_failure, say};
use super::Stream;
use super::preparation::PreparedProgram;
use crate::dnc::journal::{self, EndReason, History, Start};
use crate::dnc::reports::Reports;
use crate::dnc::resume::{CutRange, RestartPlan, RestartRequest};
use crate::dnc::transmission::Transmission;

/// Options of a restart: place and conditions.
#[derive(Debug, clap::Args)]
pub struct Resume {
    /// Restart the program after a crash or a cut cable, at the place that the journal and the control report
    #[arg(long)]
    resume: bool,
    /// Line of the program's file to continue with; needed if the control does not report its progress
    #[arg(long, value_name = "LINE", requires = "resume")]
    from: Option<usize>,
    /// Z above all obstacles, in the program's coordinates; without it the highest Z that a rapid of the program reaches
    #[arg(long, value_name = "Z", requires = "resume", allow_negative_numbers = true)]
    clearance: Option<f64>,
    /// Agree to the restart without a question: for scripts, after the plan has been checked
    #[arg(long, requires = "resume")]
    approve: bool,
}

#[derive(Serialize)]
struct Shown<'a> {
    resume: &'a RestartPlan,
}

impl Resume {
    /// Whether a restart is requested.
    pub fn is_wanted(&self) -> bool {
        self.resume
    }

    /// The rest of the program, once a person has agreed; the first record of its journal; its reports.
    ///
    /// # Errors
    /// There is nothing to restart, no restart is possible there, or the operator has not agreed.
    pub fn prepare(&self, stream: &Stream, ready: &PreparedProgram) -> Result<(Transmission, Start, Reports), Failure> {
        let path = stream.journal_path();
        let history = read(&path, ready)?;
        let took_up_all = history.executed.is_some_and(|blocks| ready.whole.line_of_block(blocks + 1).is_none());
        if history.ended == Some(EndReason::Complete) && history.stopped && took_up_all && self.from.is_none() {
            let message =
                "the program was executed to its end: there is nothing to take up; for a part of it give --from LINE";
            return Err(Failure::Input(format!("{}: {message}", path.display())));
        }
        let unit = ready.file.job.unit;
        let clearance = self.clearance.map(|z| Nm::from_mm(z * unit.mm()));
        let wanted = RestartRequest { line: self.from, clearance };
        let file = ready.program.path.display();
        let refused = |why: String| Failure::Input(format!("{file}: cannot be taken up: {why}"));
        let plan = RestartPlan::new(&ready.whole, &history, &wanted, &ready.power_on()).map_err(refused)?;
        if stream.json {
            say(format_args!("{}", serde_json::json!(Shown { resume: &plan })));
        } else {
            show(&plan, &history);
        }
        self.agree(&plan)?;
        let rest = ready.whole.resumed(&plan.preamble(), plan.index, &ready.wire);
        let rest = rest.map_err(|refusals| refused(format!("{refusals:?}")))?;
        let restart_bytes = rest.frames().len() - (ready.whole.frames().len() - ready.whole.start_of(plan.index));
        let behind_restart = rest.line_at(restart_bytes);
        let start = Start {
            bytes: rest.frames().len(),
            from: ready.whole.start_of(plan.index),
            blocks: (1..plan.index).filter(|index| ready.whole.is_block(*index)).count(),
            restart_bytes,
            restart_blocks: (1..behind_restart).filter(|index| rest.is_block(*index)).count(),
            ..ready.start
        };
        Ok((rest, start, ready.reports.clone().resumed(plan.index, behind_restart)))
    }

    fn agree(&self, plan: &RestartPlan) -> Result<(), Failure> {
        if self.approve {
            return Ok(());
        }
        if !std::io::stdin().is_terminal() {
            let message = "nothing was sent: look at the restart above, and agree to it with --approve";
            return Err(Failure::Undecided(message.into()));
        }
        say(format_args!("Type {} to send this, anything else to leave it:", plan.line));
        let mut answer = String::new();
        let read = std::io::stdin().lock().read_line(&mut answer);
        if read.is_ok() && answer.trim() == plan.line.to_string() {
            return Ok(());
        }
        Err(Failure::Undecided("nothing was sent".into()))
    }
}

/// The journal, if it is of this program and job.
fn read(path: &Path, ready: &PreparedProgram) -> Result<History, Failure> {
    let bytes = std::fs::read(path).map_err(|error| match error.kind() {
        ErrorKind::NotFound => Failure::Input(format!(
            "{}: no journal there, so nothing is known of a run before: give its place with --journal, or send the program \
             from its beginning",
            path.display()
        )),
        _ => file_failure(path, &error),
    })?;
    let failed = |what: String| Failure::Input(format!("{}: {what}", path.display()));
    let history = journal::read(&bytes).map_err(|damage| failed(damage.to_string()))?;
    let (was, is) = (history.start, ready.start);
    let changed = [
        (was.program != is.program, "the program's file"),
        (
            was.job != is.job,
            "what the job (or the options in its place), its control's settings file or its engagement map says",
        ),
        (was.sent != is.sent, "what arcfeed sends for them (another version, or --keep-comments)"),
    ];
    if let Some((_, what)) = changed.into_iter().find(|(differs, _)| *differs) {
        return Err(failed(format!(
            "{what} is not what it was when this journal was written: its places mean nothing any more. Bring back the \
             files as they were, or send the program from its beginning"
        )));
    }
    Ok(history)
}

fn show(plan: &RestartPlan, history: &History) {
    let [low, high] = plan.sent;
    let ended = match history.ended {
        None => "the sender was cut off",
        Some(EndReason::Complete) => "the sender had sent everything",
        Some(EndReason::Aborted) => "the operator stopped the sender",
        Some(EndReason::Failed) => "the line or the control failed",
    };
    say(format_args!("{ended}; the last character sent lies in lines {low} to {high}"));
    match plan.executed {
        Some(line) if plan.stopped => say(format_args!("the control stood in the block of line {line}")),
        Some(line) => {
            say(format_args!(
                "the control had taken up the block of line {line} at least, and went on with what it had"
            ));
        }
        None => say(format_args!("how far the control came is not known: sent is not executed")),
    }
    say(format_args!("continues with line {}, after these blocks:", plan.line));
    for block in &plan.blocks {
        say(format_args!("    {block}"));
    }
    if let Some(tool) = plan.tool {
        say(format_args!("tool {tool} must be in the spindle: it is not changed"));
    }
    if !plan.other_m.is_empty() {
        let codes: Vec<String> = plan.other_m.iter().map(|code| format!("M{code}")).collect();
        say(format_args!("not restored: {}; do at the machine what they stand for", codes.join(", ")));
    }
    let cuts = |cuts: &CutRange, what: &str| {
        if let Some([first, last]) = cuts.lines {
            say(format_args!("{} cutting blocks {what}: lines {first} to {last}", cuts.count));
        }
    };
    cuts(&plan.repeated, "are cut AGAIN");
    cuts(&plan.possibly_repeated, "are cut again if they were executed");
    cuts(&plan.skipped, "are LEFT OUT");
    cuts(&plan.possibly_skipped, "are left out if they were not executed");
    say(format_args!(
        "RESET the control first; jog the tool clear; the first move is Z to the clearance. At M0 look whether all is \
         right, then press cycle start"
    ));
}
