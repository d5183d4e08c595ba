//! The orientation tag of picture files: how to turn the stored pixels so that they lie as viewers show them.

use crate::{Plane, Raster, Samples};

/// An orientation after EXIF, 1 to 8. 1 is the stored one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Orientation(u8);

/// The tag of TIFF and EXIF.
const TAG: u16 = 0x0112;
const EXIF: &[u8] = b"Exif\0\0";

impl Orientation {
    /// The stored orientation.
    pub const STORED: Self = Self(1);

    /// The tag of a PNG, JPEG, WebP or TIFF file; [`Self::STORED`] without a valid one.
    #[must_use]
    pub fn read(bytes: &[u8]) -> Self {
        let tagged = match bytes {
            [0x89, b'P', b'N', b'G', ..] => find_png_exif(bytes),
            [0xff, 0xd8, 0xff, ..] => find_jpeg_exif(bytes),
            [b'R', b'I', b'F', b'F', ..] => find_webp_exif(bytes),
            _ => Some(bytes),
        };
        let short = tagged.and_then(|exif| find_short(exif, TAG));
        short.map_or(Self::STORED, |found| match found.value {
            value @ 1..=8 => Self(value as u8),
            _ => Self::STORED,
        })
    }

    /// The value of the tag.
    #[must_use]
    pub fn tag(self) -> u8 {
        self.0
    }

    /// Whether width and height are exchanged.
    #[must_use]
    pub fn swaps_sides(self) -> bool {
        self.0 >= 5
    }

    /// The sides of the shown picture.
    #[must_use]
    pub fn shown_sides(self, (width, height): (usize, usize)) -> (usize, usize) {
        if self.swaps_sides() {
            (height, width)
        } else {
            (width, height)
        }
    }

    /// The stored pixel at a place of the shown picture, for a stored picture of `width` and `height`.
    fn stored_place(self, (width, height): (usize, usize), (x, y): (usize, usize)) -> (usize, usize) {
        match self.0 {
            2 => (width - 1 - x, y),
            3 => (width - 1 - x, height - 1 - y),
            4 => (x, height - 1 - y),
            5 => (y, x),
            6 => (y, height - 1 - x),
            7 => (width - 1 - y, height - 1 - x),
            8 => (width - 1 - y, x),
            _ => (x, y),
        }
    }

    fn turn_samples<T: Copy>(self, stored: (usize, usize), count: usize, samples: &[T]) -> Vec<T> {
        let (width, height) = self.shown_sides(stored);
        let mut turned = Vec::with_capacity(samples.len());
        for y in 0..height {
            for x in 0..width {
                let (column, row) = self.stored_place(stored, (x, y));
                let start = (row * stored.0 + column) * count;
                turned.extend_from_slice(&samples[start..start + count]);
            }
        }
        turned
    }

    /// Turns a plane of the stored orientation.
    #[must_use]
    pub fn turn_plane<T: Copy>(self, plane: Plane<T>) -> Plane<T> {
        if self == Self::STORED {
            return plane;
        }
        let (width, height) = self.shown_sides(plane.size());
        let turned = self.turn_samples(plane.size(), 1, plane.data());
        Plane::new(width, height, turned).unwrap_or(plane)
    }

    /// Turns a picture of the stored orientation.
    #[must_use]
    pub(super) fn turn_raster(self, raster: Raster) -> Raster {
        if self == Self::STORED {
            return raster;
        }
        let stored = (raster.width(), raster.height());
        let turn = |samples: &Samples, count| match samples {
            Samples::U8(codes) => Samples::U8(self.turn_samples(stored, count, codes)),
            Samples::U16(codes) => Samples::U16(self.turn_samples(stored, count, codes)),
        };
        let (width, height) = self.shown_sides(stored);
        let samples = turn(raster.samples(), raster.channels().count());
        let alpha = raster.alpha().map(|alpha| turn(alpha, 1));
        Raster::new(width, height, raster.channels(), samples, alpha).unwrap_or(raster)
    }
}

/// The chunk `eXIf`.
fn find_png_exif(bytes: &[u8]) -> Option<&[u8]> {
    let mut rest = bytes.get(8..)?;
    loop {
        let (head, body) = rest.split_first_chunk::<8>()?;
        let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
        if &head[4..] == b"eXIf" {
            return body.get(..length);
        }
        rest = body.get(length.checked_add(4)?..)?;
    }
}

/// The application segment that starts with `Exif`, before the scan.
fn find_jpeg_exif(bytes: &[u8]) -> Option<&[u8]> {
    const EXIF_SEGMENT: u8 = 0xe1;
    const SCAN: u8 = 0xda;
    let mut rest = bytes.get(2..)?;
    loop {
        let marker = match rest {
            [0xff, 0xff, ..] => {
                rest = &rest[1..];
                continue;
            }
            [0xff, marker, ..] if *marker != SCAN => *marker,
            _ => return None,
        };
        let length = usize::from(u16::from_be_bytes([*rest.get(2)?, *rest.get(3)?]));
        let segment = rest.get(4..2 + length)?;
        if let (EXIF_SEGMENT, Some(exif)) = (marker, segment.strip_prefix(EXIF)) {
            return Some(exif);
        }
        rest = &rest[2 + length..];
    }
}

/// The chunk `EXIF`, which some programs start like that of a JPEG.
fn find_webp_exif(bytes: &[u8]) -> Option<&[u8]> {
    let mut rest = bytes.get(12..)?;
    loop {
        let (head, body) = rest.split_first_chunk::<8>()?;
        let length = u32::from_le_bytes([head[4], head[5], head[6], head[7]]) as usize;
        if &head[..4] == b"EXIF" {
            let exif = body.get(..length)?;
            return Some(exif.strip_prefix(EXIF).unwrap_or(exif));
        }
        rest = body.get(length.checked_add(length % 2)?..)?;
    }
}

/// A short value in the first directory of a TIFF structure.
pub(super) struct Short {
    /// Position of its two bytes.
    pub(super) position: usize,
    pub(super) value: u16,
    pub(super) is_big_endian: bool,
}

/// Finds a short value in the first directory of a TIFF structure.
pub(super) fn find_short(tiff: &[u8], tag: u16) -> Option<Short> {
    const ENTRY_BYTES: usize = 12;
    const SHORT: u16 = 3;
    let is_big_endian = match tiff.get(..4)? {
        b"MM\0*" => true,
        b"II*\0" => false,
        _ => return None,
    };
    let short = |position: usize| {
        let bytes = tiff.get(position..position + 2)?.try_into().ok()?;
        Some(if is_big_endian {
            u16::from_be_bytes(bytes)
        } else {
            u16::from_le_bytes(bytes)
        })
    };
    let start: [u8; 4] = tiff.get(4..8)?.try_into().ok()?;
    let start = if is_big_endian {
        u32::from_be_bytes(start)
    } else {
        u32::from_le_bytes(start)
    } as usize;
    let count = usize::from(short(start)?);
    (0..count).find_map(|index| {
        let entry = start + 2 + index * ENTRY_BYTES;
        if short(entry)? != tag || short(entry + 2)? != SHORT {
            return None;
        }
        Some(Short {
            position: entry + 8,
            value: short(entry + 8)?,
            is_big_endian,
        })
    })
}
