//! The fields of messages: whole numbers, little endian, one after the other.
//!
//! `T?` is a byte, 0 or 1, and the field behind a 1; `[T; n]` are n fields. Every field has one encoding only, so that what
//! decodes encodes to the same bytes again.

use super::fixed::{Q40, Q46, Q62};
use super::schema::{FieldType, Optional};

/// Most bytes of a message's payload.
pub const PAYLOAD_MAX: usize = 160;
/// Most bytes of a [`Chunk`].
pub const CHUNK_MAX: usize = 64;

/// Why a message cannot be encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EncodeError {
    /// The buffer is shorter than the message.
    Room,
}

/// Why a payload is no message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DecodeError {
    /// No message has this kind.
    Kind(u8),
    /// It ends within a field.
    Short,
    /// So many bytes are left over.
    Long(usize),
    /// A code that its field does not know.
    Code(u8),
}

/// Where fields are put.
#[derive(Debug)]
pub(crate) struct Writer<'b> {
    rest: &'b mut [u8],
    written: usize,
}

/// Where fields are taken from.
#[derive(Debug)]
pub(crate) struct Reader<'b> {
    rest: &'b [u8],
}

/// What can be a field of a message.
pub(crate) trait Field: Sized {
    /// How the schema names it.
    const TYPE: FieldType;
    /// Appends it.
    fn put(&self, writer: &mut Writer<'_>) -> Result<(), EncodeError>;
    /// Takes it off the front.
    fn take(reader: &mut Reader<'_>) -> Result<Self, DecodeError>;
}

/// Bytes of a text or a log; the rest of their message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chunk {
    bytes: [u8; CHUNK_MAX],
    length: u8,
}

impl<'b> Writer<'b> {
    pub fn new(buffer: &'b mut [u8]) -> Self {
        Writer { rest: buffer, written: 0 }
    }

    pub fn written(&self) -> usize {
        self.written
    }

    fn bytes(&mut self, bytes: &[u8]) -> Result<(), EncodeError> {
        let (room, rest) =
            core::mem::take(&mut self.rest).split_at_mut_checked(bytes.len()).ok_or(EncodeError::Room)?;
        // By hand: a copy of slices could panic, as far as the compiler sees.
        room.iter_mut().zip(bytes).for_each(|(slot, byte)| *slot = *byte);
        self.rest = rest;
        self.written = self.written.saturating_add(bytes.len());
        Ok(())
    }
}

impl<'b> Reader<'b> {
    pub fn new(payload: &'b [u8]) -> Self {
        Reader { rest: payload }
    }

    /// Nothing must be left.
    pub fn end(&self) -> Result<(), DecodeError> {
        if self.rest.is_empty() { Ok(()) } else { Err(DecodeError::Long(self.rest.len())) }
    }

    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], DecodeError> {
        let (bytes, rest) = self.rest.split_first_chunk().ok_or(DecodeError::Short)?;
        self.rest = rest;
        Ok(*bytes)
    }
}

macro_rules! whole_numbers {
    ($($number:ident)+) => {
        $(
            impl Field for $number {
                const TYPE: FieldType = FieldType::plain(stringify!($number));

                fn put(&self, writer: &mut Writer<'_>) -> Result<(), EncodeError> {
                    writer.bytes(&self.to_le_bytes())
                }

                fn take(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
                    Ok($number::from_le_bytes(reader.bytes()?))
                }
            }
        )+
    };
}

whole_numbers! { u8 u16 u32 u64 i16 i64 }

macro_rules! scaled_numbers {
    ($($number:ident)+) => {
        $(
            impl Field for $number {
                const TYPE: FieldType = FieldType::plain(stringify!($number));

                fn put(&self, writer: &mut Writer<'_>) -> Result<(), EncodeError> {
                    self.0.put(writer)
                }

                fn take(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
                    i64::take(reader).map($number)
                }
            }
        )+
    };
}

scaled_numbers! { Q40 Q46 Q62 }

impl Field for bool {
    const TYPE: FieldType = FieldType::plain("bool");

    fn put(&self, writer: &mut Writer<'_>) -> Result<(), EncodeError> {
        u8::from(*self).put(writer)
    }

    fn take(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        match u8::take(reader)? {
            0 => Ok(false),
            1 => Ok(true),
            other => Err(DecodeError::Code(other)),
        }
    }
}

impl<T: Field> Field for Option<T> {
    const TYPE: FieldType = FieldType { optional: Optional::Whole, ..T::TYPE };

    fn put(&self, writer: &mut Writer<'_>) -> Result<(), EncodeError> {
        self.is_some().put(writer)?;
        self.as_ref().map_or(Ok(()), |value| value.put(writer))
    }

    fn take(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        bool::take(reader)?.then(|| T::take(reader)).transpose()
    }
}

impl<T: Field + Copy + Default, const N: usize> Field for [T; N] {
    const TYPE: FieldType = FieldType {
        count: N as u8,
        optional: match T::TYPE.optional {
            Optional::Never => Optional::Never,
            Optional::Whole | Optional::Each => Optional::Each,
        },
        ..T::TYPE
    };

    fn put(&self, writer: &mut Writer<'_>) -> Result<(), EncodeError> {
        self.iter().try_for_each(|value| value.put(writer))
    }

    fn take(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        let mut values = [T::default(); N];
        for value in &mut values {
            *value = T::take(reader)?;
        }
        Ok(values)
    }
}

impl Chunk {
    /// As many of the bytes as there is room for.
    pub fn of(text: &[u8]) -> Self {
        let mut bytes = [0; CHUNK_MAX];
        let length = text.len().min(CHUNK_MAX);
        bytes.iter_mut().zip(text).for_each(|(slot, byte)| *slot = *byte);
        Chunk { bytes, length: length as u8 }
    }

    /// The bytes.
    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..usize::from(self.length)).unwrap_or_default()
    }
}

impl Field for Chunk {
    const TYPE: FieldType = FieldType::plain("bytes");

    fn put(&self, writer: &mut Writer<'_>) -> Result<(), EncodeError> {
        writer.bytes(self.bytes())
    }

    fn take(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        let rest = core::mem::take(&mut reader.rest);
        match rest.len().checked_sub(CHUNK_MAX) {
            None | Some(0) => Ok(Chunk::of(rest)),
            Some(over) => Err(DecodeError::Long(over)),
        }
    }
}
