//! Functions that the M, S and T words before a block have left on (spindle, coolant, tool), for a restart in the
//! middle of a program.

use arcfeed_nc::block::Block;

/// Spindle, coolant and tool functions that the blocks read so far have left in force.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Functions {
    /// 3, 4 or 5 for the last M3, M4 or M5 (M19 counts as M5); `None` before the first of them.
    pub spindle: Option<i64>,
    /// Whether M7 and M8 are on, in this order.
    pub coolant: [bool; 2],
    /// Number of the last T word, the tool that the next M6 loads; `None` before the first.
    pub prepared: Option<i64>,
    /// Number of the tool that the last M6 has loaded; `None` before the first M6 or if no T word stood before it.
    pub tool: Option<i64>,
    /// Other M codes, which only the machine's builder defines, each once, in order; their effect is unknown here.
    pub others: Vec<i64>,
}

impl Functions {
    /// Updates the functions by the M and T words of the next block.
    pub fn take(&mut self, block: &Block) {
        let of = |letter: u8| block.words.iter().filter(move |word| word.letter == letter);
        self.prepared = of(b'T').next_back().map(|word| word.number.scaled(1)).or(self.prepared);
        for code in of(b'M').filter_map(|word| word.number.as_whole()) {
            match code {
                3..=5 => self.spindle = Some(code),
                19 => self.spindle = Some(5),
                6 => self.tool = self.prepared,
                7 => self.coolant[0] = true,
                8 => self.coolant[1] = true,
                9 => self.coolant = [false; 2],
                0 | 1 | 2 | 30 => {}
                _ if self.others.contains(&code) => {}
                _ => self.others.push(code),
            }
        }
    }

    /// Blocks that switch spindle and coolant on again, one function each; `speed` is the S word, if the program has
    /// given one.
    pub fn words(&self, speed: Option<i64>) -> Vec<String> {
        let mut blocks = Vec::new();
        let speed = speed.map(|speed| format!("S{speed}")).unwrap_or_default();
        match self.spindle {
            Some(code @ (3 | 4)) => blocks.push(format!("{speed}M{code}")),
            Some(_) | None if !speed.is_empty() => blocks.push(speed),
            Some(_) | None => {}
        }
        let codes = [7, 8].into_iter().zip(self.coolant).filter(|(_, is_on)| *is_on);
        blocks.extend(codes.map(|(code, _)| format!("M{code}")));
        blocks
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arcfeed_nc::block::{Reading, parse_line};

    #[test]
    fn the_last_word_of_each_kind_counts() {
        let mut functions = Functions::default();
        for text in ["T14M6", "S1000M3", "M8", "T15", "M64", "M7M9", "M8", "M64"] {
            functions.take(&parse_line(text.as_bytes(), Reading::Lenient).unwrap().block);
        }
        assert_eq!((functions.tool, functions.prepared, functions.others.as_slice()), (Some(14), Some(15), &[64][..]));
        assert_eq!(functions.words(Some(1_000)), ["S1000M3", "M8"]);
    }
}
