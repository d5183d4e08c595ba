//! Artifact kinds.

use serde::Deserialize;

use crate::encode::Encode;
use crate::scene_parts::ScenePart;

const PNG: &str = "image/png";

/// Maximum length of a kind or media type, bytes.
const MAX_NAME_BYTES: usize = 64;

/// Whether a text is one media type and safe as a `Content-Type` header.
#[must_use]
pub fn is_media_type(text: &str) -> bool {
    let parts = text.split_once('/');
    text.len() <= MAX_NAME_BYTES && parts.is_some_and(|(kind, name)| is_token(kind) && is_token(name))
}

fn is_token(text: &str) -> bool {
    !text.is_empty()
        && text
            .bytes()
            .all(|byte| byte.is_ascii_alphanumeric() || b"-+.".contains(&byte))
}

/// A file that can be stored for a frame.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(try_from = "String")]
pub enum ArtifactKind {
    /// Final image.
    Rgb,
    /// Scene in air.
    Clean,
    /// Unscattered light, linear NPY.
    Direct,
    /// Forward-scattered light, linear NPY.
    ForwardScatter,
    /// Veiling light along the ray, linear NPY.
    Backscatter,
    /// Image after the water.
    Scattered,
    /// Output of the style network.
    Styled,
    /// Image after haze; the same as `rgb` before encoding.
    Hazed,
    /// Range in millimeters, 16-bit PNG, 0 = hole.
    Range,
    /// Transmittance, linear NPY.
    Transmittance,
    /// Instance mask, 16-bit PNG.
    Instances,
    /// Category of each pixel, 8-bit PNG.
    Semantics,
    /// Category of each pixel after the water, 8-bit PNG.
    SemanticsVisible,
    /// Unit normals in camera axes, linear NPY.
    Normals,
    /// Inspection findings visible in each pixel as bits, 8-bit PNG.
    Findings,
    /// Objects in view with category, box, transmittance and visibility, and the camera's pose, JSON.
    Boxes,
    /// Opacity of the marine snow in green, 8-bit PNG, 255 = opaque.
    SnowMask,
    /// Sensor codes before development.
    Raw,
    /// Part of the output covered by the uploaded image, 8-bit PNG, 255 = inside.
    Valid,
    /// Monte Carlo light of the frame and its standard error, linear NPY of six planes.
    Truth,
    /// Work and accuracy of the Monte Carlo truth, and the deviation of the image chain, JSON.
    TruthReport,
    /// Result of an enhancement method.
    Enhanced(String),
    /// The circular mask of HSCM, 8-bit PNG.
    HscmMask,
    /// Thumbnail.
    Preview,
}

impl ArtifactKind {
    /// Every kind with a fixed name. The results of enhancements are named `enhanced.<method>`.
    pub const FIXED: [(&'static str, Self); 23] = [
        ("rgb", Self::Rgb),
        ("clean", Self::Clean),
        ("direct", Self::Direct),
        ("forward_scatter", Self::ForwardScatter),
        ("backscatter", Self::Backscatter),
        ("scattered", Self::Scattered),
        ("styled", Self::Styled),
        ("hazed", Self::Hazed),
        ("range", Self::Range),
        ("transmittance", Self::Transmittance),
        ("instances", Self::Instances),
        ("semantics", Self::Semantics),
        ("semantics.visible", Self::SemanticsVisible),
        ("normals", Self::Normals),
        ("findings", Self::Findings),
        ("boxes", Self::Boxes),
        ("snow_mask", Self::SnowMask),
        ("raw", Self::Raw),
        ("valid", Self::Valid),
        ("truth", Self::Truth),
        ("truth_report", Self::TruthReport),
        ("hscm_mask", Self::HscmMask),
        ("preview", Self::Preview),
    ];

    /// Format, unit and meaning of the file.
    #[must_use]
    pub fn about(&self) -> &'static str {
        match self {
            Self::Rgb => "the final image, 8 bit, in the format of `encode`",
            Self::Clean => "the scene in air, 8 bit, in the format of `encode`",
            Self::Direct => "unscattered light: NPY float32 [h, w, 3], linear, white = 1",
            Self::ForwardScatter => "forward-scattered light: NPY float32 [h, w, 3], linear, white = 1",
            Self::Backscatter => "veiling light along the ray: NPY float32 [h, w, 3], linear, white = 1",
            Self::Scattered => "the image after the water, 8 bit, in the format of `encode`",
            Self::Styled => "output of the style network, 8 bit, in the format of `encode`",
            Self::Hazed => "the image after haze, the same as `rgb`",
            Self::Range => "range along the line of sight: 16-bit PNG, mm, 0 = hole",
            Self::Transmittance => "transmittance of the water along the ray, 0..1: NPY float32 [h, w, 3]",
            Self::Instances => "instance of each pixel, 0 = background: 8- or 16-bit PNG",
            Self::Semantics => "category of each pixel by its number: 8-bit PNG; `categories` lists them",
            Self::SemanticsVisible => {
                "`semantics` with background where the water transmits less than 2 % in every channel: 8-bit PNG"
            }
            Self::Normals => "unit normals in camera axes, right, down, ahead: NPY float32 [h, w, 3]",
            Self::Findings => {
                "inspection findings visible in each pixel, as bits: 8-bit PNG; `findings` lists them"
            }
            Self::Boxes => {
                "camera pose and the objects in view with category, box and visibility: JSON, m and px"
            }
            Self::SnowMask => "opacity of the marine snow in green: 8-bit PNG, 255 = opaque",
            Self::Raw => {
                "codes of the sensor: 16-bit PNG, a mosaic or RGB; black, gain and filters are in the record"
            }
            Self::Valid => {
                "part of the output covered by the uploaded image: 8-bit PNG, 255 = inside, 0 = outside"
            }
            Self::Truth => {
                "light by Monte Carlo, three planes, and its standard error, three planes: NPY float32 [h, w, 6], linear, white = 1"
            }
            Self::TruthReport => {
                "work and accuracy of the Monte Carlo light, and the deviation of the image chain: JSON"
            }
            Self::Enhanced(_) => "result of the enhancement, 8 bit, in the format of `encode`",
            Self::HscmMask => "circular mask of HSCM: 8-bit PNG",
            Self::Preview => "thumbnail of at most 256 px a side, in the format of `encode`",
        }
    }

    /// Unit of the file's numbers; `None` for codes and for several units.
    #[must_use]
    pub fn unit(&self) -> Option<&'static str> {
        match self {
            Self::Range => Some("mm"),
            Self::Raw => Some("DN"),
            _ => None,
        }
    }

    /// Whether it needs labels, which are computed only on request.
    #[must_use]
    pub fn needs_labels(&self) -> bool {
        matches!(
            self,
            Self::Semantics | Self::SemanticsVisible | Self::Normals | Self::Findings | Self::Boxes
        )
    }

    /// Whether it needs the Monte Carlo light, which is traced only on request.
    #[must_use]
    pub fn is_traced(&self) -> bool {
        matches!(self, Self::Truth | Self::TruthReport)
    }

    /// The scene part that the artifact requires.
    #[must_use]
    pub fn needs(&self) -> Option<ScenePart> {
        match self {
            Self::Range | Self::Truth | Self::TruthReport => Some(ScenePart::Range),
            Self::Instances | Self::Semantics | Self::SemanticsVisible | Self::Boxes => {
                Some(ScenePart::Instances)
            }
            Self::Normals | Self::Findings => Some(ScenePart::Surfaces),
            _ => None,
        }
    }

    /// Media type of the file for this encoding of images.
    #[must_use]
    pub fn media_type(&self, encode: Encode) -> &'static str {
        match self {
            Self::Rgb
            | Self::Clean
            | Self::Scattered
            | Self::Styled
            | Self::Hazed
            | Self::Enhanced(_)
            | Self::Preview => match encode {
                Encode::Png => PNG,
                Encode::Webp => "image/webp",
                Encode::Jpeg { .. } => "image/jpeg",
            },
            Self::Range
            | Self::Instances
            | Self::Semantics
            | Self::SemanticsVisible
            | Self::Findings
            | Self::SnowMask
            | Self::Raw
            | Self::Valid
            | Self::HscmMask => PNG,
            Self::Direct
            | Self::ForwardScatter
            | Self::Backscatter
            | Self::Transmittance
            | Self::Normals
            | Self::Truth => "application/x-npy",
            Self::Boxes | Self::TruthReport => "application/json",
        }
    }

    /// Whether it may be missing from a frame: for lack of a scene part, or because an enhancement did not run.
    #[must_use]
    pub fn may_be_absent(&self) -> bool {
        self.needs().is_some() || matches!(self, Self::Enhanced(_) | Self::HscmMask | Self::Raw)
    }

    /// Whether a text is the name of a kind and safe in paths and file names. Unknown methods are accepted.
    #[must_use]
    pub fn is_name(text: &str) -> bool {
        text.len() <= MAX_NAME_BYTES
            && text
                .bytes()
                .all(|byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || b"._-".contains(&byte))
            && Self::parse(text).is_some()
    }

    /// Parses a kind: a fixed one or `enhanced.<method>`.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        if let Some(method) = name.strip_prefix("enhanced.") {
            return (!method.is_empty()).then(|| Self::Enhanced(method.to_owned()));
        }
        Self::FIXED
            .iter()
            .find(|(fixed, _)| *fixed == name)
            .map(|(_, kind)| kind.clone())
    }
}

impl TryFrom<String> for ArtifactKind {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        Self::parse(&name).ok_or_else(|| format!("`{name}` is not an artifact kind"))
    }
}

impl std::fmt::Display for ArtifactKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Self::Enhanced(method) = self {
            return write!(f, "enhanced.{method}");
        }
        let name = Self::FIXED
            .iter()
            .find(|(_, kind)| kind == self)
            .map_or("", |(name, _)| name);
        f.write_str(name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_found_by_the_name_it_writes() {
        for (name, kind) in ArtifactKind::FIXED {
            assert_eq!(kind.to_string(), name);
            assert_eq!(ArtifactKind::parse(name), Some(kind));
        }
        let enhanced = ArtifactKind::parse("enhanced.hscm").unwrap();
        assert_eq!(enhanced, ArtifactKind::Enhanced("hscm".to_owned()));
        assert_eq!(enhanced.to_string(), "enhanced.hscm");
    }

    #[test]
    fn other_names_are_none() {
        for name in ["", "RGB", "enhanced.", "depth"] {
            assert_eq!(ArtifactKind::parse(name), None, "{name}");
        }
    }
}
