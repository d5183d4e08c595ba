//! Arrays of a stream from files. Integers of distances are millimeters, floats meters.

use imaging::codec::{FilePlane, Radiance, decode_mask, decode_plane, decode_radiance};
use imaging::transfer::{Transfer, decode_raster};
use imaging::{Plane, Rgb, Samples};
use renderer::{
    ChannelOrder, DepthSamples, PictureSamples, StreamDepth, StreamInput, StreamMask, StreamPicture,
};
use spec::RangeKind;

use super::protocol::{InputRole, PictureRequest, WrongPart};

/// Meters of an integer that 16 bits cannot hold.
const MILLIMETER_M: f64 = 0.001;

/// The decoded files of a request.
pub(super) struct Arrays {
    size: (usize, usize),
    picture: PictureArray,
    depth: Option<(RangeKind, FilePlane)>,
    instances: Option<Plane<u16>>,
}

enum PictureArray {
    Srgb(Vec<u8>),
    Linear(Vec<f32>),
}

impl Arrays {
    /// Decodes all files; the errors of all are reported together.
    pub(super) fn decode(files: &[(InputRole, Vec<u8>)]) -> Result<Self, Vec<WrongPart>> {
        let mut wrong = Vec::new();
        let (mut picture, mut depth, mut instances) = (None, None, None);
        for (role, bytes) in files {
            let decoded = match role {
                InputRole::Rgb => decode_radiance(bytes).map(|radiance| picture = Some(radiance)),
                InputRole::Range => decode_plane(bytes).map(|plane| depth = Some((RangeKind::Range, plane))),
                InputRole::ZDepth => {
                    decode_plane(bytes).map(|plane| depth = Some((RangeKind::ZDepth, plane)))
                }
                InputRole::Instances => decode_mask(bytes).map(|mask| instances = Some(mask)),
            };
            if let Err(error) = decoded {
                let name = role.name().to_owned();
                let message = format!("`{name}`: {error}");
                wrong.push(WrongPart { name, message });
            }
        }
        match picture {
            Some(picture) if wrong.is_empty() => {
                let (size, picture) = interleave(picture);
                Ok(Self {
                    size,
                    picture,
                    depth: depth.map(|(kind, plane)| (kind, narrow(plane))),
                    instances,
                })
            }
            _ => Err(wrong),
        }
    }

    /// The input of a stream.
    pub(super) fn describe(&self, request: &PictureRequest) -> StreamInput<'_> {
        let samples = match &self.picture {
            PictureArray::Srgb(codes) => PictureSamples::Srgb(codes),
            PictureArray::Linear(light) => PictureSamples::Linear(light),
        };
        let depth = self.depth.as_ref().map(|(kind, plane)| {
            let (size, samples) = match plane {
                FilePlane::Codes(codes) => (codes.size(), DepthSamples::Millimeters(codes.data())),
                FilePlane::Floats(meters) => (meters.size(), DepthSamples::Meters(meters.data())),
                // `narrow` leaves none.
                FilePlane::Wide(wide) => (wide.size(), DepthSamples::Meters(&[])),
            };
            StreamDepth {
                kind: *kind,
                size,
                samples,
            }
        });
        StreamInput {
            picture: StreamPicture {
                size: self.size,
                channels: ChannelOrder::Rgb,
                samples,
            },
            depth,
            instances: self.instances.as_ref().map(|mask| StreamMask {
                size: mask.size(),
                numbers: mask.data(),
            }),
            camera: request.camera,
            stamp_ns: Some(request.stamp_ns),
            pose: request.pose,
        }
    }
}

/// Samples pixel by pixel: 8-bit codes as they are, others as linear light.
fn interleave(picture: Radiance) -> ((usize, usize), PictureArray) {
    let light = match picture {
        Radiance::Encoded(raster) => match raster.samples() {
            Samples::U8(_) => {
                let size = (raster.width(), raster.height());
                return (size, PictureArray::Srgb(raster.to_rgb8().data().to_vec()));
            }
            Samples::U16(_) => decode_raster(&raster, Transfer::Srgb),
        },
        Radiance::Linear(light) => light,
    };
    (light.size(), PictureArray::Linear(interleave_light(&light)))
}

fn interleave_light(light: &Rgb<f32>) -> Vec<f32> {
    let [red, green, blue] = light.planes().each_ref().map(Plane::data);
    let pixels = red.iter().zip(green).zip(blue);
    pixels.flat_map(|((&r, &g), &b)| [r, g, b]).collect()
}

/// Wide integers as meters.
fn narrow(plane: FilePlane) -> FilePlane {
    match plane {
        FilePlane::Wide(codes) => {
            FilePlane::Floats(codes.map(|&code| (f64::from(code) * MILLIMETER_M) as f32))
        }
        plane => plane,
    }
}

#[cfg(test)]
mod tests {
    use imaging::codec::{encode_npy_plane, encode_png};

    use super::*;

    #[test]
    fn files_become_arrays_and_every_wrong_file_is_named() {
        let picture = encode_png(&imaging::Rgb8::from_fn(3, 2, |x, y| [x as u8, y as u8, 9]).into()).unwrap();
        let meters = encode_npy_plane(&Plane::filled(3, 2, 1.5f32));
        let files = [
            (InputRole::Rgb, picture.clone()),
            (InputRole::ZDepth, meters),
            (
                InputRole::Instances,
                encode_png(&Plane::filled(3, 2, 7u16).into()).unwrap(),
            ),
        ];
        let arrays = Arrays::decode(&files).map_err(|wrong| wrong.len()).unwrap();
        assert_eq!(arrays.size, (3, 2));
        assert!(matches!(&arrays.picture, PictureArray::Srgb(codes) if codes[3..6] == [1, 0, 9]));
        assert!(matches!(
            &arrays.depth,
            Some((RangeKind::ZDepth, FilePlane::Floats(_)))
        ));
        let broken = [
            (InputRole::Rgb, b"no picture".to_vec()),
            (InputRole::Range, picture),
            (InputRole::Instances, Vec::new()),
        ];
        let wrong = Arrays::decode(&broken).err().unwrap_or_default();
        let names: Vec<&str> = wrong.iter().map(|part| part.name.as_str()).collect();
        assert_eq!(names, ["rgb", "range", "instances"]);
    }
}
