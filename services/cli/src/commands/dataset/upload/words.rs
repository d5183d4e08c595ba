//! The words in names of files and folders that tell their content.

use super::role::Role;

/// Extensions of pictures.
pub(super) const PICTURES: &[&str] = &["png", "jpg", "jpeg", "webp", "bmp", "tif", "tiff", "exr"];
/// Extensions of maps.
const MAPS: &[&str] = &["png", "npy", "exr", "tif", "tiff", "bmp", "webp"];
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

/// Folders next to each other, or names with a word for the role.
pub(super) const PARALLEL: Vocabulary = Vocabulary {
    picture: &[
        "rgb",
        "color",
        "colour",
        "image",
        "images",
        "img",
        "imgs",
        "picture",
        "pictures",
        "photo",
        "photos",
        "frame",
        "frames",
        "jpegimages",
        "leftimg8bit",
        "image_2",
    ],
    range: &["range", "ranges", "distance", "distances"],
    z_depth: &[
        "depth",
        "depths",
        "z_depth",
        "zdepth",
        "depth_map",
        "depth_maps",
        "depthmap",
        "depthmaps",
        "depth_gt",
    ],
    instances: &[
        "instance",
        "instances",
        "mask",
        "masks",
        "seg",
        "segmentation",
        "segmentations",
        "segmentationobject",
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
    let arrays: &[&str] = if role == Role::Picture { &["npy"] } else { &[] };
    extensions_of(role).contains(&extension) || arrays.contains(&extension)
}

/// Whether files of an extension hold pictures or numbers for their pixels.
pub(super) fn is_data(extension: &str) -> bool {
    [PICTURES, MAPS, OTHER_DATA]
        .iter()
        .any(|extensions| extensions.contains(&extension))
}

/// The extensions of a role, for a message.
pub(super) fn list_extensions(role: Role) -> String {
    extensions_of(role).join(", ")
}

fn extensions_of(role: Role) -> &'static [&'static str] {
    match role {
        Role::Picture => PICTURES,
        Role::Range | Role::ZDepth | Role::Instances => MAPS,
        Role::Classes | Role::Pose => &["json"],
    }
}

/// Words for data about pictures, anywhere in a name.
const COMPANIONS: &[&str] = &[
    "depth",
    "depths",
    "depthmap",
    "depthmaps",
    "zdepth",
    "range",
    "ranges",
    "distance",
    "disparity",
    "disp",
    "mask",
    "masks",
    "instance",
    "instances",
    "seg",
    "segmentation",
    "segmentations",
    "semantic",
    "semantics",
    "label",
    "labels",
    "annotation",
    "annotations",
    "groundtruth",
    "normal",
    "normals",
    "pose",
    "poses",
    "classes",
    "flow",
    "intrinsics",
];
/// Words for such data only at the end of a name, such as `0001_gt`.
const LAST_COMPANIONS: &[&str] = &["gt", "msk", "id", "ids", "z", "d"];

/// Whether a name, without its number, is one of data about pictures, such as `0001_mask` or `0001Depth`.
pub(super) fn is_companion_name(stem: &str, extension: &str) -> bool {
    let words = split_words(stem);
    let is_last = words.len() > 1
        && words
            .last()
            .is_some_and(|word| LAST_COMPANIONS.contains(&word.as_str()));
    let has_word = words.iter().any(|word| COMPANIONS.contains(&word.as_str()));
    has_word || is_last || OTHER_DATA.contains(&extension)
}

/// Whether a folder has the name of such data, such as `gt` or `SegmentationClass`.
pub(super) fn is_companion_folder(folder: &str) -> bool {
    let words = split_words(folder);
    let is_short = words.len() == 1 && LAST_COMPANIONS.contains(&words[0].as_str());
    is_short || is_companion_name(folder, "")
}

/// The words of a name in lower case: `leftImg8bit_depthGt` has left, img, bit, depth and gt. Numbers are words of one letter, `0`.
fn split_words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut last = ' ';
    for letter in name.chars() {
        let begins =
            letter.is_uppercase() && last.is_lowercase() || letter.is_ascii_digit() != last.is_ascii_digit();
        if begins || !letter.is_alphanumeric() {
            words.push(String::new());
        }
        if letter.is_alphabetic() {
            words.last_mut().expect("one word").extend(letter.to_lowercase());
        } else if letter.is_ascii_digit() && !last.is_ascii_digit() {
            words.last_mut().expect("one word").push('0');
        }
        last = letter;
    }
    words.retain(|word| !word.is_empty());
    words
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
    fn folders_of_maps_are_told_from_folders_of_pictures() {
        for folder in [
            "SegmentationClass",
            "gt",
            "depthmap",
            "annotations",
            "depth_gt",
            "semantic",
        ] {
            assert!(is_companion_folder(folder), "{folder}");
        }
        for folder in ["JPEGImages", "left", "day_1", "cam0"] {
            assert!(!is_companion_folder(folder), "{folder}");
        }
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
            ("aDepth", "png", true),
            ("frankfurt_000_labelIds", "png", true),
            ("0001_gt", "png", true),
            ("id_0001", "png", false),
            ("z", "png", false),
        ] {
            assert_eq!(is_companion_name(stem, extension), is_companion, "{stem}");
        }
    }
}
