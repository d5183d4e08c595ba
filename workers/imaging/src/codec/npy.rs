//! NumPy array files (NPY 1.0 to 3.0) of plain numbers.

use ::exr::prelude::f16;

use super::sheet::{Sheet, SheetValues};
use super::{DecodeError, check_size};
use crate::{Plane, Rgb};

/// An array as stored in the file.
#[derive(Debug, Clone, PartialEq)]
pub struct NpyArray {
    /// Lengths of the dimensions, the slowest first.
    pub shape: Vec<usize>,
    /// The numbers, the last dimension fastest.
    pub values: NpyValues,
}

/// Numbers of an array, in the type of the file.
#[derive(Debug, Clone, PartialEq)]
pub enum NpyValues {
    /// float32, or float16 widened
    F32(Vec<f32>),
    /// float64
    F64(Vec<f64>),
    /// uint8
    U8(Vec<u8>),
    /// uint16
    U16(Vec<u16>),
    /// Other integers and truth values, widened; beyond the range of i64 its maximum
    Wide(Vec<i64>),
}

const MAGIC: &[u8] = b"\x93NUMPY";
/// Longest header: NumPy writes 128 bytes for the supported arrays.
const MAX_HEADER_BYTES: usize = 4096;

pub(super) fn is_npy(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

fn damaged(reason: impl ToString) -> DecodeError {
    DecodeError::Damaged {
        format: "NPY",
        reason: reason.to_string(),
    }
}

fn unsuitable(found: impl Into<String>, wanted: &'static str) -> DecodeError {
    DecodeError::Unsuitable {
        found: found.into(),
        wanted,
    }
}

/// Decodes an array of numbers or truth values, either byte order, C or Fortran order.
///
/// # Errors
/// [`DecodeError`]: a damaged header, another type, less data than its shape requires.
pub fn decode_npy(bytes: &[u8]) -> Result<NpyArray, DecodeError> {
    Header::read(bytes)?.decode()
}

/// Decodes an array of shape [height, width], [height, width, bands] or [1, height, width], within the limits of
/// pictures.
pub(super) fn decode_sheet(bytes: &[u8]) -> Result<Sheet, DecodeError> {
    let header = Header::read(bytes)?;
    let (height, width, bands) = match header.shape[..] {
        [height, width] => (height, width, 1),
        [height, width, bands @ 1..=4] => (height, width, bands),
        [1, height, width] => (height, width, 1),
        _ => {
            let found = format!("an array of shape {:?}", header.shape);
            return Err(unsuitable(
                found,
                "shape [height, width] for a mask or distances, [height, width, 3] for a picture",
            ));
        }
    };
    check_size(width, height)?;
    let values = match header.decode()?.values {
        NpyValues::F32(values) => SheetValues::F32(values),
        NpyValues::F64(values) => SheetValues::F32(values.into_iter().map(|value| value as f32).collect()),
        NpyValues::U8(values) => SheetValues::U8(values),
        NpyValues::U16(values) => SheetValues::U16(values),
        NpyValues::Wide(values) => SheetValues::Wide(values),
    };
    Ok(Sheet {
        width,
        height,
        bands,
        has_alpha: bands == 4,
        values,
        palette: None,
    })
}

/// The header, and the data after it.
pub(super) struct Header<'a> {
    kind: &'a str,
    is_fortran: bool,
    pub(super) shape: Vec<usize>,
    data: &'a [u8],
}

impl<'a> Header<'a> {
    pub(super) fn read(bytes: &'a [u8]) -> Result<Self, DecodeError> {
        let (prefix_bytes, header_bytes) = match bytes {
            [_, _, _, _, _, _, 1, _, low, high, ..] => (10, usize::from(u16::from_le_bytes([*low, *high]))),
            [_, _, _, _, _, _, 2 | 3, _, a, b, c, d, ..] => {
                (12, u32::from_le_bytes([*a, *b, *c, *d]) as usize)
            }
            _ => return Err(damaged("it has no header")),
        };
        if header_bytes > MAX_HEADER_BYTES {
            let found = format!("a header of {header_bytes} bytes");
            return Err(unsuitable(found, "one of at most 4096"));
        }
        let header = bytes[prefix_bytes..].get(..header_bytes);
        let header = header.ok_or_else(|| damaged("its header is cut off"))?;
        let text = str::from_utf8(header).map_err(|_| damaged("its header is not text"))?;
        // An array of plain numbers needs only a dictionary with one tuple.
        if text.contains('[') || text.matches('(').count() > 1 || text.matches('{').count() > 1 {
            return Err(unsuitable("a structured array", "plain numbers"));
        }
        Self::parse(text, &bytes[prefix_bytes + header_bytes..])
            .ok_or_else(|| damaged("its header has no `descr`, `fortran_order` and `shape`"))
    }

    pub(super) fn is_float32_by_rows(&self) -> bool {
        self.kind == "<f4" && !self.is_fortran
    }

    /// Length of the data.
    pub(super) fn data_bytes(&self) -> usize {
        self.data.len()
    }

    fn parse(text: &'a str, data: &'a [u8]) -> Option<Self> {
        let kind = entry(text, "descr")?;
        let quote = kind.chars().next().filter(|c| ['\'', '"'].contains(c))?;
        let (kind, _) = kind[1..].split_once(quote)?;
        let order = entry(text, "fortran_order")?;
        let (shape, _) = entry(text, "shape")?.strip_prefix('(')?.split_once(')')?;
        let shape = shape.trim().trim_end_matches(',');
        let lengths = shape.split(',').map(|length| length.trim().parse().ok());
        Some(Self {
            kind,
            is_fortran: order.starts_with("True"),
            shape: if shape.is_empty() {
                Vec::new()
            } else {
                lengths.collect::<Option<_>>()?
            },
            data,
        })
    }

    fn decode(self) -> Result<NpyArray, DecodeError> {
        let values = match self.kind.trim_start_matches(['<', '>', '|', '=']) {
            "f2" => {
                let halves = self.numbers(f16::from_le_bytes, f16::from_be_bytes)?;
                NpyValues::F32(halves.into_iter().map(f16::to_f32).collect())
            }
            "f4" => NpyValues::F32(self.numbers(f32::from_le_bytes, f32::from_be_bytes)?),
            "f8" => NpyValues::F64(self.numbers(f64::from_le_bytes, f64::from_be_bytes)?),
            "u2" => NpyValues::U16(self.numbers(u16::from_le_bytes, u16::from_be_bytes)?),
            "u1" => NpyValues::U8(self.numbers(u8::from_le_bytes, u8::from_be_bytes)?),
            "b1" => NpyValues::U8(self.numbers(u8::from_le_bytes, u8::from_be_bytes)?),
            "i1" => widened(self.numbers(i8::from_le_bytes, i8::from_be_bytes)?),
            "i2" => widened(self.numbers(i16::from_le_bytes, i16::from_be_bytes)?),
            "i4" => widened(self.numbers(i32::from_le_bytes, i32::from_be_bytes)?),
            "u4" => widened(self.numbers(u32::from_le_bytes, u32::from_be_bytes)?),
            "i8" => NpyValues::Wide(self.numbers(i64::from_le_bytes, i64::from_be_bytes)?),
            "u8" => {
                let values = self.numbers(u64::from_le_bytes, u64::from_be_bytes)?;
                let values = values.into_iter();
                NpyValues::Wide(
                    values
                        .map(|value| i64::try_from(value).unwrap_or(i64::MAX))
                        .collect(),
                )
            }
            _ => {
                let found = format!("values of type {}", self.kind);
                return Err(unsuitable(found, "floats, integers or truth values"));
            }
        };
        Ok(NpyArray {
            values: if self.is_fortran {
                reorder(values, &self.shape)
            } else {
                values
            },
            shape: self.shape,
        })
    }

    fn numbers<T, const BYTES: usize>(
        &self,
        little_endian: fn([u8; BYTES]) -> T,
        big_endian: fn([u8; BYTES]) -> T,
    ) -> Result<Vec<T>, DecodeError> {
        let is_big = self.kind.starts_with('>');
        let number = if is_big { big_endian } else { little_endian };
        let count = self
            .shape
            .iter()
            .try_fold(1usize, |count, &side| count.checked_mul(side));
        let numbers = self.data.as_chunks::<BYTES>().0;
        let numbers = count.and_then(|count| numbers.get(..count)).ok_or_else(|| {
            let present = self.data.len();
            damaged(format!(
                "it has {present} bytes of data, less than its header announces"
            ))
        })?;
        Ok(numbers.iter().copied().map(number).collect())
    }
}

fn widened<T: Into<i64>>(values: Vec<T>) -> NpyValues {
    NpyValues::Wide(values.into_iter().map(Into::into).collect())
}

/// From Fortran order, the first dimension fastest, to C order.
fn reorder(values: NpyValues, shape: &[usize]) -> NpyValues {
    fn reorder<T: Copy>(values: &[T], shape: &[usize]) -> Vec<T> {
        let mut strides = Vec::with_capacity(shape.len());
        let mut stride = 1;
        for side in shape {
            strides.push(stride);
            stride *= side;
        }
        let mut place = vec![0; shape.len()];
        let mut reordered = Vec::with_capacity(values.len());
        for _ in 0..values.len() {
            let index: usize = place.iter().zip(&strides).map(|(at, stride)| at * stride).sum();
            reordered.push(values[index]);
            for (at, side) in place.iter_mut().zip(shape).rev() {
                *at += 1;
                if *at < *side {
                    break;
                }
                *at = 0;
            }
        }
        reordered
    }
    match values {
        NpyValues::F32(values) => NpyValues::F32(reorder(&values, shape)),
        NpyValues::F64(values) => NpyValues::F64(reorder(&values, shape)),
        NpyValues::U8(values) => NpyValues::U8(reorder(&values, shape)),
        NpyValues::U16(values) => NpyValues::U16(reorder(&values, shape)),
        NpyValues::Wide(values) => NpyValues::Wide(reorder(&values, shape)),
    }
}

/// The text after a key of the header's dictionary.
fn entry<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(key)?;
    let rest = rest.strip_prefix(['\'', '"'])?.trim_start();
    Some(rest.strip_prefix(':')?.trim_start())
}

/// An NPY file of shape [height, width, 3], f32, little endian.
#[must_use]
pub fn encode_npy_rgb(picture: &Rgb<f32>) -> Vec<u8> {
    let [r, g, b] = picture.planes().each_ref().map(Plane::data);
    let values = r.iter().zip(g).zip(b).flat_map(|((&r, &g), &b)| [r, g, b]);
    encode(
        &format!("({}, {}, 3)", picture.height(), picture.width()),
        values,
        3 * r.len(),
    )
}

/// An NPY file of shape [height, width, 6] of two pictures, f32, little endian: the planes of the first, then those of
/// the second. Rows and columns beyond the smaller picture are dropped.
#[must_use]
pub fn encode_npy_pair(first: &Rgb<f32>, second: &Rgb<f32>) -> Vec<u8> {
    let width = first.width().min(second.width());
    let height = first.height().min(second.height());
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let values = pixels.flat_map(|(x, y)| {
        let planes = first.planes().iter().chain(second.planes());
        planes.map(move |plane| plane.pixel(x, y))
    });
    encode(&format!("({height}, {width}, 6)"), values, 6 * width * height)
}

/// An NPY file of shape [height, width], f32, little endian.
#[must_use]
pub fn encode_npy_plane(plane: &Plane<f32>) -> Vec<u8> {
    encode(
        &format!("({}, {})", plane.height(), plane.width()),
        plane.data().iter().copied(),
        plane.data().len(),
    )
}

fn encode(shape: &str, values: impl Iterator<Item = f32>, count: usize) -> Vec<u8> {
    const PREFIX_BYTES: usize = 10;
    let mut header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}");
    // The data begins at a multiple of 64 bytes, and the header ends with a line feed.
    while !(PREFIX_BYTES + header.len() + 1).is_multiple_of(64) {
        header.push(' ');
    }
    header.push('\n');
    let mut file = Vec::with_capacity(PREFIX_BYTES + header.len() + 4 * count);
    file.extend_from_slice(MAGIC);
    file.extend_from_slice(&[1, 0]);
    file.extend_from_slice(&(header.len() as u16).to_le_bytes());
    file.extend_from_slice(header.as_bytes());
    values.for_each(|value| file.extend_from_slice(&value.to_le_bytes()));
    file
}
