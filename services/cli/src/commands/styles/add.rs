//! `fathom styles add`: adds a style network to a service.

use std::path::{Path, PathBuf};

use cli::exit::Failure;
use cli::files;
use cli::remote::{Remote, ServerArguments};
use ureq::unversioned::multipart::{Form, Part};

/// Options of `fathom styles add`.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  fathom styles add bay.onnx --licence CC-BY-4.0")]
pub(super) struct Arguments {
    /// The network as ONNX; NAME.card.json beside it, if there is one, says what is not said here
    #[arg(value_name = "FILE")]
    model: PathBuf,
    /// Name by which jobs ask for it [default: that of the file]
    #[arg(long)]
    name: Option<String>,
    /// Terms under which it may be used
    #[arg(long)]
    licence: Option<String>,
    /// What it was trained on
    #[arg(long)]
    source: Option<String>,
    #[command(flatten)]
    server: ServerArguments,
}

/// What a service is told of a network beside its bytes.
pub(crate) struct Card {
    name: String,
    architecture: String,
    source: String,
    licence: String,
    alpha: String,
    caveats: Vec<String>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let stem = arguments.model.file_stem().unwrap_or_default().to_string_lossy();
    let mut card = card_of(&arguments.model, arguments.name.as_deref().unwrap_or(&stem))?;
    if let Some(licence) = &arguments.licence {
        card.licence.clone_from(licence);
    }
    if let Some(source) = &arguments.source {
        card.source.clone_from(source);
    }
    let is_new = add(
        &Remote::with_patience(&arguments.server),
        &files::read(&arguments.model)?,
        &card,
    )?;
    println!("{}", card.name);
    if !is_new {
        eprintln!("this style was added before");
    }
    Ok(())
}

/// What the card file beside a network says of it; empty texts where there is none.
pub(crate) fn card_of(model: &Path, name: &str) -> Result<Card, Failure> {
    let path = model.with_extension("card.json");
    let card: serde_json::Value = if path.is_file() {
        serde_json::from_slice(&files::read(&path)?)
            .map_err(|error| Failure::BadInput(format!("{}: {error}", path.display())))?
    } else {
        serde_json::Value::Null
    };
    let text = |name: &str| card[name].as_str().unwrap_or_default().to_owned();
    let caveats = card["caveats"].as_array().into_iter().flatten();
    Ok(Card {
        name: name.to_owned(),
        architecture: text("architecture"),
        source: text("source"),
        licence: text("licence"),
        alpha: text("alpha"),
        caveats: caveats
            .filter_map(|caveat| caveat.as_str().map(str::to_owned))
            .collect(),
    })
}

/// Adds a network; returns whether it is new to the service.
pub(crate) fn add(remote: &Remote, model: &[u8], card: &Card) -> Result<bool, Failure> {
    let texts = [
        ("name", &card.name),
        ("architecture", &card.architecture),
        ("source", &card.source),
        ("licence", &card.licence),
        ("alpha", &card.alpha),
    ];
    let texts = texts
        .into_iter()
        .chain(card.caveats.iter().map(|caveat| ("caveat", caveat)));
    let given = texts.filter(|(_, text)| !text.is_empty());
    let form = given.fold(Form::new(), |form, (name, text)| form.text(name, text));
    let form = form.part("model", Part::bytes(model).file_name("model.onnx"));
    remote.post_form("/v1/styles", form).map(|(_, is_new)| is_new)
}
