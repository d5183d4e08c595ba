//! The formats of an export.

pub(crate) mod card;
pub(crate) mod class_numbers;
pub(crate) mod coco;
pub(crate) mod colmap;
pub(crate) mod croissant;
pub(crate) mod hf;
pub(crate) mod objects;
pub(crate) mod parquet;
pub(crate) mod poses;
pub(crate) mod rle;
pub mod tables;
pub(crate) mod transforms;
pub(crate) mod view;
pub(crate) mod webdataset;
pub(crate) mod yolo;
