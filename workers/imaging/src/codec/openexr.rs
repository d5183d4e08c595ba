//! OpenEXR files: the channels R, G and B as linear light, or one channel of distances or object numbers.
//!
//! A channel of a layer is called `LAYER.R`. Channels without a layer have priority; otherwise exactly one layer must
//! contain them, or one called `Combined`, Blender's name of the picture among its passes. A Z with X and Y is a
//! component of a vector and not a distance. Without Z, the only channel of a layer called `Depth` holds the
//! distances, or the only channel of the file besides alpha, or R = G = B. The pixels are those of the data window;
//! deep files and subsampled channels are rejected.

use std::io::Cursor;

use ::exr::block::reader::ChunksReader;
use ::exr::block::{self, UncompressedBlock};
use ::exr::math::Vec2;
use ::exr::meta::BlockDescription;
use ::exr::meta::attribute::{ChannelList, SampleType};
use ::exr::meta::header::Header;
use ::exr::prelude::f16;

use super::sheet::{Sheet, SheetValues};
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

/// Decodes the channels R, G and B, or the only channel Y of a gray picture.
pub(super) fn decode_rgb(bytes: &[u8]) -> Result<Rgb<f32>, DecodeError> {
    let pick = |headers: &[Header]| {
        find(headers, &["R", "G", "B"]).or_else(|| find_only(headers, |name| name == "Y"))
    };
    let planes = decode(bytes, pick, "channels R, G and B of half or float")?;
    let planes = match <[Plane<f32>; 3]>::try_from(planes) {
        Ok(planes) => planes,
        Err(gray) => match &gray[..] {
            [gray] => [gray.clone(), gray.clone(), gray.clone()],
            _ => return Err(damaged("a channel is missing")),
        },
    };
    Rgb::new(planes).map_err(damaged)
}

/// Decodes the distances.
pub(super) fn decode_distances(bytes: &[u8]) -> Result<Sheet, DecodeError> {
    let pick = |headers: &[Header]| {
        find(headers, &["Z"])
            .or_else(|| find_in_layer(headers, "Depth"))
            .or_else(|| find_only(headers, |_| true))
            .or_else(|| find(headers, &["R", "G", "B"]).filter(|_| count_channels(headers) == 3))
    };
    interleave(decode(
        bytes,
        pick,
        "one channel of distances, half or float, such as Z",
    )?)
}

/// Decodes the numbers of objects, which Blender stores in the layer `IndexOB`.
pub(super) fn decode_numbers(bytes: &[u8]) -> Result<Sheet, DecodeError> {
    let pick = |headers: &[Header]| {
        find_in_layer(headers, "IndexOB")
            .or_else(|| find_only(headers, |_| true))
            .or_else(|| find(headers, &["R", "G", "B"]).filter(|_| count_channels(headers) == 3))
    };
    interleave(decode(bytes, pick, "one channel of object numbers")?)
}

/// Whether a picture contains distances next to its colors.
pub(super) fn has_distances(bytes: &[u8]) -> bool {
    let Ok(reader) = block::read(Cursor::new(bytes), false) else {
        return false;
    };
    let headers = reader.headers();
    find(headers, &["R", "G", "B"]).is_some()
        && find(headers, &["Z"])
            .or_else(|| find_in_layer(headers, "Depth"))
            .is_some()
}

fn interleave(planes: Vec<Plane<f32>>) -> Result<Sheet, DecodeError> {
    let (width, height) = planes
        .first()
        .ok_or_else(|| damaged("a channel is missing"))?
        .size();
    let bands = planes.len();
    let pixels = 0..width * height;
    let values = match planes.into_iter().map(Plane::into_data).collect::<Vec<_>>() {
        mut only if only.len() == 1 => only.remove(0),
        many => pixels
            .flat_map(|pixel| many.iter().map(move |band| band[pixel]))
            .collect(),
    };
    Ok(Sheet {
        width,
        height,
        bands,
        has_alpha: false,
        values: SheetValues::F32(values),
        palette: None,
    })
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

fn decode(
    bytes: &[u8],
    pick: impl Fn(&[Header]) -> Option<ChannelPart>,
    wanted: &'static str,
) -> Result<Vec<Plane<f32>>, DecodeError> {
    let reader = block::read(Cursor::new(bytes), false).map_err(damaged)?;
    reader.headers().iter().try_for_each(check)?;
    let unsuitable = |found| DecodeError::Unsuitable { found, wanted };
    let found = pick(reader.headers()).ok_or_else(|| unsuitable(listed(reader.headers())))?;
    let header = reader.headers()[found.part].clone();
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

/// A channel by its part and position.
struct NamedChannel {
    part: usize,
    channel: usize,
    name: String,
}

/// All channels but alpha.
fn list_channels(headers: &[Header]) -> Vec<NamedChannel> {
    let mut listed = Vec::new();
    for (part, header) in headers.iter().enumerate() {
        let names = channel_names(header).into_iter().enumerate();
        listed.extend(
            names
                .filter(|(_, name)| name.rsplit('.').next() != Some("A"))
                .map(|(channel, name)| NamedChannel { part, channel, name }),
        );
    }
    listed
}

fn count_channels(headers: &[Header]) -> usize {
    list_channels(headers).len()
}

/// The only channel besides alpha, if its name fits.
fn find_only(headers: &[Header], fits: impl Fn(&str) -> bool) -> Option<ChannelPart> {
    match &list_channels(headers)[..] {
        [only] if fits(&only.name) => Some(ChannelPart {
            part: only.part,
            channels: vec![only.channel],
        }),
        _ => None,
    }
}

/// The only channel of the layers of a name, or of that name.
fn find_in_layer(headers: &[Header], layer: &str) -> Option<ChannelPart> {
    let channels = list_channels(headers);
    let mut fitting = channels.iter().filter(|channel| {
        let mut names = channel.name.rsplit('.').take(2);
        names.any(|name| name.eq_ignore_ascii_case(layer))
    });
    match (fitting.next(), fitting.next()) {
        (Some(only), None) => Some(ChannelPart {
            part: only.part,
            channels: vec![only.channel],
        }),
        _ => None,
    }
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
            SampleType::U32 => {
                let samples = line.value.as_chunks::<4>().0;
                pixels[at].put(
                    place,
                    samples.iter().map(|bytes| u32::from_ne_bytes(*bytes) as f32),
                )?;
            }
        }
    }
    Ok(())
}
