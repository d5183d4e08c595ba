//! Baseline JPEG without chroma subsampling, with the standard's own tables: what the `image` crate writes, byte for
//! byte. That crate itself would cost every build its color management.

use super::dct;
use super::huffman::{self, Bits, Table};
use crate::Rgb8;

/// Quantization of T.81, annex K.1, row by row.
const LUMA: [u8; 64] = [
    16, 11, 10, 16, 24, 40, 51, 61, 12, 12, 14, 19, 26, 58, 60, 55, 14, 13, 16, 24, 40, 57, 69, 56, 14, 17,
    22, 29, 51, 87, 80, 62, 18, 22, 37, 56, 68, 109, 103, 77, 24, 35, 55, 64, 81, 104, 113, 92, 49, 64, 78,
    87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99,
];
const CHROMA: [u8; 64] = [
    17, 18, 24, 47, 99, 99, 99, 99, 18, 21, 26, 66, 99, 99, 99, 99, 24, 26, 56, 99, 99, 99, 99, 99, 47, 66,
    99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99,
    99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99,
];
/// Places of a block in the order of the file.
const ZIGZAG: [usize; 64] = [
    0, 1, 8, 16, 9, 2, 3, 10, 17, 24, 32, 25, 18, 11, 4, 5, 12, 19, 26, 33, 40, 48, 41, 34, 27, 20, 13, 6, 7,
    14, 21, 28, 35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23, 30, 37, 44, 51, 58, 59, 52, 45, 38, 31, 39,
    46, 53, 60, 61, 54, 47, 55, 62, 63,
];
/// The components' numbers with the number of their tables.
const COMPONENTS: [(u8, u8); 3] = [(1, 0), (2, 1), (3, 1)];

/// A file of sides 1..=65535 and quality 1..=100.
pub(in super::super) fn encode(picture: &Rgb8, quality: u8) -> Vec<u8> {
    let steps = [LUMA, CHROMA].map(|steps| scaled(steps, u32::from(quality)));
    let tables = [
        [huffman::LUMA_DC, huffman::LUMA_AC],
        [huffman::CHROMA_DC, huffman::CHROMA_AC],
    ];
    let mut bits = Bits::default();
    write_head(&mut bits.file, picture, &steps, &tables);
    let codes = tables.map(|pair| pair.map(|table| table.codes()));
    let mut before = [0; 3];
    for y in (0..picture.height()).step_by(8) {
        for x in (0..picture.width()).step_by(8) {
            for ((plane, before), (_, table)) in blocks(picture, x, y).iter().zip(&mut before).zip(COMPONENTS)
            {
                let block = quantized(&dct::forward(plane), &steps[usize::from(table)]);
                let [dc, ac] = &codes[usize::from(table)];
                bits.push_block(&block, *before, dc, ac);
                *before = block[0];
            }
        }
    }
    let mut file = bits.finish();
    file.extend([0xff, 0xd9]);
    file
}

/// Steps for a quality as libjpeg scales them: 50 leaves the standard's.
fn scaled(steps: [u8; 64], quality: u32) -> [u8; 64] {
    let percent = if quality < 50 {
        5000 / quality
    } else {
        200 - 2 * quality
    };
    steps.map(|step| ((u32::from(step) * percent + 50) / 100).clamp(1, 255) as u8)
}

fn write_head(file: &mut Vec<u8>, picture: &Rgb8, steps: &[[u8; 64]; 2], tables: &[[Table; 2]; 2]) {
    let [high, wide] = [picture.height(), picture.width()].map(|side| (side as u16).to_be_bytes());
    let sampled = COMPONENTS.map(|(number, table)| [number, 0x11, table]);
    let coded = COMPONENTS.map(|(number, table)| [number, table << 4 | table]);
    file.extend([0xff, 0xd8]);
    write_segment(file, 0xe0, &[b"JFIF\0\x01\x02\0\0\x01\0\x01\0\0"]);
    write_segment(file, 0xc0, &[&[8], &high, &wide, &[3], sampled.as_flattened()]);
    for (number, steps) in (0..).zip(steps) {
        write_segment(file, 0xdb, &[&[number], &ZIGZAG.map(|place| steps[place])]);
    }
    for (number, pair) in (0..).zip(tables) {
        for (class, table) in (0u8..).zip(pair) {
            write_segment(
                file,
                0xc4,
                &[&[class << 4 | number], &table.lengths, table.symbols],
            );
        }
    }
    write_segment(file, 0xda, &[&[3], coded.as_flattened(), &[0, 63, 0]]);
}

fn write_segment(file: &mut Vec<u8>, marker: u8, parts: &[&[u8]]) {
    let content = parts.concat();
    file.extend([0xff, marker]);
    file.extend((content.len() as u16 + 2).to_be_bytes());
    file.extend(content);
}

/// Y, Cb and Cr of the block whose first pixel this is; beyond the picture its edge goes on.
fn blocks(picture: &Rgb8, x: usize, y: usize) -> [[u8; 64]; 3] {
    let mut blocks = [[0; 64]; 3];
    for place in 0..64 {
        let column = (x + place % 8).min(picture.width() - 1);
        let row = (y + place / 8).min(picture.height() - 1);
        let codes = luma_and_chroma(picture.at(column, row));
        for (block, code) in blocks.iter_mut().zip(codes) {
            block[place] = code;
        }
    }
    blocks
}

/// JFIF's Y, Cb and Cr, in fixed point of 16 bits.
fn luma_and_chroma(pixel: [u8; 3]) -> [u8; 3] {
    const HALF: i32 = (1 << 15) - 1;
    const MIDDLE: i32 = (128 << 16) + HALF;
    let [r, g, b] = pixel.map(i32::from);
    [
        19595 * r + 38469 * g + 7471 * b + HALF,
        -11059 * r - 21709 * g + 32768 * b + MIDDLE,
        32768 * r - 27439 * g - 5329 * b + MIDDLE,
    ]
    .map(|sum| (sum >> 16) as u8)
}

/// In zigzag order.
fn quantized(coefficients: &[i32; 64], steps: &[u8; 64]) -> [i32; 64] {
    ZIGZAG.map(|place| ((coefficients[place] / 8) as f32 / f32::from(steps[place])).round() as i32)
}
