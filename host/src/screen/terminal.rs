//! Terminal of the screen. A thread of its own draws it and reads the keys, and restores it at the end.

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers, poll, read};

use super::render::render;
use super::view::{Command, Press, View};

/// Time between two redraws.
const PERIOD: Duration = Duration::from_millis(100);

/// Longest time for restoring the terminal: if the terminal is gone, reading it may never end.
const GIVEN_BACK_MAX: Duration = Duration::from_secs(2);

/// Terminal used by the screen; dropping it restores the terminal.
#[derive(Debug)]
pub struct Screen {
    latest: Arc<Mutex<View>>,
    commands: Receiver<Command>,
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Screen {
    /// Switches the terminal to the screen and shows the view `first`.
    ///
    /// # Errors
    /// Stdout is no terminal, or the terminal fails.
    pub fn open(first: View) -> io::Result<Self> {
        let ends = Arc::new(AtomicBool::new(false));
        // Restores the terminal in a panic, too; nothing may draw after that.
        let terminal = ratatui::try_init()?;
        let gives_back = std::panic::take_hook();
        let over = Arc::clone(&ends);
        std::panic::set_hook(Box::new(move |panic| {
            over.store(true, Ordering::Relaxed);
            gives_back(panic);
        }));
        let latest = Arc::new(Mutex::new(first));
        let (sender, commands) = channel();
        let (shown, over) = (Arc::clone(&latest), Arc::clone(&ends));
        let thread = std::thread::spawn(move || {
            // Without a terminal the program continues as it would without a screen; only the picture is missing.
            let mut terminal = terminal;
            let _terminal_gone = work(&mut terminal, &shown, &sender, &over).and(terminal.show_cursor());
            // Dropping it would print a message on stderr, and panic if that is gone as well.
            std::mem::forget(terminal);
        });
        Ok(Screen { latest, commands, ends, thread: Some(thread) })
    }

    /// Shows this view from the next redraw on; returns at once.
    pub fn show(&self, view: &View) {
        if let Ok(mut latest) = self.latest.try_lock() {
            latest.clone_from(view);
        }
    }

    /// Next command of the operator, each once; `None` if there is none.
    pub fn command(&self) -> Option<Command> {
        self.commands.try_recv().ok()
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
        let latest = Instant::now() + GIVEN_BACK_MAX;
        let left = || latest.saturating_duration_since(Instant::now());
        // The thread's end closes the channel.
        let ended = std::iter::repeat_with(|| self.commands.recv_timeout(left())).find_map(Result::err);
        if ended != Some(RecvTimeoutError::Disconnected) {
            return;
        }
        let _panicked = self.thread.take().map(JoinHandle::join);
        // Not `restore`, which panics if stderr is gone with the terminal.
        let _terminal_gone = ratatui::try_restore();
    }
}

fn work(
    terminal: &mut DefaultTerminal,
    latest: &Mutex<View>,
    commands: &Sender<Command>,
    ends: &AtomicBool,
) -> io::Result<()> {
    let (mut question, mut due) = (None, Instant::now());
    while !ends.load(Ordering::Relaxed) {
        let now = Instant::now();
        if now >= due {
            let mut view = latest.lock().unwrap_or_else(PoisonError::into_inner).clone();
            view.question = question;
            terminal.draw(|frame| render(frame, &view))?;
            due = now + PERIOD;
        }
        if !poll(due.saturating_duration_since(Instant::now()))? {
            continue;
        }
        if let Event::Key(key) = read()?
            && key.kind == KeyEventKind::Press
        {
            let state = latest.lock().unwrap_or_else(PoisonError::into_inner).state;
            if let Some(command) = press(&key).decide(&mut question, state) {
                let _nobody_listens = commands.send(command);
            }
        }
    }
    Ok(())
}

fn press(key: &KeyEvent) -> Press {
    match key.code {
        KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => Press::Abort,
        KeyCode::Char('q') => Press::Abort,
        KeyCode::Char(' ' | 'h') => Press::Hold,
        KeyCode::Char('r') => Press::Resume,
        KeyCode::Char('y') => Press::Yes,
        _ => Press::Other,
    }
}
