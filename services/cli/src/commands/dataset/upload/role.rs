//! What a file of a folder holds.

/// Part of a scene's form that a file fills.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Role {
    Picture,
    Range,
    ZDepth,
    Instances,
    Classes,
    Pose,
}

impl Role {
    /// Field of the form.
    pub(super) fn field(self) -> &'static str {
        match self {
            Self::Picture => "rgb",
            Self::Range => "range",
            Self::ZDepth => "z_depth",
            Self::Instances => "instances",
            Self::Classes => "classes",
            Self::Pose => "pose",
        }
    }
}
