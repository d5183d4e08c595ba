//! What formats with times write for each kind of artifact.

use cli::exit::Failure;
use spec::{ArtifactKind, Encode};

use crate::commands::dataset::export::format::{Format, RECORD};

/// The kind of the right pictures of stereo pairs.
pub(crate) const RIGHT: &str = "rgb_right";

/// The name of the distances along the optical axis, which take the place of the range.
pub(crate) const Z_DEPTH: &str = "z_depth";

/// Unit of the distances of a format with times.
pub(crate) fn depth_unit(format: Format) -> &'static str {
    match format {
        Format::Mcap => "m",
        Format::Euroc => "mm",
        Format::Kitti => "1/256 m",
        _ => "1/5000 m",
    }
}

/// The content of a file of a sequence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    Picture,
    RightPicture,
    /// z-depth, computed from the range.
    Depth,
    Mask,
    /// Camera and pose; it becomes no file.
    Record,
}

impl Role {
    /// The role of a kind; `None` for arrays, JSON, thumbnails and codes of sensors.
    pub(crate) fn find(kind: &str) -> Option<Self> {
        match (kind, ArtifactKind::parse(kind)?) {
            (RIGHT, _) => Some(Self::RightPicture),
            (_, ArtifactKind::Range) => Some(Self::Depth),
            (_, ArtifactKind::Preview | ArtifactKind::Raw) => None,
            // Masks are PNG whatever pictures are.
            (_, kind) => match (kind.media_type(Encode::Png), kind.media_type(Encode::Webp)) {
                ("image/png", "image/png") => Some(Self::Mask),
                ("image/png", _) => Some(Self::Picture),
                _ => None,
            },
        }
    }

    /// The role of a kind of [`check_kinds`].
    pub(crate) fn of_checked(kind: &str) -> Self {
        Self::find(kind).unwrap_or(Self::Record)
    }
}

/// Checks that a format with times has a place for every kind, and that the first one is a picture.
pub(crate) fn check_kinds(format: Format, kinds: &[String]) -> Result<(), Failure> {
    let name = format.name();
    if let Some(first) = kinds
        .first()
        .filter(|kind| Role::find(kind) != Some(Role::Picture))
    {
        return Err(Failure::BadInput(format!(
            "--kinds begins with {first}; the format {name} is made of pictures: begin with one, such as rgb"
        )));
    }
    let unplaced: Vec<&str> = kinds
        .iter()
        .map(String::as_str)
        .filter(|kind| *kind != RECORD && Role::find(kind).is_none())
        .collect();
    if unplaced.is_empty() {
        return Ok(());
    }
    Err(Failure::BadInput(format!(
        "the format {name} holds pictures, range and masks, not {}; remove it from --kinds, or choose the format folder",
        unplaced.join(", ")
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_has_its_role() {
        for (kind, role) in [
            ("rgb", Some(Role::Picture)),
            ("enhanced.hscm", Some(Role::Picture)),
            ("rgb_right", Some(Role::RightPicture)),
            ("range", Some(Role::Depth)),
            ("semantics.visible", Some(Role::Mask)),
            ("backscatter", None),
            ("boxes", None),
            ("preview", None),
        ] {
            assert_eq!(Role::find(kind), role, "{kind}");
        }
    }

    #[test]
    fn kinds_without_a_place_and_exports_without_pictures_are_refused() {
        let check = |kinds: &[&str]| {
            let kinds: Vec<String> = kinds.iter().map(|kind| (*kind).to_owned()).collect();
            check_kinds(Format::Tum, &kinds).map_err(|failure| failure.to_string())
        };
        assert_eq!(check(&["clean", "range", "instances", RECORD]), Ok(()));
        assert!(check(&["range", "rgb"]).is_err_and(|message| message.contains("begins with range")));
        let refused = check(&["rgb", "boxes", "flow"]);
        assert!(refused.is_err_and(|message| message.contains("not boxes, flow")));
    }
}
