//! Statistics of instruction counts: number, median, maximum.

use cortex_m_semihosting::hprintln;

/// Maximum number of counts; more than the ticks of the example.
const COUNTS_MAX: usize = 1 << 16;

/// Instruction counts of one kind of tick, for median and maximum.
#[derive(Debug)]
pub struct Costs {
    counts: heapless::Vec<u32, COUNTS_MAX>,
}

impl Default for Costs {
    fn default() -> Self {
        Costs { counts: heapless::Vec::new() }
    }
}

impl Costs {
    /// Adds one count. After [`COUNTS_MAX`] counts more are left out.
    pub fn add(&mut self, instructions: u32) {
        let _ = self.counts.push(instructions);
    }

    /// Whether no count was added.
    pub fn is_empty(&self) -> bool {
        self.counts.is_empty()
    }

    /// Prints `NAME count N median M worst W`, where NAME consists of `kind` and `name`, and the figures are
    /// instructions.
    pub fn print(&mut self, kind: &str, name: &str) {
        self.counts.sort_unstable();
        let median = self.counts.get(self.counts.len() / 2).copied().unwrap_or_default();
        let worst = self.counts.last().copied().unwrap_or_default();
        hprintln!("{}{} count {} median {} worst {}", kind, name, self.counts.len(), median, worst);
    }
}
