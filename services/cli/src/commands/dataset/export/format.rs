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
        }
    }

    /// Kinds of artifacts that it needs in addition to the requested ones.
    pub(crate) fn kinds(self) -> &'static [&'static str] {
        match self {
            Self::Coco => &["instances", "boxes"],
            Self::Yolo => &["boxes"],
            Self::WebDataset | Self::Parquet | Self::Colmap | Self::Transforms => &[RECORD],
            Self::Folder | Self::Hf => &[],
        }
    }

    /// Whether it lists objects.
    pub(crate) fn has_objects(self) -> bool {
        matches!(self, Self::Coco | Self::Yolo)
    }

    /// Whether many frames share a file.
    pub(crate) fn is_sharded(self) -> bool {
        matches!(self, Self::WebDataset | Self::Parquet)
    }

    /// Whether its frames must have poses.
    pub(crate) fn needs_poses(self) -> bool {
        matches!(self, Self::Colmap | Self::Transforms)
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
