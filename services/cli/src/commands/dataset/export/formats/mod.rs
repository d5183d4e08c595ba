//! The formats of an export.

mod camera_poses;
pub(crate) mod card;
pub(crate) mod class_numbers;
pub(crate) mod coco;
pub(crate) mod croissant;
pub(crate) mod exact;
pub(crate) mod hf;
pub(crate) mod objects;
pub(crate) mod parquet;
pub(crate) mod recordings;
pub(crate) mod rle;
pub(crate) mod sequences;
mod table_file;
pub(crate) mod tables;
pub(crate) mod webdataset;
pub(crate) mod yolo;

pub(crate) use camera_poses::{colmap, poses, quaternion, transforms, view};
