//! Strings: vocabulary names, fixed words, ids and paths.

use serde_json::Value;

use super::{Checker, Location};
use crate::artifact::ArtifactKind;
use crate::enhancement::NETWORK_METHOD;
use crate::enhancement::mask_image::MaskImage;
use crate::invalid::{FieldError, quote};
use crate::migration;
use crate::node::Node;
use crate::schema::Names;
use crate::vocabulary::METRIC_NETWORK;

/// Maximum path length of common systems, bytes.
const MAX_PATH_BYTES: usize = 4096;

/// Maximum length of a dataset name or scene id.
const MAX_NAME: usize = 100;

/// Maximum length of free text, characters.
const MAX_WORDS: usize = 1000;

/// Maximum length of an enhancement's name: `enhanced.NAME.STEP` is an artifact's.
const MAX_ENHANCEMENT_NAME: usize = 32;

/// Name of the unenhanced picture in stored metrics.
const MAIN_PICTURE: &str = "rgb";

/// Maximum length of a water's name.
const MAX_WATER_NAME: usize = 64;

impl Checker<'_> {
    /// The string in canonical form: presets by full name, all others unchanged.
    pub(super) fn check_text(&mut self, location: &Location, names: Names, text: &str) -> Option<Node> {
        let canonical = match names {
            Names::Preset => self.vocabulary.preset(text).map(str::to_owned),
            Names::Enhancer => self.vocabulary.enhancer(text).map(str::to_owned),
            Names::Words => is_words(text).then(|| text.to_owned()),
            Names::WaterName => is_water_name(text).then(|| text.to_owned()),
            Names::Enhancement => is_enhancement_name(text).then(|| text.to_owned()),
            Names::Artifact if is_of_enhancement(text) => Some(text.to_owned()),
            Names::Dataset | Names::Collection => is_dataset(text).then(|| text.to_owned()),
            Names::SceneId => is_scene_id(text).then(|| text.to_owned()),
            Names::Path => is_path(text).then(|| text.to_owned()),
            Names::MaskImage => {
                if let Err(why) = MaskImage::parse(text).and_then(|mask| mask.decode()) {
                    let message = format!("{location} {why}");
                    self.refuse(|| location.error(message).limit(names.describe()));
                    return None;
                }
                Some(text.to_owned())
            }
            _ => self
                .vocabulary
                .listed(names)
                .iter()
                .any(|name| name == text)
                .then(|| text.to_owned()),
        };
        if let Some(name) = canonical {
            return Some(Node::Constant(name.into()));
        }
        self.refuse_text(location, names, text);
        None
    }

    fn refuse_text(&mut self, location: &Location, names: Names, text: &str) {
        let allowed = self.vocabulary.listed(names);
        let removed = migration::find_value(&location.path(""), text);
        self.refuse(|| {
            let value = Value::from(text);
            if let Some(removed) = removed {
                let message = format!("{location} {} was removed in 0.2; {}", quote(&value), removed.instruction());
                return location.error(message).value(&value);
            }
            let names_models = matches!(names, Names::Style | Names::Enhancer | Names::Metric);
            let usage = self.vocabulary.usage_of_model(text).filter(|_| names_models);
            let problem = match names {
                Names::Style | Names::Enhancer | Names::Metric if usage.is_some() => usage.unwrap_or_default(),
                Names::Enhancer if allowed.is_empty() => {
                    "is not known: there is no enhancer network here; networks run in jobs of a service that has them (`fathom styles \
                     add FILE --role enhancer`), and in `fathom enhance` and `fathom render` with --styles"
                        .to_owned()
                }
                Names::Method if text == NETWORK_METHOD => format!(
                    "needs a model: {{\"method\": \"{NETWORK_METHOD}\", \"model\": \"NAME\"}}"
                ),
                Names::Preset if self.vocabulary.waters.contains_key(text) => {
                    "is a user-defined water and cannot be in a choice of presets; use a choice of optics, {\"optics\": {\"choice\": […]}}"
                        .to_owned()
                }
                Names::Words
                | Names::WaterName
                | Names::Enhancement
                | Names::Dataset
                | Names::Collection
                | Names::SceneId
                | Names::Path => {
                    format!("must be {}", names.describe())
                }
                Names::Fixed(_) => format!("is not one of {}", names.limit()),
                _ => format!("is not {}", names.describe()),
            };
            let error =
                location.error(format!("{location} {} {problem}", quote(&value))).value(&value);
            if allowed.is_empty() {
                error.limit(names.describe())
            } else {
                error.allowed(allowed, text)
            }
        });
    }

    /// Rejects presets that lack data for rendering. If coefficients are given, the optics decide.
    pub(super) fn refuse_unrenderable(&mut self, location: &Location, optics: &Node, is_object: bool) {
        let Node::Object(fields) = optics else { return };
        let harmless = ["preset", "veil_gain", "phase", "forward_scatter"];
        if !fields.iter().all(|(name, _)| harmless.contains(&name.as_str())) {
            return;
        }
        let Some(preset) = optics.get("preset") else {
            return;
        };
        let pointer = if is_object {
            location.field("preset").pointer
        } else {
            location.pointer.clone()
        };
        for (pointer, name) in preset.strings(&pointer) {
            let Some(why) = self.vocabulary.why_unrenderable(name) else {
                continue;
            };
            let message = format!("{location}: the preset \"{name}\" cannot be rendered: {why}");
            self.refuse(|| FieldError::new(&pointer, message).value(&Value::from(name)));
        }
    }
}

pub(crate) fn is_dataset(text: &str) -> bool {
    !text.starts_with(['.', '_', '-'])
        && (1..=MAX_NAME).contains(&text.len())
        && !text.contains("..")
        && text
            .bytes()
            .all(|byte| matches!(byte, b'a'..=b'z' | b'0'..=b'9' | b'.' | b'_' | b'-'))
}

fn is_words(text: &str) -> bool {
    !text.trim().is_empty() && text.chars().count() <= MAX_WORDS
}

fn is_water_name(text: &str) -> bool {
    let starts = text.starts_with(|c: char| c.is_ascii_alphanumeric());
    starts
        && text.len() <= MAX_WATER_NAME
        && text
            .chars()
            .all(|c: char| c.is_ascii_alphanumeric() || "._-".contains(c))
}

fn is_enhancement_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_lowercase())
        && text.len() <= MAX_ENHANCEMENT_NAME
        && ![MAIN_PICTURE, METRIC_NETWORK.trim_end_matches('.')].contains(&text)
        && text
            .bytes()
            .all(|byte| matches!(byte, b'a'..=b'z' | b'0'..=b'9' | b'_' | b'-'))
}

/// Whether a text names a result of an enhancement; whether the frame has it is a check across fields.
fn is_of_enhancement(text: &str) -> bool {
    ArtifactKind::is_name(text) && ArtifactKind::parse(text).is_some_and(|kind| kind.enhancement().is_some())
}

fn is_scene_id(text: &str) -> bool {
    let tail = text.strip_prefix("scn_").unwrap_or_default();
    !tail.is_empty()
        && text.len() <= MAX_NAME
        && tail
            .chars()
            .all(|c: char| c.is_ascii_alphanumeric() || "_-".contains(c))
}

fn is_path(text: &str) -> bool {
    !text.is_empty() && text.len() <= MAX_PATH_BYTES && !text.contains('\0')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dataset_names_are_safe_as_parts_of_addresses_and_paths() {
        for good in ["a", "shaft-v1", "0.1_x", &"a".repeat(100)] {
            assert!(is_dataset(good), "{good}");
        }
        for bad in ["", ".a", "-a", "A", "a..b", "a/b", "ä", "a b", &"a".repeat(101)] {
            assert!(!is_dataset(bad), "{bad}");
        }
    }

    #[test]
    fn scene_ids_carry_their_prefix() {
        assert!(is_scene_id("scn_01890a5d-ac96-774b-bcce-b302099a8057"));
        for bad in ["", "scn_", "job_1", "scn_a/b", "scn_../x"] {
            assert!(!is_scene_id(bad), "{bad}");
        }
    }
}
