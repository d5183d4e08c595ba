//! The options of a training.

use std::num::NonZeroU16;
use std::path::PathBuf;

use cli::remote::ServerArguments;
use imaging::Rgb8;
use training::Photo;

/// Options of `fathom train`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// One or more photos of the same water (PNG, JPEG or WebP)
    #[arg(required = true, value_name = "PHOTO")]
    pub(super) photos: Vec<PathBuf>,
    /// Name of the style: 1 to 64 characters of a-z, 0-9, _ and -
    #[arg(long)]
    pub(super) name: String,
    /// Seed of all chance: the same photos, seed and steps give the same bytes
    #[arg(long, default_value_t = 1)]
    pub(super) seed: u64,
    /// Steps; 60 are enough for a first look
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(super) steps: u32,
    /// Make a network that uses the range of each pixel as well: contrast decreases with it as in the photos. Such a style
    /// needs scenes with a range
    #[arg(long)]
    pub(super) range: bool,
    /// Folder for NAME.onnx, NAME.card.json and NAME.sheet.png
    #[arg(long, default_value = ".", value_name = "DIR")]
    pub(super) out: PathBuf,
    /// License of the photo, and so of the model; it is written on the card
    #[arg(
        long = "license",
        alias = "licence",
        default_value = "unknown",
        value_name = "LICENSE"
    )]
    pub(super) licence: String,
    /// Source of the photo; it is written on the card
    #[arg(long, default_value = "trained from photos given by the user")]
    pub(super) source: String,
    /// Threads [default: one for each core]; their number changes no byte
    #[arg(long)]
    pub(super) threads: Option<NonZeroU16>,
    /// Only check whether the photos are suitable
    #[arg(long)]
    pub(super) check: bool,
    /// Do not add the style to the service; without this it is added, if a service runs
    #[arg(long)]
    pub(super) no_add: bool,
    #[command(flatten)]
    pub(super) server: ServerArguments,
    /// File for the progress as JSON, for the service
    #[arg(long, hide = true)]
    pub(super) progress: Option<PathBuf>,
    /// File for a preview of the style, PNG, for the service
    #[arg(long, hide = true)]
    pub(super) preview: Option<PathBuf>,
}

/// A photo with its file's digest.
pub(super) struct Given {
    pub(super) picture: Rgb8,
    pub(super) photo: Photo,
    pub(super) sha256: String,
}
