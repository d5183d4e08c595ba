//! Layouts of folders, and how one is recognized.

use std::collections::BTreeSet;

use cli::exit::Failure;

use super::entries::Entry;
use super::named_role::{has_pair, is_list};
use super::role::Role;
use super::words::{GAZEBO, ISAAC, KUBRIC, PARALLEL, Vocabulary, split_numbered};

/// Arrangement of the files of a folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Layout {
    /// The one whose names fit
    Auto,
    /// NAME.png with NAME.range.png, NAME.z_depth.npy, NAME.instances.png, NAME.classes.json, NAME.pose.json
    Flat,
    /// Folders next to each other: rgb/NAME.png, depth/NAME.png, masks/NAME.png; or NAME_rgb.png, NAME_depth.png
    Parallel,
    /// Isaac Sim: rgb_0000.png, distance_to_camera_0000.npy, instance_segmentation_0000.png
    Isaac,
    /// Gazebo: image_0000.png, depth_0000.npy, labels_0000.png, or images/ and labels_maps/
    Gazebo,
    /// Kubric: rgba_00000.png, depth_00000.tiff, segmentation_00000.png, metadata.json
    Kubric,
    /// TUM RGB-D: rgb.txt, depth.txt and groundtruth.txt list the files by time
    Tum,
    /// transforms.json, or transforms_train.json and the like, with the pictures and depths that it names
    Nerfstudio,
    /// SUIM: images/NAME.jpg with masks/NAME.bmp of class colors
    Suim,
}

/// Layouts that typical names identify.
const SPECIFIC: [Layout; 6] = [
    Layout::Isaac,
    Layout::Gazebo,
    Layout::Kubric,
    Layout::Tum,
    Layout::Nerfstudio,
    Layout::Suim,
];

impl Layout {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Flat => "flat",
            Self::Parallel => "parallel",
            Self::Isaac => "isaac",
            Self::Gazebo => "gazebo",
            Self::Kubric => "kubric",
            Self::Tum => "tum",
            Self::Nerfstudio => "nerfstudio",
            Self::Suim => "suim",
        }
    }

    /// The words of a layout of numbered names or of folders.
    pub(super) fn vocabulary(self) -> Option<&'static Vocabulary> {
        match self {
            Self::Isaac => Some(&ISAAC),
            Self::Gazebo => Some(&GAZEBO),
            Self::Kubric => Some(&KUBRIC),
            Self::Parallel | Self::Suim => Some(&PARALLEL),
            Self::Auto | Self::Flat | Self::Tum | Self::Nerfstudio => None,
        }
    }

    /// Whether masks of this layout may have a color for each object.
    pub(super) fn has_color_masks(self) -> bool {
        matches!(self, Self::Isaac | Self::Gazebo)
    }

    /// Recognizes the layout of a folder.
    pub(super) fn detect(entries: &[Entry]) -> Result<Self, Failure> {
        let names = Names::new(entries);
        let fitting: Vec<Self> = SPECIFIC.into_iter().filter(|layout| names.fit(*layout)).collect();
        match fitting[..] {
            [] if names.fit(Self::Parallel) => Ok(Self::Parallel),
            [] => Ok(Self::Flat),
            [only] => Ok(only),
            _ => {
                let listed: Vec<&str> = fitting.iter().map(|layout| layout.name()).collect();
                Err(Failure::BadInput(format!(
                    "the folder fits the layouts {}; choose one with --layout",
                    listed.join(" and ")
                )))
            }
        }
    }
}

/// What the names of a folder have in common.
struct Names<'a> {
    entries: &'a [Entry],
    /// Words of numbered names, such as `depth` of `depth_0001.npy`.
    words: BTreeSet<String>,
    /// Names of all folders.
    folders: BTreeSet<String>,
}

impl<'a> Names<'a> {
    fn new(entries: &'a [Entry]) -> Self {
        let words = entries.iter().filter_map(|entry| split_numbered(entry.stem()));
        let folders = entries
            .iter()
            .flat_map(|entry| entry.folder().split('/').map(str::to_ascii_lowercase));
        Self {
            entries,
            words: words.map(|(word, _)| word.to_ascii_lowercase()).collect(),
            folders: folders.filter(|folder| !folder.is_empty()).collect(),
        }
    }

    fn has_word(&self, words: &[&str]) -> bool {
        words.iter().any(|word| self.words.contains(*word))
    }

    fn has_folder(&self, folders: &[&str]) -> bool {
        folders.iter().any(|folder| self.folders.contains(*folder))
    }

    fn has_file(&self, name: &str) -> bool {
        self.entries.iter().any(|entry| entry.file_name() == name)
    }

    fn is_isaac(&self) -> bool {
        const OWN: &[&str] = &[
            "distance_to_camera",
            "distance_to_image_plane",
            "instance_segmentation",
            "semantic_segmentation",
            "bounding_box_2d_tight",
            "bounding_box_2d_loose",
        ];
        self.has_word(&["rgb"]) && self.has_word(OWN)
    }

    fn is_kubric(&self) -> bool {
        self.has_word(&["rgba"])
            && (self.has_word(&["depth", "segmentation"]) || self.has_file("data_ranges.json"))
    }

    /// Whether the names of the pictures and of another role follow the words, as names or as folders.
    fn has_roles(&self, words: &BTreeSet<String>, vocabulary: &Vocabulary) -> bool {
        let roles: BTreeSet<Role> = words
            .iter()
            .filter_map(|word| vocabulary.find_role(word))
            .collect();
        roles.contains(&Role::Picture) && roles.len() > 1
    }

    fn fit(&self, layout: Layout) -> bool {
        match layout {
            Layout::Isaac => self.is_isaac(),
            Layout::Kubric => self.is_kubric(),
            Layout::Gazebo => {
                let has_maps = self.has_folder(&["labels_maps", "colored_maps"]);
                let is_named =
                    self.has_roles(&self.words, &GAZEBO) && !self.has_roles(&self.folders, &PARALLEL);
                has_maps || (is_named && !self.is_isaac() && !self.is_kubric())
            }
            Layout::Tum => self.has_file("rgb.txt") && self.has_file("depth.txt"),
            Layout::Nerfstudio => self.entries.iter().any(|entry| is_list(entry.file_name())),
            Layout::Suim => {
                let mut masks = self
                    .entries
                    .iter()
                    .filter(|entry| entry.folder().ends_with("masks"));
                self.has_folder(&["images"])
                    && self.has_folder(&["masks"])
                    && masks.all(|entry| entry.extension() == "bmp")
            }
            Layout::Parallel => has_pair(self.entries, &PARALLEL),
            Layout::Auto | Layout::Flat => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    fn entries(names: &[&str]) -> Vec<Entry> {
        let entry = |name: &&str| Entry {
            path: PathBuf::from(name),
            name: (*name).to_owned(),
        };
        names.iter().map(entry).collect()
    }

    #[test]
    fn each_layout_is_recognized_by_its_names() {
        let folders: [(&[&str], Layout); 15] = [
            (&["a.png", "a.range.npy"], Layout::Flat),
            (&["shot_1.jpg", "shot_2.jpg"], Layout::Flat),
            (&["rgb/1.png", "depth/1.png"], Layout::Parallel),
            (&["rgb/rgb_1.png", "depth/depth_1.png"], Layout::Parallel),
            (&["rgb_0000.png", "distance_to_camera_0000.npy"], Layout::Isaac),
            (
                &[
                    "cam/rgb/rgb_0000.png",
                    "cam/instance_segmentation/instance_segmentation_0000.png",
                ],
                Layout::Isaac,
            ),
            (&["image_0001.png", "depth_0001.tiff"], Layout::Gazebo),
            (
                &["images/image_0001.png", "labels_maps/labels_0001.png"],
                Layout::Gazebo,
            ),
            (
                &["rgba_00000.png", "depth_00000.tiff", "metadata.json"],
                Layout::Kubric,
            ),
            (
                &["rgb.txt", "depth.txt", "rgb/1.5.png", "depth/1.6.png"],
                Layout::Tum,
            ),
            (&["images/d_r_1.jpg", "masks/d_r_1.bmp"], Layout::Suim),
            (&["transforms_train.json", "train/r_0.png"], Layout::Nerfstudio),
            (&["0000_rgb.png", "0000_depth.png"], Layout::Parallel),
            (&["img_1.png", "seg_1.png"], Layout::Parallel),
            (
                &["JPEGImages/1.jpg", "SegmentationObject/1.png"],
                Layout::Parallel,
            ),
        ];
        for (names, layout) in folders {
            assert_eq!(Layout::detect(&entries(names)).unwrap(), layout, "{names:?}");
        }
        let both = entries(&["transforms.json", "rgb.txt", "depth.txt"]);
        let error = Layout::detect(&both).unwrap_err().to_string();
        assert!(error.contains("tum and nerfstudio"), "{error}");
    }
}
