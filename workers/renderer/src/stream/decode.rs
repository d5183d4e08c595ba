//! Planes of linear light and range from the arrays of a frame.

use imaging::geometry::Intrinsics;
use imaging::transfer::decode_u8;
use imaging::{Plane, Rgb};
use spec::RangeKind;

use super::error::InputError;
use super::input::{DepthSamples, PictureSamples, StreamDepth, StreamInput, StreamPicture};

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
        for (band, position) in bands.iter_mut().zip(picture.channels.positions()) {
            band.clear();
            match picture.samples {
                PictureSamples::Srgb(codes) => {
                    let light = &self.light;
                    pick(codes, picture.channels.count(), position, band, |code| {
                        light[usize::from(code)]
                    });
                }
                PictureSamples::Linear(samples) => {
                    pick(samples, picture.channels.count(), position, band, |sample| sample);
                }
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

/// Appends the sample at this position of each pixel.
fn pick<T: Copy>(
    samples: &[T],
    count: usize,
    position: usize,
    band: &mut Vec<f32>,
    convert: impl Fn(T) -> f32,
) {
    match count {
        1 => band.extend(samples.iter().map(|&sample| convert(sample))),
        3 => band.extend(
            samples
                .as_chunks::<3>()
                .0
                .iter()
                .map(|pixel| convert(pixel[position])),
        ),
        _ => band.extend(
            samples
                .as_chunks::<4>()
                .0
                .iter()
                .map(|pixel| convert(pixel[position])),
        ),
    }
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
    use super::super::input::ChannelOrder;
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
