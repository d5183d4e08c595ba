//! The words in names of files and folders that tell their content.

use super::role::Role;

/// Extensions of pictures.
pub(super) const PICTURES: &[&str] = &["png", "jpg", "jpeg", "webp", "bmp", "tif", "tiff", "exr"];
/// Extensions of maps.
pub(super) const MAPS: &[&str] = &["png", "npy", "exr", "tif", "tiff", "bmp", "webp"];
/// Extensions of data that no part of a scene has.
const OTHER_DATA: &[&str] = &["npy", "npz", "pfm", "h5", "hdf5", "mat", "raw", "dpt", "flo"];

/// Words by the role of their file.
pub(super) struct Vocabulary {
    pub(super) picture: &'static [&'static str],
    pub(super) range: &'static [&'static str],
    pub(super) z_depth: &'static [&'static str],
    pub(super) instances: &'static [&'static str],
    pub(super) classes: &'static [&'static str],
}

/// Folders next to each other.
pub(super) const PARALLEL: Vocabulary = Vocabulary {
    picture: &[
        "rgb", "color", "colour", "image", "images", "img", "imgs", "picture", "pictures",
    ],
    range: &["range", "ranges", "distance", "distances"],
    z_depth: &["depth", "depths", "z_depth", "zdepth", "depth_map", "depth_maps"],
    instances: &[
        "instance",
        "instances",
        "mask",
        "masks",
        "segmentation",
        "segmentations",
        "label",
        "labels",
    ],
    classes: &["classes"],
};

/// NVIDIA Isaac Sim, `BasicWriter` of Replicator.
pub(super) const ISAAC: Vocabulary = Vocabulary {
    picture: &["rgb"],
    range: &["distance_to_camera"],
    z_depth: &["distance_to_image_plane"],
    instances: &["instance_segmentation"],
    classes: &[],
};

/// Kubric, whose depth is the distance from the center of the camera.
pub(super) const KUBRIC: Vocabulary = Vocabulary {
    picture: &["rgba", "rgb"],
    range: &["depth"],
    z_depth: &[],
    instances: &["segmentation"],
    classes: &[],
};

/// Cameras of Gazebo.
pub(super) const GAZEBO: Vocabulary = Vocabulary {
    picture: &["image", "images", "rgb", "color", "camera", "frame"],
    range: &["range"],
    z_depth: &["depth", "depth_image", "depths"],
    instances: &[
        "labels",
        "labels_maps",
        "labels_map",
        "segmentation",
        "instances",
        "instance",
    ],
    classes: &[],
};

impl Vocabulary {
    /// The role of a word.
    pub(super) fn find_role(&self, word: &str) -> Option<Role> {
        let word = word.to_ascii_lowercase();
        let words = [
            (Role::Picture, self.picture),
            (Role::Range, self.range),
            (Role::ZDepth, self.z_depth),
            (Role::Instances, self.instances),
            (Role::Classes, self.classes),
        ];
        words
            .into_iter()
            .find(|(_, words)| words.contains(&word.as_str()))
            .map(|(role, _)| role)
    }
}

/// A name as a word and a number, such as `depth` and `0001` of `depth_0001`.
pub(super) fn split_numbered(stem: &str) -> Option<(&str, &str)> {
    let start = stem
        .trim_end_matches(|letter: char| letter.is_ascii_digit())
        .len();
    let word = stem[..start].trim_end_matches(['_', '-', '.']);
    (start < stem.len() && !word.is_empty()).then_some((word, &stem[start..]))
}

/// Whether an extension may belong to a role.
pub(super) fn fits_role(role: Role, extension: &str) -> bool {
    match role {
        Role::Picture => PICTURES.contains(&extension) || extension == "npy",
        Role::Range | Role::ZDepth | Role::Instances => MAPS.contains(&extension),
        Role::Classes | Role::Pose => extension == "json",
    }
}

/// Whether a name without its number tells of data that belongs to pictures, such as `0001_mask`.
pub(super) fn is_companion_name(stem: &str, extension: &str) -> bool {
    const WORDS: &[&str] = &[
        "depth",
        "zdepth",
        "range",
        "distance",
        "disparity",
        "disp",
        "mask",
        "masks",
        "instance",
        "instances",
        "seg",
        "segmentation",
        "semantic",
        "semantics",
        "label",
        "labels",
        "annotation",
        "normal",
        "normals",
        "pose",
        "poses",
        "classes",
        "flow",
        "intrinsics",
    ];
    let lower = stem.to_ascii_lowercase();
    let has_word = lower
        .split(|letter: char| !letter.is_ascii_alphabetic())
        .any(|word| WORDS.contains(&word));
    has_word || OTHER_DATA.contains(&extension)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_numbered_name_has_a_word_and_a_number() {
        assert_eq!(
            split_numbered("distance_to_camera_0001"),
            Some(("distance_to_camera", "0001"))
        );
        assert_eq!(split_numbered("rgb0001"), Some(("rgb", "0001")));
        assert_eq!(split_numbered("0001"), None);
        assert_eq!(split_numbered("rgb_"), None);
    }

    #[test]
    fn names_of_maps_are_told_from_names_of_pictures() {
        for (stem, extension, is_companion) in [
            ("0001_mask", "png", true),
            ("0001.z_depth", "tif", true),
            ("0002.Range", "npy", true),
            ("0003", "npz", true),
            ("0003", "jpg", false),
            ("unmasked", "png", false),
        ] {
            assert_eq!(is_companion_name(stem, extension), is_companion, "{stem}");
        }
    }
}
