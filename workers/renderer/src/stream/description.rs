//! The job of a stream: a job whose scene is replaced by the pictures of the stream.

use serde_json::{Map, Value, json};
use spec::{ArtifactKind, Invalid, Job, ScenePart, Vocabulary};

/// Name of the files that represent the pictures and distances of the stream; errors name it.
const STREAM: &str = "stream";
/// The fields of a camera that apply to procedural scenes only.
const PROCEDURAL: [&str; 8] = [
    "width",
    "height",
    "path",
    "view",
    "stereo",
    "supersample",
    "frames_per_s",
    "readout_s",
];
/// The artifacts of a camera path and of a stereo pair.
const NEEDS_CAMERA_PATH: [ArtifactKind; 3] = [
    ArtifactKind::Flow,
    ArtifactKind::RgbRight,
    ArtifactKind::Disparity,
];
/// Those that every canonical description has. They may be defaults, so they are removed without a warning.
const ALWAYS: [&str; 4] = ["width", "height", "supersample", "frames_per_s"];
/// Field of view by default, degrees.
const DEFAULT_HFOV_DEG: f64 = 80.0;

/// What a stream measures and receives in addition to pictures and distances.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct StreamParts {
    /// Whether the metrics of the job are measured.
    pub has_metrics: bool,
    /// Whether its frames have instance masks.
    pub has_instances: bool,
}

impl StreamParts {
    /// Whether frames have a part of a scene.
    fn give(self, part: ScenePart) -> bool {
        match part {
            ScenePart::Range => true,
            ScenePart::Instances => self.has_instances,
            ScenePart::Surfaces => false,
        }
    }
}

/// A checked job over the pictures of a stream.
#[derive(Debug, Clone)]
pub struct StreamJob {
    /// The job; its scene represents the pictures of the stream.
    pub job: Job,
    /// Warnings about the job.
    pub warnings: Vec<String>,
    /// Whether the description gives a field of view.
    pub gives_hfov: bool,
}

impl StreamJob {
    /// Reads a description. The pictures of the stream replace its scene, which is therefore optional.
    ///
    /// # Errors
    /// All errors of the description.
    pub fn read(text: &[u8], parts: StreamParts, vocabulary: &Vocabulary) -> Result<Self, Invalid> {
        let mut written = spec::read_json(text)?;
        let gives_hfov = gives_hfov(&written);
        if let Value::Object(fields) = &mut written {
            complete(fields, parts);
        }
        let mut job = Job::parse(written.to_string().as_bytes(), vocabulary)?;
        let mut canonical = spec::read_json(job.canonical().as_bytes())?;
        let mut warnings = Vec::new();
        if replace_scenes(&mut canonical, parts, &mut warnings) {
            job = Job::parse(canonical.to_string().as_bytes(), vocabulary)?;
        }
        warnings.extend(job.warnings().iter().cloned());
        Ok(Self {
            job,
            warnings,
            gives_hfov,
        })
    }
}

/// Whether a description states a field of view other than the default; that of a complete site may be replaced.
fn gives_hfov(written: &Value) -> bool {
    let is_of_site = written.get("site").is_some_and(Value::is_object);
    let hfov_deg = written.pointer("/camera/hfov_deg");
    !is_of_site && hfov_deg.is_some_and(|hfov_deg| hfov_deg.as_f64() != Some(DEFAULT_HFOV_DEG))
}

/// Adds the scene of the stream if the description has none, and removes unrequested metrics.
fn complete(fields: &mut Map<String, Value>, parts: StreamParts) {
    let has_site = fields.contains_key("site");
    match fields.get_mut("scene") {
        None if !has_site => {
            fields.insert("scene".to_owned(), stream_scene(parts, None));
        }
        // Fields of the stream's scene, such as its lighting.
        Some(Value::Object(scene)) if !has_site && !is_complete(scene) => {
            for (name, value) in stream_scene(parts, None).as_object().into_iter().flatten() {
                scene.entry(name.clone()).or_insert_with(|| value.clone());
            }
        }
        _ => {}
    }
    if !parts.has_metrics {
        fields.insert("metrics".to_owned(), json!([]));
    }
}

/// Whether a scene has a kind or is a distribution of scenes.
fn is_complete(scene: &Map<String, Value>) -> bool {
    let is_distribution = scene.keys().any(|key| spec::law::KEYS.contains(&key.as_str()));
    is_distribution || scene.contains_key("kind")
}

fn stream_scene(parts: StreamParts, lighting: Option<Value>) -> Value {
    let mut scene = json!({"kind": "files", "rgb": STREAM, "range": STREAM});
    if parts.has_instances {
        scene["instances"] = STREAM.into();
    }
    if let Some(lighting) = lighting {
        scene["lighting"] = lighting;
    }
    scene
}

/// Replaces the scenes of a canonical description. Returns whether any of them was not that of the stream.
fn replace_scenes(value: &mut Value, parts: StreamParts, warnings: &mut Vec<String>) -> bool {
    let values: Vec<&mut Value> = match value {
        Value::Array(items) => items.iter_mut().collect(),
        Value::Object(fields) if fields.contains_key("scene") => {
            return replace_scene(fields, parts, warnings);
        }
        Value::Object(fields) => fields.values_mut().collect(),
        _ => Vec::new(),
    };
    let mut is_replaced = false;
    for value in values {
        is_replaced |= replace_scenes(value, parts, warnings);
    }
    is_replaced
}

fn replace_scene(fields: &mut Map<String, Value>, parts: StreamParts, warnings: &mut Vec<String>) -> bool {
    let Some(scene) = fields.get("scene").filter(|scene| scene["rgb"] != STREAM) else {
        return false;
    };
    let is_picture = ["files", "uploaded", "collection"]
        .iter()
        .any(|kind| scene["kind"] == *kind);
    let lighting = scene.get("lighting").filter(|_| is_picture).cloned();
    fields.insert("scene".to_owned(), stream_scene(parts, lighting));
    let mut removed = Vec::new();
    if let Some(camera) = fields.get_mut("camera") {
        remove_procedural(camera, &mut removed);
    }
    removed.sort_unstable();
    removed.dedup();
    let mut without: Vec<String> = removed.iter().map(|name| format!("`camera.{name}`")).collect();
    if let Some(Value::Array(kinds)) = fields.get_mut("artifacts") {
        without.extend(remove_labels(kinds, parts));
    }
    let without = match without.len() {
        0 => String::new(),
        _ => format!(", without {}", without.join(", ")),
    };
    let warning = format!("the pictures of the stream replace `scene`{without}");
    if !warnings.contains(&warning) {
        warnings.push(warning);
    }
    true
}

/// Removes the artifacts that only procedural scenes have, and describes them.
fn remove_labels(kinds: &mut Vec<Value>, parts: StreamParts) -> Vec<String> {
    let mut removed = Vec::new();
    kinds.retain(|kind| {
        let parsed = kind.as_str().and_then(ArtifactKind::parse);
        let is_removed = parsed.is_some_and(|kind| {
            let needed = kind.needs();
            needed.is_some_and(|part| !parts.give(part)) || NEEDS_CAMERA_PATH.contains(&kind)
        });
        if is_removed {
            removed.push(format!("the artifact {kind}"));
        }
        !is_removed
    });
    removed
}

/// Removes the fields of a camera, or of each camera of a distribution, that apply to procedural scenes only.
fn remove_procedural(camera: &mut Value, removed: &mut Vec<&'static str>) {
    match camera {
        Value::Array(items) => items.iter_mut().for_each(|item| remove_procedural(item, removed)),
        Value::Object(fields) => {
            for name in PROCEDURAL {
                if fields.remove(name).is_some() && !ALWAYS.contains(&name) {
                    removed.push(name);
                }
            }
            for law in spec::law::KEYS {
                if let Some(cameras) = fields.get_mut(law) {
                    remove_procedural(cameras, removed);
                }
            }
        }
        _ => {}
    }
}
