//! The options of `fathom upload`.

use std::path::PathBuf;

use cli::remote::ServerArguments;

use super::layout::Layout;
use super::plan::CameraNumbers;
use crate::commands::dataset::recording::CameraArguments;

/// Use of the channel of distances of an EXR picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum EmbeddedDepth {
    /// Along the optical axis, as renderers write it; needs the camera
    ZDepth,
    /// Along the line of sight
    Range,
    /// Not used
    Ignore,
}

/// Options of `fathom upload`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The picture (PNG, JPEG, WebP, BMP, TIFF or NPY; floats are linear light, as in EXR), a folder of pictures with their
    /// files in one of the layouts, or a ROS recording
    pub(super) rgb: PathBuf,
    /// Arrangement of a folder's files
    #[arg(long, value_enum, default_value = "auto")]
    pub(super) layout: Layout,
    /// Files of a folder to leave out, such as "*_preview.png"; repeatable
    #[arg(long, value_name = "PATTERN")]
    pub(super) ignore: Vec<String>,
    /// Distances along the line of sight (gray PNG, BMP or TIFF, NPY, or EXR with one channel or Z)
    #[arg(long, value_name = "FILE", conflicts_with = "z_depth")]
    pub(super) range: Option<PathBuf>,
    /// Distances along the optical axis (the same formats)
    #[arg(long, value_name = "FILE")]
    pub(super) z_depth: Option<PathBuf>,
    /// Meters of one unit of the range file
    #[arg(long, value_name = "METERS")]
    pub(super) unit_m: Option<f64>,
    /// The code that means "no return" in an integer range file
    #[arg(long, value_name = "CODE")]
    pub(super) invalid_code: Option<u16>,
    /// Factor from the floats of the picture to linear light, where 1 is white: 0.00392156862745098 for 0 to 255
    #[arg(long, value_name = "FACTOR")]
    pub(super) scale: Option<f64>,
    /// Use of the channel of distances of an EXR picture
    #[arg(long, value_enum, default_value = "z-depth")]
    pub(super) embedded_depth: EmbeddedDepth,
    /// Focal length in pixels
    #[arg(long, value_name = "PIXELS", group = "focal")]
    pub(super) focal_px: Option<f64>,
    /// Horizontal field of view in degrees
    #[arg(long, value_name = "DEGREES", group = "focal")]
    pub(super) hfov_deg: Option<f64>,
    /// Column of the principal point in pixels [default: the middle]
    #[arg(long, value_name = "PIXELS", requires = "focal")]
    pub(super) cx: Option<f64>,
    /// Row of the principal point in pixels [default: the middle]
    #[arg(long, value_name = "PIXELS", requires = "focal")]
    pub(super) cy: Option<f64>,
    /// Instance mask, 0 = background (gray or palette PNG, BMP or TIFF, or NPY)
    #[arg(long, value_name = "FILE")]
    pub(super) instances: Option<PathBuf>,
    /// Classes of the mask's objects: JSON such as {"1": "pile", "2": "chain"}, or categories and segments_info as in COCO's
    /// panoptic annotations. Of a folder: of all its masks, which need not show every object
    #[arg(long, value_name = "FILE")]
    pub(super) classes: Option<PathBuf>,
    /// Where the camera was: JSON {"world_from_camera": [[…], […], […], [0, 0, 0, 1]]}, the rows of the matrix from camera axes (right,
    /// down, ahead) to the world, meters. Of a folder: the transforms.json of nerfstudio, which names its pictures
    #[arg(long, value_name = "FILE")]
    pub(super) pose: Option<PathBuf>,
    /// The collection that the scenes join, under the names of their files: a job may then name the collection
    #[arg(long, value_name = "NAME")]
    pub(super) collection: Option<String>,
    /// Pictures of a recording: Image or CompressedImage. The other options with topics are for recordings too
    #[arg(long, value_name = "TOPIC")]
    pub(super) image: Option<String>,
    #[command(flatten)]
    pub(super) recorded: CameraArguments,
    /// Use one of so many frames of a recording
    #[arg(long, value_name = "COUNT")]
    pub(super) every: Option<u64>,
    #[command(flatten)]
    pub(super) server: ServerArguments,
}

impl Arguments {
    pub(super) fn camera(&self) -> CameraNumbers {
        CameraNumbers {
            focal_px: self.focal_px,
            hfov_deg: self.hfov_deg,
            cx: self.cx,
            cy: self.cy,
        }
    }
}
