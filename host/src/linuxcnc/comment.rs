//! Comments for LinuxCNC, which does not nest them and executes some of them.

/// First words of comments that LinuxCNC executes.
const ACTIVE: [&str; 14] = [
    "MSG",
    "DEBUG",
    "PRINT",
    "LOG",
    "LOGOPEN",
    "LOGAPPEND",
    "LOGCLOSE",
    "PROBEOPEN",
    "PROBECLOSE",
    "PY",
    "PYRUN",
    "PYRELOAD",
    "ABORT",
    "AXIS",
];

/// A comment with this text, which LinuxCNC only displays.
pub fn comment(text: &[u8]) -> Vec<u8> {
    let first: Vec<u8> = text.iter().copied().filter(|byte| !byte.is_ascii_whitespace()).collect();
    let first = first.split(|byte| *byte == b',').next().unwrap_or_default().to_ascii_uppercase();
    let is_active = text.contains(&b',') && ACTIVE.iter().any(|word| word.as_bytes() == first);
    let mut comment = b"(".to_vec();
    comment.extend_from_slice(if is_active { b"NC " } else { b"" });
    comment.extend(text.iter().filter(|byte| **byte != b'\r').map(|&byte| match byte {
        b'(' => b'[',
        b')' => b']',
        _ => byte,
    }));
    comment.push(b')');
    comment
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_comment_is_nested_or_executed() {
        for (text, expected) in [
            ("TOOL", "(TOOL)"),
            ("A (B", "(A [B)"),
            ("MSG, STOP", "(NC MSG, STOP)"),
            (" py , x", "(NC  py , x)"),
            ("MESSAGE, STOP", "(MESSAGE, STOP)"),
        ] {
            assert_eq!(String::from_utf8_lossy(&comment(text.as_bytes())), expected);
        }
    }
}
