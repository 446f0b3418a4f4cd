//! `--store`: reads programs into the control's memory and punches them, as an operator does with READ and PUNCH.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use arcfeed_control::store::{Store, StoreState};
use arcfeed_hil_sim::simulated_machine::STEP;

use super::super::outcome::{Failure, say};
use super::super::simulate::control::control_settings;
use super::line::ControlLine;
use super::{PERIOD, Serve};
use crate::job::JobFile;
use crate::plural::counted;

impl Serve {
    /// Reads a program and punches it at each request; with `--once` one time.
    pub(super) fn keep_programs(
        &self,
        file: &JobFile,
        line: &mut ControlLine,
        interrupted: &AtomicBool,
    ) -> Result<(), Failure> {
        let mut settings = control_settings(file);
        self.panel.apply(&mut settings);
        let mut store = Store::new(settings.line);
        let mut state = store.state();
        while !interrupted.load(Ordering::Relaxed) {
            let started = Instant::now();
            for _ in 0..self.speed {
                if !line.has_sender() {
                    // An interrupted program is not kept.
                    if store.state() == StoreState::Reading {
                        store = Store::new(settings.line);
                    }
                    line.begin();
                }
                let has_sender = line.has_sender();
                if has_sender {
                    let is_punching = store.state() == StoreState::Punching;
                    line.feed_control(store.port(), !is_punching)?;
                }
                // A receiver of the last character may be gone before the control knows that it was the last.
                if has_sender || store.state() == StoreState::Punching {
                    store.step(STEP);
                }
                line.answer(store.port())?;
            }
            match (state, store.state()) {
                (_, StoreState::Refused(fault)) => {
                    line.wait_for_silence(|| interrupted.load(Ordering::Relaxed))?;
                    let failure = Failure::Machine(format!("the control refused the program: {}", fault.cause));
                    if self.once || !line.hang_up() {
                        return Err(failure);
                    }
                    let _serves_on = failure.report();
                    store = Store::new(settings.line);
                }
                (StoreState::Reading, StoreState::Stored) => {
                    say(format_args!("stored: {}", counted(store.blocks().len(), "block")));
                }
                (StoreState::Punching, StoreState::Stored) => {
                    say(format_args!("punched: {}", counted(store.blocks().len(), "block")));
                    if self.once {
                        // Closing a pseudo-terminal discards unread data.
                        return line.wait_for_silence(|| interrupted.load(Ordering::Relaxed));
                    }
                }
                _ => {}
            }
            state = store.state();
            std::thread::sleep(PERIOD.saturating_sub(started.elapsed()));
        }
        Err(Failure::Stopped("stopped by the operator".into()))
    }
}
