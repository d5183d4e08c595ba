//! `fathom style-photo`: renders a photo to train a style water from.

use std::path::PathBuf;

use cli::exit::Failure;
use cli::files;
use training::waters::{LOOKS, WaterLook};

/// Options of `fathom style-photo`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The water: atlantic, mediterranean or muddy
    water: String,
    /// Seed of the scene
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Where to write the photo (.png or .webp; .jpg loses texture that training needs)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Some(look) = WaterLook::named(&arguments.water) else {
        let known = LOOKS.map(|look| look.name).join(", ");
        let message = format!("water: there is no look `{}`; there are {known}", arguments.water);
        return Err(Failure::BadInput(message));
    };
    files::write_picture(&arguments.out, &look.photograph(arguments.seed).into())?;
    println!("{}", arguments.out.display());
    Ok(())
}
