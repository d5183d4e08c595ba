//! Artifact kinds.

use serde::Deserialize;
use utoipa::openapi::{ObjectBuilder, RefOr, Schema};
use utoipa::{PartialSchema, ToSchema};

use crate::encode::Encode;
use crate::scene_parts::ScenePart;

/// Maximum length of a kind, bytes.
const MAX_NAME_BYTES: usize = 64;

/// Declares the kinds with a fixed name: variant, name, format, and unit and meaning of the file.
macro_rules! artifacts {
    ($($Kind:ident $name:literal $format:ident $about:literal;)*) => {
        /// A file that can be stored for a frame.
        #[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
        #[serde(try_from = "String")]
        pub enum ArtifactKind {
            $(#[doc = $about] $Kind,)*
            /// Result of an enhancement, by its name, or of a step of it, by both names.
            Enhanced(String),
        }

        impl ArtifactKind {
            /// Every kind with a fixed name. The results of enhancements are named `enhanced.NAME`, and those of
            /// their steps `enhanced.NAME.STEP`.
            pub const FIXED: &[(&str, Self)] = &[$(($name, Self::$Kind)),*];

            /// Format, unit and meaning of the file.
            #[must_use]
            pub fn about(&self) -> &'static str {
                match self {
                    $(Self::$Kind => $about,)*
                    Self::Enhanced(name) if name.ends_with(".mask") => "kept part of the enhancement: 8-bit PNG, 255 = kept",
                    Self::Enhanced(_) => "result of the enhancement, 8 bit, in the format of `encode`",
                }
            }

            fn format(&self) -> FileFormat {
                match self {
                    $(Self::$Kind => FileFormat::$format,)*
                    Self::Enhanced(name) if name.ends_with(".mask") => FileFormat::Png,
                    Self::Enhanced(_) => FileFormat::Picture,
                }
            }
        }
    };
}

artifacts! {
    Rgb "rgb" Picture "the final image, 8 bit, in the format of `encode`";
    RgbRight "rgb_right" Picture "the image of the right camera of `camera.stereo`, as `rgb`";
    Clean "clean" Picture "the scene in air, 8 bit, in the format of `encode`";
    Direct "direct" Npy "unscattered light: NPY float32 [h, w, 3], linear, white = 1";
    ForwardScatter "forward_scatter" Npy "forward-scattered light: NPY float32 [h, w, 3], linear, white = 1";
    Backscatter "backscatter" Npy "veiling light along the ray: NPY float32 [h, w, 3], linear, white = 1";
    Scattered "scattered" Picture "the image after the water, 8 bit, in the format of `encode`";
    Styled "styled" Picture "output of the style network, 8 bit, in the format of `encode`";
    Hazed "hazed" Picture "the image after haze, the same as `rgb`";
    Range "range" Png "range along the line of sight: 16-bit PNG, mm, 0 = hole";
    Flow "flow" Npy "motion to the next frame of the path in x and y, px, and its visibility there, 1 or 0: NPY float32 [h, w, 3], NaN without a range";
    Disparity "disparity" Npy "position minus that in `rgb_right` in x and y, px, and its visibility there, 1 or 0: NPY float32 [h, w, 3], NaN without a range";
    Transmittance "transmittance" Npy "transmittance of the water along the ray, 0..1: NPY float32 [h, w, 3]";
    Instances "instances" Png "instance of each pixel, 0 = background: 8- or 16-bit PNG";
    Semantics "semantics" Png "category of each pixel by its number: 8-bit PNG; `categories` lists them";
    SemanticsVisible "semantics.visible" Png "`semantics` with background where the water transmits less than 2 % in every channel: 8-bit PNG";
    Normals "normals" Npy "unit normals in camera axes, right, down, ahead: NPY float32 [h, w, 3]";
    Findings "findings" Png "inspection findings visible in each pixel, as bits: 8-bit PNG; `findings` lists them";
    Boxes "boxes" Json "camera pose and the objects in view with category, box and visibility: JSON, m and px";
    SnowMask "snow_mask" Png "opacity of the marine snow in green: 8-bit PNG, 255 = opaque";
    Raw "raw" Png "codes of the sensor: 16-bit PNG, a mosaic or RGB; black, gain and filters are in the record";
    Valid "valid" Png "part of the output covered by the uploaded image: 8-bit PNG, 255 = inside, 0 = outside";
    Truth "truth" Npy "light by Monte Carlo, three planes, and its standard error, three planes: NPY float32 [h, w, 6], linear, white = 1";
    TruthReport "truth_report" Json "work and accuracy of the Monte Carlo light, and the deviation of the image chain: JSON";
    Preview "preview" Picture "thumbnail of at most 256 px a side, in the format of `encode`";
}

// Its words depend on the vocabulary of the service, which replaces this schema.
impl ToSchema for ArtifactKind {}

impl PartialSchema for ArtifactKind {
    fn schema() -> RefOr<Schema> {
        ObjectBuilder::new().into()
    }
}

enum FileFormat {
    /// An 8-bit picture in the format of `encode`.
    Picture,
    Png,
    Npy,
    Json,
}

impl ArtifactKind {
    /// Unit of the file's numbers; `None` for codes and for several units.
    #[must_use]
    pub fn unit(&self) -> Option<&'static str> {
        match self {
            Self::Range => Some("mm"),
            Self::Raw => Some("DN"),
            Self::Flow | Self::Disparity => Some("px"),
            _ => None,
        }
    }

    /// The enhancement that it belongs to, and the step if it is one.
    #[must_use]
    pub fn enhancement(&self) -> Option<(&str, Option<&str>)> {
        let Self::Enhanced(name) = self else { return None };
        Some(match name.split_once('.') {
            Some((name, step)) => (name, Some(step)),
            None => (name, None),
        })
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

    /// Whether it needs one pose for all rows.
    #[must_use]
    pub fn needs_one_pose(&self) -> bool {
        matches!(self, Self::Flow | Self::Disparity)
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

    /// Every media type of an artifact.
    pub const MEDIA_TYPES: [&str; 5] = [
        "image/png",
        "image/jpeg",
        "image/webp",
        "application/x-npy",
        "application/json",
    ];

    /// Media type of the file for this encoding of images.
    #[must_use]
    pub fn media_type(&self, encode: Encode) -> &'static str {
        match (self.format(), encode) {
            (FileFormat::Picture, Encode::Webp) => "image/webp",
            (FileFormat::Picture, Encode::Jpeg { .. }) => "image/jpeg",
            (FileFormat::Picture | FileFormat::Png, _) => "image/png",
            (FileFormat::Npy, _) => "application/x-npy",
            (FileFormat::Json, _) => "application/json",
        }
    }

    /// Whether it may be missing from a frame: for lack of a scene part, of another camera or of a next frame, or because
    /// an enhancement did not run.
    #[must_use]
    pub fn may_be_absent(&self) -> bool {
        let depends_on_camera = matches!(self, Self::Raw | Self::Flow | Self::RgbRight | Self::Disparity);
        self.needs().is_some() || depends_on_camera || matches!(self, Self::Enhanced(_))
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

    /// Parses a kind: a fixed one, `enhanced.NAME` or `enhanced.NAME.STEP`.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        if let Some(enhanced) = name.strip_prefix("enhanced.") {
            let mut parts = enhanced.splitn(2, '.');
            return (!parts.any(str::is_empty)).then(|| Self::Enhanced(enhanced.to_owned()));
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
        if let Self::Enhanced(name) = self {
            return write!(f, "enhanced.{name}");
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
            assert_eq!(kind.to_string(), *name);
            assert_eq!(ArtifactKind::parse(name).as_ref(), Some(kind));
        }
        let enhanced = ArtifactKind::parse("enhanced.hscm").unwrap();
        assert_eq!(enhanced, ArtifactKind::Enhanced("hscm".to_owned()));
        assert_eq!(enhanced.to_string(), "enhanced.hscm");
    }

    #[test]
    fn other_names_are_none() {
        for name in [
            "",
            "RGB",
            "enhanced.",
            "enhanced.hscm.",
            "enhanced..mask",
            "depth",
        ] {
            assert_eq!(ArtifactKind::parse(name), None, "{name}");
        }
    }
}
