//! Warnings about a program's tool path: cuts with a stopped spindle, and G62.

use std::collections::BTreeSet;

use arcfeed_nc::text::Lines;

use super::Diagnostic;

const STOPPED: &str = "this move cuts while the spindle stands still: no M3 or M4 with an S starts it before, or M5 or M6 has stopped it; write \
                       S and M3 before the cut";
const CORNER_OVERRIDE: &str = "G62 has no effect here: the simulated control accelerates before interpolation, and then has no automatic override at \
                               inside corners. A control that has it (parameters 1711 to 1714) reduces F there once more, so chips are only \
                               thinner; if that costs time, write G64 instead";

/// Warnings of the lines of cuts with a `stopped` spindle and of a line with G62, each with the text of its line in the program.
pub(super) fn warnings<'a>(
    stopped: &BTreeSet<usize>,
    corner_override: Option<usize>,
    program: &'a [u8],
) -> Vec<(Diagnostic, &'a [u8])> {
    if stopped.is_empty() && corner_override.is_none() {
        return Vec::new();
    }
    let of_line = |line| {
        let stopped = stopped.contains(&line).then_some(STOPPED);
        stopped.into_iter().chain((corner_override == Some(line)).then_some(CORNER_OVERRIDE))
    };
    let lines = (1..).zip(Lines::new(program));
    let found = lines.flat_map(|(line, raw)| of_line(line).map(move |message| (line, raw.text, message)));
    found.map(|(line, text, message)| (Diagnostic::of_line(line, text, message), text)).collect()
}
