//! All names allowed in descriptions and labels.

use std::collections::BTreeMap;

use pyo3::prelude::*;
use scenes::categories::{CATEGORIES, FINDINGS};
use spec::schema::Names;

use crate::studio::Studio;

/// Names by kind; categories in the order of their numbers, findings in that of their bits.
#[pyfunction]
pub(crate) fn names() -> PyResult<BTreeMap<&'static str, Vec<String>>> {
    let known = renderer::vocabulary(&Studio::open(None, None)?.engine.library(), true);
    let kinds = known.listed(Names::Artifact);
    let categories = CATEGORIES.iter().map(|(_, name)| (*name).to_owned());
    let findings = FINDINGS.iter().map(|(_, name)| (*name).to_owned());
    Ok(BTreeMap::from([
        ("artifacts", kinds),
        ("categories", categories.collect()),
        ("enhancements", known.listed(Names::Method)),
        ("families", known.families),
        ("findings", findings.collect()),
        ("metrics", known.metrics),
        ("sites", spec::SITES.map(|site| site.name.to_owned()).to_vec()),
        ("styles", known.styles),
        ("waters", known.presets),
    ]))
}
