//! Surfaces one below the other as a picture: along the chord to the right, up the span upwards, each with its damping ratios.

use std::io::{self, Write};
use std::path::Path;

use arcfeed_blades::finishing::marks::SurfaceMark;

/// Deviation at which colours are full.
const FULL_MM: f64 = 0.02;
const PIXELS_PER_MM: f64 = 10.0;
const PIXELS_PER_LAYER: usize = 5;
/// Size of a dot of a label, and rows of a label.
const DOT: usize = 2;
const LABEL: usize = 7 * DOT;

/// Three by five dots each, row by row, a bit a dot.
const GLYPHS: [(char, [u8; 5]); 14] = [
    ('0', [7, 5, 5, 5, 7]),
    ('1', [2, 6, 2, 2, 7]),
    ('2', [7, 1, 7, 4, 7]),
    ('3', [7, 1, 7, 1, 7]),
    ('4', [5, 5, 7, 1, 1]),
    ('5', [7, 4, 7, 1, 7]),
    ('6', [7, 4, 7, 5, 7]),
    ('7', [7, 1, 1, 2, 2]),
    ('8', [7, 5, 7, 5, 7]),
    ('9', [7, 5, 7, 1, 7]),
    ('.', [0, 0, 0, 0, 2]),
    ('-', [0, 0, 7, 0, 0]),
    ('W', [5, 5, 5, 7, 5]),
    ('T', [7, 2, 2, 2, 2]),
];

/// Picture of surfaces, one below the other: pixels in red, green, blue, row by row.
pub struct Picture {
    width: usize,
    pixels: Vec<[u8; 3]>,
}

impl Picture {
    /// Empty picture for surfaces of this length.
    pub fn new(length_mm: f64) -> Self {
        Picture { width: (length_mm * PIXELS_PER_MM) as usize, pixels: Vec::new() }
    }

    /// Draws a surface with its label below those drawn before.
    pub fn add(&mut self, label: &str, marks: &[SurfaceMark]) {
        let top = self.rows();
        self.pixels.resize((top + LABEL) * self.width, [255; 3]);
        self.write(label, top + DOT);
        let layers = marks.iter().map(|mark| mark.layer + 1).max().unwrap_or(0);
        let top = self.rows();
        self.pixels.resize((top + layers * PIXELS_PER_LAYER) * self.width, [255; 3]);
        let mut weights = vec![[0.0, 0.0]; self.width * layers];
        for mark in marks {
            let column = (mark.along_mm * PIXELS_PER_MM + self.width as f64 / 2.0) as usize;
            if let Some([sum, count]) = weights.get_mut((layers - 1 - mark.layer) * self.width + column) {
                *sum += mark.deviation_mm;
                *count += 1.0;
            }
        }
        for row in 0..layers * PIXELS_PER_LAYER {
            for column in 0..self.width {
                let [sum, count] = weights[row / PIXELS_PER_LAYER * self.width + column];
                if count > 0.0 {
                    self.pixels[(top + row) * self.width + column] = colour(sum / count);
                }
            }
        }
    }

    fn rows(&self) -> usize {
        self.pixels.len() / self.width
    }

    fn write(&mut self, text: &str, top: usize) {
        for (at, letter) in text.chars().enumerate() {
            let Some((_, dots)) = GLYPHS.iter().find(|(c, _)| *c == letter) else { continue };
            for (row, column) in (0..5 * DOT).flat_map(|row| (0..3 * DOT).map(move |column| (row, column))) {
                if dots[row / DOT] >> (2 - column / DOT) & 1 == 1 {
                    self.pixels[(top + row) * self.width + at * 4 * DOT + column] = [0; 3];
                }
            }
        }
    }

    /// Saves the picture as an uncompressed PNG file.
    pub fn save(&self, path: &Path) -> io::Result<()> {
        let mut raw = Vec::new();
        for row in self.pixels.chunks(self.width) {
            raw.push(0);
            raw.extend(row.iter().flatten());
        }
        let mut data = vec![0x78, 0x01];
        let blocks = raw.chunks(0xffff);
        let last = blocks.len() - 1;
        for (at, block) in blocks.enumerate() {
            let length = block.len() as u16;
            data.push(u8::from(at == last));
            data.extend(length.to_le_bytes());
            data.extend((!length).to_le_bytes());
            data.extend(block);
        }
        data.extend(adler(&raw).to_be_bytes());
        let mut header = Vec::new();
        header.extend((self.width as u32).to_be_bytes());
        header.extend((self.rows() as u32).to_be_bytes());
        header.extend([8, 2, 0, 0, 0]);
        let mut file = std::fs::File::create(path)?;
        file.write_all(b"\x89PNG\r\n\x1a\n")?;
        for (name, content) in [(b"IHDR", header), (b"IDAT", data), (b"IEND", Vec::new())] {
            file.write_all(&(content.len() as u32).to_be_bytes())?;
            let named: Vec<u8> = name.iter().copied().chain(content).collect();
            file.write_all(&named)?;
            file.write_all(&crc(&named).to_be_bytes())?;
        }
        Ok(())
    }
}

/// Blue where material is left, red where too much is gone, black where the blade is cut through by more than half a millimetre.
fn colour(deviation_mm: f64) -> [u8; 3] {
    if deviation_mm < -0.5 {
        return [0; 3];
    }
    let part = (deviation_mm / FULL_MM).clamp(-1.0, 1.0);
    let pale = (225.0 * (1.0 - part.abs())) as u8;
    if part > 0.0 { [pale, pale, 225] } else { [225, pale, pale] }
}

fn adler(data: &[u8]) -> u32 {
    let (a, b) = data.iter().fold((1, 0), |(a, b), byte| {
        let a = (a + u32::from(*byte)) % 65521;
        (a, (a + b) % 65521)
    });
    b << 16 | a
}

fn crc(data: &[u8]) -> u32 {
    !data.iter().fold(!0, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 })
    })
}
