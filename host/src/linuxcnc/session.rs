//! Session with a running LinuxCNC, through LinuxCNC's Python module and HAL's sampler.
//!
//! The machine's side is `session.py`. It is executed by the Python that LinuxCNC has installed its module for.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use serde::Deserialize;

/// Machine's side of the conversation.
const SCRIPT: &str = include_str!("session.py");
/// Pythons that may have LinuxCNC's module: of the terminal's environment, and of Debian's package.
const PYTHONS: [&str; 2] = ["python3", "/usr/bin/python3"];
/// Longest time until the machine's side has begun.
const START: Duration = Duration::from_secs(10);
const NO_LINUXCNC: &str = "no Python here has LinuxCNC's module `linuxcnc`; run this on the machine's computer, in a terminal \
                           where the command `linuxcnc` works";

/// Names of the component's states, by its pin `state`.
const STATES: [&str; 8] = ["idle", "armed", "running", "holding", "fallback", "faulted", "inhibited", "disarmed"];

/// Message of the script that runs beside LinuxCNC and controls it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SessionEvent {
    /// The program cannot be run: the reason and the remedy.
    Fault(String),
    /// Message for a person.
    Note(String),
    /// The machine is on, homed and idle.
    Idle {},
    /// LinuxCNC has opened the program.
    Ready(Ready),
    /// State of the run.
    Status(Status),
    /// The program is no longer in execution.
    Ended(Ended),
    /// Measured values of one servo period.
    #[serde(skip)]
    Sample(MachineSample),
}

/// Message: the machine has opened the program.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Ready {
    /// Number of moves of the prepared program that the component `arcfeed` has loaded.
    pub moves: u32,
    /// Servo period, s.
    pub period_s: f64,
    /// Reason why there are no samples of the servo periods; empty if there are.
    pub no_samples: String,
    /// Unit of length of LinuxCNC's machine, mm (25.4 for inches).
    pub mm_per_unit: f64,
}

/// Message: state of a run on LinuxCNC.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Status {
    /// Line of the NC file in execution.
    pub line: usize,
    /// The program is paused.
    pub paused: bool,
    /// The axes are at rest.
    pub at_rest: bool,
    /// The feed law controls the adaptive feed.
    pub armed: bool,
}

/// Message: a run on LinuxCNC has ended.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Ended {
    /// The machine is still on.
    pub is_on: bool,
    /// Number of servo periods that were lost.
    pub missing: u64,
}

/// Measured values of one servo period; lengths in the unit of LinuxCNC's machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MachineSample {
    /// Number of the servo period.
    pub number: u64,
    /// Position relative to the workpiece's origin.
    pub position: [f64; 3],
    /// Speed along the path that the planner commands, per second.
    pub speed: f64,
    /// Commanded feed divided by F.
    pub ratio: f64,
    /// Spindle speed, rev/min.
    pub spindle: f64,
    /// Line of the NC file in execution; 0 between moves.
    pub line: usize,
    /// State of the component `arcfeed`; `None` if it is not loaded.
    pub state: Option<&'static str>,
}

impl MachineSample {
    /// Row of halsampler with the columns of `examples/linuxcnc/sampler.hal`.
    fn parse(row: &str) -> Option<Self> {
        let fields: Vec<f64> = row.split_whitespace().map(str::parse).collect::<Result<_, _>>().ok()?;
        let [number, x, y, z, speed, adaptive, dial, spindle, line, kind, state, _, _, ox, oy, oz] = fields[..] else {
            return None;
        };
        let position = [x - ox, y - oy, z - oz];
        // The line of the last move stays while there is none.
        let (number, line) = (number as u64, if kind == 0.0 { 0 } else { line.max(0.0) as usize });
        let state = STATES.get(state as usize).copied();
        Some(MachineSample { number, position, speed, ratio: adaptive * dial, spindle, line, state })
    }
}

/// Connection to the script that controls LinuxCNC.
pub struct Session {
    script: Child,
    commands: Option<ChildStdin>,
    events: Receiver<SessionEvent>,
}

impl Session {
    /// Session for a program in this file; `has_component`: the component has its feed. The program is opened by the command
    /// `open`.
    ///
    /// # Errors
    /// LinuxCNC is not there, or not ready: the reason and the remedy.
    pub fn begin(program: &Path, has_component: bool) -> Result<Self, String> {
        let python = PYTHONS.into_iter().find(|python| has_module(python)).ok_or(NO_LINUXCNC)?;
        let mut command = Command::new(python);
        command.args(["-c", SCRIPT]).arg(program).args(has_component.then_some("component"));
        let mut script = command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|error| format!("{python}: {error}"))?;
        let (commands, output) = (script.stdin.take(), script.stdout.take());
        let (sender, events) = channel();
        std::thread::spawn(move || {
            for line in BufReader::new(output?).lines().map_while(Result::ok) {
                let event = match MachineSample::parse(&line) {
                    Some(sample) => SessionEvent::Sample(sample),
                    None => serde_json::from_str(&line).ok()?,
                };
                sender.send(event).ok()?;
            }
            Some(())
        });
        let session = Session { script, commands, events };
        loop {
            match session.event(START)? {
                Some(SessionEvent::Idle {}) => return Ok(session),
                Some(SessionEvent::Fault(message)) => return Err(message),
                Some(_) => {}
                None => return Err("LinuxCNC does not answer; look at the machine".into()),
            }
        }
    }

    /// Next message of the script; `None` if none comes within this time.
    ///
    /// # Errors
    /// The script has ended.
    pub fn event(&self, time: Duration) -> Result<Option<SessionEvent>, String> {
        match self.events.recv_timeout(time) {
            Ok(event) => Ok(Some(event)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => {
                Err("the conversation with LinuxCNC has ended; look at the machine".into())
            }
        }
    }

    /// Sends a command: `open`, `arm`, `run` or `pause`.
    pub fn send(&mut self, command: &str) {
        // A script that is gone is reported by the next event.
        let _gone = self.commands.as_mut().map(|commands| writeln!(commands, "{command}"));
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        self.commands = None;
        let _ended = self.script.wait();
    }
}

fn has_module(python: &str) -> bool {
    let mut command = Command::new(python);
    command.args(["-c", "import hal, linuxcnc"]).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_of_the_sampler_is_relative_to_the_workpiece_and_belongs_to_a_line_only_in_a_move() {
        let row = |kind: u8| format!("57835 11.5 -2 3 4.5 0.5 1.2 1000 12 {kind} 2 0 0.99 1.5 -1 0.25 ");
        let sample = MachineSample::parse(&row(3)).expect("a row");
        let expected = MachineSample {
            number: 57_835,
            position: [10.0, -1.0, 2.75],
            speed: 4.5,
            ratio: 0.6,
            spindle: 1e3,
            line: 12,
            state: Some("running"),
        };
        assert_eq!(sample, expected);
        assert_eq!(MachineSample::parse(&row(0)).map(|sample| sample.line), Some(0));
        assert_eq!(MachineSample::parse("overrun"), None);
        assert_eq!(MachineSample::parse("57835 11.5 -2"), None);
    }

    #[test]
    fn the_reports_of_the_script_are_events() {
        let event = |text: &str| serde_json::from_str::<SessionEvent>(text).expect(text);
        assert_eq!(event(r#"{"idle": {}}"#), SessionEvent::Idle {});
        assert_eq!(event(r#"{"fault": "off"}"#), SessionEvent::Fault("off".into()));
        let status = Status { line: 3, paused: false, at_rest: true, armed: false };
        let text = r#"{"status": {"line": 3, "paused": false, "at_rest": true, "armed": false}}"#;
        assert_eq!(event(text), SessionEvent::Status(status));
        let ended = Ended { is_on: true, missing: 2 };
        assert_eq!(event(r#"{"ended": {"is_on": true, "missing": 2}}"#), SessionEvent::Ended(ended));
    }
}
