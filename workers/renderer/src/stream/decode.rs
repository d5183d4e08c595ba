//! Planes of linear light and range from the arrays of a frame.

use imaging::geometry::Intrinsics;
use imaging::transfer::decode_u8;
use imaging::{Plane, Rgb, Rgb8};
use spec::RangeKind;

use super::error::InputError;
use super::input::{ChannelOrder, DepthSamples, PictureSamples, StreamDepth, StreamInput, StreamPicture};

/// Meters of a code of [`DepthSamples::Millimeters`].
const MILLIMETER_M: f64 = 0.001;

/// Decodes frames into buffers of earlier ones.
pub(super) struct Decoder {
    /// Linear light of each code.
    light: [f32; 256],
    bands: [Vec<f32>; 3],
    range: Vec<f32>,
    rays: Option<RayLengths>,
}

/// [`Intrinsics::ray_length`] of each pixel.
struct RayLengths {
    camera: Intrinsics,
    size: (usize, usize),
    factors: Vec<f64>,
}

impl Default for Decoder {
    fn default() -> Self {
        Self {
            light: std::array::from_fn(|code| decode_u8(code as u8)),
            bands: Default::default(),
            range: Vec::new(),
            rays: None,
        }
    }
}

impl Decoder {
    /// The scene of a checked input, without its camera.
    pub(super) fn decode(
        &mut self,
        input: &StreamInput<'_>,
        camera: &Intrinsics,
    ) -> Result<scenes::Scene, InputError> {
        Ok(scenes::Scene {
            radiance: self.decode_picture(&input.picture)?,
            range: input.depth.as_ref().map(|depth| self.decode_depth(depth, camera)),
            instances: input.instances.as_ref().map(|mask| {
                let (width, height) = mask.size;
                Plane::new(width, height, mask.numbers.to_vec()).expect("the count was checked")
            }),
            intrinsics: None,
            normals: None,
        })
    }

    /// Keeps the buffers of a rendered scene.
    pub(super) fn recycle(&mut self, scene: scenes::Scene) {
        self.bands = scene.radiance.into_planes().map(Plane::into_data);
        self.range = scene.range.map(Plane::into_data).unwrap_or_default();
    }

    fn decode_picture(&mut self, picture: &StreamPicture<'_>) -> Result<Rgb<f32>, InputError> {
        if let PictureSamples::Linear(samples) = picture.samples
            && let Some(error) = find_not_finite(picture, samples)
        {
            return Err(error);
        }
        let (width, height) = picture.size;
        let mut bands = std::mem::take(&mut self.bands);
        bands.iter_mut().for_each(|band| band.resize(width * height, 0.0));
        match picture.samples {
            PictureSamples::Srgb(codes) => {
                let light = &self.light;
                separate(codes, picture.channels, &mut bands, |code| {
                    light[usize::from(code)]
                });
            }
            PictureSamples::Linear(samples) => {
                separate(samples, picture.channels, &mut bands, |sample| sample)
            }
        }
        let planes = bands.map(|band| Plane::new(width, height, band).expect("the count was checked"));
        Ok(Rgb::new(planes).expect("planes of one size"))
    }

    fn decode_depth(&mut self, depth: &StreamDepth<'_>, camera: &Intrinsics) -> Plane<f32> {
        let mut range = std::mem::take(&mut self.range);
        range.clear();
        match depth.samples {
            DepthSamples::Meters(meters) => range.extend(meters.iter().map(|&v| read_meters(v))),
            DepthSamples::Millimeters(codes) => range.extend(codes.iter().map(|&code| match code {
                0 => f32::NAN,
                code => (f64::from(code) * MILLIMETER_M) as f32,
            })),
        }
        if depth.kind == RangeKind::ZDepth {
            let rays = self.find_rays(camera, depth.size);
            for (meters, factor) in range.iter_mut().zip(&rays.factors) {
                *meters = (f64::from(*meters) * factor) as f32;
            }
        }
        let (width, height) = depth.size;
        Plane::new(width, height, range).expect("the count was checked")
    }

    /// The rays of a camera; those of the last frame if it had the same one.
    fn find_rays(&mut self, camera: &Intrinsics, size: (usize, usize)) -> &RayLengths {
        let kept = self.rays.take();
        let kept = kept.filter(|rays| (&rays.camera, rays.size) == (camera, size));
        self.rays
            .insert(kept.unwrap_or_else(|| RayLengths::new(*camera, size)))
    }
}

impl RayLengths {
    fn new(camera: Intrinsics, (width, height): (usize, usize)) -> Self {
        let mut factors = Vec::with_capacity(width * height);
        for y in 0..height {
            factors.extend((0..width).map(|x| camera.ray_length(x, y)));
        }
        Self {
            camera,
            size: (width, height),
            factors,
        }
    }
}

fn read_meters(meters: f32) -> f32 {
    if meters.is_finite() { meters } else { f32::NAN }
}

/// Converts red, green and blue of each pixel in one pass.
fn separate<T: Copy>(
    samples: &[T],
    channels: ChannelOrder,
    bands: &mut [Vec<f32>; 3],
    convert: impl Fn(T) -> f32,
) {
    let positions = channels.positions();
    match channels.count() {
        1 => separate_pixels::<T, 1>(samples, positions, bands, convert),
        3 => separate_pixels::<T, 3>(samples, positions, bands, convert),
        _ => separate_pixels::<T, 4>(samples, positions, bands, convert),
    }
}

fn separate_pixels<T: Copy, const COUNT: usize>(
    samples: &[T],
    [red, green, blue]: [usize; 3],
    [reds, greens, blues]: &mut [Vec<f32>; 3],
    convert: impl Fn(T) -> f32,
) {
    let pixels = samples.as_chunks::<COUNT>().0.iter();
    for (((pixel, r), g), b) in pixels.zip(reds).zip(greens).zip(blues) {
        *r = convert(pixel[red]);
        *g = convert(pixel[green]);
        *b = convert(pixel[blue]);
    }
}

/// The codes of an 8-bit picture in color; `None` for other pictures.
pub(super) fn read_codes(picture: &StreamPicture<'_>) -> Option<Rgb8> {
    let PictureSamples::Srgb(codes) = picture.samples else {
        return None;
    };
    let (width, height) = picture.size;
    let data = match picture.channels {
        ChannelOrder::Mono => return None,
        ChannelOrder::Rgb => codes.to_vec(),
        ChannelOrder::Bgr => {
            let pixels = codes.as_chunks::<3>().0.iter();
            pixels.flat_map(|&[b, g, r]| [r, g, b]).collect()
        }
        ChannelOrder::Rgba => {
            let pixels = codes.as_chunks::<4>().0.iter();
            pixels.flat_map(|&[r, g, b, _]| [r, g, b]).collect()
        }
        ChannelOrder::Bgra => {
            let pixels = codes.as_chunks::<4>().0.iter();
            pixels.flat_map(|&[b, g, r, _]| [r, g, b]).collect()
        }
    };
    Rgb8::new(width, height, data).ok()
}

/// The first sample of a color channel that is not finite: forward scatter would spread it over the picture.
fn find_not_finite(picture: &StreamPicture<'_>, samples: &[f32]) -> Option<InputError> {
    let count = picture.channels.count();
    let colors = count.min(3);
    let found = samples.chunks(count).enumerate().find_map(|(pixel, samples)| {
        let wrong = samples[..colors].iter().find(|sample| !sample.is_finite())?;
        Some((pixel, *wrong))
    });
    found.map(|(pixel, value)| {
        let (width, _) = picture.size;
        let (x, y) = (pixel % width, pixel / width);
        InputError::new("rgb", format!("is {value} at pixel ({x}, {y}); must be finite"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use imaging::geometry::range_from_z_depth;

    fn decode(samples: PictureSamples<'_>, channels: ChannelOrder) -> Rgb<f32> {
        let picture = StreamPicture {
            size: (2, 1),
            channels,
            samples,
        };
        Decoder::default().decode_picture(&picture).unwrap()
    }

    #[test]
    fn every_order_of_channels_gives_red_green_and_blue() {
        let expected = decode(PictureSamples::Srgb(&[10, 20, 30, 40, 50, 60]), ChannelOrder::Rgb);
        let orders: [(ChannelOrder, &[u8]); 3] = [
            (ChannelOrder::Bgr, &[30, 20, 10, 60, 50, 40]),
            (ChannelOrder::Rgba, &[10, 20, 30, 0, 40, 50, 60, 255]),
            (ChannelOrder::Bgra, &[30, 20, 10, 9, 60, 50, 40, 9]),
        ];
        for (order, codes) in orders {
            assert_eq!(decode(PictureSamples::Srgb(codes), order), expected, "{order:?}");
        }
        let mono = decode(PictureSamples::Srgb(&[10, 200]), ChannelOrder::Mono);
        assert_eq!(mono.pixel(1, 0), [decode_u8(200); 3]);
    }

    #[test]
    fn z_depth_becomes_the_same_range_as_that_of_a_file() {
        let camera = Intrinsics {
            focal_px: 3.0,
            cx: 1.2,
            cy: 0.4,
        };
        let meters: Vec<f32> = (0..12).map(|i| 0.3 + 0.7 * i as f32).collect();
        let depth = StreamDepth {
            kind: RangeKind::ZDepth,
            size: (4, 3),
            samples: DepthSamples::Meters(&meters),
        };
        let plane = Plane::new(4, 3, meters.clone()).unwrap();
        let mut decoder = Decoder::default();
        for _ in 0..2 {
            assert_eq!(
                decoder.decode_depth(&depth, &camera),
                range_from_z_depth(&plane, &camera)
            );
        }
        let other = Intrinsics { cx: 0.0, ..camera };
        assert_eq!(
            decoder.decode_depth(&depth, &other),
            range_from_z_depth(&plane, &other)
        );
    }
}
