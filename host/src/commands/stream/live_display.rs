//! Display while a program is sent: the screen, or a progress bar on a terminal; the live page; and the log of events.

use std::fs::File;
use std::io::{IsTerminal, Write};
use std::path::Path;
use std::time::{Duration, Instant, SystemTime};

use arcfeed_units::Micros;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::super::outcome::{Failure, file_failure};
use crate::console::note;
use crate::dnc::events::Events;
use crate::dnc::{Sender, State};
use crate::features::not_built_in;
use crate::output;
use crate::port::Port;
use crate::port::clock::iso_8601;
use crate::screen::Screen;
use crate::screen::view::{Command, View};
use crate::web::LivePage;
use crate::web::snapshot::Snapshot;

/// Wall time between two states of the screen, and between two samples of its strip.
const PERIOD: Duration = Duration::from_millis(100);
/// Wall time between two states of the live page.
const PAGE_PERIOD: Duration = Duration::from_millis(50);

/// Display of a transmission while it runs, with the event log.
pub struct LiveDisplay {
    bar: Option<ProgressBar>,
    shown: Option<ShownView>,
    log: Option<EventLog>,
}

/// View, and the places that show it.
struct ShownView {
    view: View,
    screen: Option<Screen>,
    page: Option<LivePage>,
    due: Instant,
    sample_due: Instant,
}

struct EventLog {
    file: File,
    events: Events,
}

impl LiveDisplay {
    /// Progress bar for `total` characters; nothing if stderr is not a terminal.
    pub fn bar(total: usize) -> Self {
        let bar = ProgressBar::with_draw_target(Some(total as u64), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}") {
            bar.set_style(style);
        }
        LiveDisplay { bar: Some(bar), shown: None, log: None }
    }

    /// Display that shows nothing.
    pub fn nothing() -> Self {
        LiveDisplay { bar: None, shown: None, log: None }
    }

    /// Display on the whole terminal (`--tui`).
    ///
    /// # Errors
    /// Stdout is no terminal.
    pub fn screen(view: View) -> Result<Self, Failure> {
        let failed = |error: std::io::Error| Failure::Usage(format!("--tui: {error}"));
        let screen = Screen::open(view.clone()).map_err(failed)?;
        Ok(LiveDisplay { bar: None, shown: Some(ShownView::new(view, Some(screen))), log: None })
    }

    /// Adds a live page in the browser to the display.
    pub fn on_page(mut self, view: View, page: LivePage) -> Self {
        self.shown.get_or_insert_with(|| ShownView::new(view, None)).page = Some(page);
        self
    }

    /// Adds a log file of all events to the display.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn logging(
        mut self,
        path: &Path,
        title: &str,
        opened: Option<SystemTime>,
        sender: &Sender,
    ) -> Result<Self, Failure> {
        let opened = opened.map_or("simulated time".into(), |time| format!("opened {}", iso_8601(time)));
        let begin = || {
            let mut file = output::create(path)?;
            writeln!(file, "# {title}; {opened}; seconds since the line was opened")?;
            Ok(file)
        };
        let file = begin().map_err(|error: std::io::Error| file_failure(path, &error))?;
        self.log = Some(EventLog { file, events: Events::new(sender) });
        Ok(self)
    }

    /// Shows a warning at once: on the screen, or on stderr, and in the log.
    pub fn warn(&mut self, now: Micros, warning: String) {
        self.log_lines(now, std::slice::from_ref(&warning));
        if let Some(shown) = &mut self.shown {
            shown.view.warning = Some(warning.clone());
            shown.due = Instant::now();
        }
        match &self.bar {
            _ if self.shown.as_ref().is_some_and(|shown| shown.screen.is_some()) => {}
            Some(bar) if !bar.is_hidden() => bar.println(warning),
            _ => note(format_args!("{warning}")),
        }
    }

    /// Updates the display; `executed` is the number of blocks that the control has started, if that is known. Returns
    /// a command that the operator has given.
    pub fn show(&mut self, port: &dyn Port, sender: &Sender, executed: Option<usize>) -> Option<Command> {
        self.write_events(port, sender);
        if let Some(bar) = self.bar.as_ref().filter(|bar| !bar.is_hidden()) {
            bar.set_position(sender.progress().0 as u64);
            let damaged = port.line_errors().map_or(0, |errors| errors.total());
            let damage = if damaged > 0 { format!(", {damaged} damaged characters") } else { String::new() };
            bar.set_message(format!("{}{damage}", words(sender.state())));
        }
        let shown = self.shown.as_mut()?;
        if Instant::now() >= shown.due {
            shown.update(port, sender, executed);
        }
        shown.command()
    }

    /// Updates the display for the last time.
    pub fn show_end(&mut self, port: &dyn Port, sender: &Sender, executed: Option<usize>) {
        self.write_events(port, sender);
        if let Some(shown) = &mut self.shown {
            shown.update(port, sender, executed);
            if let Some(page) = &mut shown.page {
                page.end(Snapshot::new(&shown.view));
            }
        }
    }

    /// Sets the state of the feed board that is shown; `None` without a board.
    pub fn set_board(&mut self, state: Option<&'static str>) {
        if let Some(shown) = &mut self.shown {
            shown.view.board = state;
        }
    }

    fn write_events(&mut self, port: &dyn Port, sender: &Sender) {
        let Some(log) = &mut self.log else { return };
        let alarm = port.machine().alarm;
        let lines = log.events.messages(sender, port.blocks_executed(), alarm.as_deref());
        self.log_lines(port.now(), &lines);
    }

    fn log_lines(&mut self, now: Micros, lines: &[String]) {
        let Some(log) = &mut self.log else { return };
        let at = now.to_s();
        let text: String = lines.iter().map(|event| format!("{at:>10.3}  {event}\n")).collect();
        if !text.is_empty() && log.file.write_all(text.as_bytes()).is_err() {
            // A full disk is no reason to leave the tool standing in the cut.
            self.log = None;
        }
    }
}

impl ShownView {
    fn new(view: View, screen: Option<Screen>) -> Self {
        ShownView { view, screen, page: None, due: Instant::now(), sample_due: Instant::now() }
    }

    fn update(&mut self, port: &dyn Port, sender: &Sender, executed: Option<usize>) {
        let (view, now) = (&mut self.view, Instant::now());
        let period = if self.page.is_some() { PAGE_PERIOD } else { PERIOD };
        // From when it was due, so that the waits of the sending loop do not add up.
        self.due = (self.due + period).max(now);
        view.is_least = port.blocks_executed().is_none();
        view.update(port.now(), sender, executed, port.machine());
        view.damaged = port.line_errors().map(|errors| errors.total());
        if now >= self.sample_due {
            self.sample_due = now + PERIOD;
            view.sample();
        }
        if let Some(screen) = &self.screen {
            screen.show(view);
        }
        if let Some(page) = &self.page {
            page.show(Snapshot::new(view));
        }
    }

    /// Command from the keys or from a browser.
    fn command(&self) -> Option<Command> {
        let key = self.screen.as_ref().and_then(Screen::command);
        key.or_else(|| self.page.as_ref().and_then(LivePage::command))
    }
}

/// Rejects `--tui` without a terminal.
///
/// # Errors
/// There is no terminal, or this build has no terminal screen.
pub fn need_terminal() -> Result<(), Failure> {
    if cfg!(not(feature = "tui")) {
        return Err(Failure::Usage(format!("--tui: {}", not_built_in("the terminal view", "tui"))));
    }
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
        State::Aborted | State::Failed(_) => "ended",
        State::Sent => "all sent, the control executes what it has",
    }
}

impl Drop for LiveDisplay {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
