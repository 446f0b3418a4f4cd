//! Schema of all messages: `docs/protocol.md` prints it, and both ends compare its hash.

/// Type of a message's field: how its bytes are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldType {
    /// Name of the type: a whole number, a scaled number, or an enumeration followed by its values.
    pub name: &'static str,
    /// Number of elements of an array; 1 for a single value.
    pub count: u8,
    /// Whether the field, or each of its elements, may be absent.
    pub optional: Optional,
}

/// Which part of a field may be absent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Optional {
    /// None: the field is always there.
    Never,
    /// The whole field.
    Whole,
    /// Each element of the array by itself.
    Each,
}

/// Description of one kind of message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Number of the kind on the wire.
    pub kind: u8,
    /// Name of the kind.
    pub name: &'static str,
    /// Class and direction.
    pub class: MessageClass,
    /// Meaning of the message, as a sentence.
    pub meaning: &'static str,
    /// Fields in the order in which they are sent.
    pub fields: &'static [FieldEntry],
}

/// Description of one field of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldEntry {
    /// Name of the field.
    pub name: &'static str,
    /// Type of the field.
    pub field_type: FieldType,
    /// Meaning of the field, with its unit.
    pub meaning: &'static str,
}

/// Direction of a message, and whether it is repeated if lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MessageClass {
    /// Host to board; delivered once and in order.
    Down,
    /// Board to host; delivered once and in order.
    Up,
    /// Board to host; only the newest value counts, so it is not repeated.
    Latest,
    /// Between board and simulated machine, on a line of their own without sessions.
    Machine,
}

impl FieldType {
    /// Type of a single value that is always present.
    pub const fn plain(name: &'static str) -> Self {
        FieldType { name, count: 1, optional: Optional::Never }
    }
}

impl MessageClass {
    /// Text by which docs/protocol.md names the class.
    pub const fn label(self) -> &'static str {
        match self {
            MessageClass::Down => "host to board, reliable",
            MessageClass::Up => "board to host, reliable",
            MessageClass::Latest => "board to host, latest",
            MessageClass::Machine => "machine line",
        }
    }
}

/// Hash (FNV-1a) of kinds, names, classes and fields, but not of the meanings. A field with a new meaning must
/// therefore get a new name.
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
