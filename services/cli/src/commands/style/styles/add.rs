//! `fathom styles add`: adds a style, an enhancer or a metric network to a service.

use std::path::{Path, PathBuf};

use cli::exit::Failure;
use cli::files;
use cli::remote::ServerArguments;
use client::Client;
use serde::Deserialize;
use style::{InputScale, Layout, ModelCard, ModelRole, SizeRule};
use ureq::unversioned::multipart::{Form, Part};

/// Options of `fathom styles add`.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  fathom styles add bay.onnx --license CC-BY-4.0\n  fathom styles add clear.onnx --role enhancer \
                  --input-scale=-1..1 --size 'multiple of 32'"
)]
pub(super) struct Arguments {
    /// The network as ONNX
    #[arg(value_name = "FILE")]
    model: PathBuf,
    /// Card with the values of missing options [default: NAME.card.json next to the network, if there is one]
    #[arg(long, value_name = "FILE")]
    card: Option<PathBuf>,
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
    /// Its use in jobs: a style repaints the water, an enhancer the picture, a metric measures a picture [default: style]
    #[arg(long, value_parser = ModelRole::ALL.map(ModelRole::name))]
    role: Option<String>,
    /// Enhancers and metrics only: the values of black and white [default: 0..1]
    #[arg(long, value_parser = InputScale::ALL.map(InputScale::name), allow_hyphen_values = true)]
    input_scale: Option<String>,
    /// Enhancers and metrics only: the order of the axes [default: NCHW]
    #[arg(long, value_parser = Layout::ALL.map(Layout::name))]
    layout: Option<String>,
    /// Enhancers and metrics only: the sizes that it takes, `any`, `multiple of N` or `fixed WxH` [default: any]
    #[arg(long, value_name = "RULE", value_parser = parse_size)]
    size: Option<String>,
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
    role: String,
    input_scale: String,
    layout: String,
    size: String,
}

fn parse_size(text: &str) -> Result<String, String> {
    text.parse::<SizeRule>().map(|rule| rule.to_string())
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let stem = arguments.model.file_stem().unwrap_or_default().to_string_lossy();
    let name = arguments.name.as_deref().unwrap_or(&stem);
    let mut card = match &arguments.card {
        Some(path) => read_card(path, name)?,
        None => read_upload_card(&arguments.model, name)?,
    };
    for (given, value) in [
        (&arguments.licence, &mut card.licence),
        (&arguments.source, &mut card.source),
        (&arguments.role, &mut card.role),
        (&arguments.input_scale, &mut card.input_scale),
        (&arguments.layout, &mut card.layout),
        (&arguments.size, &mut card.size),
    ] {
        if let Some(given) = given {
            value.clone_from(given);
        }
    }
    card.scale = arguments.scale.or(card.scale);
    let client = arguments.server.patient_client();
    let is_new = add(&client, &files::read(&arguments.model)?, &card)?;
    println!("{}", card.name);
    if !is_new {
        eprintln!("this network was added before");
    }
    Ok(())
}

/// The card file next to a network, under a name; empty texts without a file.
pub(crate) fn read_upload_card(model: &Path, name: &str) -> Result<UploadCard, Failure> {
    let path = model.with_extension("card.json");
    if path.is_file() {
        return read_card(&path, name);
    }
    Ok(UploadCard {
        name: name.to_owned(),
        ..UploadCard::default()
    })
}

fn read_card(path: &Path, name: &str) -> Result<UploadCard, Failure> {
    let card: UploadCard = serde_json::from_slice(&files::read(path)?)
        .map_err(|error| Failure::BadInput(format!("{}: {error}", path.display())))?;
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
        ("role", &card.role),
        ("input_scale", &card.input_scale),
        ("layout", &card.layout),
        ("size", &card.size),
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
