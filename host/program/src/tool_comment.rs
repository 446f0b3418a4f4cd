//! Tool data in a program's comments, as CAM posts and shops write them.
//!
//! ```text
//! (T1 D=10. CR=0.5 - ZMIN=-5. - BULLNOSE END MILL)       (T2 | 3/8 FLAT ENDMILL | H2 | D2)
//! (TOOL - 3 DIA. OFF. - 3 LEN. - 3 DIA. - 12.)           (T4 16MM 4 FLUTE CARBIDE END MILL)
//! ```
//!
//! Only what a comment states clearly counts: a number that could also be an offset (`D2`) is no diameter.

use arcfeed_units::LengthUnit;

/// Diameters outside this range are no milling tool's, mm.
const DIAMETERS_MM: std::ops::RangeInclusive<f64> = 0.05..=250.0;
/// Most teeth.
const TEETH_MAX: f64 = 40.0;

/// Tool data that a comment of a program states; `None`: not stated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToolComment {
    /// T number.
    pub number: Option<i64>,
    /// Diameter, mm.
    pub diameter_mm: Option<f64>,
    /// Corner radius, mm.
    pub corner_radius_mm: Option<f64>,
    /// Number of teeth.
    pub teeth: Option<u16>,
    /// Kind of tool.
    pub kind: Option<CommentedKind>,
}

/// Kind of tool, as far as a feed law distinguishes them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommentedKind {
    /// Flat or bull-nose end mill, which cuts along a wall with its full diameter.
    EndMill,
    /// Any other tool: a ball, face or chamfer mill cuts with another diameter; drills and the like do not mill.
    Other,
}

/// Words of tools that are no flat or bull-nose end mills. `ENDMILL` in the same comment does not change this.
const OTHERS: [&str; 48] = [
    "CUP",
    "RING",
    "BALL",
    "BALLNOSE",
    "BALLMILL",
    "BN",
    "SPHERICAL",
    "LOLLIPOP",
    "DRILL",
    "SPOTDRILL",
    "SPOT",
    "CENTER",
    "CENTERDRILL",
    "TAP",
    "TAPPING",
    "REAM",
    "REAMER",
    "BORE",
    "BORING",
    "BAR",
    "COUNTERSINK",
    "CSINK",
    "COUNTERBORE",
    "CHAMFER",
    "THREAD",
    "THREADMILL",
    "FACE",
    "FACEMILL",
    "ENGRAVE",
    "PROBE",
    "TAPER",
    "DOVETAIL",
    "KUGEL",
    "KUGELFRAESER",
    "BOHRER",
    "ANBOHRER",
    "SPIRALBOHRER",
    "SENKER",
    "REIBAHLE",
    "GEWINDE",
    "GEWINDEFRAESER",
    "GEWINDEBOHRER",
    "PLANFRAESER",
    "MESSERKOPF",
    "FASE",
    "FASENFRAESER",
    "ZENTRIERER",
    "FEINBOHREN",
];
/// Words of end mills.
const MILLS: [&str; 13] = [
    "ENDMILL",
    SLOT_DRILL,
    "MILL",
    "BULLNOSE",
    "BULL",
    "FLAT",
    "ROUGHER",
    "EM",
    "TIP",
    "FRAESER",
    "SCHAFTFRAESER",
    "CUTTER",
    "SCHRUPPFRAESER",
];
/// A slot drill is an end mill that cuts to its centre: two words, read as one.
const SLOT_DRILL: &str = "SLOTDRILL";
/// Words of cutting materials, behind the diameter of a tool without a name.
const MATERIALS: [&str; 7] = ["HM", "VHM", "HSS", "HSSE", "HSSCO", "WSP", "HPC"];
/// Words behind a number that measures something else than the tool.
const MEASURES: [&str; 7] = ["DEEP", "DEPTH", "LONG", "WIDE", "STOCK", "LEFT", "LEAVE"];
/// Words and signs between a name and its number: `DIA. - 12`, `FLUTES: 4`.
const LINKS: [&str; 9] = [".", ":", "=", "-", "#", "NO", "NUMBER", "OF", "IS"];

impl ToolComment {
    /// Data of a comment that names one tool at most, without its brackets; `unit` applies to lengths without a unit.
    pub fn read(text: &str, unit: LengthUnit) -> Self {
        let mut scan = Scan::new(&text.to_ascii_uppercase());
        let kind = scan.kind();
        let number =
            scan.after(&["T", "TOOL"], Number::whole).or_else(|| kind.and_then(|_| scan.number_before_equals()));
        scan.drop_after(&["H", "LEN", "LENGTH", "OFF", "L", "S", "F", "N", "ZMIN", "ZMAX", "Z", "M", "X"]);
        let teeth = scan
            .after(&["FLUTES", "FLUTE", "TEETH", "FL"], Number::whole)
            .or_else(|| scan.before(&["FL", "FLT", "FLUTE", "FLUTES", "TEETH", "TOOTH"], Number::whole));
        let length = |number: &Number| Some(number.value * number.unit.unwrap_or(unit).mm());
        let corner_radius_mm =
            scan.after(&["CR", "RAD", "RADIUS", "R"], length).or_else(|| scan.before(&["RAD", "RADIUS"], length));
        let diameter_mm = scan
            .after(&["DIA", "DIAM", "DIAMETER", "EM", "TIP", "BN"], length)
            .or_else(|| scan.diameter_after_d(number).and_then(|number| length(&number)))
            .or_else(|| {
                scan.diameter_before_kind(number.is_some() || kind.is_some()).and_then(|number| length(&number))
            });
        let diameter_mm = diameter_mm.filter(|diameter| DIAMETERS_MM.contains(diameter));
        let is_possible = |radius: &f64| diameter_mm.is_none_or(|diameter| *radius <= diameter / 2.0 + 1e-6);
        ToolComment {
            number,
            diameter_mm,
            corner_radius_mm: corner_radius_mm.filter(is_possible),
            teeth: teeth.filter(|teeth| (1..=TEETH_MAX as i64).contains(teeth)).map(|teeth| teeth as u16),
            kind,
        }
    }

    /// Whether there is anything about the tool's shape.
    pub fn has_data(&self) -> bool {
        self.has_size() || self.kind.is_some()
    }

    /// Whether the comment has a dimension of the tool or a number of teeth.
    pub fn has_size(&self) -> bool {
        self.diameter_mm.is_some() || self.corner_radius_mm.is_some() || self.teeth.is_some()
    }
}

/// Part of a comment.
#[derive(Clone, Debug, PartialEq)]
enum Token {
    Word(String),
    Number(Number),
    Sign(char),
    /// A number that belongs to a word that was read before.
    Used,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Number {
    value: f64,
    /// Unit that follows it.
    unit: Option<LengthUnit>,
    /// Written with a point or as a fraction: no count and no offset.
    is_decimal: bool,
}

impl Number {
    fn whole(&self) -> Option<i64> {
        (!self.is_decimal && self.unit.is_none()).then_some(self.value as i64)
    }
}

/// Tokens of a comment.
struct Scan {
    tokens: Vec<Token>,
}

impl Scan {
    fn new(text: &str) -> Self {
        let (mut tokens, mut rest) = (Vec::new(), text);
        while let Some(first) = rest.chars().next() {
            let run = |is: fn(char) -> bool| rest.find(|c| !is(c)).unwrap_or(rest.len());
            let is_number =
                first.is_ascii_digit() || (first == '.' && rest[1..].starts_with(|c: char| c.is_ascii_digit()));
            let length = if first.is_ascii_alphabetic() {
                let length = run(|c| c.is_ascii_alphabetic());
                tokens.push(Token::Word(rest[..length].to_owned()));
                length
            } else if is_number {
                let length = run(|c| c.is_ascii_digit() || c == '.' || c == '/');
                tokens.extend(number(&rest[..length]).map(Token::Number));
                length
            } else {
                if !first.is_whitespace() {
                    tokens.push(if first == '"' { Token::Word("IN".into()) } else { Token::Sign(first) });
                }
                first.len_utf8()
            };
            rest = &rest[length..];
        }
        for index in 1..tokens.len() {
            let unit = match &tokens[index] {
                Token::Word(word) if word == "MM" => LengthUnit::Mm,
                Token::Word(word) if word == "IN" || word == "INCH" => LengthUnit::Inch,
                _ => continue,
            };
            if let Token::Number(number) = &mut tokens[index - 1] {
                number.unit = Some(unit);
            }
        }
        let is = |token: &Token, word: &str| matches!(token, Token::Word(found) if found == word);
        while let Some(at) = tokens.windows(2).position(|pair| is(&pair[0], "SLOT") && is(&pair[1], "DRILL")) {
            tokens.splice(at..at + 2, [Token::Word(SLOT_DRILL.into())]);
        }
        Scan { tokens }
    }

    /// `1 = END MILL`: the tool's number.
    fn number_before_equals(&mut self) -> Option<i64> {
        let is_assigned = matches!(self.tokens.get(1), Some(Token::Sign('=')));
        if is_assigned { self.take(0, Number::whole) } else { None }
    }

    fn is_word(&self, index: usize, words: &[&str]) -> bool {
        matches!(self.tokens.get(index), Some(Token::Word(word)) if words.contains(&word.as_str()))
    }

    /// Index of the number that follows a word at `index`, with nothing but links between them.
    fn number_after(&self, index: usize) -> Option<usize> {
        let is_link = |index: &usize| match &self.tokens[*index] {
            Token::Sign(sign) => LINKS.contains(&sign.to_string().as_str()),
            Token::Word(word) => LINKS.contains(&word.as_str()),
            Token::Number(_) | Token::Used => false,
        };
        (index + 1..self.tokens.len()).find(|index| !is_link(index)).filter(|index| self.number_at(*index).is_some())
    }

    fn number_at(&self, index: usize) -> Option<Number> {
        if let Some(Token::Number(number)) = self.tokens.get(index) { Some(*number) } else { None }
    }

    /// Takes the number at `index` if `read` accepts it.
    fn take<R>(&mut self, index: usize, read: impl Fn(&Number) -> Option<R>) -> Option<R> {
        let value = read(&self.number_at(index)?)?;
        self.tokens[index] = Token::Used;
        Some(value)
    }

    /// Takes the number behind the first of these words that has one.
    fn after<R>(&mut self, words: &[&str], read: impl Fn(&Number) -> Option<R>) -> Option<R> {
        let places = (0..self.tokens.len()).filter(|index| self.is_word(*index, words));
        let index = places.filter_map(|index| self.number_after(index)).next()?;
        self.take(index, read)
    }

    /// Takes the number right before the first of these words.
    fn before<R>(&mut self, words: &[&str], read: impl Fn(&Number) -> Option<R>) -> Option<R> {
        let index = (1..self.tokens.len()).find(|index| self.is_word(*index, words))?;
        // `1.0 MM RAD`
        let is_unit = self.is_word(index - 1, &["MM", "IN", "INCH"]);
        self.take(if is_unit { index.checked_sub(2)? } else { index - 1 }, read)
    }

    /// Removes the numbers behind these words: lengths, offsets, speeds.
    fn drop_after(&mut self, words: &[&str]) {
        for index in 0..self.tokens.len() {
            if self.is_word(index, words)
                && let Some(number) = self.number_after(index)
            {
                self.tokens[number] = Token::Used;
            }
        }
    }

    /// `D=10`, `D10.`, `END MILL D10`. Beside an `H`, and with the tool's own number, `D10` may be an offset.
    fn diameter_after_d(&mut self, tool: Option<i64>) -> Option<Number> {
        let is_d = |index: &usize| self.is_word(*index, &["D"]);
        let index = (0..self.tokens.len()).find(is_d)?;
        let has_sign = matches!(self.tokens.get(index + 1), Some(Token::Sign('=')));
        let place = self.number_after(index)?;
        let found = self.take(place, |number| Some(*number))?;
        let is_offset = found.whole() == tool || (0..self.tokens.len()).any(|index| self.is_word(index, &["H"]));
        let is_clear = has_sign || found.is_decimal || found.unit.is_some();
        (is_clear || !is_offset).then_some(found)
    }

    /// `12 BULL ENDMILL`: the number before a tool's name; else the only one with a unit, if the comment names the tool.
    fn diameter_before_kind(&self, is_named: bool) -> Option<Number> {
        let mut with_unit = None;
        for index in 0..self.tokens.len() {
            let Some(number) = self.number_at(index) else { continue };
            let behind = || (index + 1..self.tokens.len()).take_while(|index| self.number_at(*index).is_none());
            if behind().take(1 + usize::from(number.unit.is_some())).any(|index| self.is_word(index, &MEASURES)) {
                continue;
            }
            let is_name =
                |index: usize| [&MILLS[..], &OTHERS, &MATERIALS].iter().any(|names| self.is_word(index, names));
            if behind().any(is_name) {
                return Some(number);
            }
            if number.unit.is_some() {
                with_unit = if with_unit.is_none() { Some(number) } else { return None };
            }
        }
        with_unit.filter(|_| is_named).or_else(|| self.only_number())
    }

    /// `T1 : 6.0`: a tool number and a decimal number, no other word.
    fn only_number(&self) -> Option<Number> {
        let is_other = |token: &&Token| !matches!(token, Token::Sign(':' | '-' | '='));
        match self.tokens.iter().filter(is_other).collect::<Vec<_>>().as_slice() {
            [Token::Word(tool), Token::Used, Token::Number(number)] if tool == "T" && number.is_decimal => {
                Some(*number)
            }
            _ => None,
        }
    }

    fn kind(&self) -> Option<CommentedKind> {
        let has = |words: &[&str]| (0..self.tokens.len()).any(|index| self.is_word(index, words));
        if has(&OTHERS) { Some(CommentedKind::Other) } else { has(&MILLS).then_some(CommentedKind::EndMill) }
    }
}

/// `10`, `.5`, `3/8`; `None` for anything else, such as a date.
fn number(text: &str) -> Option<Number> {
    let value = match text.split_once('/') {
        Some((top, bottom)) => top.parse::<f64>().ok()? / bottom.parse::<f64>().ok().filter(|bottom| *bottom > 0.0)?,
        None => text.parse().ok()?,
    };
    Some(Number { value, unit: None, is_decimal: text.contains(['.', '/']) })
}

#[cfg(test)]
mod tests {
    use super::CommentedKind::{EndMill, Other};
    use super::*;

    type Expected = (Option<i64>, Option<f64>, Option<f64>, Option<u16>, Option<CommentedKind>);

    fn read(text: &str, unit: LengthUnit) -> Expected {
        let ToolComment { number, diameter_mm, corner_radius_mm, teeth, kind } = ToolComment::read(text, unit);
        let rounded = |value: f64| (value * 1e6).round() / 1e6;
        (number, diameter_mm.map(rounded), corner_radius_mm.map(rounded), teeth, kind)
    }

    #[test]
    fn comments_of_posts_and_shops_are_understood() {
        let mill = Some(EndMill);
        for (text, expected) in [
            ("T1 D=10. CR=0. - ZMIN=-5. - FLAT END MILL", (Some(1), Some(10.0), Some(0.0), None, mill)),
            ("T12  D=8. CR=0.5 - ZMIN=-10.5 - BULLNOSE END MILL", (Some(12), Some(8.0), Some(0.5), None, mill)),
            ("T5 D=6. CR=3. - ZMIN=-4. - BALL END MILL", (Some(5), Some(6.0), Some(3.0), None, Some(Other))),
            ("T7 D=8.5 CR=0. TAPER=118DEG - ZMIN=-20. - DRILL", (Some(7), Some(8.5), Some(0.0), None, Some(Other))),
            ("T2 | 12. BULL ENDMILL 1. RAD | H2 | D2", (Some(2), Some(12.0), Some(1.0), None, mill)),
            ("T2 | 12. FLAT ENDMILL | H2 | D2 | WEAR COMP | TOOL DIA. - 12.", (Some(2), Some(12.0), None, None, mill)),
            ("3/8 FLAT ENDMILL TOOL - 2 DIA. OFF. - 2 LEN. - 2 DIA. - 9.525", (Some(2), Some(9.525), None, None, mill)),
            ("T04 16MM 4 FLUTE CARBIDE END MILL", (Some(4), Some(16.0), None, Some(4), mill)),
            ("TOOL NUMBER : 3", (Some(3), None, None, None, None)),
            ("TOOL DIA. 10.0", (None, Some(10.0), None, None, None)),
            ("NUMBER OF FLUTES : 4", (None, None, None, Some(4), None)),
            ("1 = End Mill {6 mm}", (Some(1), Some(6.0), None, None, mill)),
            ("TOOL T7 : 6MM SLOT DRILL 2 FLUTE", (Some(7), Some(6.0), None, Some(2), mill)),
            ("T6=20MM ENDMILL R0.8", (Some(6), Some(20.0), Some(0.8), None, mill)),
            ("TOOL -2- MILL DIA 10.0 R0. MM", (Some(2), Some(10.0), Some(0.0), None, mill)),
            ("T3 M6X1 TAP", (Some(3), None, None, None, Some(Other))),
            ("T8 D8 H8", (Some(8), None, None, None, None)),
            ("ROUGH POCKET LEAVE 0.5MM - 10MM ENDMILL", (None, Some(10.0), None, None, mill)),
            ("END MILL D10, 4 TEETH, ALUMINIUM", (None, Some(10.0), None, Some(4), mill)),
            ("T10 ENDMILL D10", (Some(10), None, None, None, mill)),
            ("T2 ENDMILL D4 H2", (Some(2), None, None, None, mill)),
            ("T1 : 6.0", (Some(1), Some(6.0), None, None, None)),
            ("TOOL - TIP12R2", (None, Some(12.0), Some(2.0), None, mill)),
            ("TOOL 1 - 16 HM", (Some(1), Some(16.0), None, None, None)),
            ("TOOL -1- END MILL D16.0 R0. MM", (Some(1), Some(16.0), Some(0.0), None, mill)),
            ("DIAMETER = .375 SPOT DRILL", (None, Some(0.375), None, None, Some(Other))),
            ("D10 AUSSENKONTUR SECHSECK R6", (None, Some(10.0), None, None, None)),
            ("CONTOUR 10MM DEEP", (None, None, None, None, None)),
            ("END MILL 16 MM 3FL", (None, Some(16.0), None, Some(3), mill)),
            ("DATE 01/02/24 TIME 10:30", (None, None, None, None, None)),
        ] {
            assert_eq!(read(text, LengthUnit::Mm), expected, "{text}");
        }
    }

    #[test]
    fn a_unit_in_the_comment_counts_before_the_programs() {
        for (text, diameter) in [
            ("T1 1/2 FLAT ENDMILL", Some(12.7)),
            ("T1 D=0.5 CR=0.", Some(12.7)),
            ("T1 10MM ENDMILL", Some(10.0)),
            ("T1 .375\" END MILL", Some(9.525)),
            ("T1 D=999. MILL", None),
        ] {
            assert_eq!(read(text, LengthUnit::Inch).1, diameter, "{text}");
        }
        assert_eq!(read("T1 3/4 IN END MILL", LengthUnit::Mm).1, Some(19.05));
    }
}
