//! Picture of at most 256 colours as a `data:` URI: PNG.
//!
//! Source: PNG (Third Edition), W3C 2025, sections 5 and 11; RFC 4648 (4).

use miniz_oxide::deflate::compress_to_vec_zlib;

use crate::checksum::CRC_32;

/// Level of the compression, of 10.
const LEVEL: u8 = 6;

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
    chunk(&mut file, b"IDAT", &compress_to_vec_zlib(&filtered, LEVEL));
    chunk(&mut file, b"IEND", &[]);
    file
}

fn chunk(file: &mut Vec<u8>, kind: &[u8; 4], data: &[u8]) {
    file.extend((data.len() as u32).to_be_bytes());
    let from = file.len();
    file.extend(kind);
    file.extend(data);
    let check = CRC_32.checksum(&file[from..]);
    file.extend(check.to_be_bytes());
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
    fn digits_are_those_of_the_standard() {
        let pairs = [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")];
        pairs.iter().for_each(|(plain, coded)| assert_eq!(base64(plain.as_bytes()), *coded));
    }

    #[test]
    fn another_decoder_reads_the_same_pixels() {
        let palette: Vec<[u8; 3]> = (0..=255).map(|shade| [shade, 255 - shade, 7]).collect();
        for width in [1, 3, 300] {
            let rows: Vec<u8> = (0..width * 300).map(|at| (at * at % 251) as u8).collect();
            let file = png(width, &palette, 5, &rows);
            let mut reader = ::png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("a PNG");
            let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
            let frame = reader.next_frame(&mut pixels).expect("a picture");
            assert_eq!((frame.width as usize, frame.height), (width, 300));
            assert_eq!((frame.color_type, frame.bit_depth), (::png::ColorType::Indexed, ::png::BitDepth::Eight));
            assert!(pixels == rows, "{width}");
            let info = reader.info();
            assert_eq!(info.palette.as_deref(), Some(palette.as_flattened()));
            let opacity = info.trns.as_deref().expect("opacities");
            assert_eq!((opacity[4], opacity[5], opacity[6]), (255, 0, 255));
        }
    }
}
