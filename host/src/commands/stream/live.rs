//! What a person sees while a program is sent: the screen, or a progress bar on a terminal; and the log of events.

use std::fs::File;
use std::io::{IsTerminal, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::super::outcome::{Failure, file_failure};
use crate::dnc::events::Events;
use crate::dnc::{Sender, State};
use crate::port::Port;
use crate::screen::Screen;
use crate::screen::view::{Command, View};

/// Wall time between two pictures.
const PERIOD: Duration = Duration::from_millis(100);

/// Whoever watches.
pub struct Live {
    bar: Option<ProgressBar>,
    screen: Option<(Screen, View, Instant)>,
    log: Option<EventLog>,
}

struct EventLog {
    file: File,
    events: Events,
}

impl Live {
    /// A bar over `total` characters, where stderr is a terminal.
    pub fn bar(total: usize) -> Self {
        let bar = ProgressBar::with_draw_target(Some(total as u64), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}") {
            bar.set_style(style);
        }
        Live { bar: Some(bar), screen: None, log: None }
    }

    /// Nothing.
    pub fn nothing() -> Self {
        Live { bar: None, screen: None, log: None }
    }

    /// The whole terminal.
    ///
    /// # Errors
    /// It is none.
    pub fn screen(view: View) -> Result<Self, Failure> {
        let failed = |error: std::io::Error| Failure::Usage(format!("--tui: {error}"));
        let screen = Screen::open(view.clone()).map_err(failed)?;
        Ok(Live { bar: None, screen: Some((screen, view, Instant::now())), log: None })
    }

    /// Writes what happens into a file, too.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn logging(mut self, path: &Path, title: &str, sender: &Sender) -> Result<Self, Failure> {
        let begin = || {
            let mut file = File::create(path)?;
            writeln!(file, "# {title}; seconds since the line was opened")?;
            Ok(file)
        };
        let file = begin().map_err(|error: std::io::Error| file_failure(path, &error))?;
        self.log = Some(EventLog { file, events: Events::new(sender) });
        Ok(self)
    }

    /// Shows where things stand; answers what the operator wants.
    pub fn show(&mut self, port: &dyn Port, sender: &Sender) -> Option<Command> {
        self.write_events(port, sender);
        if let Some(bar) = self.bar.as_ref().filter(|bar| !bar.is_hidden()) {
            bar.set_position(sender.progress().0 as u64);
            bar.set_message(words(sender.state()));
        }
        let (screen, view, due) = self.screen.as_mut()?;
        if Instant::now() >= *due {
            *due = Instant::now() + PERIOD;
            view.update(port.now(), sender, port.blocks_executed(), port.machine());
            screen.show(view);
        }
        screen.command()
    }

    fn write_events(&mut self, port: &dyn Port, sender: &Sender) {
        let Some(log) = &mut self.log else { return };
        let alarm = port.machine().alarm;
        let at = port.now().to_s();
        let lines = log.events.look(sender, port.blocks_executed(), alarm.as_deref());
        let text: String = lines.iter().map(|event| format!("{at:>10.3}  {event}\n")).collect();
        if !text.is_empty() && log.file.write_all(text.as_bytes()).is_err() {
            // A full disk is no reason to leave the tool standing in the cut.
            self.log = None;
        }
    }
}

/// Refuses `--tui` where nobody would see it.
///
/// # Errors
/// There is no terminal.
pub fn need_terminal() -> Result<(), Failure> {
    if std::io::stdin().is_terminal() && std::io::stdout().is_terminal() {
        return Ok(());
    }
    let message = "--tui draws on a terminal and reads its keys: stdin and stdout must both be one; without --tui the \
                   program is sent with a progress bar, and --log FILE writes what happens";
    Err(Failure::Usage(message.into()))
}

fn words(state: State) -> &'static str {
    match state {
        State::Waiting => "waiting for the control's DC1: start DNC operation there",
        State::Sending => "sending",
        State::Stopped => "the control's buffer is full (XOFF)",
        State::Held => "held",
        State::Cut | State::Failed(_) => "ended",
        State::Sent => "all sent, the control executes what it has",
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
