//! Allowed strings.

/// Allowed strings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Names {
    /// One of these.
    Fixed(&'static [&'static str]),
    /// A family of procedural scenes.
    Family,
    /// A water preset.
    Preset,
    /// A user's name for a water.
    WaterName,
    /// Free text.
    Words,
    /// A camera preset.
    Camera,
    /// A sensor preset.
    Sensor,
    /// A style model.
    Style,
    /// An enhancer network, by name or digest.
    Enhancer,
    /// An enhancement method.
    Method,
    /// A user's name for an enhancement.
    Enhancement,
    /// A metric, `name` or `name@profile`.
    Metric,
    /// An artifact kind.
    Artifact,
    /// A dataset's name.
    Dataset,
    /// The id of an uploaded scene.
    SceneId,
    /// A collection of uploaded scenes.
    Collection,
    /// A path on this machine.
    Path,
    /// A mask as a PNG in base64.
    MaskImage,
}

impl Names {
    /// The allowed words if fixed, else a description of the string.
    #[must_use]
    pub fn limit(&self) -> String {
        match self {
            Self::Fixed(words) => words
                .iter()
                .map(|word| format!("`{word}`"))
                .collect::<Vec<_>>()
                .join(", "),
            other => other.describe().to_owned(),
        }
    }

    /// The expected string in messages: `a known style model`.
    #[must_use]
    pub fn describe(&self) -> &'static str {
        match self {
            Self::Fixed(_) => "one of the allowed words",
            Self::Family => "a known scene family",
            Self::Preset => "a known water preset",
            Self::WaterName => "1 to 64 of A-Z a-z 0-9 . _ - that begin with a letter or digit",
            Self::Words => "1 to 1000 characters",
            Self::Camera => "a known camera",
            Self::Sensor => "a known sensor",
            Self::Style => "a known style model",
            Self::Enhancer => "a known enhancer network",
            Self::Method => "a known enhancement method",
            Self::Enhancement => "1 to 32 of a-z 0-9 _ - that begin with a letter, and not `rgb` or `net`",
            Self::Metric => "a known metric",
            Self::Artifact => "a known artifact kind",
            Self::Dataset | Self::Collection => {
                "1 to 100 of a-z 0-9 . _ - that begin with a letter or digit, without `..`"
            }
            Self::SceneId => "the id of an uploaded scene, `scn_…`",
            Self::Path => "a path of 1 to 4096 bytes",
            Self::MaskImage => "a gray PNG in base64, at most 16384 bytes of text",
        }
    }
}
