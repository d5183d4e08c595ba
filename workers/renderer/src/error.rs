//! Why a frame has no image.

use enhance::EnhanceError;
use imaging::codec::EncodeError;
use optics::chain::ChainError;
use optics::setting::SettingError;
use quality::QualityError;
use scenes::SceneError;
use style::{NetworkError, StyleError};

/// Why a frame has no image.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The description cannot be read or has no such frame.
    #[error(transparent)]
    Resolve(spec::Invalid),
    /// The scene cannot be made or decoded.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A file of this machine cannot be read.
    #[error("cannot read {path}: {source}")]
    File {
        /// The file.
        path: String,
        /// The error of the file system.
        source: std::io::Error,
    },
    /// The frame names an uploaded scene, which only a service has.
    #[error("scene `{id}` was uploaded to a service and can only be rendered by one of its workers")]
    NotHere {
        /// The scene.
        id: String,
    },
    /// Something that the frame needs did not arrive from the service.
    #[error("{what} cannot be fetched: {reason}")]
    Fetch {
        /// The missing input, such as ``scene `scn_…` ``.
        what: String,
        /// What happened.
        reason: String,
        /// Whether another try may succeed.
        retryable: bool,
    },
    /// Water, lamps, patches or snow are invalid.
    #[error("{}", list(.0))]
    Setting(Vec<SettingError>),
    /// The water cannot be applied to this scene.
    #[error(transparent)]
    Chain(#[from] ChainError),
    /// ONNX Runtime is not installed.
    #[error("{0}")]
    RuntimeMissing(String),
    /// The worker does not have the style model.
    #[error("style `{name}` does not exist here; there is {known}")]
    UnknownStyle {
        /// The style.
        name: String,
        /// The styles it has.
        known: String,
    },
    /// The worker does not have the enhancer or metric network.
    #[error("{role} network `{name}` does not exist here; there is {known}")]
    UnknownNetwork {
        /// Its role.
        role: &'static str,
        /// The network.
        name: String,
        /// The networks of the role that it has.
        known: String,
    },
    /// An enhancer or metric network failed.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// The camera has no picture of this scene.
    #[error("camera: {0}")]
    Camera(#[from] camera::PartsError),
    /// The camera's path is invalid.
    #[error("{}", list(.0))]
    Path(Vec<SceneError>),
    /// The light of the frame cannot be traced.
    #[error(transparent)]
    Truth(#[from] truth::NoTruth),
    /// A comparison with the truth at another size has a scene that cannot be rendered at it.
    #[error("only procedural scenes can be rendered at another size; the scene of this frame has files")]
    FixedSize,
    /// A comparison with the truth needs a range.
    #[error("the scene has no range, without which its light cannot be traced")]
    NoRange,
    /// Tracing it would take too many paths.
    #[error(transparent)]
    TruthWork(#[from] spec::truth::TooMuch),
    /// The style network failed.
    #[error(transparent)]
    Style(#[from] StyleError),
    /// A name unknown to this build.
    #[error("{kind} `{name}` does not exist in this version")]
    Unknown {
        /// The kind of thing named.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// An enhancement failed.
    #[error(transparent)]
    Enhance(#[from] EnhanceError),
    /// A metric failed.
    #[error(transparent)]
    Quality(#[from] QualityError),
    /// The result does not fit the file format.
    #[error(transparent)]
    Encode(#[from] EncodeError),
    /// The frame was cancelled.
    #[error("the frame was cancelled")]
    Cancelled,
    /// A bug in this program.
    #[error("rendering panicked: {0}")]
    Panic(String),
}

impl RenderError {
    /// Whether a retry of the same frame may succeed, here or elsewhere. An error caused by the frame's description is permanent.
    #[must_use]
    pub fn retryable(&self) -> bool {
        matches!(self, Self::Panic(_) | Self::Fetch { retryable: true, .. })
    }
}

/// All errors in one line.
fn list(errors: &[impl ToString]) -> String {
    let texts: Vec<String> = errors.iter().map(ToString::to_string).collect();
    texts.join("; ")
}
