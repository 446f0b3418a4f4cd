//! Line of the program for each executed block.

use arcfeed_nc::text::Lines;

/// Lines of the program, counted from 1, of the executed blocks in their order; `None` for a block that is not in it.
/// `line_ends` has the end of each program line in the text as sent.
///
/// The control executes each block as received, so it is the next line of the text with the same bytes.
pub fn block_lines(executed: &[Vec<u8>], text: &[u8], line_ends: &[usize]) -> Vec<Option<usize>> {
    let begins = std::iter::once(0).chain(line_ends.iter().copied());
    let spans = (1..).zip(begins.zip(line_ends));
    let piece = |begin: usize, end: usize| text.get(begin..end).unwrap_or_default();
    let lines =
        spans.flat_map(|(line, (begin, end))| Lines::new(piece(begin, *end)).map(move |sent| (line, sent.text)));
    let mut left = lines;
    let mut next_line = |block: &Vec<u8>| {
        let mut search = left.clone();
        let line = search.find(|(_, sent)| sent.trim_ascii() == block.trim_ascii())?.0;
        left = search;
        Some(line)
    };
    executed.iter().map(&mut next_line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pieces_of_a_line_belong_to_it_and_comments_are_no_blocks() {
        let text = b"%\n(A)\nN1G1X1.\nG2X2.R9.F1.\nG2X3.R9.F2.\nN1G1X1.\n".to_vec();
        // The fourth line of the program is sent in two pieces.
        let line_ends = vec![2, 6, 14, 38, 46];
        let executed =
            ["N1G1X1.", "G2X2.R9.F1.", "G2X3.R9.F2.", "G99", "N1G1X1."].map(|block| block.as_bytes().to_vec());
        assert_eq!(block_lines(&executed, &text, &line_ends), [Some(3), Some(4), Some(4), None, Some(5)]);
    }
}
