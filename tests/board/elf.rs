//! As much of a 32-bit little-endian ELF as these tests need: its sections.

/// A section.
#[derive(Clone, Copy, Debug)]
pub struct Section<'f> {
    /// Name of the section.
    pub name: &'f str,
    /// Address on the chip.
    pub address: u32,
    /// Bytes.
    pub size: u32,
    offset: u32,
    kind: u32,
    flags: u32,
}

/// A parsed file.
#[derive(Debug)]
pub struct Elf<'f> {
    /// In the order of the file.
    pub sections: Vec<Section<'f>>,
}

const NO_BITS: u32 = 8;
const ALLOCATED: u32 = 2;

impl Section<'_> {
    /// Whether the section takes memory on the chip.
    pub fn is_loaded(&self) -> bool {
        self.flags & ALLOCATED != 0
    }

    /// Whether the file, and hence the flash, has the content of the section.
    pub fn has_content(&self) -> bool {
        self.kind != NO_BITS
    }
}

impl<'f> Elf<'f> {
    /// Reads the table of sections.
    pub fn parse(file: &'f [u8]) -> Self {
        assert_eq!(&file[..6], b"\x7fELF\x01\x01", "a 32-bit little-endian ELF");
        let (table, size, count) = (word(file, 32), half(file, 46), half(file, 48));
        let header = |index: u32| -> [u32; 6] {
            std::array::from_fn(|field| word(file, (table + index * size) as usize + 4 * field))
        };
        let names = header(half(file, 50))[4];
        let section = |index| {
            let [name, kind, flags, address, offset, size] = header(index);
            Section { name: text(file, names + name), address, size, offset, kind, flags }
        };
        Elf { sections: (0..count).map(section).collect() }
    }

    /// Content of a section.
    pub fn content(&self, file: &'f [u8], name: &str) -> &'f [u8] {
        let section = self.sections.iter().find(|section| section.name == name).expect("a section of this name");
        &file[section.offset as usize..][..section.size as usize]
    }
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"))
}

fn half(bytes: &[u8], at: usize) -> u32 {
    u32::from(u16::from_le_bytes(bytes[at..at + 2].try_into().expect("two bytes")))
}

fn text(file: &[u8], at: u32) -> &str {
    let rest = &file[at as usize..];
    let end = rest.iter().position(|byte| *byte == 0).expect("a terminated string");
    std::str::from_utf8(&rest[..end]).expect("names are text")
}
