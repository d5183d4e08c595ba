//! The arrays of a call.

use numpy::{Element, PyReadonlyArrayDyn, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use renderer::{ChannelOrder, DepthSamples, PictureSamples, StreamDepth, StreamPicture};
use spec::RangeKind;

use crate::arrays::Array;

/// The samples of an array in the order of its indices: shared with Python if its memory has this order.
enum OrderedSamples<'py, T: Element + Copy> {
    Shared(PyReadonlyArrayDyn<'py, T>),
    Copied(Vec<T>),
}

impl<'py, T: Element + Copy> OrderedSamples<'py, T> {
    fn new(array: PyReadonlyArrayDyn<'py, T>) -> Self {
        // Arrays in Fortran order have a slice as well.
        let is_in_order = array.is_c_contiguous() && array.as_slice().is_ok();
        if is_in_order {
            Self::Shared(array)
        } else {
            Self::Copied(array.as_array().iter().copied().collect())
        }
    }

    fn as_slice(&self) -> &[T] {
        match self {
            Self::Shared(array) => array.as_slice().expect("its order was checked"),
            Self::Copied(samples) => samples,
        }
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
    Srgb(OrderedSamples<'py, u8>),
    Linear(OrderedSamples<'py, f32>),
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
            PictureHeld::Srgb(OrderedSamples::new(codes))
        } else if let Ok(light) = given.extract() {
            PictureHeld::Linear(OrderedSamples::new(light))
        } else {
            return Err(format!(
                "`rgb` has the dtype {}; must be uint8 (sRGB codes) or float32 (linear light)",
                describe_type(given)
            ));
        };
        Ok(Self { size, held })
    }

    pub(super) fn describe(&self, channels: ChannelOrder) -> StreamPicture<'_> {
        StreamPicture {
            size: self.size,
            channels,
            samples: match &self.held {
                PictureHeld::Srgb(codes) => PictureSamples::Srgb(codes.as_slice()),
                PictureHeld::Linear(light) => PictureSamples::Linear(light.as_slice()),
            },
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
    Meters(OrderedSamples<'py, f32>),
    Millimeters(OrderedSamples<'py, u16>),
}

impl<'py> DepthArray<'py> {
    pub(super) fn read(name: &str, given: &Array<'py>) -> Result<Self, String> {
        let shape = read_shape(name, given)?;
        let ([height, width] | [height, width, 1]) = *shape else {
            let shape = describe_shape(&shape);
            return Err(format!("`{name}` has the shape {shape}; must be (height, width)"));
        };
        let held = if let Ok(meters) = given.extract() {
            DepthHeld::Meters(OrderedSamples::new(meters))
        } else if let Ok(codes) = given.extract() {
            DepthHeld::Millimeters(OrderedSamples::new(codes))
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

    pub(super) fn describe(&self) -> StreamDepth<'_> {
        StreamDepth {
            kind: self.kind,
            size: self.size,
            samples: match &self.held {
                DepthHeld::Meters(meters) => DepthSamples::Meters(meters.as_slice()),
                DepthHeld::Millimeters(codes) => DepthSamples::Millimeters(codes.as_slice()),
            },
        }
    }
}
