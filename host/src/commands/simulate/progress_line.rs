//! Line on stderr that shows how far a simulation is. A page in a browser has none.

#[cfg(not(target_family = "wasm"))]
use indicatif::{ProgressBar, ProgressDrawTarget};

/// Line on stderr that shows the progress of a simulation.
pub struct ProgressLine<'n> {
    /// Word for what is simulated.
    name: &'n str,
    #[cfg(not(target_family = "wasm"))]
    bar: ProgressBar,
}

impl<'n> ProgressLine<'n> {
    /// Shows a line that begins with `name`.
    pub fn begin(name: &'n str) -> Self {
        ProgressLine {
            name,
            #[cfg(not(target_family = "wasm"))]
            bar: ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr()),
        }
    }

    /// Updates the line: number of executed blocks, and machine time, s.
    pub fn show(&self, blocks: usize, time_s: f64) {
        #[cfg(not(target_family = "wasm"))]
        {
            self.bar.set_message(format!("{}: {blocks} blocks, {time_s:.0} s of machine time", self.name));
            self.bar.tick();
        }
        #[cfg(target_family = "wasm")]
        let _not_shown = (self.name, blocks, time_s);
    }

    /// Removes the line.
    pub fn clear(&self) {
        #[cfg(not(target_family = "wasm"))]
        self.bar.finish_and_clear();
    }
}
