//! The terminal: drawn and listened to by a thread of its own, and given back as it was.

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

/// Time between two pictures.
const PERIOD: Duration = Duration::from_millis(100);

/// How long the thread may take to give the terminal back: where the terminal is gone, reading it may never end.
const GIVEN_BACK_MAX: Duration = Duration::from_secs(2);

/// A terminal taken over; dropped, it is as it was.
#[derive(Debug)]
pub struct Screen {
    latest: Arc<Mutex<View>>,
    commands: Receiver<Command>,
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Screen {
    /// Takes the terminal over.
    ///
    /// # Errors
    /// It is none, or does not do what it is told.
    pub fn open(first: View) -> io::Result<Self> {
        let ends = Arc::new(AtomicBool::new(false));
        // Gives the terminal back in a panic, too; before that nobody may draw any more.
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
            // Without a terminal the program goes on as it would without a screen: nothing is lost but the picture.
            let mut terminal = terminal;
            let _terminal_gone = work(&mut terminal, &shown, &sender, &over).and(terminal.show_cursor());
            // Dropped, it would complain on stderr, and panic where that is gone with it.
            std::mem::forget(terminal);
        });
        Ok(Screen { latest, commands, ends, thread: Some(thread) })
    }

    /// Shows this from the next picture on; never waits for the terminal.
    pub fn show(&self, view: &View) {
        if let Ok(mut latest) = self.latest.try_lock() {
            latest.clone_from(view);
        }
    }

    /// What the operator wants, each once.
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
        // Not `restore`, which panics where stderr is gone with the terminal.
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
