//! `arcfeed verify`: compares a program from the control's memory with the transmission of the job.

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use arcfeed_units::Micros;
use serde::Serialize;

use super::job_input::JobInput;
use super::line_args::LineArgs;
use super::outcome::{Failure, json_text, on_interrupt, refuse_inputs, say, write_whole};
use super::stream::preparation::PreparedProgram;
use crate::console::note;
use crate::dnc::readback::{Difference, ReadBack};
use crate::plural::counted;
use crate::port::Port;
use crate::port::open::open;
use crate::port::url::{Base, PortUrl};

const DC1: u8 = 0x11;
/// Time between two polls of the line.
const PERIOD: Micros = Micros::from_ms(5);
/// Silence after which a program has ended without its end.
const SILENCE: Micros = Micros::from_ms(10_000);

/// Compare a program that the control punches from its memory with the transmission of a job
#[derive(Debug, clap::Args)]
pub struct Verify {
    /// The line: a serial port's name or one of pyserial's URLs (docs/ports.md)
    #[arg(long, value_name = "URL")]
    port: PortUrl,
    #[command(flatten)]
    line: LineArgs,
    /// Compare with the transmission of `stream --keep-comments`
    #[arg(long)]
    keep_comments: bool,
    /// Write the text that the control has sent here
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    input: JobInput,
}

/// Figures of a comparison.
#[derive(Debug, Serialize)]
struct VerifyReport<'a> {
    identical: bool,
    blocks: Option<usize>,
    difference: Option<Shown<'a>>,
}

#[derive(Debug, Serialize)]
struct Shown<'a> {
    line: usize,
    column: usize,
    sent: Option<&'a str>,
    received: Option<&'a str>,
}

impl Verify {
    /// Runs the command.
    ///
    /// # Errors
    /// The job is at fault, the control has another program, or the line failed.
    pub fn run(&self) -> Result<(), Failure> {
        if self.port.base == Base::Sim {
            let message = "--port sim: has no program in its memory; `arcfeed serve --store` is a control that has one";
            return Err(Failure::Usage(message.into()));
        }
        if self.port.base == Base::LinuxCnc {
            let message = "--port linuxcnc: reads files; compare them with `arcfeed adapt --for linuxcnc`";
            return Err(Failure::Usage(message.into()));
        }
        let ready = PreparedProgram::load(&self.input, &self.line, !self.keep_comments)?;
        refuse_inputs(&[self.output.as_deref()], &ready.file.inputs(&self.input.job))?;
        let mut port = open(&self.port, &ready.file.serial)?;
        let mut back = ReadBack::new(ready.wire.encode);
        if !self.json {
            note(format_args!(
                "waiting for the program: press PUNCH at the control (EDIT mode), its line set as the job's"
            ));
        }
        self.read_program(&mut *port, &mut back, ready.file.dnc.start_timeout)?;
        if let Some(path) = &self.output {
            write_whole(path, back.text())?;
        }
        self.report(&ready, back.compare(&ready.whole))
    }

    /// Reads to the program's end.
    fn read_program(&self, port: &mut dyn Port, back: &mut ReadBack, start_timeout: Micros) -> Result<(), Failure> {
        let interrupted = on_interrupt();
        let (mut buffer, mut heard_at, mut is_ready) = ([0; 256], None, false);
        loop {
            if interrupted.load(Ordering::Relaxed) {
                return Err(Failure::Stopped("stopped by the operator".into()));
            }
            // A DC3 of a run before may still be in force there.
            is_ready = is_ready || port.write(&[DC1])? > 0;
            let len = port.read(&mut buffer)?;
            if back.take(&buffer[..len]) {
                return Ok(());
            }
            let now = port.now();
            heard_at = if len > 0 && back.has_begun() { Some(now) } else { heard_at };
            match heard_at {
                Some(heard_at) if now.since(heard_at) > SILENCE => {
                    let message = "the control has stopped sending before the `%` behind its program: look whether it is in alarm, \
                                   and check cable and flow control";
                    return Err(Failure::Machine(message.into()));
                }
                None if start_timeout > Micros(0) && now > start_timeout => {
                    return Err(Failure::Machine(format!(
                        "no program in {} s: press PUNCH at the control after this command, not before; then check channel, baud \
                         rate, parity and cable",
                        start_timeout.to_s()
                    )));
                }
                _ => {}
            }
            if len == 0 {
                port.wait(now.after(PERIOD));
            }
        }
    }

    fn report(&self, ready: &PreparedProgram, compared: Result<usize, Box<Difference>>) -> Result<(), Failure> {
        let path = ready.program.path.display();
        if self.json {
            let difference = compared.as_ref().err().map(|found| Shown {
                line: found.line,
                column: found.column,
                sent: found.sent.as_deref(),
                received: found.received.as_deref(),
            });
            let verdict =
                VerifyReport { identical: compared.is_ok(), blocks: compared.as_ref().ok().copied(), difference };
            say(format_args!("{}", json_text(&verdict)));
        } else if let Ok(blocks) = &compared {
            say(format_args!("{path}: {}, in the control as sent", counted(*blocks, "block")));
        }
        compared.map(|_| ()).map_err(|found| {
            let Difference { line, column, sent, received } = *found;
            let what = match (sent, received) {
                (Some(sent), Some(received)) => format!("the control has `{received}`, sent is `{sent}`"),
                (Some(sent), None) => format!("the control's program ends before `{sent}`"),
                (_, received) => format!("the control has `{}` behind the program's end", received.unwrap_or_default()),
            };
            Failure::Input(format!("{path}:{line}:{column}: error: {what}; do not run it"))
        })
    }
}
