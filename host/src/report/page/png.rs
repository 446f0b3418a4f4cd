//! Picture of at most 256 colours as a `data:` URI: PNG with stored, uncompressed pixels.
//!
//! Source: PNG (Third Edition), W3C 2025, sections 5, 11 and annex D; RFC 1950, RFC 1951 (3.2.4), RFC 4648 (4).

use crate::checksum::crc32;

/// Most bytes of a stored block.
const BLOCK_MAX: usize = 0xFFFF;

/// Colour type: indices into a palette.
const INDEXED: u8 = 3;

/// `data:` URI of the picture; the rows are indices of colours, from the top.
pub fn data_uri(width: usize, palette: &[[u8; 3]], transparent: u8, rows: &[u8]) -> String {
    format!("data:image/png;base64,{}", base64(&png(width, palette, transparent, rows)))
}

fn png(width: usize, palette: &[[u8; 3]], transparent: u8, rows: &[u8]) -> Vec<u8> {
    let mut file = b"\x89PNG\r\n\x1A\n".to_vec();
    let height = rows.len() / width.max(1);
    let mut header = [width as u32, height as u32].map(u32::to_be_bytes).concat();
    header.extend([8, INDEXED, 0, 0, 0]);
    chunk(&mut file, b"IHDR", &header);
    chunk(&mut file, b"PLTE", &palette.concat());
    let opacity: Vec<u8> =
        (0..palette.len()).map(|index| if index == usize::from(transparent) { 0 } else { 255 }).collect();
    chunk(&mut file, b"tRNS", &opacity);
    let filtered: Vec<u8> = rows.chunks(width.max(1)).flat_map(|row| [&[0], row].concat()).collect();
    chunk(&mut file, b"IDAT", &stored(&filtered));
    chunk(&mut file, b"IEND", &[]);
    file
}

fn chunk(file: &mut Vec<u8>, kind: &[u8; 4], data: &[u8]) {
    file.extend((data.len() as u32).to_be_bytes());
    let from = file.len();
    file.extend(kind);
    file.extend(data);
    let check = crc32(&file[from..]);
    file.extend(check.to_be_bytes());
}

/// A zlib stream of stored blocks.
fn stored(data: &[u8]) -> Vec<u8> {
    let mut stream = vec![0x78, 0x01];
    let blocks = data.len().div_ceil(BLOCK_MAX).max(1);
    for index in 0..blocks {
        let block = &data[index * BLOCK_MAX..data.len().min((index + 1) * BLOCK_MAX)];
        let length = block.len() as u16;
        stream.push(u8::from(index + 1 == blocks));
        stream.extend(length.to_le_bytes());
        stream.extend((!length).to_le_bytes());
        stream.extend(block);
    }
    stream.extend(adler_32(data).to_be_bytes());
    stream
}

fn adler_32(data: &[u8]) -> u32 {
    let step = |(a, b): (u32, u32), byte: &u8| {
        let a = (a + u32::from(*byte)) % 65_521;
        (a, (b + a) % 65_521)
    };
    let (a, b) = data.iter().fold((1, 0), step);
    b << 16 | a
}

/// Data as text of RFC 4648.
pub(super) fn base64(data: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(data.len().div_ceil(3) * 4);
    for three in data.chunks(3) {
        let bits = three.iter().enumerate().fold(0, |bits: u32, (at, byte)| bits | u32::from(*byte) << (16 - 8 * at));
        for digit in 0..4 {
            let is_there = digit <= three.len();
            let index = (bits >> (18 - 6 * digit) & 63) as usize;
            text.push(if is_there { char::from(DIGITS[index]) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn check_sums_and_digits_are_those_of_the_standards() {
        assert_eq!(crc32(b"IEND"), 0xAE42_6082);
        assert_eq!(adler_32(b"Wikipedia"), 0x11E6_0398);
        let pairs = [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")];
        pairs.iter().for_each(|(plain, coded)| assert_eq!(base64(plain.as_bytes()), *coded));
    }

    #[test]
    fn long_data_are_stored_in_blocks() {
        let stream = stored(&[7; BLOCK_MAX + 1]);
        assert_eq!(stream.len(), 2 + 5 + BLOCK_MAX + 5 + 1 + 4);
        assert_eq!((stream[2], &stream[2 + 5 + BLOCK_MAX..][..6]), (0, &[1, 1, 0, 0xFE, 0xFF, 7][..]));
    }
}
