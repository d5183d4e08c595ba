//! The formats of an export, and what each needs of a dataset.

use serde_json::{Value, json};

/// How an export is laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Format {
    /// A folder for each frame, with one file for each kind
    Folder,
    /// Tars of --shard-size frames with their records, as WebDataset reads them
    #[value(name = "webdataset")]
    WebDataset,
    /// Parquet files of --shard-size rows with every column and the bytes of the files
    Parquet,
    /// A folder of images with metadata.parquet, as load_dataset of Hugging Face reads it
    Hf,
    /// Boxes, masks and tracks in annotations.json, as pycocotools reads it
    Coco,
    /// Boxes as text files, and data.yaml
    Yolo,
    /// Cameras and poses of each sequence as a text model of COLMAP
    Colmap,
    /// Cameras and poses of each sequence as transforms.json of nerfstudio
    Transforms,
    /// A file of ROS 2 messages for each sequence: pictures, z-depth, masks, cameras, poses
    Mcap,
    /// Each sequence as in the TUM RGB-D benchmark, with z-depth
    Tum,
    /// Each sequence as in the EuRoC benchmark; stereo pairs as cam0 and cam1
    Euroc,
    /// Sequences as in the odometry benchmark of KITTI
    Kitti,
}

impl Format {
    /// Its name on the command line.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Folder => "folder",
            Self::WebDataset => "webdataset",
            Self::Parquet => "parquet",
            Self::Hf => "hf",
            Self::Coco => "coco",
            Self::Yolo => "yolo",
            Self::Colmap => "colmap",
            Self::Transforms => "transforms",
            Self::Mcap => "mcap",
            Self::Tum => "tum",
            Self::Euroc => "euroc",
            Self::Kitti => "kitti",
        }
    }

    /// Kinds of artifacts that it needs in addition to the requested ones.
    pub(crate) fn kinds(self) -> &'static [&'static str] {
        match self {
            Self::Coco => &["instances", "boxes"],
            Self::Yolo => &["boxes"],
            Self::WebDataset | Self::Parquet | Self::Colmap | Self::Transforms => &[RECORD],
            Self::Tum => &["range", RECORD],
            Self::Mcap | Self::Euroc | Self::Kitti => &[RECORD],
            Self::Folder | Self::Hf => &[],
        }
    }

    /// Whether it lists objects.
    pub(crate) fn has_objects(self) -> bool {
        matches!(self, Self::Coco | Self::Yolo)
    }

    /// Whether its files have a fixed number of frames.
    pub(crate) fn is_sharded(self) -> bool {
        matches!(self, Self::WebDataset | Self::Parquet)
    }

    /// Whether many frames share a file.
    pub(crate) fn shares_files(self) -> bool {
        self.is_sharded() || self == Self::Mcap
    }

    /// Whether its frames have times and are written sequence by sequence.
    pub(crate) fn has_times(self) -> bool {
        self == Self::Mcap || self.has_one_camera()
    }

    /// Whether a sequence has one camera, described once.
    pub(crate) fn has_one_camera(self) -> bool {
        matches!(self, Self::Tum | Self::Euroc | Self::Kitti)
    }

    /// Whether its frames must have poses.
    pub(crate) fn needs_poses(self) -> bool {
        matches!(self, Self::Colmap | Self::Transforms) || self.has_times()
    }

    /// The settings that must not change when an export is continued.
    pub(crate) fn card(
        self,
        dataset: &str,
        split: Option<String>,
        kinds: &[String],
        shard_size: usize,
    ) -> Value {
        if self == Self::Folder {
            return json!({"dataset": dataset, "split": split, "layout": "JOB/FRAME/KIND.EXTENSION"});
        }
        let mut card = json!({"dataset": dataset, "split": split, "format": self.name(), "kinds": kinds});
        if self.is_sharded() {
            card["shard_size"] = shard_size.into();
        }
        card
    }
}

/// The name of a frame's record among its kinds; no artifact has this name.
pub(crate) const RECORD: &str = "record";
