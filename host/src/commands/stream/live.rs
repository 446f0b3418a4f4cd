//! What a person sees while a program is sent: a progress bar on a terminal, nothing elsewhere.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::dnc::{Sender, State};

/// The bar; it vanishes when dropped.
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// A bar over `total` characters; hidden where stderr is no terminal or `shown` is false.
    pub fn new(total: usize, shown: bool) -> Self {
        let target = if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(Some(total as u64), target);
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}") {
            bar.set_style(style);
        }
        Progress { bar }
    }

    /// Shows where the sender stands.
    pub fn show(&self, sender: &Sender) {
        if self.bar.is_hidden() {
            return;
        }
        let (sent, _) = sender.progress();
        self.bar.set_position(sent as u64);
        self.bar.set_message(match sender.state() {
            State::Waiting => "waiting for the control's DC1: start DNC operation there",
            State::Sending => "sending",
            State::Stopped => "the control's buffer is full (XOFF)",
            State::Held => "held",
            State::Cut | State::Failed(_) => "ended",
            State::Sent => "all sent, the control executes what it has",
        });
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
