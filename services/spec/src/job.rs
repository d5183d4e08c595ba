//! A job: a frame description with laws in place of values, valid by construction.

mod draft;
mod grids;

use std::collections::BTreeSet;

use imaging::digest::sha256;
use serde_json::Value;

use crate::check::{places, whole};
use crate::earlier::refuse_earlier_version;
use crate::frame::Frame;
use crate::invalid::{FieldError, Invalid};
use crate::json;
use crate::node::Node;
use crate::scene_parts::Uploads;
use crate::site::{OF_THE_JOB, insert_descriptions};
use crate::vocabulary::Vocabulary;

pub use draft::Draft;

/// A job, valid by construction: N frames as a formula.
///
/// Each law draws its value for frame i from (seed, JSON pointer of the law, i) alone, see [`crate::law`]; so any
/// frame can be resolved by itself, another law changes nothing, and a greater `count` keeps the frames there were.
/// Grids span the frames instead: cell = i mod product of the axes, axes in the order of their pointers' bytes, the
/// last one fastest. An axis inside a choice, a site or another grid counts whether or not its place is chosen; axes at
/// the same pointer of several sites are one, as long as the longest.
#[derive(Debug, Clone)]
pub struct Job {
    /// The name of a frame's site, or how it is drawn. `None` for a job without a site.
    site: Option<Node>,
    /// One for each site, or that of the job without a site. Never empty.
    documents: Vec<Document>,
    pub(crate) canonical: String,
    dataset: String,
    frames: u64,
    /// Product of the lengths of the grid axes.
    cells: u64,
    seed: u64,
    pub(crate) warnings: Vec<String>,
}

/// A complete description, checked.
#[derive(Debug, Clone)]
struct Document {
    /// Name of the site; empty without one.
    site: String,
    node: Node,
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
    /// what it rendered then, whatever names, sites and limits there are by now.
    ///
    /// # Errors
    /// A text that does not parse: it is damaged, or the job of version 0.1.
    pub fn trusted(canonical: &str) -> Result<Self, Invalid> {
        let value = json::read(canonical.as_bytes())?;
        refuse_earlier_version(&value)?;
        let vocabulary = Vocabulary::default();
        Draft::start(value, &vocabulary, true)?.finish()
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

    /// Number of frames: count × product of the grid axes, 1..=[`crate::fields::MAX_FRAMES`].
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
        let mut parameters = self.document(index).value(&|law| law.draw(index));
        // Each cell of the grid goes through the whole path, and then again.
        if let Some(Value::Object(path)) = parameters.pointer_mut("/camera/path")
            && !path.contains_key("frame")
        {
            let frames = path.get("frames").and_then(Value::as_u64).unwrap_or(1);
            path.insert("frame".to_owned(), (index / self.cells % frames).into());
        }
        Frame::read(index, parameters)
            .map_err(|error| single(FieldError::new("", format!("frame {index}: {error}"))))
    }

    /// The description that a frame is drawn from.
    fn document(&self, index: u64) -> &Node {
        let drawn = self.site.as_ref().map(|site| site.value(&|law| law.draw(index)));
        let is_drawn = |document: &&Document| drawn.as_ref().is_some_and(|name| *name == document.site);
        let document = self.documents.iter().find(is_drawn);
        &document.unwrap_or(&self.documents[0]).node
    }

    /// Names of all style models that a frame can ask for, sorted.
    #[must_use]
    pub fn styles(&self) -> Vec<String> {
        self.strings("water", "style")
    }

    /// Ids of all uploaded scenes that a frame can ask for, sorted.
    #[must_use]
    pub fn uploaded_scene_ids(&self) -> Vec<String> {
        self.strings("scene", "id")
    }

    /// Every string that a field of an object can have in any site, sorted.
    fn strings(&self, object: &str, field: &str) -> Vec<String> {
        let objects = self
            .documents
            .iter()
            .flat_map(|document| places(&document.node, object));
        let strings: BTreeSet<_> = objects
            .filter_map(|(_, object)| object.get(field))
            .flat_map(|node| node.strings(""))
            .map(|(_, text)| text.to_owned())
            .collect();
        strings.into_iter().collect()
    }

    /// What the user should know, though nothing is wrong.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
}

pub(crate) fn seed(description: &Value) -> u64 {
    let written = description.get("seed").and_then(whole);
    written.and_then(|seed| u64::try_from(seed).ok()).unwrap_or(0)
}

fn single(error: FieldError) -> Invalid {
    Invalid(vec![error])
}

/// The canonical form of a job: that of its description, or of each description in place of its site's name.
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
