//! The queryable columns of an image: one table from which the schema, the insert and the filter language all follow.

use serde_json::Value;

use crate::filter::{Bind, Column, Kind};
use crate::joins::Join;

/// The water by name: that of a preset, or of a water of the user's own, whose numbers the record holds.
const WATER: &str = "water.optics";
const OWN_WATER: &str = "/parameters/water/optics/name";

/// (name in questions, where it stands in the record, kind). An array stands for its length.
const PARAMETERS: &[(&str, &str, Kind)] = &[
    ("scene.kind", "/parameters/scene/kind", Kind::Text),
    ("scene.family", "/parameters/scene/family", Kind::Text),
    ("scene.seed", "/parameters/scene/seed", Kind::Number),
    ("scene.id", "/parameters/scene/id", Kind::Text),
    ("camera.width", "/parameters/camera/width", Kind::Number),
    ("camera.height", "/parameters/camera/height", Kind::Number),
    ("camera.hfov_deg", "/parameters/camera/hfov_deg", Kind::Number),
    (WATER, "/parameters/water/optics/preset", Kind::Text),
    ("water.range_scale", "/parameters/water/range_scale", Kind::Number),
    ("water.depth_m", "/parameters/water/depth_m", Kind::Number),
    ("water.ambient", "/parameters/water/ambient", Kind::Text),
    ("water.style", "/parameters/water/style", Kind::Text),
    (
        "snow.density_per_m3",
        "/parameters/water/snow/density_per_m3",
        Kind::Number,
    ),
    ("snow.radius_m", "/parameters/water/snow/radius_m", Kind::Number),
    (
        "snow.radius_spread",
        "/parameters/water/snow/radius_spread",
        Kind::Number,
    ),
    ("snow.near_m", "/parameters/water/snow/near_m", Kind::Number),
    ("snow.far_m", "/parameters/water/snow/far_m", Kind::Number),
    ("snow.albedo.r", "/parameters/water/snow/albedo/0", Kind::Number),
    ("snow.albedo.g", "/parameters/water/snow/albedo/1", Kind::Number),
    ("snow.albedo.b", "/parameters/water/snow/albedo/2", Kind::Number),
    ("snow.particles", "/optics/snow/particles", Kind::Number),
    ("snow.cover", "/optics/snow/cover", Kind::Number),
    (
        "turbidity.contrast",
        "/parameters/water/turbidity/contrast",
        Kind::Number,
    ),
    (
        "turbidity.scale_m",
        "/parameters/water/turbidity/scale_m",
        Kind::Number,
    ),
    ("turbidity.mean", "/optics/turbidity/mean", Kind::Number),
    ("turbidity.least", "/optics/turbidity/least", Kind::Number),
    ("turbidity.most", "/optics/turbidity/most", Kind::Number),
    ("alpha", "/parameters/alpha", Kind::Number),
    ("lights.count", "/parameters/lights", Kind::Number),
    (
        "fidelity.tolerance",
        "/parameters/fidelity/tolerance",
        Kind::Number,
    ),
    ("fidelity.terms", "/parameters/fidelity/terms", Kind::Number),
    ("fidelity.variant", "/parameters/fidelity/variant", Kind::Text),
    ("seed", "/parameters/seed", Kind::Number),
    ("absorption_per_m.r", "/optics/absorption_per_m/0", Kind::Number),
    ("absorption_per_m.g", "/optics/absorption_per_m/1", Kind::Number),
    ("absorption_per_m.b", "/optics/absorption_per_m/2", Kind::Number),
    ("scattering_per_m.r", "/optics/scattering_per_m/0", Kind::Number),
    ("scattering_per_m.g", "/optics/scattering_per_m/1", Kind::Number),
    ("scattering_per_m.b", "/optics/scattering_per_m/2", Kind::Number),
    (
        "beam_attenuation_per_m.r",
        "/optics/beam_attenuation_per_m/0",
        Kind::Number,
    ),
    (
        "beam_attenuation_per_m.g",
        "/optics/beam_attenuation_per_m/1",
        Kind::Number,
    ),
    (
        "beam_attenuation_per_m.b",
        "/optics/beam_attenuation_per_m/2",
        Kind::Number,
    ),
    (
        "backscatter_attenuation_per_m.r",
        "/optics/backscatter_attenuation_per_m/0",
        Kind::Number,
    ),
    (
        "backscatter_attenuation_per_m.g",
        "/optics/backscatter_attenuation_per_m/1",
        Kind::Number,
    ),
    (
        "backscatter_attenuation_per_m.b",
        "/optics/backscatter_attenuation_per_m/2",
        Kind::Number,
    ),
    (
        "diffuse_attenuation_per_m.r",
        "/optics/diffuse_attenuation_per_m/0",
        Kind::Number,
    ),
    (
        "diffuse_attenuation_per_m.g",
        "/optics/diffuse_attenuation_per_m/1",
        Kind::Number,
    ),
    (
        "diffuse_attenuation_per_m.b",
        "/optics/diffuse_attenuation_per_m/2",
        Kind::Number,
    ),
    ("veiling_light.r", "/optics/veiling_light/0", Kind::Number),
    ("veiling_light.g", "/optics/veiling_light/1", Kind::Number),
    ("veiling_light.b", "/optics/veiling_light/2", Kind::Number),
    ("g_per_m.r", "/optics/g_per_m/0", Kind::Number),
    ("g_per_m.g", "/optics/g_per_m/1", Kind::Number),
    ("g_per_m.b", "/optics/g_per_m/2", Kind::Number),
    ("spread_px_per_m.r", "/optics/spread_px_per_m/0", Kind::Number),
    ("spread_px_per_m.g", "/optics/spread_px_per_m/1", Kind::Number),
    ("spread_px_per_m.b", "/optics/spread_px_per_m/2", Kind::Number),
    (
        "backscatter_fraction",
        "/optics/backscatter_fraction",
        Kind::Number,
    ),
    ("path.frame", "/parameters/camera/path/frame", Kind::Number),
    ("instances.count", "/scene/instances", Kind::Number),
    ("instances.visible", "/scene/visible", Kind::Number),
    (
        "instances.least_visibility",
        "/scene/least_visibility",
        Kind::Number,
    ),
    (
        "instances.mean_visibility",
        "/scene/mean_visibility",
        Kind::Number,
    ),
    ("holes", "/counts/holes", Kind::Number),
    ("negative_radiance", "/counts/negative_radiance", Kind::Number),
    ("clamped", "/counts/clamped", Kind::Number),
    ("range_saturated", "/counts/range_saturated", Kind::Number),
    ("total_ms", "/timings_ms/total", Kind::Number),
    ("code_version", "/provenance/code_version", Kind::Text),
    ("onnx_runtime", "/provenance/onnx_runtime", Kind::Text),
    ("cpu_features", "/provenance/cpu_features", Kind::Text),
];

/// Columns that every row has: (name in questions, SQL, kind). Frames that failed have no image, so `failed` is false in
/// every row; it is there because people ask.
const OWN: &[(&str, &str, Kind)] = &[
    ("job", "images.job_id", Kind::Text),
    ("frame", "images.frame", Kind::Number),
    ("dataset", "images.dataset", Kind::Text),
    ("created_ms", "images.created_ms", Kind::Number),
    ("digest", "images.digest", Kind::Text),
    ("failed", "0", Kind::Bool),
    ("warned", "(images.warnings > 0)", Kind::Bool),
];

/// What is measured unless a question says otherwise.
const MAIN_SUBJECT: &str = "rgb";

/// All columns of one catalogue.
#[derive(Debug, Clone)]
pub(crate) struct Columns {
    metrics: Vec<String>,
}

/// A column of the schema: (table, name, type).
pub(crate) struct Added {
    pub(crate) table: &'static str,
    pub(crate) name: String,
    pub(crate) kind: &'static str,
}

impl Columns {
    pub(crate) fn new(metrics: &[String]) -> Self {
        Self {
            metrics: metrics.to_vec(),
        }
    }

    pub(crate) fn metrics(&self) -> &[String] {
        &self.metrics
    }

    /// The wide columns that the schema needs.
    pub(crate) fn added(&self) -> Vec<Added> {
        let kind = |kind| if kind == Kind::Text { "TEXT" } else { "REAL" };
        let parameters = PARAMETERS.iter().map(|&(name, _, k)| Added {
            table: "images",
            name: name.to_owned(),
            kind: kind(k),
        });
        let metrics = self.metrics.iter().map(|name| Added {
            table: "measurements",
            name: name.clone(),
            kind: "REAL",
        });
        parameters.chain(metrics).collect()
    }

    /// Parameter values of a record in the order of [`Columns::parameter_names`].
    pub(crate) fn parameter_values(record: &Value) -> Vec<Option<Bind>> {
        let found = |name: &str, pointer: &str| {
            let own = || record.pointer(OWN_WATER).filter(|_| name == WATER);
            record.pointer(pointer).or_else(own)
        };
        let value = |name: &str, pointer: &str| match found(name, pointer)? {
            Value::Number(number) => number.as_f64().map(Bind::Number),
            Value::String(text) => Some(Bind::Text(text.clone())),
            Value::Array(items) => Some(Bind::Number(items.len() as f64)),
            Value::Bool(_) | Value::Null | Value::Object(_) => None,
        };
        PARAMETERS
            .iter()
            .map(|(name, pointer, _)| value(name, pointer))
            .collect()
    }

    pub(crate) fn parameter_names() -> impl Iterator<Item = &'static str> {
        PARAMETERS.iter().map(|(name, ..)| *name)
    }

    /// Names that a question may use, apart from the open families `labels.…`, `timings.…`, `lights.N.…`,
    /// `artifacts.KIND` (its digest) and `SUBJECT.METRIC`.
    pub(crate) fn names(&self) -> Vec<String> {
        let own = OWN.iter().map(|(name, ..)| (*name).to_owned());
        own.chain(Self::parameter_names().map(str::to_owned))
            .chain(self.metrics.iter().cloned())
            .collect()
    }

    /// The column of a name.
    pub(crate) fn get(&self, name: &str) -> Option<Column> {
        if let Some((_, sql, kind)) = OWN.iter().find(|(own, ..)| *own == name) {
            return Some(Column {
                sql: (*sql).to_owned(),
                binds: Vec::new(),
                kind: *kind,
                always: true,
                join: None,
            });
        }
        if let Some((name, _, kind)) = PARAMETERS.iter().find(|(known, ..)| *known == name) {
            return Some(Column {
                sql: format!("images.\"{name}\""),
                binds: Vec::new(),
                kind: *kind,
                always: false,
                join: None,
            });
        }
        self.metric(name).or_else(|| open_family(name))
    }

    fn metric(&self, name: &str) -> Option<Column> {
        let (subject, metric) = if self.metrics.iter().any(|metric| metric == name) {
            (MAIN_SUBJECT, name)
        } else {
            name.split_once('.')?
        };
        let plain = subject
            .chars()
            .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
        let known = self.metrics.iter().find(|known| *known == metric)?;
        (plain && !subject.is_empty()).then(|| {
            let join = Join::Measured(subject.to_owned());
            Column {
                sql: format!("{}.\"{known}\"", join.alias()),
                binds: Vec::new(),
                kind: Kind::Number,
                always: false,
                join: Some(join),
            }
        })
    }
}

/// Names that depend on the job: labels and digests of artifacts are compared as text, times in milliseconds and numbers of a light as numbers.
fn open_family(name: &str) -> Option<Column> {
    // What a description admits as a name: anything else is no label, and could not stand in a JSON path (a NUL ends it).
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '.' | '-');
    let quoted = |key: &str| (!key.is_empty() && key.chars().all(plain)).then(|| format!("\"{key}\""));
    let extract = |path: String, kind| {
        let record = Join::Record.alias();
        // Text is greater than every number in SQLite, and a list is text: the intensity of a lamp is no number.
        let extracted = match kind {
            Kind::Text => format!("CAST(json_extract({record}.record, ?) AS TEXT)"),
            Kind::Number | Kind::Bool => format!(
                "(SELECT iif(typeof(v) = 'text', NULL, v) FROM (SELECT json_extract({record}.record, ?) AS v))"
            ),
        };
        Some(Column {
            sql: extracted,
            binds: vec![Bind::Text(path)],
            kind,
            always: false,
            join: Some(Join::Record),
        })
    };
    if let Some(kind) = name.strip_prefix("artifacts.") {
        return Some(Column {
            sql: "(SELECT a.digest FROM artifacts a
                   WHERE a.job_id = images.job_id AND a.frame = images.frame AND a.kind = ?)"
                .to_owned(),
            binds: vec![Bind::Text(kind.to_owned())],
            kind: Kind::Text,
            always: false,
            join: None,
        });
    }
    if let Some(label) = name.strip_prefix("labels.") {
        return extract(format!("$.parameters.labels.{}", quoted(label)?), Kind::Text);
    }
    if let Some(stage) = name.strip_prefix("timings.") {
        return extract(format!("$.timings_ms.{}", quoted(stage)?), Kind::Number);
    }
    let (index, field) = name.strip_prefix("lights.")?.split_once('.')?;
    let index: u16 = index.parse().ok()?;
    let at = |field: &str| format!("$.parameters.lights[{index}].{field}");
    let kind = match field {
        "x" | "y" | "size" | "intensity" | "cone_deg" => Kind::Number,
        "kind" | "blend" | "space" => Kind::Text,
        _ => {
            let (list, part) = field.split_once('.')?;
            let names = match list {
                "position_m" | "direction" => ["x", "y", "z"],
                "intensity" | "color" => ["r", "g", "b"],
                _ => return None,
            };
            let place = names.iter().position(|name| *name == part)?;
            return extract(at(&format!("{list}[{place}]")), Kind::Number);
        }
    };
    extract(at(field), kind)
}
