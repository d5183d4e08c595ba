//! A job: a frame description with laws in place of values, valid by construction.

mod draft;

use std::collections::BTreeSet;

use imaging::digest::sha256;
use serde_json::Value;

use crate::check::{Checker, Place, places, whole};
use crate::fields::{DOCUMENT, MAX_FRAMES};
use crate::frame::Frame;
use crate::invalid::{FieldError, Invalid};
use crate::json;
use crate::node::{Law, Node};
use crate::scene_parts::Uploads;
use crate::vocabulary::Vocabulary;

pub use draft::Draft;

/// A job, valid by construction: N frames as a formula.
///
/// Each law draws its value for frame i from (seed, JSON pointer of the law, i) alone, see [`crate::law`]; so any
/// frame can be resolved by itself, another law changes nothing, and a greater `count` keeps the frames there were.
/// Grids span the frames instead: cell = i mod product of the axes, axes in the order of their pointers' bytes, the
/// last one fastest. An axis inside a choice or another grid counts whether or not its place is chosen.
///
/// With `camera.path` the frames of one pass over the path share their world: laws of `scene`, of `camera.view` and inside
/// `camera.path` draw for the number of the pass, which is i / (product of the axes × frames of the path), instead of i.
#[derive(Debug, Clone)]
pub struct Job {
    pub(crate) document: Node,
    pub(crate) canonical: String,
    dataset: String,
    frames: u64,
    /// Product of the lengths of the grid axes.
    cells: u64,
    seed: u64,
    pub(crate) warnings: Vec<String>,
}

impl Job {
    /// Reads and checks a description where nothing is known of uploaded scenes; elsewhere [`Draft`] checks them, too.
    ///
    /// # Errors
    /// Every error of the description together, at most [`crate::MAX_ERRORS`]; of a text that is not JSON, that one.
    pub fn parse(json: &[u8], vocabulary: &Vocabulary) -> Result<Self, Invalid> {
        Draft::read(json, vocabulary)?.check(&Uploads::Unknown)
    }

    /// Reads the canonical text of a job that was accepted before. Its names and numbers are believed, so that it renders
    /// what it rendered then, whatever names and limits there are by now.
    ///
    /// # Errors
    /// What is no description by its form: the text is damaged, or of another version of the program.
    pub fn trusted(canonical: &str) -> Result<Self, Invalid> {
        let value = json::read(canonical.as_bytes())?;
        let mut checker = Checker {
            vocabulary: &Vocabulary::default(),
            trusting: true,
            seed: seed(&value),
            errors: Vec::new(),
        };
        let job = Self::read(&value, &mut checker)?;
        if checker.errors.is_empty() {
            Ok(job)
        } else {
            Err(Invalid(checker.errors))
        }
    }

    /// The job of a description that is right field by field, or as far as it is: the checker holds what is wrong.
    pub(crate) fn read(value: &Value, checker: &mut Checker<'_>) -> Result<Self, Invalid> {
        let document = checker.node(&Place::default(), &DOCUMENT, false, value);
        let Some(mut document) = document else {
            return Err(Invalid(std::mem::take(&mut checker.errors)));
        };
        let product = lay_out_grids(&mut document);
        let frames = frames(&document, product, checker);
        let dataset = document
            .get("dataset")
            .map(|node| node.strings(""))
            .unwrap_or_default();
        Ok(Self {
            dataset: dataset.into_iter().map(|(_, name)| name.to_owned()).collect(),
            warnings: Vec::new(),
            canonical: document.canonical().to_string(),
            frames,
            cells: product.unwrap_or(1),
            seed: checker.seed,
            document,
        })
    }

    /// Canonical JSON text: sorted keys, no spaces, defaults filled in, presets by full name and in object form,
    /// laws kept; number fields with a point or exponent (`1.0`), whole-number fields without. Parsing it again
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

    /// Number of frames: count × product of the grid axes, 1..=[`MAX_FRAMES`].
    #[must_use]
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// The job's seed.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The frame of this index: a pure function of the description and the index. It does not depend on `count`.
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
        let path_frames = self.path_frames(index);
        let pass = index / self.cells / path_frames.unwrap_or(1).max(1);
        let mut parameters = self.document.value(&|law| match law.law {
            Law::Grid { .. } => law.draw(index),
            _ if path_frames.is_some() && is_shared_by_pass(&law.pointer) => law.draw(pass),
            _ => law.draw(index),
        });
        // Each cell of the grid goes through the whole path, and then again.
        if let Some(Value::Object(path)) = parameters.pointer_mut("/camera/path")
            && !path.contains_key("frame")
        {
            let frames = path_frames.unwrap_or(1).max(1);
            path.insert("frame".to_owned(), (index / self.cells % frames).into());
        }
        Frame::read(index, parameters)
            .map_err(|error| single(FieldError::new("", format!("frame {index}: {error}"))))
    }

    /// Frames of the path that a frame is on, of one that stays at a given place 1; `None` without a path.
    fn path_frames(&self, index: u64) -> Option<u64> {
        let camera = self.document.get("camera")?.value(&|law| law.draw(index));
        let path = camera.get("path")?;
        match path.get("frame") {
            Some(_) => Some(1),
            None => path.get("frames").and_then(Value::as_u64),
        }
    }

    /// Names of all style models that a frame can ask for, sorted.
    #[must_use]
    pub fn styles(&self) -> Vec<String> {
        let names: BTreeSet<_> = places(&self.document, "water")
            .into_iter()
            .filter_map(|(_, water)| water.get("style"))
            .flat_map(|name| name.strings(""))
            .map(|(_, name)| name.to_owned())
            .collect();
        names.into_iter().collect()
    }

    /// Ids of all uploaded scenes that a frame can ask for, sorted.
    #[must_use]
    pub fn uploaded_scene_ids(&self) -> Vec<String> {
        let ids: BTreeSet<_> = places(&self.document, "scene")
            .into_iter()
            .filter_map(|(_, scene)| scene.get("id"))
            .flat_map(|id| id.strings(""))
            .map(|(_, id)| id.to_owned())
            .collect();
        ids.into_iter().collect()
    }

    /// What the user should know, though nothing is wrong.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
}

/// Whether all frames of a pass over a path share what the law at this pointer draws.
fn is_shared_by_pass(pointer: &str) -> bool {
    let mut parts = pointer.split('/').skip(1);
    match parts.next() {
        Some("scene") => true,
        Some("camera") => match parts.find(|part| ["view", "path"].contains(part)) {
            Some("view") => true,
            // The path itself decides how long a pass is.
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

/// Gives every grid axis its stride; returns the product of their lengths, or `None` beyond u64.
fn lay_out_grids(document: &mut Node) -> Option<u64> {
    let mut axes: Vec<_> = document
        .laws()
        .into_iter()
        .filter(|node| matches!(node.law, Law::Grid { .. }))
        .map(|node| (node.pointer.clone(), node.values().len() as u64))
        .collect();
    axes.sort_unstable();
    let mut product: Option<u64> = Some(1);
    let mut strides = std::collections::BTreeMap::new();
    for (pointer, length) in axes.into_iter().rev() {
        strides.insert(pointer, product.unwrap_or(1));
        product = product.and_then(|product| product.checked_mul(length));
    }
    document.change_laws(&mut |node| {
        if let Law::Grid { stride, .. } = &mut node.law {
            *stride = strides.get(&node.pointer).copied().unwrap_or(1);
        }
    });
    product
}

fn frames(document: &Node, product: Option<u64>, checker: &mut Checker<'_>) -> u64 {
    let Some(count) = document.get("count").and_then(Node::greatest) else {
        return 0;
    };
    let count = count as u64;
    match product.and_then(|product| product.checked_mul(count)) {
        Some(frames) if frames <= MAX_FRAMES => frames,
        _ => {
            let cells = product.map_or("more than 2^64".to_owned(), |product| product.to_string());
            let message = format!("`count` {count} × {cells} grid cells is more than {MAX_FRAMES} frames");
            checker.refuse(|| {
                FieldError::new("/count", message)
                    .value(&count.into())
                    .limit(format!("{MAX_FRAMES} frames"))
            });
            0
        }
    }
}
