//! `fathom styles add`: adds a style network to a service.

use std::path::{Path, PathBuf};

use cli::exit::Failure;
use cli::files;
use cli::remote::ServerArguments;
use client::Client;
use serde::Deserialize;
use style::ModelCard;
use ureq::unversioned::multipart::{Form, Part};

/// Options of `fathom styles add`.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  fathom styles add bay.onnx --license CC-BY-4.0")]
pub(super) struct Arguments {
    /// The network as ONNX; NAME.card.json next to it, if there is one, has the values of missing options
    #[arg(value_name = "FILE")]
    model: PathBuf,
    /// Name for jobs to use [default: that of the file]
    #[arg(long)]
    name: Option<String>,
    /// Its license
    #[arg(long = "license", alias = "licence", value_name = "LICENSE")]
    licence: Option<String>,
    /// The photos that it was trained on
    #[arg(long)]
    source: Option<String>,
    /// The value of white in its inputs and outputs: 255 for networks that take and return 0 to 255 [default: 1]
    #[arg(long, value_name = "VALUE")]
    scale: Option<f32>,
    #[command(flatten)]
    server: ServerArguments,
}

/// The uploaded fields of a card. A card file may have more or fewer fields.
#[derive(Default, Deserialize)]
#[serde(default)]
pub(crate) struct UploadCard {
    name: String,
    architecture: String,
    source: String,
    licence: String,
    alpha: String,
    caveats: Vec<String>,
    scale: Option<f32>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let stem = arguments.model.file_stem().unwrap_or_default().to_string_lossy();
    let mut card = read_upload_card(&arguments.model, arguments.name.as_deref().unwrap_or(&stem))?;
    if let Some(licence) = &arguments.licence {
        card.licence.clone_from(licence);
    }
    if let Some(source) = &arguments.source {
        card.source.clone_from(source);
    }
    card.scale = arguments.scale.or(card.scale);
    let client = arguments.server.patient_client();
    let is_new = add(&client, &files::read(&arguments.model)?, &card)?;
    println!("{}", card.name);
    if !is_new {
        eprintln!("this style was added before");
    }
    Ok(())
}

/// The card file next to a network, under a name; empty texts without a file.
pub(crate) fn read_upload_card(model: &Path, name: &str) -> Result<UploadCard, Failure> {
    let path = model.with_extension("card.json");
    let card: UploadCard = match path.is_file() {
        true => serde_json::from_slice(&files::read(&path)?)
            .map_err(|error| Failure::BadInput(format!("{}: {error}", path.display())))?,
        false => UploadCard::default(),
    };
    Ok(UploadCard {
        name: name.to_owned(),
        ..card
    })
}

/// Adds a network; returns whether it is new to the service.
pub(crate) fn add(client: &Client, model: &[u8], card: &UploadCard) -> Result<bool, Failure> {
    let texts = [
        ("name", &card.name),
        ("architecture", &card.architecture),
        ("source", &card.source),
        ("licence", &card.licence),
        ("alpha", &card.alpha),
    ];
    let scale = card.scale.map(|scale| scale.to_string()).unwrap_or_default();
    let caveats = card.caveats.iter().map(|caveat| ("caveat", caveat));
    let fields: Vec<_> = texts
        .into_iter()
        .chain(caveats)
        .chain([("scale", &scale)])
        .filter(|(_, text)| !text.is_empty())
        .collect();
    let added = client.post_form::<ModelCard>("/v1/styles", || {
        fields
            .iter()
            .fold(Form::new(), |form, (name, text)| form.text(name, text))
            .part("model", Part::bytes(model).file_name("model.onnx"))
    });
    match added.map_err(Failure::from) {
        Err(Failure::BadInput(message)) => {
            Err(Failure::BadInput(message.replace("the scale 255", "--scale 255")))
        }
        added => Ok(added?.is_new),
    }
}
