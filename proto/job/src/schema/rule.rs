//! Rules across fields.

/// A rule across fields. It applies to a field whose value differs from its default.
///
/// A name without a dot is a field of the same object. A path with dots starts at the description, as in
/// `water.optics`, or names a word of a list, as in `artifacts.truth`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// Requires one of these fields.
    Needs(&'static [&'static str]),
    /// Requires this field in every frame.
    NeedsAlways(&'static str),
    /// Rejects these fields.
    Excludes(&'static [&'static str]),
    /// The number must be below that of this field.
    Below(&'static str),
    /// The number must be at most that of this field.
    AtMost(&'static str),
    /// The value must differ from that of this field.
    Differs(&'static str),
    /// The three numbers must not all be 0.
    NonZero,
    /// The whole number must be odd.
    Odd,
    /// The Monte Carlo truth does not model it, for this reason.
    Untraced(&'static str),
}

/// The artifacts that [`Rule::Untraced`] excludes.
pub(crate) const TRACED: [&str; 2] = ["artifacts.truth", "artifacts.truth_report"];

impl std::fmt::Display for Rule {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Needs(paths) => write!(f, "needs {}", describe(paths)),
            Self::NeedsAlways(path) => write!(f, "needs {} in every frame", describe(&[path])),
            Self::Excludes(paths) => write!(f, "not with {}", describe(paths)),
            Self::Below(path) => write!(f, "below `{path}`"),
            Self::AtMost(path) => write!(f, "at most `{path}`"),
            Self::Differs(path) => write!(f, "not the same as `{path}`"),
            Self::Odd => f.write_str("odd"),
            Self::NonZero => f.write_str("of any length above 0"),
            Self::Untraced(reason) => write!(f, "not with {}: {reason}", describe(&TRACED)),
        }
    }
}

/// Field names joined for a sentence: `` `range` or `z_depth` ``.
pub(crate) fn describe<S: AsRef<str>>(paths: &[S]) -> String {
    paths
        .iter()
        .map(|path| describe_one(path.as_ref()))
        .collect::<Vec<_>>()
        .join(" or ")
}

fn describe_one(path: &str) -> String {
    match path {
        "scene.family" => "a procedural scene".to_owned(),
        "scene.id" => "an uploaded scene".to_owned(),
        "scene.rgb" => "a scene of files".to_owned(),
        "daylight.sun_elevation_deg" => "a sky in `daylight`".to_owned(),
        _ => match path.strip_prefix("artifacts.") {
            Some(kind) => format!("the artifact `{kind}`"),
            None => format!("`{path}`"),
        },
    }
}
