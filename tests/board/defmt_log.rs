//! The image's log in plain words: defmt sends the index of a message and its arguments, the message itself stays in the
//! ELF. Decodes what the images use: rzcobs frames, `{=u32}`, `{=usize}` and `{=u64}`. `defmt-print` decodes it all.

use std::collections::BTreeMap;

use crate::elf::Elf;

/// Every message of a log.
pub fn messages(image: &[u8], log: &[u8]) -> Vec<String> {
    let formats = formats(&Elf::parse(image));
    assert!(!formats.is_empty(), "the image has no messages");
    log.split(|byte| *byte == 0)
        .filter(|frame| !frame.is_empty())
        .map(|frame| message(&formats, &unpack(frame)))
        .collect()
}

/// `LEVEL text` by index: symbols of the section `.defmt`, whose names are JSON.
fn formats(elf: &Elf<'_>) -> BTreeMap<u32, String> {
    let section = elf.sections.iter().position(|section| section.name == ".defmt");
    let symbols = elf.symbols().into_iter().filter(|symbol| Some(symbol.section) == section);
    let format = |name: &str| {
        let json: serde_json::Value = serde_json::from_str(name).ok()?;
        let level = json["tag"].as_str()?.strip_prefix("defmt_")?.to_uppercase();
        Some(format!("{level} {}", json["data"].as_str()?))
    };
    symbols.filter_map(|symbol| Some((symbol.value, format(symbol.name)?))).collect()
}

fn message(formats: &BTreeMap<u32, String>, frame: &[u8]) -> String {
    let mut bytes = frame.iter().copied();
    let mut number = |size: u32| (0..size).map(|at| u64::from(bytes.next().unwrap_or(0)) << (8 * at)).sum::<u64>();
    let index = number(2) as u32;
    let format = formats.get(&index).unwrap_or_else(|| panic!("no message {index} in the image"));
    let mut parts = format.split("{=");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (kind, rest) = part.split_once('}').expect("a closed argument");
        let size = match kind {
            "u32" | "usize" => 4,
            "u64" => 8,
            _ => panic!("{{={kind}}} is not decoded here"),
        };
        text += &format!("{}{rest}", number(size));
    }
    text
}

/// Undoes reverse zero-compressing COBS: from the end, a byte tells which of the bytes before it were zero.
fn unpack(frame: &[u8]) -> Vec<u8> {
    let mut packed = frame.iter().rev().copied();
    let mut bytes = Vec::new();
    while let Some(head) = packed.next() {
        match head {
            0x00..=0x7f => {
                let byte = |bit: u8| if head & 1 << bit == 0 { packed.next().unwrap_or(0) } else { 0 };
                bytes.extend((0..7).rev().map(byte));
            }
            0x80..=0xfe => {
                bytes.push(0);
                bytes.extend(packed.by_ref().take(usize::from(head & 0x7f) + 7));
            }
            0xff => bytes.extend(packed.by_ref().take(134)),
        }
    }
    bytes.reverse();
    bytes
}
