//! `fathom enhance`: enhances a picture of the user.

use std::path::PathBuf;

use cli::exit::Failure;
use cli::files;
use enhance::Method;

/// Options of `fathom enhance`.
#[derive(clap::Args)]
#[command(after_long_help = methods())]
pub(crate) struct Arguments {
    /// Enhancement method
    #[arg(value_parser = method)]
    method: Method,
    /// Picture to enhance (PNG, JPEG or WebP; 8 or 16 bit, gray or color)
    input: PathBuf,
    /// Where to write the result (.png, .jpg or .webp)
    output: PathBuf,
    /// Keep the whole frame instead of the circular mask
    #[arg(long)]
    no_mask: bool,
    /// Also write the mask itself, 255 where the picture is kept
    #[arg(long, value_name = "FILE")]
    mask_out: Option<PathBuf>,
}

/// Every method with its description and its distance from published results.
fn methods() -> String {
    let all = enhance::METHODS.iter().filter_map(|name| Method::parse(name));
    let lines = all.map(|method| {
        let (name, about, published) = (method.name(), method.about(), method.against_published());
        format!("\n  {name}: {about}\n    {published}")
    });
    format!(
        "Methods, with their distance from published results:{}",
        lines.collect::<String>()
    )
}

fn method(name: &str) -> Result<Method, String> {
    Method::parse(name).ok_or_else(|| {
        format!(
            "enhancement `{name}` does not exist; there is {}",
            enhance::METHODS.join(", ")
        )
    })
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let picture = files::read_picture(&arguments.input)?;
    let enhanced = enhance::run(&arguments.method, &picture)
        .map_err(|error| Failure::BadInput(format!("{}: {error}", arguments.input.display())))?;
    eprintln!(
        "{}: {}",
        arguments.method.name(),
        arguments.method.against_published()
    );
    for warning in &enhanced.warnings {
        eprintln!("warning: {warning}");
    }
    let result = if arguments.no_mask {
        &enhanced.unmasked
    } else {
        &enhanced.picture
    };
    files::write_picture(&arguments.output, result)?;
    if let Some(path) = &arguments.mask_out {
        let mask = enhanced
            .mask
            .ok_or_else(|| Failure::BadInput(format!("method {} has no mask", arguments.method.name())))?;
        files::write_picture(path, &mask.into())?;
    }
    Ok(())
}
