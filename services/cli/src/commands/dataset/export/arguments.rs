//! The options of `fathom export`.

use std::path::PathBuf;

use cli::remote::ServerArguments;
use spec::ArtifactKind;

use super::files::split::Splits;
use super::format::Format;
use super::object_filter::ObjectFilter;

/// Options of `fathom export`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The dataset
    pub(super) dataset: String,
    /// Layout of the export
    #[arg(long, value_enum, default_value = "folder")]
    pub(super) format: Format,
    /// Which images, such as 'uiqm > 0.8 and water.style in ("muddy")' [default: all]
    #[arg(long, default_value = "", hide_default_value = true)]
    pub(super) filter: String,
    /// Kinds of artifacts, comma-separated; the first one becomes the `file_name` column. Formats add the kinds that they need
    #[arg(long, value_delimiter = ',', default_value = "rgb", value_parser = kind)]
    pub(super) kinds: Vec<String>,
    /// Parts with their shares, such as train=.8,val=.1,test=.1, each in a folder of its name; images of one scene are never in
    /// two parts, and no image changes its part when the dataset grows
    #[arg(long, value_name = "PARTS", value_parser = Splits::parse)]
    pub(super) split: Option<Splits>,
    /// Frames of each file of the formats webdataset and parquet [default: 1000]
    #[arg(long, value_name = "FRAMES", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(super) shard_size: Option<u32>,
    #[command(flatten)]
    pub(super) objects: ObjectFilter,
    /// License for the card, such as cc-by-4.0; the card also lists the licenses of waters and styles
    #[arg(long, alias = "licence", default_value = "other", value_name = "LICENSE")]
    pub(super) license: String,
    /// The folder to fill; existing files with the right digest are kept
    #[arg(long, value_name = "DIR")]
    pub(super) out: PathBuf,
    #[command(flatten)]
    pub(super) server: ServerArguments,
}

impl Arguments {
    /// Frames of each file of a format with shards.
    pub(super) fn frames_per_shard(&self) -> usize {
        const USUAL: u32 = 1000;
        self.shard_size.unwrap_or(USUAL) as usize
    }
}

/// A kind of artifact whose name can be that of a file.
pub(super) fn kind(name: &str) -> Result<String, String> {
    if ArtifactKind::parse(name).is_some()
        && name
            .chars()
            .all(|c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_' || c == '.')
    {
        return Ok(name.to_owned());
    }
    let known: Vec<&str> = ArtifactKind::FIXED.iter().map(|(name, _)| *name).collect();
    Err(format!("the kinds are {} and enhanced.NAME", known.join(", ")))
}
