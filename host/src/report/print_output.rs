//! Output of POPEN, DPRNT, BPRNT and PCLOS, as lines.

/// Printed lines in the control's output: without DC2, DC4 and parity bits; other codes are escaped as in Rust.
pub fn lines(bytes: &[u8]) -> Vec<String> {
    let text: Vec<u8> =
        bytes.iter().map(|byte| byte & 0x7F).filter(|byte| !matches!(byte, 0x11..=0x14 | b'\r')).collect();
    let lines = text.split(|byte| *byte == b'\n').map(|line| line.escape_ascii().to_string());
    lines.filter(|line| !line.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_codes_are_no_text_and_the_last_line_may_lack_its_end() {
        assert_eq!(lines(b"\x12X  1.5\n\r\rY-2.\n\x14"), ["X  1.5", "Y-2."]);
        assert_eq!(lines(b"\x12A\x8D\x0A\xB1"), ["A", "1"]);
        assert_eq!(lines(b"\x12C\x01\n"), ["C\\x01"]);
        assert_eq!(lines(b"\x12\x14"), [""; 0]);
    }
}
