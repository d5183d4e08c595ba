//! Contact sheets: pictures in a grid, a caption under each.

use imaging::{Rgb8, codec};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// A picture and the lines under it.
pub struct Tile {
    pub picture: Rgb8,
    pub caption: Vec<String>,
}

const GAP_PX: usize = 8;
const LINE_PX: usize = 16;
const PAPER: [u8; 3] = [22, 26, 30];
const INK: [u8; 3] = [222, 226, 230];

/// Lays tiles out row by row, each picture reduced to `tile_width` columns at most, and captions below.
pub fn sheet(tiles: &[Tile], columns: usize, tile_width: usize) -> Rgb8 {
    let columns = columns.clamp(1, tiles.len().max(1));
    let thumbnails: Vec<Rgb8> = tiles
        .iter()
        .map(|tile| thumbnail(&tile.picture, tile_width))
        .collect();
    let picture_height = thumbnails.iter().map(Rgb8::height).max().unwrap_or(0);
    let caption_lines = tiles.iter().map(|tile| tile.caption.len()).max().unwrap_or(0);
    let cell_height = picture_height + caption_lines * LINE_PX + GAP_PX;
    let rows = tiles.len().div_ceil(columns);
    let width = GAP_PX + columns * (tile_width + GAP_PX);
    let height = GAP_PX + rows * (cell_height + GAP_PX);
    let mut paper = Rgb8::from_fn(width, height, |_, _| PAPER);
    for (index, (tile, thumbnail)) in tiles.iter().zip(&thumbnails).enumerate() {
        let left = GAP_PX + index % columns * (tile_width + GAP_PX);
        let top = GAP_PX + index / columns * (cell_height + GAP_PX);
        paste(&mut paper, thumbnail, left, top);
        for (line, text) in tile.caption.iter().enumerate() {
            write(
                &mut paper,
                text,
                left,
                top + picture_height + 4 + line * LINE_PX,
                left + tile_width,
            );
        }
    }
    paper
}

/// The legend of a sheet.
pub enum Legend {
    /// Colors with their names.
    Colors(Vec<([u8; 3], String)>),
    /// A ramp from share 0 to share 1.
    Ramp {
        /// The color of a share.
        color: fn(f64) -> [u8; 3],
        /// Labels at equal steps from one end to the other.
        ticks: Vec<String>,
        /// An additional color, outside of the ramp.
        hole: Option<([u8; 3], String)>,
    },
}

/// Side of a swatch, and height of a ramp.
const SWATCH_PX: usize = 14;
const RAMP_PX: usize = 480;

/// Puts a legend below a sheet, on as many lines as it needs.
pub fn with_legend(sheet: &Rgb8, legend: &Legend) -> Rgb8 {
    let right = sheet.width().saturating_sub(GAP_PX);
    let advance = get_raster_width(FontWeight::Regular, RasterHeight::Size16);
    let (entries, ramp) = match legend {
        Legend::Colors(entries) => (entries.as_slice(), None),
        Legend::Ramp { hole, .. } => (hole.as_slice(), Some(legend)),
    };
    let mut drawn = Vec::new();
    let (mut left, mut line) = (GAP_PX, 0);
    for (color, name) in entries {
        let width = SWATCH_PX + 6 + name.chars().count() * advance;
        if left > GAP_PX && left + width > right {
            (left, line) = (GAP_PX, line + 1);
        }
        drawn.push((*color, name, left, line));
        left += width + 2 * GAP_PX;
    }
    let ramp_height = ramp.map_or(0, |_| SWATCH_PX + LINE_PX + GAP_PX);
    let lines = if entries.is_empty() { 0 } else { line + 1 };
    let top = sheet.height();
    let height = top + ramp_height + lines * (LINE_PX + 4) + GAP_PX;
    let mut paper = Rgb8::from_fn(sheet.width(), height, |_, _| PAPER);
    paste(&mut paper, sheet, 0, 0);
    if let Some(ramp) = ramp {
        draw_ramp(&mut paper, ramp, top);
    }
    for (color, name, left, line) in drawn {
        let top = top + ramp_height + line * (LINE_PX + 4);
        paste(
            &mut paper,
            &Rgb8::from_fn(SWATCH_PX, SWATCH_PX, |_, _| color),
            left,
            top,
        );
        write(&mut paper, name, left + SWATCH_PX + 6, top, right);
    }
    paper
}

fn draw_ramp(paper: &mut Rgb8, legend: &Legend, top: usize) {
    let Legend::Ramp { color, ticks, .. } = legend else {
        return;
    };
    let width = RAMP_PX.min(paper.width().saturating_sub(2 * GAP_PX)).max(2);
    let share = |x: usize| x as f64 / (width - 1) as f64;
    paste(
        paper,
        &Rgb8::from_fn(width, SWATCH_PX, |x, _| color(share(x))),
        GAP_PX,
        top,
    );
    let advance = get_raster_width(FontWeight::Regular, RasterHeight::Size16);
    for (index, text) in ticks.iter().enumerate() {
        let x = index * (width - 1) / (ticks.len() - 1).max(1);
        // The outer ones end with the ramp, the inner ones have their middle below their place.
        let text_width = text.chars().count() * advance;
        let left = (GAP_PX + x).saturating_sub(text_width / 2);
        let left = left.clamp(GAP_PX, (GAP_PX + width).saturating_sub(text_width).max(GAP_PX));
        let right = paper.width();
        write(paper, text, left, top + SWATCH_PX + 2, right);
    }
}

fn thumbnail(picture: &Rgb8, tile_width: usize) -> Rgb8 {
    if picture.width() <= tile_width {
        return picture.clone();
    }
    let height = picture.height() * tile_width / picture.width();
    codec::downscale(picture, tile_width.max(height))
}

fn paste(paper: &mut Rgb8, picture: &Rgb8, left: usize, top: usize) {
    let stride = 3 * paper.width();
    let columns = picture.width().min(paper.width().saturating_sub(left));
    for y in 0..picture.height().min(paper.height().saturating_sub(top)) {
        let source = &picture.data()[3 * y * picture.width()..][..3 * columns];
        paper.data_mut()[(top + y) * stride + 3 * left..][..3 * columns].copy_from_slice(source);
    }
}

/// Writes one line from (left, top); what would pass `right` is cut off.
fn write(paper: &mut Rgb8, text: &str, left: usize, top: usize, right: usize) {
    let advance = get_raster_width(FontWeight::Regular, RasterHeight::Size16);
    for (index, character) in text.chars().enumerate() {
        let x = left + index * advance;
        if x + advance > right.min(paper.width()) || top + LINE_PX > paper.height() {
            return;
        }
        let known = if character.is_ascii_graphic() || character == ' ' {
            character
        } else {
            '?'
        };
        if let Some(glyph) = get_raster(known, FontWeight::Regular, RasterHeight::Size16) {
            for (row, coverage) in glyph.raster().iter().enumerate() {
                for (column, &share) in coverage.iter().enumerate() {
                    let first = 3 * ((top + row) * paper.width() + x + column);
                    let pixel = &mut paper.data_mut()[first..first + 3];
                    for (sample, ink) in pixel.iter_mut().zip(INK) {
                        let mixed =
                            u32::from(*sample) * u32::from(255 - share) + u32::from(ink) * u32::from(share);
                        *sample = (mixed / 255) as u8;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tile_has_its_place_and_its_caption_is_written_below() {
        let tile = |value| Tile {
            picture: Rgb8::from_fn(40, 20, |_, _| [value; 3]),
            caption: vec!["Hg".into()],
        };
        let paper = sheet(&[tile(100), tile(200), tile(50)], 2, 40);
        assert_eq!(paper.width(), 8 + 2 * 48);
        assert_eq!(paper.pixel(8, 8), [100; 3]);
        assert_eq!(paper.pixel(56, 8), [200; 3]);
        assert_eq!(paper.pixel(8, 8 + 20 + 16 + 8 + 8), [50; 3]);
        let ink = (0..16).flat_map(|y| (0..20).map(move |x| (x, y)));
        assert!(
            ink.map(|(x, y)| paper.pixel(8 + x, 32 + y)[0]).any(|v| v > 150),
            "no caption was written"
        );
    }

    #[test]
    fn a_legend_stands_below_the_sheet_with_its_colors() {
        let sheet = Rgb8::from_fn(200, 50, |_, _| [9; 3]);
        let names = ["pile", "brace", "background", "fitting"];
        let entries = names
            .iter()
            .enumerate()
            .map(|(index, name)| ([100 + index as u8; 3], (*name).to_owned()));
        let paper = with_legend(&sheet, &Legend::Colors(entries.collect()));
        assert_eq!((paper.width(), paper.pixel(199, 49)), (200, [9; 3]));
        for color in 100..104 {
            let below = (50..paper.height()).flat_map(|y| (0..200).map(move |x| (x, y)));
            let count = below.filter(|&(x, y)| paper.pixel(x, y) == [color; 3]).count();
            assert_eq!(count, SWATCH_PX * SWATCH_PX, "{color}");
        }
    }

    #[test]
    fn a_caption_wider_than_its_tile_is_cut_off() {
        let long = Tile {
            picture: Rgb8::from_fn(20, 10, |_, _| [9; 3]),
            caption: vec!["W".repeat(100)],
        };
        let paper = sheet(&[long], 1, 20);
        let beyond: Vec<_> = (0..paper.height())
            .map(|y| paper.pixel(paper.width() - 1, y))
            .collect();
        assert!(beyond.iter().all(|&pixel| pixel == PAPER));
    }
}
