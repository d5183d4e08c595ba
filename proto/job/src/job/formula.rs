//! A job: N frames as a formula.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use imaging::digest::sha256;
use serde_json::Value;

use super::grids::{count_frames, lay_out_grids};
use crate::check::{find_enhancers, find_values, names_in, whole};
use crate::frame::{Frame, Siblings};
use crate::invalid::{FieldError, Invalid};
use crate::label_types::{LabelType, label_types};
use crate::node::{Law, Node};
use crate::site::{OF_THE_JOB, insert_descriptions};
use crate::vocabulary::METRIC_NETWORK;

/// A job, valid by construction: N frames as a formula.
///
/// Each distribution draws its value for frame i only from (seed, its JSON pointer, i), see [`crate::law`]. Any frame
/// can be resolved independently, other distributions have no effect on it, and a greater `count` keeps the existing
/// frames. Grids enumerate instead: cell = i mod product of the axes, axes in byte order of their pointers, the last
/// one fastest. An axis inside a choice, a site or another grid always counts. Axes at the same pointer of several
/// sites are one axis of the maximum length.
///
/// With `camera.path` the frames of one pass over the path share their world: distributions of `scene`, of
/// `camera.view` and inside `camera.path` draw for the number of the pass, i / (product of the axes × frames of the
/// path), instead of i.
#[derive(Debug, Clone)]
pub struct Job {
    pub(super) formula: Arc<Formula>,
    pub(crate) canonical: String,
    dataset: String,
    pub(super) frames: u64,
    pub(crate) warnings: Vec<String>,
}

/// The frames of a job without their number.
#[derive(Debug)]
pub(super) struct Formula {
    /// Name of a frame's site, or its distribution. `None` for a job without sites.
    pub(super) site: Option<Node>,
    /// One per site, or a single one without sites. Never empty.
    pub(super) documents: Vec<Document>,
    /// Product of the lengths of the grid axes.
    cells: u64,
    seed: u64,
}

/// A complete, checked description.
#[derive(Debug, Clone)]
pub(super) struct Document {
    /// Name of the site; empty without one.
    pub(super) site: String,
    pub(super) node: Node,
}

impl Job {
    /// Lays out the grids of the documents and counts the frames.
    pub(super) fn assemble(
        seed: u64,
        mut site: Option<Node>,
        mut documents: Vec<Document>,
        errors: &mut Vec<FieldError>,
    ) -> Self {
        let trees = documents.iter_mut().map(|document| &mut document.node);
        let cells = lay_out_grids(trees.chain(site.as_mut()));
        let frames = count_frames(&documents[0].node, cells, errors);
        let dataset = documents[0].node.get("dataset").map(|node| node.strings(""));
        let dataset = dataset.into_iter().flatten().map(|(_, name)| name.to_owned());
        Self {
            dataset: dataset.collect(),
            warnings: Vec::new(),
            canonical: canonical(site.as_ref(), &documents).to_string(),
            frames,
            formula: Arc::new(Formula {
                cells: cells.unwrap_or(1),
                seed,
                site,
                documents,
            }),
        }
    }

    /// Canonical JSON text: sorted keys, no spaces, defaults filled in, presets by full name and in object form,
    /// distributions kept; number fields with a point or exponent (`1.0`), whole-number fields without. Parsing it
    /// yields the same text.
    #[must_use]
    pub fn canonical(&self) -> &str {
        &self.canonical
    }

    /// SHA-256 of the canonical text, lower-case hex.
    #[must_use]
    pub fn digest(&self) -> String {
        sha256(self.canonical.as_bytes())
    }

    /// Name of the dataset.
    #[must_use]
    pub fn dataset(&self) -> &str {
        &self.dataset
    }

    /// Number of frames: count × product of the grid axes, 1..=[`crate::fields::MAX_FRAMES`].
    #[must_use]
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// The job's seed.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.formula.seed
    }

    /// Resolves the frame of this index: a pure function of description and index, independent of `count`.
    ///
    /// # Errors
    /// An index beyond the last frame.
    pub fn resolve(&self, index: u64) -> Result<Frame, Invalid> {
        if index >= self.frames {
            let message = format!("frame {index} does not exist, the job has {} frames", self.frames);
            return Err(single(
                FieldError::new("", message).limit(format!("0..{}", self.frames)),
            ));
        }
        self.formula.resolve(index)
    }

    /// As [`Job::resolve`], for any index: the frames of a stream are numbered by their time stamps.
    ///
    /// # Errors
    /// A value outside the schema.
    pub fn resolve_any(&self, index: u64) -> Result<Frame, Invalid> {
        self.formula.resolve(index)
    }

    /// Names of all style models that a frame can use, sorted.
    #[must_use]
    pub fn styles(&self) -> Vec<String> {
        self.strings("water", "style")
    }

    /// Names of all enhancer networks that a frame can use, sorted.
    #[must_use]
    pub fn enhancers(&self) -> Vec<String> {
        let documents = self.formula.documents.iter();
        let names = documents.flat_map(|document| find_enhancers(&document.node));
        let names: BTreeSet<_> = names.map(|(_, name)| name.to_owned()).collect();
        names.into_iter().collect()
    }

    /// Names of all metric networks that a frame can use, sorted, without `net.`.
    #[must_use]
    pub fn metric_networks(&self) -> Vec<String> {
        let names = self.words("metrics").into_iter();
        let networks = names.filter_map(|name| Some(name.strip_prefix(METRIC_NETWORK)?.to_owned()));
        networks.collect()
    }

    /// Names of all models that a frame can use: styles, enhancers and metric networks.
    #[must_use]
    pub fn models(&self) -> Vec<String> {
        let mut models = self.styles();
        models.extend(self.enhancers());
        models.extend(self.metric_networks());
        models
    }

    /// Ids of all uploaded scenes that a frame can use, sorted.
    #[must_use]
    pub fn uploaded_scene_ids(&self) -> Vec<String> {
        self.strings("scene", "id")
    }

    /// All possible strings of an object's field over all sites, sorted.
    fn strings(&self, object: &str, field: &str) -> Vec<String> {
        let objects = self
            .formula
            .documents
            .iter()
            .flat_map(|document| find_values(&document.node, object));
        let strings: BTreeSet<_> = objects
            .filter_map(|(_, object)| object.get(field))
            .flat_map(|node| node.strings(""))
            .map(|(_, text)| text.to_owned())
            .collect();
        strings.into_iter().collect()
    }

    /// All possible strings at and below a field, over all sites and distributions.
    #[must_use]
    pub fn words(&self, field: &str) -> BTreeSet<String> {
        let values = self
            .formula
            .documents
            .iter()
            .filter_map(|document| document.node.get(field));
        values.flat_map(Node::words).map(str::to_owned).collect()
    }

    /// The names of all enhancements, over all sites and distributions.
    #[must_use]
    pub fn enhancements(&self) -> BTreeSet<String> {
        let documents = self.formula.documents.iter();
        documents.flat_map(|document| names_in(&document.node)).collect()
    }

    /// The types of each label over all sites.
    #[must_use]
    pub fn label_types(&self) -> BTreeMap<String, BTreeSet<LabelType>> {
        let mut types: BTreeMap<String, BTreeSet<LabelType>> = BTreeMap::new();
        let labels = self
            .formula
            .documents
            .iter()
            .filter_map(|document| document.node.get("labels"));
        for (name, found) in labels.flat_map(|labels| label_types(&labels.canonical())) {
            types.entry(name).or_default().extend(found);
        }
        types
    }

    /// Warnings about a valid description.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
}

impl Formula {
    /// Resolves the frame of any index, also beyond the last one.
    fn resolve(self: &Arc<Self>, index: u64) -> Result<Frame, Invalid> {
        let document = self.document(index);
        let path_frames = path_frames(document, index);
        let pass = index / self.cells / path_frames.unwrap_or(1).max(1);
        let mut parameters = document.value(&|law| match law.law {
            Law::Grid { .. } => law.draw(index),
            _ if path_frames.is_some() && is_shared_by_pass(&law.pointer) => law.draw(pass),
            _ => law.draw(index),
        });
        // Each cell of the grid passes over the whole path, then repeats.
        if let Some(Value::Object(path)) = parameters.pointer_mut("/camera/path")
            && !path.contains_key("frame")
        {
            let frames = path_frames.unwrap_or(1).max(1);
            path.insert("frame".to_owned(), (index / self.cells % frames).into());
        }
        let mut frame = Frame::read(index, parameters)
            .map_err(|error| single(FieldError::new("", format!("frame {index}: {error}"))))?;
        if path_frames.is_some_and(|frames| frames > 1) {
            let formula = Arc::clone(self);
            frame.siblings = Siblings::new(self.cells, move |index| formula.resolve(index));
        }
        Ok(frame)
    }

    /// The description of this frame's site.
    fn document(&self, index: u64) -> &Node {
        let drawn = self.site.as_ref().map(|site| site.value(&|law| law.draw(index)));
        let document = self
            .documents
            .iter()
            .find(|document: &&Document| drawn.as_ref().is_some_and(|name| *name == document.site));
        &document.unwrap_or(&self.documents[0]).node
    }
}

/// Length of the frame's path, frames; 1 for a fixed position, `None` without a path.
fn path_frames(document: &Node, index: u64) -> Option<u64> {
    let camera = document.get("camera")?.value(&|law| law.draw(index));
    let path = camera.get("path")?;
    match path.get("frame") {
        Some(_) => Some(1),
        None => path.get("frames").and_then(Value::as_u64),
    }
}

/// Whether all frames of a pass over a path share the value of the distribution at this pointer.
fn is_shared_by_pass(pointer: &str) -> bool {
    let mut parts = pointer.split('/').skip(1);
    match parts.next() {
        Some("scene") => true,
        Some("camera") => match parts.find(|part| ["view", "path"].contains(part)) {
            Some("view") => true,
            // The path itself sets the length of a pass.
            Some(_) => parts.next().is_some(),
            None => false,
        },
        _ => false,
    }
}

pub(crate) fn seed(description: &Value) -> u64 {
    let written = description.get("seed").and_then(whole);
    written.and_then(|seed| u64::try_from(seed).ok()).unwrap_or(0)
}

fn single(error: FieldError) -> Invalid {
    Invalid(vec![error])
}

/// The canonical form of a job: its description, or each description in place of its site's name.
fn canonical(site: Option<&Node>, documents: &[Document]) -> Value {
    let mut job = documents[0].node.canonical();
    if let Some(site @ Node::Law(_)) = site {
        let descriptions = documents
            .iter()
            .map(|document| (document.site.as_str(), document.node.canonical()));
        let descriptions = descriptions.collect();
        if let Value::Object(fields) = &mut job {
            fields.retain(|field, _| OF_THE_JOB.contains(&field.as_str()));
            let site = insert_descriptions(&site.canonical(), &descriptions);
            fields.insert("site".to_owned(), site);
        }
    }
    job
}
