//! The card of a model: where it comes from and how to feed it.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// What is known of a model. A card file is this as JSON; all but the name and the digest may be left out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
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
    /// What the style weight does with its output.
    #[serde(default)]
    pub alpha: String,
    /// What a user should know.
    #[serde(default)]
    pub caveats: Vec<String>,
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
        let sha256 = sha256_of(onnx);
        if card.sha256 != sha256 {
            return Err(format!(
                "it gives the SHA-256 {} but the model has {sha256}",
                card.sha256
            ));
        }
        Ok(card)
    }

    /// The card of a model that came without one.
    pub(crate) fn absent(name: &str, onnx: &[u8]) -> Self {
        Self {
            name: name.to_owned(),
            file: file_of(name),
            sha256: sha256_of(onnx),
            architecture: unknown(),
            parameters: None,
            source: unknown(),
            licence: unknown(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            alpha: String::new(),
            caveats: vec!["it came without a card".to_owned()],
        }
    }
}

fn file_of(name: &str) -> String {
    format!("{name}.onnx")
}

fn sha256_of(onnx: &[u8]) -> String {
    Sha256::digest(onnx)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_card_of_another_model_or_of_other_bytes_is_refused() {
        let digest = sha256_of(b"model");
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
