//! Converts between the renderer's buffers and NumPy arrays. Arrays take ownership of the buffer without a copy.

use imaging::codec::{NpyArray, NpyValues};
use imaging::{Channels, Plane, Raster, Samples};
use numpy::{Element, PyArray1, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArray, PyUntypedArrayMethods};
use optics::range::is_hole;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use renderer::Content;

/// An array of any type.
pub(crate) type Array<'py> = Bound<'py, PyAny>;

/// Wraps a buffer; its length is the product of the shape.
pub(crate) fn array<'py, T: Element>(
    py: Python<'py>,
    values: Vec<T>,
    shape: Vec<usize>,
) -> PyResult<Array<'py>> {
    Ok(PyArray1::from_vec(py, values).reshape(shape)?.into_any())
}

/// Shape (height, width) for a gray raster, (height, width, 3) for a color one; alpha is dropped.
pub(crate) fn of_raster<'py>(py: Python<'py>, raster: Raster) -> PyResult<Array<'py>> {
    let mut shape = vec![raster.height(), raster.width()];
    if raster.channels() == Channels::Rgb {
        shape.push(3);
    }
    match raster.into_samples() {
        Samples::U8(codes) => array(py, codes, shape),
        Samples::U16(codes) => array(py, codes, shape),
    }
}

/// The content of an artifact: `boxes` as JSON text, ranges with NaN for holes.
pub(crate) fn of_content<'py>(py: Python<'py>, content: Content<'static>) -> PyResult<Array<'py>> {
    match content {
        Content::Picture(picture) => of_raster(py, Raster::from(picture.into_owned())),
        Content::Codes(codes) => of_raster(py, codes),
        Content::Linear(layer) => {
            let (width, height) = layer.size();
            let [red, green, blue] = layer.planes().each_ref().map(Plane::data);
            let pixels = red.iter().zip(green).zip(blue);
            let samples = pixels.flat_map(|((r, g), b)| [*r, *g, *b]).collect();
            array(py, samples, vec![height, width, 3])
        }
        Content::Pair([first, second]) => {
            let (width, height) = first.size();
            let planes = first.planes().iter().chain(second.planes());
            let planes: Vec<&[f32]> = planes.map(Plane::data).collect();
            let samples = (0..width * height).flat_map(|i| planes.iter().map(move |plane| plane[i]));
            array(py, samples.collect(), vec![height, width, 6])
        }
        Content::Range(range) => {
            let (width, height) = range.size();
            let mut meters = range.into_owned().into_data();
            for sample in meters.iter_mut().filter(|sample| is_hole(**sample)) {
                *sample = f32::NAN;
            }
            array(py, meters, vec![height, width])
        }
        Content::Json(value) => Ok(value.to_string().into_pyobject(py)?.into_any()),
    }
}

/// An array from a file, in its stored type.
pub(crate) fn of_npy(py: Python<'_>, npy: NpyArray) -> PyResult<Array<'_>> {
    match npy.values {
        NpyValues::F32(values) => array(py, values, npy.shape),
        NpyValues::F64(values) => array(py, values, npy.shape),
        NpyValues::U8(values) => array(py, values, npy.shape),
        NpyValues::U16(values) => array(py, values, npy.shape),
        NpyValues::Wide(values) => array(py, values, npy.shape),
    }
}

/// The raster of a user's picture; `name` is that of the argument.
pub(crate) fn to_raster(name: &str, given: &Array<'_>) -> PyResult<Raster> {
    let untyped = given.cast::<PyUntypedArray>().map_err(|_| {
        let kind = given
            .get_type()
            .name()
            .map_or_else(|_| String::new(), |name| name.to_string());
        PyTypeError::new_err(format!("{name} is a {kind} but a NumPy array is needed"))
    })?;
    let shape = untyped.shape();
    let (height, width, channels) = match *shape {
        [height, width] => (height, width, Channels::Gray),
        [height, width, 3] => (height, width, Channels::Rgb),
        _ => {
            return Err(PyValueError::new_err(format!(
                "{name} has shape {shape:?} but (height, width) or (height, width, 3) is needed"
            )));
        }
    };
    let samples = if let Ok(codes) = given.extract::<PyReadonlyArrayDyn<'_, u8>>() {
        Samples::U8(codes.as_array().iter().copied().collect())
    } else if let Ok(codes) = given.extract::<PyReadonlyArrayDyn<'_, u16>>() {
        Samples::U16(codes.as_array().iter().copied().collect())
    } else {
        return Err(PyTypeError::new_err(format!(
            "{name} has dtype {} but uint8 or uint16 is needed: sRGB codes, not floats",
            untyped.dtype()
        )));
    };
    Raster::new(width, height, channels, samples, None)
        .map_err(|error| PyValueError::new_err(error.to_string()))
}
