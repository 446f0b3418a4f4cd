//! Place in a line's text where an F word is written, also where the present F has an expression as its value.

use arcfeed_nc_macro::code::MacroCode;

use super::rewrite::Edit;

/// Edit that writes the F word `word` into a line: in place of the line's last F word, or after its last word if it has
/// none.
pub fn put_feed(text: &[u8], word: &str) -> Edit {
    let bytes = code_of(text);
    let end = bytes.last().map_or(text.len(), |(_, offset)| offset + 1);
    let found = words(&bytes).filter(|[first, _]| bytes[*first].0 == b'F').last();
    let (at, len) = found.map_or((end, 0), |[first, last]| {
        let [from, to] = [first, last].map(|index| bytes[index].1);
        (from, to + 1 - from)
    });
    Edit { at, len, new: word.to_owned() }
}

/// Bytes of the code, each with its offset in the line.
fn code_of(text: &[u8]) -> Vec<(u8, usize)> {
    let code = MacroCode::new(text);
    let mut cursor = code.cursor();
    std::iter::from_fn(|| {
        let found = (cursor.peek()?, usize::from(cursor.column()) - 1);
        cursor.skip(1);
        Some(found)
    })
    .collect()
}

/// Indices of the first and the last byte of each word: an address and its value up to the next address.
fn words(bytes: &[(u8, usize)]) -> impl Iterator<Item = [usize; 2]> {
    let (mut depth, mut index, mut starts) = (0_usize, 0, Vec::new());
    while let Some((byte, _)) = bytes.get(index) {
        index += 1;
        match byte {
            b'[' => depth += 1,
            b']' => depth = depth.saturating_sub(1),
            b'A'..=b'Z' if depth == 0 => {
                starts.push(index - 1);
                index += function_len(&bytes[index..]);
            }
            _ => {}
        }
    }
    let ends: Vec<usize> = starts.iter().skip(1).copied().chain([bytes.len()]).collect();
    starts.into_iter().zip(ends).map(|(first, end)| [first, end - 1])
}

/// Length of a sign and a function's name before its bracket, as in `X-SIN[#1]`.
fn function_len(bytes: &[(u8, usize)]) -> usize {
    let sign = usize::from(matches!(bytes.first(), Some((b'+' | b'-', _))));
    let name = bytes[sign..].iter().take_while(|(byte, _)| byte.is_ascii_uppercase()).count();
    let has_bracket = matches!(bytes.get(sign + name), Some((b'[', _)));
    if has_bracket { sign + name } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapt::rewrite::apply;

    #[test]
    fn an_f_is_put_in_place_of_the_last_one_or_behind_the_last_word() {
        for (line, put) in [
            ("G1X1.F25.Y2.", "G1X1.F80.Y2."),
            ("N5 G1 X#1 (CUT)", "N5 G1 X#1F80. (CUT)"),
            ("G1X[#1+SIN[30]*FIX[#2]]F#9 Y2.", "G1X[#1+SIN[30]*FIX[#2]]F80. Y2."),
            ("G1XFUP[#1]F-ABS[#9]Z-1.", "G1XFUP[#1]F80.Z-1."),
            ("G3I-#4F[#9*2]", "G3I-#4F80."),
            ("G1X-FIX[#3]", "G1X-FIX[#3]F80."),
            ("F 25. X1. F (A) 30.", "F 25. X1. F80."),
            ("G1X1.M98P1000", "G1X1.M98P1000F80."),
        ] {
            let changed = apply(line.as_bytes(), &[put_feed(line.as_bytes(), "F80.")]);
            assert_eq!(String::from_utf8_lossy(&changed), put, "{line}");
        }
    }
}
