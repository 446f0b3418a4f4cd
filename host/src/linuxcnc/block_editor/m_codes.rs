//! M codes of a block.

use super::{BlockEditor, LinuxCncState, RefusedWord};
use crate::linuxcnc::codes::m_group;

/// Rigid tapping, for the cycle that follows.
const RIGID: i64 = 29;

impl BlockEditor<'_> {
    /// M codes: LinuxCNC stops spindle and coolant before the move of their block, so those words follow behind it.
    pub(super) fn edit_m_codes(&mut self, theirs: &mut LinuxCncState) -> Result<(), RefusedWord> {
        let (mut groups, mut ends) = (Vec::new(), false);
        for word in self.words().iter().filter(|word| word.letter == b'M') {
            let code = word.number.as_whole().unwrap_or(-1);
            if code == RIGID {
                theirs.taps_rigidly = true;
                self.drop_word(word);
                continue;
            }
            let group = m_group(code).map_err(|remedy| (word.column, remedy))?;
            if groups.contains(&group) {
                return Err((
                    word.column,
                    "LinuxCNC takes one M code of a kind per block; write it in a block of its own",
                ));
            }
            groups.push(group);
            let is_end = matches!(code, 0..=2 | 30);
            ends |= matches!(code, 5 | 9);
            if self.has_axis() && (matches!(code, 5 | 9) || is_end) {
                self.later += &format!("M{code} ");
            }
        }
        if !ends {
            self.later.clear();
        }
        self.behind.extend((!self.later.is_empty()).then(|| self.later.trim_end().to_owned()));
        for word in self.words().iter().filter(|word| word.letter == b'M') {
            let is_late = matches!(word.number.as_whole(), Some(0..=2 | 5 | 9 | 30));
            if !self.later.is_empty() && is_late {
                self.drop_word(word);
            }
        }
        Ok(())
    }
}
