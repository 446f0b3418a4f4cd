//! Schema of all messages: `docs/protocol.md` prints it, and both ends compare its hash.

/// Encoding of a field of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldType {
    /// A whole number, a scaled number, or a code with its values.
    pub name: &'static str,
    /// Number of elements; 1 for a plain field.
    pub count: u8,
    /// Part of the field that may be absent.
    pub optional: Optional,
}

/// Part of a field that may be absent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Optional {
    /// No part.
    Never,
    /// The whole field.
    Whole,
    /// Each element.
    Each,
}

/// Description of one kind of message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Number on the wire.
    pub kind: u8,
    /// Name.
    pub name: &'static str,
    /// Class and direction.
    pub class: MessageClass,
    /// Meaning.
    pub meaning: &'static str,
    /// Fields in their order.
    pub fields: &'static [FieldEntry],
}

/// Description of one field of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldEntry {
    /// Name.
    pub name: &'static str,
    /// Encoding.
    pub field_type: FieldType,
    /// Meaning, with the unit.
    pub meaning: &'static str,
}

/// Class and direction of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MessageClass {
    /// Host to board, reliable and in order.
    Down,
    /// Board to host, reliable and in order.
    Up,
    /// Board to host, latest-wins.
    Latest,
    /// On the machine line, outside of the link.
    Machine,
}

impl FieldType {
    /// A field that is always present.
    pub const fn plain(name: &'static str) -> Self {
        FieldType { name, count: 1, optional: Optional::Never }
    }
}

impl MessageClass {
    /// Label in the documents.
    pub const fn label(self) -> &'static str {
        match self {
            MessageClass::Down => "host to board, reliable",
            MessageClass::Up => "board to host, reliable",
            MessageClass::Latest => "board to host, latest",
            MessageClass::Machine => "machine line",
        }
    }
}

/// FNV-1a over all data of the entries except their meanings in words. A field with a new meaning must get a new name.
pub const fn hash(entries: &[Entry]) -> u32 {
    let mut hash = 0x811C_9DC5;
    let mut rest = entries;
    while let [entry, others @ ..] = rest {
        hash = byte(text(byte(hash, entry.kind), entry.name), entry.class as u8);
        let mut fields = entry.fields;
        while let [FieldEntry { name, field_type, .. }, more @ ..] = fields {
            hash = text(text(hash, name), field_type.name);
            hash = byte(byte(hash, field_type.count), field_type.optional as u8);
            fields = more;
        }
        rest = others;
    }
    hash
}

const fn text(mut hash: u32, text: &str) -> u32 {
    let mut rest = text.as_bytes();
    while let [first, others @ ..] = rest {
        hash = byte(hash, *first);
        rest = others;
    }
    // A separator that does not occur in UTF-8, so that "ab" "c" differs from "a" "bc".
    byte(hash, 0xFF)
}

const fn byte(hash: u32, byte: u8) -> u32 {
    (hash ^ byte as u32).wrapping_mul(0x0100_0193)
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn field(name: &'static str, field_type: FieldType) -> FieldEntry {
        FieldEntry { name, field_type, meaning: "" }
    }

    const U8: FieldType = FieldType::plain("u8");
    const U16: FieldType = FieldType::plain("u16");
    const FIELDS: &[FieldEntry] = &[field("a", U8), field("b", U16)];
    const ENTRY: Entry = Entry { kind: 1, name: "One", class: MessageClass::Down, meaning: "", fields: FIELDS };

    #[test]
    fn any_difference_is_another_hash() {
        const OTHERS: &[&[FieldEntry]] = &[
            &[field("ab", U8), field("", U16)],
            &[FIELDS[1], FIELDS[0]],
            &[FIELDS[0], field("b", FieldType { optional: Optional::Whole, ..U16 })],
            &[FIELDS[0], field("b", FieldType { count: 2, ..U16 })],
            &[],
        ];
        let entries = [
            ENTRY,
            Entry { kind: 2, ..ENTRY },
            Entry { name: "Two", ..ENTRY },
            Entry { class: MessageClass::Up, ..ENTRY },
        ];
        let entries =
            [&entries[..], &OTHERS.iter().map(|fields| Entry { fields, ..ENTRY }).collect::<Vec<_>>()].concat();
        let mut hashes: Vec<u32> = entries.iter().map(|entry| hash(&[*entry])).collect();
        hashes.push(hash(&[]));
        hashes.push(hash(&[ENTRY, ENTRY]));
        hashes.sort_unstable();
        hashes.dedup();
        assert_eq!(hashes.len(), entries.len() + 2);
    }

    #[test]
    fn the_hash_is_fnv_1a() {
        // The published value for "foobar".
        let hash = b"foobar".iter().fold(0x811C_9DC5, |hash, letter| byte(hash, *letter));
        assert_eq!(hash, 0xBF9C_F968);
    }
}
