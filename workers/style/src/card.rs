//! Model cards: provenance and inputs of a model.

use imaging::digest::sha256;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::ports::takes;
use crate::role::{InputScale, Layout, ModelRole, PictureInput, SizeRule};

/// Metadata of a model. A card file is this as JSON; all fields but the name and the digest are optional.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelCard {
    /// Name in job descriptions.
    pub name: String,
    /// Its use in jobs.
    #[serde(default)]
    pub role: ModelRole,
    /// Name of the ONNX file.
    #[serde(default)]
    pub file: String,
    /// SHA-256 of the ONNX file, lower-case hex.
    pub sha256: String,
    /// Kind of network.
    #[serde(default = "unknown")]
    pub architecture: String,
    /// Number of trained parameters.
    #[serde(default)]
    pub parameters: Option<u64>,
    /// Training data.
    #[serde(default = "unknown")]
    pub source: String,
    /// License.
    #[serde(default = "unknown")]
    pub licence: String,
    /// Its inputs.
    #[serde(default)]
    pub inputs: Vec<String>,
    /// Its outputs.
    #[serde(default)]
    pub outputs: Vec<String>,
    /// Whether it has an input `noise`, filled from the job's seed and the frame. Read from the model file; the card
    /// file is ignored.
    #[serde(default)]
    pub takes_noise: bool,
    /// Whether it has a required input `range`, filled from the frame. Read from the model file; the card file is
    /// ignored.
    #[serde(default)]
    pub takes_range: bool,
    /// The value of white in its inputs and outputs, such as 255; 1 if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<f32>,
    /// Enhancers and metrics only: the values of black and white.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub input_scale: Option<InputScale>,
    /// Enhancers and metrics only: the order of the axes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layout: Option<Layout>,
    /// Enhancers and metrics only: the sizes that it takes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<SizeRule>,
    /// Effect of the style weight on its output.
    #[serde(default)]
    pub alpha: String,
    /// Known limitations.
    #[serde(default)]
    pub caveats: Vec<String>,
    /// Training record of `fathom train`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub training: Option<TrainingCard>,
    /// Distance of its color table from the network, if measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table: Option<TableDistance>,
}

/// Training record of a style.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = TrainingRecord)]
pub struct TrainingCard {
    /// SHA-256 of each photo's file.
    pub photos: Vec<String>,
    /// Random seed.
    pub seed: u64,
    /// Requested steps.
    #[schema(value_type = u64)]
    pub steps: usize,
    /// The step with the selected weights; 0: only the color transfer.
    #[schema(value_type = u64)]
    pub kept_step: usize,
    /// Mean losses of the steps leading to it.
    pub losses: LossTerms,
    /// Losses on new scenes.
    pub held_out: LossTerms,
    /// Losses of the color transfer alone on new scenes.
    #[serde(rename = "held_out_colour_transfer")]
    pub held_out_color_transfer: LossTerms,
    /// Contribution of the network beyond its color map on new scenes: root mean square, of 255.
    pub branch_rms_255: f64,
    /// Version of the trainer.
    pub code_version: String,
}

/// Parts of a loss; lower is better.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = Losses)]
pub struct LossTerms {
    /// Distance of the texture from the photo's.
    pub texture: f64,
    /// Distance of the colors from the photo's.
    #[serde(rename = "colour")]
    pub color: f64,
    /// Lost share of the content.
    pub content: f64,
}

/// Distance of the color table from the network on new scenes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TableDistance {
    /// Mean absolute difference, of 255.
    pub mean_255: f64,
    /// 99.9th percentile of the absolute difference, of 255.
    pub high_255: f64,
    /// Maximum absolute difference, of 255.
    pub max_255: f64,
    /// Mean structural similarity of the brightness.
    pub ssim: f64,
    /// Mean color difference ΔE (CIE 1976).
    pub delta_e: f64,
}

/// Largest value of white: 16-bit codes.
pub const MAX_SCALE: f32 = 65535.0;

/// Whether a network may have this scale.
#[must_use]
pub fn is_scale(scale: f32) -> bool {
    scale > 0.0 && scale <= MAX_SCALE
}

fn unknown() -> String {
    "unknown".to_owned()
}

impl ModelCard {
    /// Parses a card file and checks it against the name and the bytes of the model.
    pub(crate) fn parse(text: &str, name: &str, onnx: &[u8]) -> Result<Self, String> {
        let mut card: Self = serde_json::from_str(text).map_err(|error| error.to_string())?;
        if card.name != name {
            return Err(format!("it is the card of `{}`", card.name));
        }
        let file = file_of(name);
        if card.file.is_empty() {
            card.file = file;
        } else if card.file != file {
            return Err(format!(
                "it names the file `{}` but the model is `{file}`",
                card.file
            ));
        }
        let digest = sha256(onnx);
        if card.sha256 != digest {
            return Err(format!(
                "its SHA-256 is {} but the model has {digest}",
                card.sha256
            ));
        }
        if let Some(scale) = card.scale.filter(|scale| !is_scale(*scale)) {
            return Err(format!(
                "its `scale` is {scale}; must be above 0 and at most {MAX_SCALE}"
            ));
        }
        let foreign = card.foreign_fields();
        if !foreign.is_empty() {
            let faults = foreign
                .iter()
                .map(|(field, reason)| format!("its `{field}` {reason}"));
            return Err(faults.collect::<Vec<_>>().join("; "));
        }
        let is_style = card.role == ModelRole::Style;
        card.takes_noise = is_style && takes(onnx, "noise");
        card.takes_range = is_style && takes(onnx, "range");
        card.declare_input();
        Ok(card)
    }

    /// How an enhancer or a metric takes a picture.
    #[must_use]
    pub fn picture_input(&self) -> PictureInput {
        PictureInput {
            scale: self.input_scale.unwrap_or_default(),
            layout: self.layout.unwrap_or_default(),
            size: self.size.unwrap_or_default(),
        }
    }

    /// The given fields that a model of this role does not have, with the reasons.
    #[must_use]
    pub fn foreign_fields(&self) -> Vec<(&'static str, String)> {
        let role = self.role.name();
        if self.role == ModelRole::Style {
            let given = [
                ("input_scale", self.input_scale.is_some()),
                ("layout", self.layout.is_some()),
                ("size", self.size.is_some()),
            ];
            let foreign = given.into_iter().filter(|(_, is_given)| *is_given);
            let reason =
                "belongs to enhancers and metrics, but the role is `style`; set the role, or remove it";
            return foreign.map(|(field, _)| (field, reason.to_owned())).collect();
        }
        let reason = format!("belongs to styles, but the role is `{role}`; ");
        let scale = self
            .scale
            .is_some()
            .then(|| ("scale", format!("{reason}use `input_scale`")));
        let alpha = (!self.alpha.is_empty()).then(|| ("alpha", format!("{reason}remove it")));
        scale.into_iter().chain(alpha).collect()
    }

    /// Fills in the defaults of an enhancer or a metric.
    pub fn declare_input(&mut self) {
        if self.role != ModelRole::Style {
            let PictureInput { scale, layout, size } = self.picture_input();
            (self.input_scale, self.layout, self.size) = (Some(scale), Some(layout), Some(size));
        }
    }

    /// The card of a model without one.
    pub(crate) fn absent(name: &str, onnx: &[u8]) -> Self {
        Self {
            name: name.to_owned(),
            role: ModelRole::Style,
            file: file_of(name),
            sha256: sha256(onnx),
            architecture: unknown(),
            parameters: None,
            source: unknown(),
            licence: unknown(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            takes_noise: takes(onnx, "noise"),
            takes_range: takes(onnx, "range"),
            scale: None,
            input_scale: None,
            layout: None,
            size: None,
            alpha: String::new(),
            caveats: vec!["it came without a card".to_owned()],
            training: None,
            table: None,
        }
    }
}

fn file_of(name: &str) -> String {
    format!("{name}.onnx")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_card_of_another_model_or_of_other_bytes_is_refused() {
        let digest = sha256(b"model");
        let text = |name: &str, digest: &str| format!(r#"{{"name": "{name}", "sha256": "{digest}"}}"#);
        let card = ModelCard::parse(&text("harbour", &digest), "harbour", b"model").unwrap();
        assert_eq!(
            (card.file.as_str(), card.licence.as_str()),
            ("harbour.onnx", "unknown")
        );
        let error = ModelCard::parse(&text("harbour", &digest), "dock", b"model").unwrap_err();
        assert_eq!(error, "it is the card of `harbour`");
        let error = ModelCard::parse(&text("harbour", &digest), "harbour", b"another").unwrap_err();
        assert!(error.starts_with("its SHA-256 is "), "{error}");
        let error =
            ModelCard::parse(r#"{"name": "harbour", "license": "MIT"}"#, "harbour", b"model").unwrap_err();
        assert!(error.contains("unknown field `license`"), "{error}");
    }

    #[test]
    fn an_enhancer_declares_how_it_takes_a_picture() {
        let card = |fields: &str| {
            let digest = sha256(b"model");
            let text = format!(r#"{{"name": "net", "sha256": "{digest}", {fields}}}"#);
            ModelCard::parse(&text, "net", b"model")
        };
        let declared =
            card(r#""role": "enhancer", "input_scale": "-1..1", "layout": "NHWC", "size": "multiple of 32""#);
        let expected = PictureInput {
            scale: InputScale::Signed,
            layout: Layout::ChannelsLast,
            size: SizeRule::MultipleOf(32),
        };
        assert_eq!(declared.unwrap().picture_input(), expected);
        let usual = card(r#""role": "metric""#).unwrap();
        assert_eq!(
            (usual.input_scale, usual.size),
            (Some(InputScale::Unit), Some(SizeRule::Any))
        );
    }

    #[test]
    fn fields_of_another_role_are_refused_together() {
        let refused = |fields: &str| {
            let digest = sha256(b"model");
            let text = format!(r#"{{"name": "net", "sha256": "{digest}", {fields}}}"#);
            ModelCard::parse(&text, "net", b"model").unwrap_err()
        };
        let error = refused(r#""layout": "NHWC", "size": "any""#);
        assert!(
            error.contains("`layout` belongs to enhancers") && error.contains("`size` belongs to enhancers"),
            "{error}"
        );
        let error = refused(r#""role": "enhancer", "scale": 255"#);
        assert!(error.contains("use `input_scale`"), "{error}");
        let error = refused(r#""role": "enhancer", "size": "multiple of 0""#);
        assert!(error.contains("`multiple of N`"), "{error}");
        assert!(refused(r#""role": "judge""#).contains("judge"));
    }
}
