//! Kinds of slots of a rotor with splitters: the planned one, its name, and the flaws of all.

use arcfeed_plan::geometry::blisk::Blisk;
use arcfeed_plan::geometry::flaws::flaws;
use toml::Spanned;

use super::PartFile;
use crate::job::{Complaint, at};

impl PartFile {
    /// Flaws of the blades and slots of all kinds, in words.
    pub fn flaws(&self) -> Vec<String> {
        let of_blade = |index: i32| {
            let found = flaws(&self.blisk.from_blade(index), self.roughing.allowance_mm);
            let name = self.blade_name(index).map_or(String::new(), |name| format!("{name}: "));
            found.into_iter().map(move |flaw| format!("{name}{flaw}"))
        };
        (0..self.blisk.kinds()).flat_map(of_blade).collect()
    }

    /// Name of a blade of [`blisk`](Self::blisk) by its index; `None` if all blades are alike.
    pub fn blade_name(&self, index: i32) -> Option<&'static str> {
        let is_main = (self.slot - 1 + index).rem_euclid(self.blisk.kinds()) == 0;
        (self.blisk.kinds() > 1).then_some(if is_main { "main blade" } else { "splitter" })
    }

    /// Name of the planned kind of slot; `None` if all slots are alike.
    pub fn slot_name(&self) -> Option<String> {
        let [from, to] = [self.blade_name(0)?, self.blade_name(1)?];
        Some(format!("slot {} of {}, from the {from}'s pressure side to the {to}", self.slot, self.blisk.kinds()))
    }

    /// Sentence that a rotor with splitters also needs the plan of its other slots; `None` if all slots are alike.
    pub fn both_slots(&self) -> Option<String> {
        let other = self.blisk.kinds() + 1 - self.slot;
        let slot = self.slot_name()?;
        Some(format!("This is {slot}; the part also needs the program of `slot = {other}` in [roughing]."))
    }
}

/// Kind of slot that is planned.
pub(super) fn slot(entry: Option<&Spanned<i64>>, blisk: &Blisk) -> Result<i32, Complaint> {
    let Some(entry) = entry else { return Ok(1) };
    let given = i32::try_from(*entry.as_ref()).ok().filter(|slot| (1..=blisk.kinds()).contains(slot));
    let message = match blisk.kinds() {
        1 => "all slots of this rotor are of one kind: `slot` is 1, or is left out; 2 is for rotors with splitters",
        _ => {
            "`slot` is 1, from the main blade's pressure side to the splitter, or 2, from the splitter's pressure side to the main blade"
        }
    };
    given.ok_or_else(|| at(entry, message))
}
