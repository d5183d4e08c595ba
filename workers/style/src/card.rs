//! The card of a model: where it comes from and how to feed it.

use imaging::digest::sha256;
use serde::{Deserialize, Serialize};

use crate::ports::takes;

/// What is known of a model. A card file is this as JSON; all but the name and the digest may be left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Card {
    /// Name by which jobs ask for it.
    pub name: String,
    /// Name of the ONNX file.
    #[serde(default)]
    pub file: String,
    /// SHA-256 of the ONNX file, lower-case hex.
    pub sha256: String,
    /// What kind of network it is.
    #[serde(default = "unknown")]
    pub architecture: String,
    /// How many numbers were trained.
    #[serde(default)]
    pub parameters: Option<u64>,
    /// What it was trained on.
    #[serde(default = "unknown")]
    pub source: String,
    /// Under what terms it may be used.
    #[serde(default = "unknown")]
    pub licence: String,
    /// Its inputs.
    #[serde(default)]
    pub inputs: Vec<String>,
    /// Its outputs.
    #[serde(default)]
    pub outputs: Vec<String>,
    /// Whether it has an input `noise`, which is fed from the job's seed and the frame. Read from the file, whatever a
    /// card file says.
    #[serde(default)]
    pub takes_noise: bool,
    /// Whether it has an input `range`, which is fed from the frame: it cannot repaint a scene without one. Read from the
    /// file, whatever a card file says.
    #[serde(default)]
    pub takes_range: bool,
    /// What the style weight does with its output.
    #[serde(default)]
    pub alpha: String,
    /// What a user should know.
    #[serde(default)]
    pub caveats: Vec<String>,
    /// How it was trained, if `fathom train` made it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub training: Option<Training>,
    /// How far its color table is from the network, if that was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table: Option<TableDistance>,
}

/// How a model came about: enough to make it again, and how well it does.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Training {
    /// SHA-256 of each photo's file.
    pub photos: Vec<String>,
    /// Seed of all chance.
    pub seed: u64,
    /// Steps asked for.
    pub steps: usize,
    /// The step whose weights were kept; 0: the color transfer alone.
    pub kept_step: usize,
    /// Mean losses of the steps that led to it.
    pub losses: Parts,
    /// Losses on new scenes.
    pub held_out: Parts,
    /// The same for the color transfer alone.
    #[serde(rename = "held_out_colour_transfer")]
    pub held_out_color_transfer: Parts,
    /// What the network does beyond its color map on new scenes: root mean square, of 255.
    pub branch_rms_255: f64,
    /// Version of the trainer.
    pub code_version: String,
}

/// Parts of a loss; lower is better.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parts {
    /// Distance of the texture from the photo's.
    pub texture: f64,
    /// Distance of the colors from the photo's.
    #[serde(rename = "colour")]
    pub color: f64,
    /// Share of the content that is lost.
    pub content: f64,
}

/// Distance of the color table from the network on new scenes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableDistance {
    /// Mean absolute difference, of 255.
    pub mean_255: f64,
    /// 99.9th percentile of the absolute difference, of 255.
    pub high_255: f64,
    /// Greatest absolute difference, of 255.
    pub max_255: f64,
    /// Mean structural similarity of the brightness.
    pub ssim: f64,
    /// Mean color difference ΔE (CIE 1976).
    pub delta_e: f64,
}

fn unknown() -> String {
    "unknown".to_owned()
}

impl Card {
    /// The card of the model `name`, from the text of its card file; checked against the name and the bytes of the
    /// model.
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
                "it gives the SHA-256 {} but the model has {digest}",
                card.sha256
            ));
        }
        card.takes_noise = takes(onnx, "noise");
        card.takes_range = takes(onnx, "range");
        Ok(card)
    }

    /// The card of a model that came without one.
    pub(crate) fn absent(name: &str, onnx: &[u8]) -> Self {
        Self {
            name: name.to_owned(),
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
            alpha: String::new(),
            caveats: vec!["it came without a card".to_owned()],
            training: None,
            table: None,
        }
    }
}

/// What the file of a model of this name is called.
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
        let card = Card::parse(&text("harbour", &digest), "harbour", b"model").unwrap();
        assert_eq!(
            (card.file.as_str(), card.licence.as_str()),
            ("harbour.onnx", "unknown")
        );
        let error = Card::parse(&text("harbour", &digest), "dock", b"model").unwrap_err();
        assert_eq!(error, "it is the card of `harbour`");
        let error = Card::parse(&text("harbour", &digest), "harbour", b"another").unwrap_err();
        assert!(error.starts_with("it gives the SHA-256 "), "{error}");
        let error = Card::parse(r#"{"name": "harbour", "license": "MIT"}"#, "harbour", b"model").unwrap_err();
        assert!(error.contains("unknown field `license`"), "{error}");
    }
}
