//! Remedies for what programs of other controls contain: whose it is, and what a Fanuc has in its place.

use arcfeed_nc::alarm::{Alarm, Cause, Fault, NotModelled};
use arcfeed_nc::number;

/// G codes of other controls, in tenths, from first to last of a row.
const FOREIGN_G: [(u16, u16, &str); 29] = [
    (52, 53, "G5.2 and G5.3 are splines of LinuxCNC: post lines and arcs"),
    (120, 130, "G12 and G13 are circular pockets of a Haas or a Mazak: write the circles with G2 or G3"),
    (331, 331, "G33.1 is the rigid tapping of LinuxCNC: write M29 S and then G84"),
    (350, 360, "G35 and G36 are probing cycles of a Haas: call the probe's macro with G65 P"),
    (382, 385, "G38 with a decimal is the probing of LinuxCNC: write G31, or call the probe's macro with G65 P"),
    (591, 593, "G59.1 to G59.3 are work offsets of LinuxCNC: write G54.1 P1 to P3"),
    (611, 611, "G61.1 is LinuxCNC's exact path, or high accuracy on a Mazak or a Mitsubishi: write G61, or G5.1 Q1"),
    (700, 710, "G70 and G71 select inches and millimetres on other controls: write G20 or G21"),
    (720, 720, "G72 is a bolt hole pattern of a Haas: write the holes"),
    (842, 842, "G84.2 is rigid tapping in the FS10/11 format (parameter 0001 bit 1): write M29 S and then G84"),
    (843, 843, "G84.3 is rigid tapping in the FS10/11 format (parameter 0001 bit 1): write M29 S and then G74"),
    (
        901,
        901,
        "G90.1 makes I, J, K coordinates on LinuxCNC and Mach3: post them as distances from the arc's start, or say in the \
         settings that the control has it: arc_centers = \"absolute\"",
    ),
    (
        911,
        911,
        "G91.1 makes I, J, K distances from the start on LinuxCNC and Mach3, which they always are on a Fanuc: remove it, or \
         say in the settings that the control has it: arc_centers = \"incremental\"",
    ),
    (922, 923, "G92.2 and G92.3 switch offsets of LinuxCNC: write G92.1, or G92 with the coordinates"),
    (1000, 1010, "G100 and G101 are the mirror image of a Haas: write G50.1 and G51.1"),
    (1030, 1030, "G103 limits the look-ahead of a Haas: remove it"),
    (1070, 1070, "G107 is the cylinder of a Haas: post the moves of the rotary axis"),
    (1100, 1290, "G110 to G129 are work offsets of a Haas: write G54.1 P1 to P20"),
    (1360, 1370, "G136 is a probing cycle of a Haas: call the probe's macro with G65 P"),
    (1410, 1410, "G141 is the 3D cutter compensation of a Haas: post the tool centre's path"),
    (1430, 1430, "G143 is the five-axis tool length compensation of a Haas: write G43.4 H"),
    (1500, 1500, "G150 is a pocket of a Haas: post its moves"),
    (1530, 1530, "G153 is the machine's coordinates on other controls: write G53"),
    (1540, 1540, "G154 P is a work offset of a Haas: write G54.1 P"),
    (1870, 1880, "G187 is the smoothness of a Haas: remove it, or write G5.1 Q1"),
    (2340, 2340, "G234 is the tool centre point control of a Haas: write G43.4 H"),
    (2530, 2530, "G253 turns the tool to the plane on a Haas: write G53.1"),
    (2540, 2550, "G254 and G255 are the dynamic work offset of a Haas: write G54.2 P"),
    (2680, 2690, "G268 and G269 are the tilted plane of a Haas: write G68.2 and G69"),
];
/// Words of programs that are no NC blocks.
const FOREIGN_TEXT: [(&[u8], &str); 8] = [
    (b" PGM ", "this is a conversational program of a Heidenhain: post it for a Fanuc"),
    (b"TOOL CALL", "TOOL CALL is conversational text of a Heidenhain: write T and M6"),
    (b"BLK FORM", "BLK FORM is conversational text of a Heidenhain: remove it"),
    (b"FMAX", "this is conversational text of a Heidenhain: post the program for a Fanuc"),
    (b"CYCLE", "CYCLE is a cycle of a Siemens: write G81 to G89"),
    (b"MSG(", "MSG is a message of a Siemens: write a comment in ( )"),
    (b"DEF ", "DEF is a declaration of a Siemens: post the program for a Fanuc"),
    (b"CR=", "CR= is the arc's radius on a Siemens: write R"),
];
/// Words behind the O of LinuxCNC's flow control.
const FLOW_WORDS: [&[u8]; 15] = [
    b"SUB",
    b"ENDSUB",
    b"CALL",
    b"RETURN",
    b"IF",
    b"ELSEIF",
    b"ELSE",
    b"ENDIF",
    b"WHILE",
    b"ENDWHILE",
    b"DO",
    b"REPEAT",
    b"ENDREPEAT",
    b"BREAK",
    b"CONTINUE",
];
pub(super) const FLOW_WORD: &str = "O with sub, call, if, while, do or repeat is the flow control of LinuxCNC, and a Fanuc would \
                                     not execute it; write the subprogram as O and a number up to M99, call it with M98 P or G65 P, and \
                                     write IF, WHILE and GOTO of a macro";
const EQUALS: &str = "an address with = is the spelling of a Siemens: write the number behind the letter";
const NESTED: &str = "the first ) ends a comment, so comments cannot be nested: remove the inner brackets";
const COMMENT: &str = "a comment is written in ( ) on a Fanuc";
const FAR_SYSTEM: &str = "a 16i and a 0i have G54.1 P1 to P48, a 31i P1 to P300 (--control fanuc-31i)";
const DECIMAL_COMMA: &str = "a number has a decimal point: write a point in place of the comma";
const CAPITALS: &str = "write capitals";

/// Remedy for a fault that depends on the text of the line; `None` if the fault's own remedy is the best.
pub fn advice(text: &[u8], fault: Fault) -> Option<&'static str> {
    let Cause::Alarm(alarm) = fault.cause else {
        return is_in(fault, NotModelled::Macro).then(|| foreign_text(text)).flatten();
    };
    let offset = usize::from(fault.column).saturating_sub(1);
    let (before, rest) = text.split_at(offset.min(text.len()));
    match alarm {
        Alarm::ImproperGCode => foreign_g(number::read(rest, 1)?.0.as_tenths()?),
        Alarm::Character => match rest.first()? {
            _ if foreign_text(text).is_some() => foreign_text(text),
            b';' | b'\'' | b'"' => Some(COMMENT),
            byte if byte.is_ascii_lowercase() => Some(CAPITALS),
            _ => None,
        },
        Alarm::DecimalPoint if rest.first() == Some(&b'P') => Some(point_in_p(text)),
        Alarm::IllegalAddress if foreign_g_in(text).is_some() => foreign_g_in(text),
        Alarm::NoDataAfterAddress | Alarm::IllegalAddress | Alarm::AddressNotFound => {
            if is_behind_nested_comment(before) {
                return Some(NESTED);
            }
            if is_decimal_comma(before, rest) {
                return Some(DECIMAL_COMMA);
            }
            foreign_text(text).or((rest.first() == Some(&b'=')).then_some(EQUALS))
        }
        Alarm::OffsetNumber => (rest.first() == Some(&b'P')).then_some(FAR_SYSTEM),
        _ => None,
    }
}

/// Whether a comma at the beginning of `rest`, or before it, is in a number: not the one of `,C`, `,R` and `,A`.
fn is_decimal_comma(before: &[u8], rest: &[u8]) -> bool {
    let (before, behind) = match (before.split_last(), rest.split_first()) {
        (_, Some((b',', behind))) => (before, behind),
        (Some((b',', before)), _) => (before, rest),
        _ => return false,
    };
    let begins_corner = behind.first().is_some_and(|byte| b"CRA".contains(&byte.to_ascii_uppercase()));
    before.last().is_some_and(u8::is_ascii_digit) && !begins_corner
}

/// Whether a line is flow control of LinuxCNC: `o100 sub`, `o<name> call`.
pub(super) fn is_flow_word(text: &[u8]) -> bool {
    let text = text.trim_ascii_start();
    let Some((b'O' | b'o', rest)) = text.split_first() else { return false };
    let rest = rest.trim_ascii_start();
    let name_len = match rest.first() {
        Some(b'<') => rest.iter().position(|byte| *byte == b'>').map(|end| end + 1),
        Some(b'0'..=b'9') => rest.iter().position(|byte| !byte.is_ascii_digit()),
        _ => None,
    };
    let Some(behind) = name_len.and_then(|len| rest.get(len..)) else { return false };
    let word = behind.trim_ascii_start();
    let word = &word[..word.iter().position(|byte| !byte.is_ascii_alphabetic()).unwrap_or(word.len())];
    FLOW_WORDS.iter().any(|known| known.eq_ignore_ascii_case(word))
}

/// Whether a comment with a bracket in it stands before the place.
fn is_behind_nested_comment(before: &[u8]) -> bool {
    let mut parts = before.split(|byte| *byte == b'(').skip(1);
    parts.next().is_some_and(|first| !first.contains(&b')'))
        && parts.next().is_some_and(|second| second.contains(&b')'))
}

fn is_in(fault: Fault, what: NotModelled) -> bool {
    fault.cause == Cause::NotModelled(what)
}

fn foreign_g(tenths: i64) -> Option<&'static str> {
    let of = |(first, last, _): &&(u16, u16, &str)| (i64::from(*first)..=i64::from(*last)).contains(&tenths);
    FOREIGN_G.iter().find(of).map(|(.., remedy)| *remedy)
}

/// Remedy for the first G code of another control in the block. An address that only that control's code has is an alarm
/// before the code is.
fn foreign_g_in(text: &[u8]) -> Option<&'static str> {
    text.split(|byte| *byte == b'G').skip(1).find_map(|rest| foreign_g(number::read(rest, 0)?.0.as_tenths()?))
}

/// Remedy for a decimal point in a P: without its point the number would mean something else.
fn point_in_p(text: &[u8]) -> &'static str {
    let codes = text.split(|byte| *byte == b'G').skip(1);
    let tenths: Vec<i64> = codes.filter_map(|rest| number::read(rest, 0)?.0.as_tenths()).collect();
    let has = |codes: std::ops::RangeInclusive<i64>| tenths.iter().any(|code| codes.contains(code));
    if has(40..=40) {
        "P of G4 counts milliseconds: write the seconds with X (G4 X1.8), or 1000 times the number without a point"
    } else if has(640..=640) {
        "G64 has no P on a Fanuc: remove the P word"
    } else if has(510..=510) {
        "P of G51 counts thousandths: write 1000 times the number without a point"
    } else if has(740..=890) {
        "P of a cycle counts milliseconds: write 1000 times the seconds without a point"
    } else {
        "P has no decimal point; a dwell counts milliseconds: write what is meant as a whole number"
    }
}

fn foreign_text(text: &[u8]) -> Option<&'static str> {
    let has = |word: &[u8]| text.windows(word.len()).any(|part| part == word);
    FOREIGN_TEXT.iter().find(|(word, _)| has(word)).map(|(_, remedy)| *remedy)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use arcfeed_nc::block::Reading;
    use arcfeed_units::LengthUnit;

    use super::super::Program;
    use super::*;

    fn message(line: &str) -> String {
        let text = format!("%\n{line}\nM30\n%\n");
        let program = Program::parse(Path::new("t.nc"), text.as_bytes(), LengthUnit::Mm, Reading::Lenient);
        assert_eq!(program.diagnostics.len(), 1, "{line}: {:?}", program.diagnostics);
        program.diagnostics[0].message.clone()
    }

    #[test]
    fn what_another_control_has_is_named_with_the_words_of_a_fanuc() {
        for (line, whose, remedy) in [
            ("G154P3", "Haas", "G54.1 P"),
            ("G112", "Haas", "G54.1 P"),
            ("G187P2", "Haas", "G5.1 Q1"),
            ("G0X1.G234", "Haas", "G43.4"),
            ("G59.1", "LinuxCNC", "G54.1 P1"),
            ("G91.1", "LinuxCNC", "arc_centers"),
            ("N10G71", "other controls", "G21"),
            ("G84.2X1.Z-1.R1.F1.", "FS10/11", "M29"),
            ("1 TOOL CALL 1 Z S2000", "Heidenhain", "M6"),
            ("2 L Z+50 R0 FMAX", "Heidenhain", "post"),
            ("CYCLE81(5,0,1,-10)", "Siemens", "G81"),
            ("G0X=10", "Siemens", "behind the letter"),
            ("G0X1.;SAFE", "Fanuc", "( )"),
            ("(TOOL (10MM) FLAT)", "nested", "remove"),
            ("(TOOL (10MM) FLAT", "nested", "remove"),
            ("G54.1P300", "31i", "--control"),
            ("G187P3E0.01", "Haas", "G5.1 Q1"),
            ("G4P1.8", "milliseconds", "G4 X1.8"),
            ("G82Z-1.R1.P.5F100", "cycle", "1000 times"),
            ("G64P0.01", "Fanuc", "remove the P"),
            ("G51X0Y0P2.", "thousandths", "1000 times"),
        ] {
            let said = message(line);
            assert!(said.contains(whose) && said.contains(remedy), "{line}: {said}");
        }
    }

    #[test]
    fn flow_words_of_linuxcnc_are_no_program_numbers_and_no_titles() {
        for line in ["o100 sub", "O<pocket> call [1]", " o1 if [#1 EQ 1]", "o<a>endsub", "O2 ENDWHILE (X)", "o3 do"] {
            assert!(is_flow_word(line.as_bytes()), "{line}");
        }
        for line in ["O100", "O100 (SUB)", "O<SUB>", "OSUB", "O100 SUBPLATE", "G1X1.", "(o100 sub)", "O0001 M30", ""] {
            assert!(!is_flow_word(line.as_bytes()), "{line}");
        }
        let said = message("o100 sub");
        assert!(said.contains("LinuxCNC") && said.contains("M98 P"), "{said}");
    }

    #[test]
    fn the_rows_are_in_order_and_none_is_a_code_of_the_control() {
        assert!(FOREIGN_G.windows(2).all(|rows| rows[0].1 < rows[1].0));
        for (first, ..) in FOREIGN_G {
            let line = format!("G{}.{}", first / 10, first % 10);
            assert!(message(&line).starts_with(Alarm::ImproperGCode.when()), "{line}");
        }
    }
}
