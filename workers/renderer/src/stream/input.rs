//! The input of a stream.

use spec::RangeKind;

/// When the random distributions of the job are drawn.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Vary {
    /// Once: all frames have the values of frame 0 of the job.
    #[default]
    Stream,
    /// For each frame, from its stamp.
    Frame,
}

/// Settings of a stream beyond its job.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StreamOptions {
    /// When distributions are drawn.
    pub vary: Vary,
    /// Whether the metrics of the job are measured.
    pub has_metrics: bool,
    /// Time for a frame, ms: selects the most accurate plan that is expected to meet it. Plans then depend on the machine;
    /// `None` makes them depend on the job alone.
    pub deadline_ms: Option<f64>,
}

/// Order of the samples of a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChannelOrder {
    /// Red, green, blue.
    Rgb,
    /// Blue, green, red.
    Bgr,
    /// As [`Self::Rgb`], then alpha, which is not used.
    Rgba,
    /// As [`Self::Bgr`], then alpha, which is not used.
    Bgra,
    /// Luminance alone.
    Mono,
}

impl ChannelOrder {
    /// All orders with their names.
    pub const ALL: [(&str, Self); 5] = [
        ("rgb", Self::Rgb),
        ("bgr", Self::Bgr),
        ("rgba", Self::Rgba),
        ("bgra", Self::Bgra),
        ("mono", Self::Mono),
    ];

    /// The order of this name.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        let found = Self::ALL.iter().find(|(known, _)| *known == name);
        found.map(|(_, order)| *order)
    }

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        let found = Self::ALL.iter().find(|(_, order)| *order == self);
        found.map_or("", |(name, _)| name)
    }

    /// Samples of a pixel.
    #[must_use]
    pub fn count(self) -> usize {
        match self {
            Self::Mono => 1,
            Self::Rgb | Self::Bgr => 3,
            Self::Rgba | Self::Bgra => 4,
        }
    }

    /// Positions of red, green and blue in a pixel.
    pub(crate) fn positions(self) -> [usize; 3] {
        match self {
            Self::Mono => [0; 3],
            Self::Rgb | Self::Rgba => [0, 1, 2],
            Self::Bgr | Self::Bgra => [2, 1, 0],
        }
    }
}

/// The samples of a picture, row by row and pixel by pixel.
#[derive(Debug, Clone, Copy)]
pub enum PictureSamples<'a> {
    /// 8-bit sRGB codes.
    Srgb(&'a [u8]),
    /// Linear light, white = 1.
    Linear(&'a [f32]),
}

impl PictureSamples<'_> {
    pub(crate) fn count(&self) -> usize {
        match self {
            Self::Srgb(samples) => samples.len(),
            Self::Linear(samples) => samples.len(),
        }
    }
}

/// A picture.
#[derive(Debug, Clone, Copy)]
pub struct StreamPicture<'a> {
    /// Columns and rows.
    pub size: (usize, usize),
    /// Order of the samples of a pixel.
    pub channels: ChannelOrder,
    /// The samples.
    pub samples: PictureSamples<'a>,
}

/// Distances row by row. NaN, infinity, 0 and negative values are pixels without a return.
#[derive(Debug, Clone, Copy)]
pub enum DepthSamples<'a> {
    /// Meters.
    Meters(&'a [f32]),
    /// Whole millimeters.
    Millimeters(&'a [u16]),
}

impl DepthSamples<'_> {
    pub(crate) fn count(&self) -> usize {
        match self {
            Self::Meters(samples) => samples.len(),
            Self::Millimeters(samples) => samples.len(),
        }
    }
}

/// The distance of every pixel.
#[derive(Debug, Clone, Copy)]
pub struct StreamDepth<'a> {
    /// Along the ray, or along the optical axis.
    pub kind: RangeKind,
    /// Columns and rows.
    pub size: (usize, usize),
    /// The distances.
    pub samples: DepthSamples<'a>,
}

impl StreamDepth<'_> {
    /// The name of its field in errors.
    pub(crate) fn field(&self) -> &'static str {
        match self.kind {
            RangeKind::Range => "range_m",
            RangeKind::ZDepth => "z_depth",
        }
    }
}

/// The instance of every pixel row by row, 0 = background.
#[derive(Debug, Clone, Copy)]
pub struct StreamMask<'a> {
    /// Columns and rows.
    pub size: (usize, usize),
    /// The numbers.
    pub numbers: &'a [u16],
}

/// The input of one frame.
#[derive(Debug, Clone, Copy)]
pub struct StreamInput<'a> {
    /// The picture in air.
    pub picture: StreamPicture<'a>,
    /// Distances; without them the stages of the water are skipped.
    pub depth: Option<StreamDepth<'a>>,
    /// Instances, for the labels of a job that was read with them.
    pub instances: Option<StreamMask<'a>>,
    /// The camera matrix `[[fx, 0, cx], [0, fy, cy], [0, 0, 1]]` in px, with the center of the first pixel at (0, 0); by
    /// default the camera of the job.
    pub camera: Option<[[f64; 3]; 3]>,
    /// Time of the picture, ns; by default the number of frames so far.
    pub stamp_ns: Option<u64>,
    /// Rows of the matrix from camera axes (right, down, ahead, 1) to a world whose z axis points up, m.
    pub pose: Option<[[f64; 4]; 4]>,
}
