//! Enhancement, measurement and files of a user's pictures.

use std::borrow::Cow;
use std::path::PathBuf;

use imaging::{Rgb8, codec};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quality::MetricId;
use renderer::PictureNetworks;
use spec::schema::Names;
use spec::{Enhancement, METRIC_NETWORK};

use crate::arrays::{Array, of_npy, of_raster, to_raster};
use crate::errors::invalid_job;
use crate::studio::Studio;

fn refused(error: impl ToString) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// The result and its warnings; `method` as [`Enhancement::parse_with`] reads it. Networks are those of the folder `styles`.
#[pyfunction]
pub(crate) fn enhance<'py>(
    py: Python<'py>,
    image: &Array<'py>,
    method: &str,
    styles: Option<PathBuf>,
    onnxruntime: Option<PathBuf>,
) -> PyResult<(Array<'py>, Vec<String>)> {
    let picture = to_raster("image", image)?;
    let studio = Studio::open_recent(styles.as_deref(), onnxruntime.as_deref())?;
    let vocabulary = renderer::vocabulary(&studio.engine.library(), true);
    let enhancement =
        Enhancement::parse_with(method, &vocabulary).map_err(|invalid| invalid_job(py, &invalid))?;
    let mut networks = studio.take_networks();
    let (networks, enhanced) = py.detach(|| {
        let enhanced = networks.enhance(&enhancement, &picture, &[]);
        (networks, enhanced)
    });
    studio.keep_networks(networks);
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
    styles: Option<PathBuf>,
    onnxruntime: Option<PathBuf>,
) -> PyResult<Vec<(String, f64)>> {
    let picture = to_raster("image", image)?.to_rgb8();
    let clean = clean.map(|clean| to_raster("clean", clean)).transpose()?;
    let clean = clean.map(|clean| clean.to_rgb8());
    let studio = Studio::open_recent(styles.as_deref(), onnxruntime.as_deref())?;
    let known = renderer::vocabulary(&studio.engine.library(), true).listed(Names::Metric);
    let mut ids = Vec::new();
    for name in &metrics {
        match MetricId::parse(name) {
            Some(id) => ids.push(id),
            None if name.starts_with(METRIC_NETWORK) && known.contains(name) => {}
            None => {
                let known = known.join(", ");
                return Err(refused(format!(
                    "metric `{name}` does not exist; there is {known}"
                )));
            }
        }
    }
    let mut networks = studio.take_networks();
    let (networks, values) = py.detach(|| {
        let values = measure_all(&picture, clean.as_ref(), &ids, metrics, &mut networks);
        (networks, values)
    });
    studio.keep_networks(networks);
    values.map_err(PyValueError::new_err)
}

/// The values of the metrics with these names, of which `ids` are those of the registry.
fn measure_all(
    picture: &Rgb8,
    clean: Option<&Rgb8>,
    ids: &[MetricId],
    names: Vec<String>,
    networks: &mut PictureNetworks,
) -> Result<Vec<(String, f64)>, String> {
    let registered = quality::measure(picture, clean, ids).map_err(|error| error.to_string())?;
    let mut registered = registered.into_iter().map(|(_, value)| value);
    let mut all = Vec::with_capacity(names.len());
    for name in names {
        let value = match name.strip_prefix(METRIC_NETWORK) {
            Some(network) => networks
                .measure(network, picture)
                .map_err(|error| error.to_string())?,
            None => registered.next().ok_or("a metric has no value")?,
        };
        all.push((name, value));
    }
    Ok(all)
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
