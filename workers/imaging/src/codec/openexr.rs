//! OpenEXR files: the channels R, G and B as linear light, or Z as distances; half or float, any compression.
//!
//! A channel of a layer is called `LAYER.R`. Channels without a layer have priority; otherwise exactly one layer must
//! contain them, or one called `Combined`, Blender's name of the picture among its passes. A Z with X and Y is a
//! component of a vector and not a distance. The pixels are those of the data window; deep files and subsampled
//! channels are rejected.

use std::io::Cursor;

use ::exr::block::reader::ChunksReader;
use ::exr::block::{self, UncompressedBlock};
use ::exr::math::Vec2;
use ::exr::meta::BlockDescription;
use ::exr::meta::attribute::{ChannelList, SampleType};
use ::exr::meta::header::Header;
use ::exr::prelude::f16;

use super::{DecodeError, MAX_DECODER_BYTES, check_size};
use crate::{Plane, Rgb};

const MAGIC: &[u8] = &[0x76, 0x2f, 0x31, 0x01];
/// Layer of the picture among Blender's other passes.
const PICTURE_LAYER: &str = "Combined.";

pub(super) fn is_exr(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Columns and rows of the first data window in the header.
pub(super) fn announced_sides(bytes: &[u8]) -> Option<(usize, usize)> {
    /// Headers have a few hundred bytes.
    const HEADER_BYTES: usize = 1 << 16;
    const NAME: &[u8] = b"dataWindow\0box2i\0\x10\0\0\0";
    let head = bytes
        .get(..HEADER_BYTES.min(bytes.len()))
        .filter(|head| is_exr(head))?;
    let place = head.windows(NAME.len()).position(|window| window == NAME)? + NAME.len();
    let corners = head.get(place..place + 16)?.as_chunks::<4>().0;
    let [left, top, right, bottom] = [0, 1, 2, 3].map(|i: usize| i64::from(i32::from_le_bytes(corners[i])));
    let width = usize::try_from(right - left + 1).ok()?;
    let height = usize::try_from(bottom - top + 1).ok()?;
    Some((width, height))
}

/// Decodes the channels R, G and B.
pub(super) fn decode_rgb(bytes: &[u8]) -> Result<Rgb<f32>, DecodeError> {
    let planes = decode(bytes, &["R", "G", "B"], "channels R, G and B of half or float")?;
    let planes = <[Plane<f32>; 3]>::try_from(planes).map_err(|_| damaged("a channel is missing"))?;
    Rgb::new(planes).map_err(damaged)
}

/// Decodes the channel Z.
pub(super) fn decode_distances(bytes: &[u8]) -> Result<Plane<f32>, DecodeError> {
    let planes = decode(bytes, &["Z"], "one channel Z of half or float")?;
    planes
        .into_iter()
        .next()
        .ok_or_else(|| damaged("a channel is missing"))
}

fn damaged(reason: impl ToString) -> DecodeError {
    DecodeError::Damaged {
        format: "EXR",
        reason: reason.to_string(),
    }
}

/// Channels of a part of the file.
struct ChannelPart {
    part: usize,
    channels: Vec<usize>,
}

fn decode(bytes: &[u8], names: &[&str], wanted: &'static str) -> Result<Vec<Plane<f32>>, DecodeError> {
    let reader = block::read(Cursor::new(bytes), false).map_err(damaged)?;
    reader.headers().iter().try_for_each(check)?;
    let unsuitable = |found| DecodeError::Unsuitable { found, wanted };
    let found = find(reader.headers(), names).ok_or_else(|| unsuitable(listed(reader.headers())))?;
    let header = reader.headers()[found.part].clone();
    let has_integers = found
        .channels
        .iter()
        .any(|&channel| header.channels.list[channel].sample_type == SampleType::U32);
    if has_integers {
        return Err(unsuitable("channels of integers".to_owned()));
    }
    let Vec2(width, height) = header.layer_size;
    let mut pixels: Vec<ChannelPixels> = found
        .channels
        .iter()
        .map(|_| ChannelPixels::new(width, height))
        .collect();
    let blocks = reader
        .all_chunks(false)
        .map_err(damaged)?
        .sequential_decompressor(false);
    for block in blocks {
        let block = block.map_err(damaged)?;
        if block.index.layer == found.part && block.index.level == Vec2(0, 0) {
            take(&block, &header.channels, &found.channels, &mut pixels)?;
        }
    }
    pixels.into_iter().map(ChannelPixels::whole).collect()
}

/// Rejects unsupported files and those that need too much memory.
fn check(header: &Header) -> Result<(), DecodeError> {
    let Vec2(width, height) = header.layer_size;
    check_size(width, height)?;
    let channels = &header.channels.list;
    let unsuitable = |found: &str, wanted| DecodeError::Unsuitable {
        found: found.to_owned(),
        wanted,
    };
    if header.deep {
        return Err(unsuitable("deep data", "flat data"));
    }
    if channels.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
        return Err(unsuitable("subsampled channels", "a sample for each pixel"));
    }
    let Vec2(columns, rows) = match header.blocks {
        BlockDescription::ScanLines => Vec2(width, header.compression.scan_lines_per_block()),
        BlockDescription::Tiles(tiles) => tiles.tile_size,
    };
    let bytes = channels
        .iter()
        .map(|channel| channel.sample_type.bytes_per_sample());
    let pixel_bytes: usize = bytes.sum();
    if columns.saturating_mul(rows).saturating_mul(pixel_bytes) > MAX_DECODER_BYTES {
        return Err(unsuitable("blocks of more than 256 MiB", "smaller blocks"));
    }
    Ok(())
}

/// The channels of these names, by the rules of the module.
fn find(headers: &[Header], names: &[&str]) -> Option<ChannelPart> {
    let mut found: Vec<(&str, ChannelPart)> = Vec::new();
    let texts: Vec<Vec<String>> = headers.iter().map(channel_names).collect();
    for (part, texts) in texts.iter().enumerate() {
        let layers = texts.iter().filter_map(|text| text.strip_suffix(names[0]));
        for layer in layers.filter(|layer| layer.is_empty() || layer.ends_with('.')) {
            let channels = names.iter().map(|name| {
                let name = format!("{layer}{name}");
                texts.iter().position(|text| *text == name)
            });
            let is_vector = names == ["Z"]
                && ["X", "Y"]
                    .iter()
                    .all(|axis| texts.contains(&format!("{layer}{axis}")));
            if let (Some(channels), false) = (channels.collect(), is_vector) {
                found.push((layer, ChannelPart { part, channels }));
            }
        }
    }
    let only = found.len() == 1;
    // Channels without a layer come first.
    found.sort_by_key(|(layer, _)| !layer.is_empty());
    let mut found = found.into_iter();
    found
        .find(|(layer, _)| only || layer.is_empty() || layer.ends_with(PICTURE_LAYER))
        .map(|(_, found)| found)
}

fn channel_names(header: &Header) -> Vec<String> {
    header
        .channels
        .list
        .iter()
        .map(|channel| channel.name.to_string())
        .collect()
}

/// The content of a file, for messages.
fn listed(headers: &[Header]) -> String {
    const MOST: usize = 20;
    let names: Vec<String> = headers.iter().flat_map(channel_names).collect();
    let more = if names.len() > MOST { ", …" } else { "" };
    let shown: Vec<String> = names
        .iter()
        .take(MOST)
        .map(|name| name.escape_debug().to_string())
        .collect();
    format!("the channels {}{more}", shown.join(", "))
}

/// A channel being assembled from blocks.
struct ChannelPixels {
    width: usize,
    height: usize,
    data: Vec<f32>,
    /// Number of samples received.
    filled: usize,
}

impl ChannelPixels {
    fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            data: vec![f32::NAN; width * height],
            filled: 0,
        }
    }

    fn put(
        &mut self,
        Vec2(x, y): Vec2<usize>,
        samples: impl ExactSizeIterator<Item = f32>,
    ) -> Result<(), DecodeError> {
        let count = samples.len();
        let start = y * self.width + x;
        let target = self.data.get_mut(start..start + count);
        let Some(target) = target.filter(|_| x + count <= self.width && y < self.height) else {
            return Err(damaged("a block is outside of the picture"));
        };
        target
            .iter_mut()
            .zip(samples)
            .for_each(|(pixel, sample)| *pixel = sample);
        self.filled += count;
        Ok(())
    }

    fn whole(self) -> Result<Plane<f32>, DecodeError> {
        if self.filled != self.data.len() {
            return Err(damaged("blocks are missing"));
        }
        Plane::new(self.width, self.height, self.data).map_err(damaged)
    }
}

/// Copies the requested channels out of a block.
fn take(
    block: &UncompressedBlock,
    channels: &ChannelList,
    wanted: &[usize],
    pixels: &mut [ChannelPixels],
) -> Result<(), DecodeError> {
    for line in block.lines(channels) {
        let Some(at) = wanted
            .iter()
            .position(|channel| *channel == line.location.channel)
        else {
            continue;
        };
        let place = line.location.position;
        match channels.list[line.location.channel].sample_type {
            SampleType::F16 => {
                let samples = line.value.as_chunks::<2>().0;
                pixels[at].put(
                    place,
                    samples.iter().map(|bytes| f16::from_ne_bytes(*bytes).to_f32()),
                )?;
            }
            SampleType::F32 => {
                let samples = line.value.as_chunks::<4>().0;
                pixels[at].put(place, samples.iter().map(|bytes| f32::from_ne_bytes(*bytes)))?;
            }
            SampleType::U32 => return Err(damaged("a channel of integers")),
        }
    }
    Ok(())
}
