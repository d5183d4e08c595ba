//! Errors as the exceptions of `fathom.errors`.

use pyo3::prelude::*;
use pyo3::types::PyTuple;
use spec::Invalid;

/// Every error of a description in one `InvalidJob`.
pub(crate) fn invalid_job(py: Python<'_>, invalid: &Invalid) -> PyErr {
    let errors = serde_json::to_string(invalid).unwrap_or_default();
    exception(py, "invalid_job", (errors,))
}

/// An `InvalidArgument`.
pub(crate) fn invalid_argument(py: Python<'_>, message: String) -> PyErr {
    exception(py, "InvalidArgument", (message,))
}

/// A `RenderError` of one frame.
pub(crate) fn render_error(py: Python<'_>, frame: u64, reason: impl ToString) -> PyErr {
    exception(py, "RenderError", (reason.to_string(), frame))
}

fn exception<'py>(
    py: Python<'py>,
    maker: &str,
    arguments: impl IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
) -> PyErr {
    py.import("fathom.errors")
        .and_then(|module| module.getattr(maker))
        .and_then(|maker| maker.call1(arguments.into_pyobject(py)?))
        .map_or_else(|error| error, PyErr::from_value)
}
