//! Color profiles of picture files. Codes are read as sRGB, so another profile is worth a note.

use std::io::Cursor;

use tiff::tags::Tag;
use zune_core::bytestream::ZCursor;

/// Memory for unpacking a profile; those of cameras and printers are below.
const MOST_BYTES: usize = 4 << 20;
/// Gamma of sRGB after the PNG specification, and how far a rounded one may be from it.
const SRGB_GAMMA: f32 = 0.45455;
const GAMMA_SLACK: f32 = 0.02;

/// The profile of a PNG, JPEG, WebP or TIFF file that is not sRGB, in words; `None` for sRGB and without a readable profile.
#[must_use]
pub fn find_foreign_profile(bytes: &[u8]) -> Option<String> {
    let profile = match bytes {
        [0x89, b'P', b'N', b'G', ..] => return find_png_profile(bytes),
        [0xff, 0xd8, 0xff, ..] => {
            let mut decoder = zune_jpeg::JpegDecoder::new(ZCursor::new(bytes));
            decoder.decode_headers().ok()?;
            decoder.icc_profile()
        }
        [b'R', b'I', b'F', b'F', ..] => {
            let mut decoder = image_webp::WebPDecoder::new(Cursor::new(bytes)).ok()?;
            decoder.set_memory_limit(MOST_BYTES);
            decoder.icc_profile().ok()?
        }
        [b'I', b'I', ..] | [b'M', b'M', ..] => {
            let mut decoder = tiff::decoder::Decoder::new(Cursor::new(bytes)).ok()?;
            decoder.get_tag_u8_vec(Tag::IccProfile).ok()
        }
        _ => None,
    };
    name_foreign(&profile?)
}

fn find_png_profile(bytes: &[u8]) -> Option<String> {
    let limits = png::Limits { bytes: MOST_BYTES };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_ignore_text_chunk(true);
    let reader = decoder.read_info().ok()?;
    let info = reader.info();
    if info.srgb.is_some() {
        return None;
    }
    if let Some(profile) = &info.icc_profile {
        return name_foreign(profile);
    }
    let gamma = info.gama_chunk?.into_value();
    ((gamma - SRGB_GAMMA).abs() > GAMMA_SLACK).then(|| format!("a gamma of {gamma}"))
}

fn name_foreign(profile: &[u8]) -> Option<String> {
    let name = read_description(profile);
    match name {
        Some(name) if name.to_ascii_lowercase().contains("srgb") => None,
        // A small sRGB profile by Facebook.
        Some(name) if name == "c2" => None,
        Some(name) => Some(format!("the color profile `{name}`")),
        None => Some("a color profile without a name".to_owned()),
    }
}

/// The text of the tag `desc` of an ICC profile, of version 2 (ASCII) or 4 (UTF-16).
fn read_description(profile: &[u8]) -> Option<String> {
    const HEADER_BYTES: usize = 128;
    const ENTRY_BYTES: usize = 12;
    const MOST_TAGS: usize = 100;
    let word = |position: usize| {
        let bytes = profile.get(position..position.checked_add(4)?)?;
        Some(u32::from_be_bytes(bytes.try_into().ok()?) as usize)
    };
    let tags = word(HEADER_BYTES)?.min(MOST_TAGS);
    let entry = (0..tags)
        .map(|tag| HEADER_BYTES + 4 + tag * ENTRY_BYTES)
        .find(|&entry| profile.get(entry..entry + 4) == Some(b"desc"))?;
    let start = word(entry + 4)?;
    let name = match profile.get(start..start.checked_add(4)?)? {
        b"desc" => {
            let length = word(start + 8)?;
            let text = profile.get(start + 12..(start + 12).checked_add(length)?)?;
            String::from_utf8_lossy(text).into_owned()
        }
        b"mluc" => {
            let (length, offset) = (word(start + 20)?, word(start + 24)?);
            let begin = start.checked_add(offset)?;
            let text = profile.get(begin..begin.checked_add(length)?)?;
            let units: Vec<u16> = text
                .chunks_exact(2)
                .map(|pair| u16::from_be_bytes([pair[0], pair[1]]))
                .collect();
            String::from_utf16_lossy(&units)
        }
        _ => return None,
    };
    let name: String = name
        .chars()
        .filter(|letter| !letter.is_control())
        .take(80)
        .collect();
    let name = name.trim();
    (!name.is_empty()).then(|| name.to_owned())
}
