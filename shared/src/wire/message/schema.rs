//! The shape of all messages as data: what `docs/protocol.md` prints, and what both ends compare by its hash.

/// How one field is encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldType {
    /// A whole number, a scaled one, or a code with its values.
    pub name: &'static str,
    /// How many of them; 1 for a plain field.
    pub count: u8,
    /// Whether it may be absent.
    pub optional: Optional,
}

/// What of a field may be absent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Optional {
    /// Nothing.
    Never,
    /// All of it.
    Whole,
    /// Each of several.
    Each,
}

/// One message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Its number on the wire.
    pub kind: u8,
    /// Its name.
    pub name: &'static str,
    /// How the link carries it, and which way.
    pub class: Class,
    /// What it says.
    pub meaning: &'static str,
    /// Its fields in their order.
    pub fields: &'static [FieldEntry],
}

/// One field of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldEntry {
    /// Its name.
    pub name: &'static str,
    /// How it is encoded.
    pub field_type: FieldType,
    /// What it says, with its unit.
    pub meaning: &'static str,
}

/// How a message travels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Host to board, reliable and in order.
    Down,
    /// Board to host, reliable and in order.
    Up,
    /// Board to host, the latest only.
    Latest,
    /// On the machine line, outside the link's classes.
    Machine,
}

impl FieldType {
    /// One that is always there.
    pub const fn plain(name: &'static str) -> Self {
        FieldType { name, count: 1, optional: Optional::Never }
    }
}

impl Class {
    /// As the documents call it.
    pub const fn label(self) -> &'static str {
        match self {
            Class::Down => "host to board, reliable",
            Class::Up => "board to host, reliable",
            Class::Latest => "board to host, latest",
            Class::Machine => "machine line",
        }
    }
}

/// FNV-1a over everything an entry says but its meaning in words: who gives a field another meaning gives it another name.
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
    // A mark that no UTF-8 has: "ab" "c" is not "a" "bc".
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
    const ENTRY: Entry = Entry { kind: 1, name: "One", class: Class::Down, meaning: "", fields: FIELDS };

    #[test]
    fn any_difference_is_another_hash() {
        const OTHERS: &[&[FieldEntry]] = &[
            &[field("ab", U8), field("", U16)],
            &[FIELDS[1], FIELDS[0]],
            &[FIELDS[0], field("b", FieldType { optional: Optional::Whole, ..U16 })],
            &[FIELDS[0], field("b", FieldType { count: 2, ..U16 })],
            &[],
        ];
        let entries =
            [ENTRY, Entry { kind: 2, ..ENTRY }, Entry { name: "Two", ..ENTRY }, Entry { class: Class::Up, ..ENTRY }];
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
