//! Sampling of pictures and labels along a map.

use imaging::{Plane, Rgb, cancel};

use super::map::Coordinates;

/// A map prepared for sampling: four pixels and the weights between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampling {
    size: (usize, usize),
    source: (usize, usize),
    /// One for all channels, or three.
    taps: Vec<Vec<Tap>>,
    /// 0 where a channel looks outside the source picture; `None` if all are inside everywhere.
    valid: Option<Plane<u8>>,
}

/// The upper left of four pixels, and the position between them.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Tap {
    index: u32,
    x: f32,
    y: f32,
}

impl Tap {
    fn new(x: f64, y: f64, source: (usize, usize)) -> Self {
        let ((column, x), (row, y)) = (split_position(x, source.0), split_position(y, source.1));
        Self {
            index: (row * source.0 + column) as u32,
            x: x as f32,
            y: y as f32,
        }
    }
}

/// Whether a position is on a picture of square pixels.
fn is_inside(place: f64, side: usize) -> bool {
    place >= -0.5 && place < side as f64 - 0.5
}

/// The lower neighbor of a position and the distance from it, clamped to the edge.
fn split_position(place: f64, side: usize) -> (usize, f64) {
    let last = side as f64 - 1.0;
    let place = place.clamp(0.0, last);
    let lower = place.floor().min((last - 1.0).max(0.0));
    (lower as usize, place - lower)
}

impl Sampling {
    /// Prepares these maps, one for all channels or three, for a source picture of this size.
    ///
    /// # Panics
    /// Without a map.
    #[must_use]
    pub fn new(maps: &[Coordinates], source: (usize, usize)) -> Self {
        let size = maps[0].x.size();
        let taps = maps.iter().map(|map| {
            cancel::check();
            let places = map.x.data().iter().zip(map.y.data());
            places.map(|(&x, &y)| Tap::new(x, y, source)).collect()
        });
        let mut valid = Plane::filled(size.0, size.1, 1u8);
        for map in maps {
            let places = map.x.data().iter().zip(map.y.data());
            for (valid, (&x, &y)) in valid.data_mut().iter_mut().zip(places) {
                *valid &= u8::from(is_inside(x, source.0) && is_inside(y, source.1));
            }
        }
        Self {
            size,
            source,
            taps: taps.collect(),
            valid: valid.data().contains(&0).then_some(valid),
        }
    }

    /// Columns and rows of the output.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        self.size
    }

    /// 1 where all channels look into the source picture, else 0; `None` if all do everywhere.
    #[must_use]
    pub fn valid(&self) -> Option<&Plane<u8>> {
        self.valid.as_ref()
    }

    /// Position in the source picture of a pixel's green channel, px.
    #[must_use]
    pub fn position(&self, x: usize, y: usize) -> [f64; 2] {
        let (tap, [column, row]) = self.tap(x, y);
        [column + f64::from(tap.x), row + f64::from(tap.y)]
    }

    /// The source pixel that provides the label of a pixel in [`Sampling::labels`].
    #[must_use]
    pub fn nearest(&self, x: usize, y: usize) -> [f64; 2] {
        let (tap, [column, row]) = self.tap(x, y);
        [
            column + f64::from(u8::from(tap.x >= 0.5)),
            row + f64::from(u8::from(tap.y >= 0.5)),
        ]
    }

    fn tap(&self, x: usize, y: usize) -> (Tap, [f64; 2]) {
        let taps = self.taps.get(1).unwrap_or(&self.taps[0]);
        let tap = taps[y * self.size.0 + x];
        let (row, column) = (
            tap.index as usize / self.source.0,
            tap.index as usize % self.source.0,
        );
        (tap, [column as f64, row as f64])
    }

    /// Samples a picture bilinearly along the map; its edge extends outwards.
    ///
    /// # Panics
    /// If the picture does not have the size of the source.
    #[must_use]
    pub fn picture(&self, picture: &Rgb<f32>) -> Rgb<f32> {
        assert_eq!(
            picture.size(),
            self.source,
            "the picture that the map was made for"
        );
        let (right, below) = self.steps();
        let (width, height) = self.size;
        let planes = picture.planes().each_ref().map(Plane::data);
        let mut out = [const { Vec::new() }; 3];
        for (channel, out) in out.iter_mut().enumerate() {
            let taps = self.taps.get(channel).unwrap_or(&self.taps[0]);
            let data = planes[channel];
            out.reserve_exact(taps.len());
            for row in taps.chunks(width.max(1)) {
                cancel::check();
                out.extend(row.iter().map(|tap| bilinear(data, tap, right, below)));
            }
        }
        let planes = out.map(|data| Plane::new(width, height, data).expect("a sample for each tap"));
        Rgb::new(planes).expect("three planes of one map")
    }

    /// Samples labels along the map of the green channel, nearest neighbor.
    ///
    /// # Panics
    /// If the plane does not have the size of the source.
    #[must_use]
    pub fn labels<T: Copy>(&self, labels: &Plane<T>) -> Plane<T> {
        assert_eq!(
            labels.size(),
            self.source,
            "the picture that the map was made for"
        );
        let (right, below) = self.steps();
        let taps = self.taps.get(1).unwrap_or(&self.taps[0]);
        let nearest = taps.iter().map(|tap| {
            let column = if tap.x >= 0.5 { right } else { 0 };
            let row = if tap.y >= 0.5 { below } else { 0 };
            labels.data()[tap.index as usize + column + row]
        });
        let data = nearest.collect();
        Plane::new(self.size.0, self.size.1, data).expect("a sample for each tap")
    }

    /// Index steps to the right and lower neighbor; 0 for a source of one column or row.
    fn steps(&self) -> (usize, usize) {
        let (width, height) = self.source;
        (usize::from(width > 1), if height > 1 { width } else { 0 })
    }
}

#[inline(always)]
fn bilinear(data: &[f32], tap: &Tap, right: usize, below: usize) -> f32 {
    let index = tap.index as usize;
    let (a, b) = (data[index], data[index + right]);
    let (c, d) = (data[index + below], data[index + below + right]);
    let upper = a + (b - a) * tap.x;
    let lower = c + (d - c) * tap.x;
    upper + (lower - upper) * tap.y
}

/// Samples a channel of a picture along its map in f64.
#[must_use]
pub fn resample_reference(plane: &Plane<f64>, map: &Coordinates) -> Plane<f64> {
    let (width, height) = plane.size();
    Plane::from_fn(map.x.width(), map.x.height(), |i, j| {
        let (column, x) = split_position(map.x.pixel(i, j), width);
        let (row, y) = split_position(map.y.pixel(i, j), height);
        let sample =
            |dx: usize, dy: usize| plane.pixel((column + dx).min(width - 1), (row + dy).min(height - 1));
        let upper = sample(0, 0) * (1.0 - x) + sample(1, 0) * x;
        let lower = sample(0, 1) * (1.0 - x) + sample(1, 1) * x;
        upper * (1.0 - y) + lower * y
    })
}
