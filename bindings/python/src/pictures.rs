//! Enhancement, measurement and files of a user's pictures.

use std::borrow::Cow;

use imaging::codec;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quality::MetricId;
use spec::Enhancement;

use crate::arrays::{Array, of_npy, of_raster, to_raster};
use crate::errors::invalid_job;

fn refused(error: impl ToString) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// The result and its warnings; `method` as [`Enhancement::parse`] reads it.
#[pyfunction]
pub(crate) fn enhance<'py>(
    py: Python<'py>,
    image: &Array<'py>,
    method: &str,
) -> PyResult<(Array<'py>, Vec<String>)> {
    let picture = to_raster("image", image)?;
    let enhancement = Enhancement::parse(method).map_err(|invalid| invalid_job(py, &invalid))?;
    let enhanced = py.detach(|| ::enhance::enhance(&enhancement, &picture, &[]));
    let enhanced = enhanced.map_err(refused)?;
    let warnings = enhanced.warnings.iter().map(ToString::to_string).collect();
    Ok((of_raster(py, enhanced.picture)?, warnings))
}

/// The metrics and their values, in the order of the request.
#[pyfunction]
pub(crate) fn measure(
    py: Python<'_>,
    image: &Array<'_>,
    metrics: Vec<String>,
    clean: Option<&Array<'_>>,
) -> PyResult<Vec<(String, f64)>> {
    let picture = to_raster("image", image)?.to_rgb8();
    let clean = clean.map(|clean| to_raster("clean", clean)).transpose()?;
    let clean = clean.map(|clean| clean.to_rgb8());
    let metric = |name: &String| {
        MetricId::parse(name).ok_or_else(|| {
            let known: Vec<String> = MetricId::all().map(|id| id.to_string()).collect();
            refused(format!(
                "metric `{name}` does not exist; there is {}",
                known.join(", ")
            ))
        })
    };
    let ids = metrics.iter().map(metric).collect::<PyResult<Vec<_>>>()?;
    let values = py
        .detach(|| quality::measure(&picture, clean.as_ref(), &ids))
        .map_err(refused)?;
    Ok(metrics
        .into_iter()
        .zip(values.into_iter().map(|(_, value)| value))
        .collect())
}

/// The array of a PNG, JPEG, WebP or NPY file.
#[pyfunction]
pub(crate) fn decode<'py>(py: Python<'py>, file: Cow<'_, [u8]>) -> PyResult<Array<'py>> {
    if file.starts_with(b"\x93NUMPY") {
        let npy = py.detach(|| codec::decode_npy(&file)).map_err(refused)?;
        return of_npy(py, npy);
    }
    let raster = py.detach(|| codec::decode_picture(&file)).map_err(refused)?;
    of_raster(py, raster)
}

/// The PNG file of an array, byte for byte as stored by a service.
#[pyfunction]
pub(crate) fn encode_png(py: Python<'_>, image: &Array<'_>) -> PyResult<Vec<u8>> {
    let raster = to_raster("image", image)?;
    py.detach(|| codec::encode_png(&raster)).map_err(refused)
}
