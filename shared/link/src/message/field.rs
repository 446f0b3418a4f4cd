//! Fields of messages: whole numbers, little endian, without padding.
//!
//! `T?` is a byte, 0 or 1, followed by the field if it is 1; `[T; n]` are n fields. Every value has exactly one
//! encoding, so that decoding and encoding again gives the same bytes.

use super::fixed::{Q40, Q46, Q62};
use super::schema::{FieldType, Optional};

/// Maximum length of a message's payload, bytes.
pub const PAYLOAD_MAX: usize = 160;
/// Maximum length of a [`Chunk`], bytes.
pub const CHUNK_MAX: usize = 64;

/// Reason why a message cannot be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EncodeError {
    /// The buffer is too short for the message.
    Room,
}

/// Reason why a received payload is not a valid message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DecodeError {
    /// No message has this number.
    Kind(u8),
    /// The payload ends before the last field does.
    Short,
    /// This number of bytes is left over after the last field.
    Long(usize),
    /// This byte is not a value of the field's enumeration.
    Code(u8),
}

/// Buffer to which fields are written.
#[derive(Debug)]
pub(crate) struct Writer<'b> {
    rest: &'b mut [u8],
    written: usize,
}

/// Payload from which fields are read.
#[derive(Debug)]
pub(crate) struct Reader<'b> {
    rest: &'b [u8],
}

/// Type of a message's field.
pub(crate) trait Field: Sized {
    /// Name in the schema.
    const TYPE: FieldType;
    /// Writes the field.
    fn put(&self, writer: &mut Writer<'_>) -> Result<(), EncodeError>;
    /// Reads the field.
    fn take(reader: &mut Reader<'_>) -> Result<Self, DecodeError>;
}

/// Up to [`CHUNK_MAX`] bytes of a text or a log: the last field of a message, to the end of its payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chunk {
    bytes: [u8; CHUNK_MAX],
    length: u8,
}

impl<'b> Writer<'b> {
    /// Writer at the start of a buffer.
    pub fn new(buffer: &'b mut [u8]) -> Self {
        Writer { rest: buffer, written: 0 }
    }

    /// Number of bytes written.
    pub fn written(&self) -> usize {
        self.written
    }

    fn bytes(&mut self, bytes: &[u8]) -> Result<(), EncodeError> {
        let (room, rest) =
            core::mem::take(&mut self.rest).split_at_mut_checked(bytes.len()).ok_or(EncodeError::Room)?;
        // Byte by byte: the compiler would add a panic path to a copy of slices.
        room.iter_mut().zip(bytes).for_each(|(slot, byte)| *slot = *byte);
        self.rest = rest;
        self.written = self.written.saturating_add(bytes.len());
        Ok(())
    }
}

impl<'b> Reader<'b> {
    /// Reader at the start of a payload.
    pub fn new(payload: &'b [u8]) -> Self {
        Reader { rest: payload }
    }

    /// Checks that no bytes remain.
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
    /// Chunk of these bytes; bytes beyond the maximum length are left out.
    pub fn of(text: &[u8]) -> Self {
        let mut bytes = [0; CHUNK_MAX];
        let length = text.len().min(CHUNK_MAX);
        bytes.iter_mut().zip(text).for_each(|(slot, byte)| *slot = *byte);
        Chunk { bytes, length: length as u8 }
    }

    /// The bytes of the chunk.
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
