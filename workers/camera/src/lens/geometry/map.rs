//! The map: for each output pixel and channel a position in the source picture.

use imaging::codec::{MAX_PIXELS, MAX_SIDE_PX};
use imaging::geometry::Intrinsics;
use imaging::{Plane, vectorized};
use spec::Distortion;

use super::brown::distorted;
use super::lens::{ARRIVED, Lens, MOST_STEPS, PortRefraction, border, refracted};

/// Margin around the area reached by the map.
const MARGIN_PX: f64 = 2.0;
/// Pixels that are inverted together.
const LANES: usize = 16;

/// A pinhole picture in water.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SourcePicture {
    /// Columns and rows.
    pub size: (usize, usize),
    /// Its intrinsics.
    pub camera: Intrinsics,
}

impl SourcePicture {
    /// The smallest centered picture that contains the mapped area of a lens and output size, with two pixels of margin
    /// and `supersample` pixels per output pixel along a side. Its sides are even, so that samples of a supersampled
    /// picture fall between pixels. `None` beyond the size limits of pictures.
    #[must_use]
    pub fn covering(lens: &Lens, size: (usize, usize), supersample: usize) -> Option<Self> {
        let focal_px = supersample as f64 * lens.camera.focal_px * lens.magnification();
        let (mut across, mut down) = (0.0f64, 0.0f64);
        for (x, y) in border(size) {
            let camera = lens.camera;
            let ideal = lens.undistorted(
                (x as f64 - camera.cx) / camera.focal_px,
                (y as f64 - camera.cy) / camera.focal_px,
            )?;
            for channel in 0..3 {
                let (u, v) = lens.in_water(ideal, channel);
                (across, down) = (across.max((u * focal_px).abs()), down.max((v * focal_px).abs()));
            }
        }
        let [width, height] = [across, down].map(|half| 2.0 * (half + 0.5 + MARGIN_PX).ceil());
        let fits = width.max(height) <= MAX_SIDE_PX as f64 && width * height <= MAX_PIXELS as f64;
        let size = (width as usize, height as usize);
        fits.then(|| Self {
            size,
            camera: Intrinsics::centered(focal_px, size.0, size.1),
        })
    }
}

/// Positions in the source picture, in its pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Coordinates {
    /// Columns.
    pub x: Plane<f64>,
    /// Rows.
    pub y: Plane<f64>,
}

/// The map of a channel, pixel by pixel, for a lens that passes [`Lens::check`]. Pixels without an inverse are not distorted.
#[must_use]
pub fn coordinates_reference(
    lens: &Lens,
    source: &SourcePicture,
    (width, height): (usize, usize),
    channel: usize,
) -> Coordinates {
    let places = Plane::from_fn(width, height, |x, y| {
        let air = lens.camera.ray(x as f64, y as f64);
        let ideal = lens.undistorted(air.x, air.y).unwrap_or((air.x, air.y));
        let (u, v) = lens.in_water(ideal, channel);
        let Intrinsics { focal_px, cx, cy } = source.camera;
        (cx + focal_px * u, cy + focal_px * v)
    });
    Coordinates {
        x: places.map(|place| place.0),
        y: places.map(|place| place.1),
    }
}

/// The maps of the channels: one if all are equal, else R, G, B. Equal to the reference apart from the last bits.
#[must_use]
pub fn coordinates(lens: &Lens, source: &SourcePicture, (width, height): (usize, usize)) -> Vec<Coordinates> {
    let channels = if lens.is_chromatic() { 3 } else { 1 };
    let maps = (0..channels).map(|_| Coordinates {
        x: Plane::filled(width, height, 0.0),
        y: Plane::filled(width, height, 0.0),
    });
    let mut maps: Vec<Coordinates> = maps.collect();
    let (mut xs, mut ys) = (vec![0.0; width], vec![0.0; width]);
    for y in 0..height {
        vectorized!(ideal_row(lens, y, &mut xs, &mut ys));
        for (channel, map) in maps.iter_mut().enumerate() {
            let (us, vs) = (map.x.row_mut(y), map.y.row_mut(y));
            vectorized!(water_row(lens, source, channel, (&xs, &ys), (&mut *us, &mut *vs)));
        }
    }
    maps
}

#[inline(always)]
fn ideal_row(lens: &Lens, row: usize, xs: &mut [f64], ys: &mut [f64]) {
    let Intrinsics { focal_px, cx, cy } = lens.camera;
    let yd = (row as f64 - cy) / focal_px;
    let is_ideal = lens.distortion == Distortion::default();
    for (block, (xs, ys)) in xs.chunks_mut(LANES).zip(ys.chunks_mut(LANES)).enumerate() {
        let xd: [f64; LANES] = std::array::from_fn(|lane| ((block * LANES + lane) as f64 - cx) / focal_px);
        let (mut x, mut y) = (xd, [yd; LANES]);
        if !is_ideal {
            // Lanes beyond the end of a row repeat its last pixel: the lens may fold there.
            let last = xs.len() - 1;
            let xd: [f64; LANES] = std::array::from_fn(|lane| xd[lane.min(last)]);
            x = xd;
            if !invert(&lens.distortion, &xd, yd, &mut x, &mut y) {
                for lane in 0..LANES {
                    (x[lane], y[lane]) = lens.undistorted(xd[lane], yd).unwrap_or((xd[lane], yd));
                }
            }
        }
        xs.copy_from_slice(&x[..xs.len()]);
        ys.copy_from_slice(&y[..ys.len()]);
    }
}

/// Fixed-point iteration until all lanes have converged; returns whether they have.
#[inline(always)]
fn invert(d: &Distortion, xd: &[f64; LANES], yd: f64, x: &mut [f64; LANES], y: &mut [f64; LANES]) -> bool {
    for _ in 0..MOST_STEPS {
        let mut far = 0.0f64;
        for lane in 0..LANES {
            let (dx, dy) = distorted(d, x[lane], y[lane]);
            let (step_x, step_y) = (dx - xd[lane], dy - yd);
            x[lane] -= step_x;
            y[lane] -= step_y;
            let step = imaging::simd::larger(step_x.abs(), step_y.abs());
            far = imaging::simd::larger(far, step);
        }
        if far < ARRIVED {
            return true;
        }
    }
    false
}

#[inline(always)]
fn water_row(
    lens: &Lens,
    source: &SourcePicture,
    channel: usize,
    (xs, ys): (&[f64], &[f64]),
    (us, vs): (&mut [f64], &mut [f64]),
) {
    let Intrinsics { focal_px, cx, cy } = source.camera;
    let index = match lens.refraction {
        PortRefraction::None => None,
        PortRefraction::Flat { index } => Some(index[channel]),
    };
    let outputs = us.iter_mut().zip(vs);
    for ((u, v), (&x, &y)) in outputs.zip(xs.iter().zip(ys)) {
        let factor = match index {
            None => 1.0,
            Some(index) => refracted(x * x + y * y, index),
        };
        *u = cx + focal_px * (x * factor);
        *v = cy + focal_px * (y * factor);
    }
}
