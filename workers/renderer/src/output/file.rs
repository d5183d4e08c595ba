//! A file of a rendered frame.

use spec::ArtifactEntry;

/// A file of a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct File {
    /// Artifact kind, such as `rgb`.
    pub kind: String,
    /// Such as `image/png`.
    pub media_type: &'static str,
    /// The contents.
    pub bytes: Vec<u8>,
    /// SHA-256 of the bytes, lower-case hex.
    pub digest: String,
}

impl File {
    pub(crate) fn new(kind: String, media_type: &'static str, bytes: Vec<u8>) -> Self {
        let digest = spec::sha256(&bytes);
        Self {
            kind,
            media_type,
            bytes,
            digest,
        }
    }

    /// Its entry in the record.
    pub(crate) fn entry(&self) -> ArtifactEntry {
        ArtifactEntry {
            kind: self.kind.clone(),
            digest: self.digest.clone(),
            bytes: self.bytes.len() as u64,
            media_type: self.media_type.to_owned(),
        }
    }
}

/// The media types of a frame's files, with their file name extensions.
pub const EXTENSIONS: [(&str, &str); 5] = [
    ("image/png", "png"),
    ("image/webp", "webp"),
    ("image/jpeg", "jpg"),
    ("application/x-npy", "npy"),
    ("application/json", "json"),
];

/// The file name extension of a media type, without the dot.
#[must_use]
pub fn extension(media_type: &str) -> &'static str {
    let known = EXTENSIONS.iter().find(|(known, _)| *known == media_type);
    known.map_or("bin", |(_, extension)| extension)
}
