//! The options of `fathom import`, for a running service and for a data folder.

use std::path::PathBuf;

use crate::remote::OtherServer;
use crate::styles::StyleArguments;

/// Options of `fathom import`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The sharded dataset: a folder or s3://BUCKET/PREFIX
    pub set: String,
    /// Folder of the catalogue and the artifacts; its service must be stopped
    #[arg(long, env = "FATHOM_DATA", default_value = "data", value_name = "DIR")]
    pub data: PathBuf,
    /// With --server: wait until every frame has ended and is imported
    #[arg(long, requires = "server")]
    pub wait: bool,
    /// Print the import as one JSON object
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub style: StyleArguments,
    #[command(flatten)]
    pub server: OtherServer,
}
