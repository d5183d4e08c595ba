//! The arrays of a call.

use std::borrow::Cow;

use numpy::{Element, PyReadonlyArrayDyn, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use renderer::{ChannelOrder, DepthSamples, PictureSamples, StreamDepth, StreamPicture};
use spec::RangeKind;

use crate::arrays::Array;

/// An array in the order of its indices: borrowed if its memory has this order.
fn in_order<'a, T: Element + Copy>(array: &'a PyReadonlyArrayDyn<'_, T>) -> Cow<'a, [T]> {
    // A slice in the order of columns is one, too.
    match array.as_slice() {
        Ok(samples) if array.is_c_contiguous() => Cow::Borrowed(samples),
        _ => Cow::Owned(array.as_array().iter().copied().collect()),
    }
}

/// The shape of an array of an argument.
fn read_shape(name: &str, given: &Array<'_>) -> Result<Vec<usize>, String> {
    match given.cast::<PyUntypedArray>() {
        Ok(array) => Ok(array.shape().to_vec()),
        Err(_) => {
            let kind = given.get_type().name();
            let kind = kind.map_or_else(|_| String::new(), |name| name.to_string());
            Err(format!("`{name}` is a {kind}; must be a NumPy array"))
        }
    }
}

fn describe_type(given: &Array<'_>) -> String {
    let array = given.cast::<PyUntypedArray>();
    array.map_or_else(|_| String::new(), |array| array.dtype().to_string())
}

/// Sizes as Python writes them.
fn describe_shape(shape: &[usize]) -> String {
    let sides: Vec<String> = shape.iter().map(ToString::to_string).collect();
    let comma = if sides.len() == 1 { "," } else { "" };
    format!("({}{comma})", sides.join(", "))
}

/// The picture of a call.
pub(super) struct PictureArray<'py> {
    size: (usize, usize),
    held: PictureHeld<'py>,
}

enum PictureHeld<'py> {
    Srgb(PyReadonlyArrayDyn<'py, u8>),
    Linear(PyReadonlyArrayDyn<'py, f32>),
}

pub(super) enum PictureCow<'a> {
    Srgb(Cow<'a, [u8]>),
    Linear(Cow<'a, [f32]>),
}

impl PictureCow<'_> {
    fn borrow(&self) -> PictureSamples<'_> {
        match self {
            Self::Srgb(samples) => PictureSamples::Srgb(samples),
            Self::Linear(samples) => PictureSamples::Linear(samples),
        }
    }
}

impl<'py> PictureArray<'py> {
    pub(super) fn read(given: &Array<'py>, channels: ChannelOrder) -> Result<Self, String> {
        let shape = read_shape("rgb", given)?;
        let size = match *shape {
            [height, width] if channels == ChannelOrder::Mono => (width, height),
            [height, width, count] if count == channels.count() => (width, height),
            _ => {
                let needed = match channels {
                    ChannelOrder::Mono => "(height, width)".to_owned(),
                    _ => format!("(height, width, {})", channels.count()),
                };
                return Err(format!(
                    "`rgb` has the shape {}; must be {needed} with `channels` \"{}\"",
                    describe_shape(&shape),
                    channels.name()
                ));
            }
        };
        let held = if let Ok(codes) = given.extract() {
            PictureHeld::Srgb(codes)
        } else if let Ok(light) = given.extract() {
            PictureHeld::Linear(light)
        } else {
            return Err(format!(
                "`rgb` has the dtype {}; must be uint8 (sRGB codes) or float32 (linear light)",
                describe_type(given)
            ));
        };
        Ok(Self { size, held })
    }

    /// The picture with its samples.
    pub(super) fn describe<'a>(
        &self,
        channels: ChannelOrder,
        samples: &'a PictureCow<'_>,
    ) -> StreamPicture<'a> {
        StreamPicture {
            size: self.size,
            channels,
            samples: samples.borrow(),
        }
    }

    pub(super) fn samples(&self) -> PictureCow<'_> {
        match &self.held {
            PictureHeld::Srgb(codes) => PictureCow::Srgb(in_order(codes)),
            PictureHeld::Linear(light) => PictureCow::Linear(in_order(light)),
        }
    }
}

/// The distances of a call.
pub(super) struct DepthArray<'py> {
    kind: RangeKind,
    size: (usize, usize),
    held: DepthHeld<'py>,
}

enum DepthHeld<'py> {
    Meters(PyReadonlyArrayDyn<'py, f32>),
    Millimeters(PyReadonlyArrayDyn<'py, u16>),
}

pub(super) enum DepthCow<'a> {
    Meters(Cow<'a, [f32]>),
    Millimeters(Cow<'a, [u16]>),
}

impl DepthCow<'_> {
    fn borrow(&self) -> DepthSamples<'_> {
        match self {
            Self::Meters(samples) => DepthSamples::Meters(samples),
            Self::Millimeters(samples) => DepthSamples::Millimeters(samples),
        }
    }
}

impl<'py> DepthArray<'py> {
    pub(super) fn read(name: &str, given: &Array<'py>) -> Result<Self, String> {
        let shape = read_shape(name, given)?;
        let ([height, width] | [height, width, 1]) = *shape else {
            let shape = describe_shape(&shape);
            return Err(format!("`{name}` has the shape {shape}; must be (height, width)"));
        };
        let held = if let Ok(meters) = given.extract() {
            DepthHeld::Meters(meters)
        } else if let Ok(codes) = given.extract() {
            DepthHeld::Millimeters(codes)
        } else {
            return Err(format!(
                "`{name}` has the dtype {}; must be float32 (meters) or uint16 (millimeters)",
                describe_type(given)
            ));
        };
        Ok(Self {
            kind: if name == "z_depth" {
                RangeKind::ZDepth
            } else {
                RangeKind::Range
            },
            size: (width, height),
            held,
        })
    }

    /// The distances with their samples.
    pub(super) fn describe<'a>(&self, samples: &'a DepthCow<'_>) -> StreamDepth<'a> {
        StreamDepth {
            kind: self.kind,
            size: self.size,
            samples: samples.borrow(),
        }
    }

    pub(super) fn samples(&self) -> DepthCow<'_> {
        match &self.held {
            DepthHeld::Meters(meters) => DepthCow::Meters(in_order(meters)),
            DepthHeld::Millimeters(codes) => DepthCow::Millimeters(in_order(codes)),
        }
    }
}
