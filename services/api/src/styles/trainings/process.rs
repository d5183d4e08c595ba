//! The training process: `fathom train` on a folder.

use std::ffi::{OsStr, OsString};
use std::path::Path;
use std::time::Duration;

use style::ModelCard;

use super::order::Order;
use crate::http::problem::Problem;
use crate::processes::child::{Allowance, Children, Ended};
use crate::styles::new_style::NewStyle;

/// Progress file in the folder of the order.
pub(super) const PROGRESS: &str = "progress.json";
/// Preview file in the folder of the order.
pub(super) const PREVIEW: &str = "preview.png";
const OUT: &str = "out";

/// An image of 64 Mpx is decoded in a few seconds and needs 1 GiB.
const LOOK: Allowance = Allowance {
    time: Duration::from_secs(60),
    memory_bytes: 3 << 30,
};
/// The maximum number of steps needs a tenth of this on an idle machine. A training needs about 0.2 GiB in addition
/// to the photos.
const TRAIN: Allowance = Allowance {
    time: Duration::from_secs(3600),
    memory_bytes: 4 << 30,
};

/// The name of a photo in the folder of its order; it appears in messages.
pub(crate) fn photo_name(index: usize) -> String {
    format!("photo {}", index + 1)
}

fn arguments(order: &Order) -> Vec<OsString> {
    let folder = order.folder.path();
    let photos = (0..order.photos).map(|index| folder.join(photo_name(index)).into_os_string());
    photos
        .chain(["--name".into(), order.name.clone().into()])
        .collect()
}

/// Rejects unsuitable photos.
pub(super) async fn validate(children: &Children, order: &Order) -> Result<(), Problem> {
    let mut arguments = arguments(order);
    arguments.push("--check".into());
    let ended = run(children, &arguments, LOOK).await?;
    let message = match ended {
        Ended::Well => return Ok(()),
        Ended::Refused(why) => why,
        Ended::Lacking(why) | Ended::Badly(why) => format!("it cannot be checked: {why}"),
    };
    Err(Problem::field("/photo", clean(&message, order.folder.path())))
}

/// Trains a network.
pub(super) async fn train(children: &Children, order: &Order) -> Result<NewStyle, String> {
    let folder = order.folder.path();
    let out = folder.join(OUT);
    let mut arguments = arguments(order);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let options: [(&str, OsString); 8] = [
        ("--seed", order.seed.to_string().into()),
        ("--steps", order.steps.to_string().into()),
        ("--threads", cores.div_ceil(2).to_string().into()),
        ("--progress", folder.join(PROGRESS).into()),
        ("--preview", folder.join(PREVIEW).into()),
        ("--out", out.clone().into()),
        ("--licence", order.licence.clone().into()),
        ("--source", order.source.clone().into()),
    ];
    for (name, value) in options {
        // Joined with `=`, so that a text with a leading dash is not an option.
        let mut option = OsString::from(name);
        option.push("=");
        option.push(value);
        arguments.push(option);
    }
    if order.range {
        arguments.push("--range".into());
    }
    let ended = run(children, &arguments, TRAIN).await;
    match ended.map_err(|problem| problem.to_string())? {
        Ended::Well => {}
        Ended::Refused(why) | Ended::Lacking(why) | Ended::Badly(why) => return Err(clean(&why, folder)),
    }
    let [onnx, card] = ["onnx", "card.json"].map(|extension| {
        let file = out.join(format!("{}.{extension}", order.name));
        std::fs::read(&file).map_err(|error| format!("the training wrote no {extension}: {error}"))
    });
    let (onnx, card) = (onnx?, card?);
    let card: ModelCard = serde_json::from_slice(&card).map_err(|error| format!("its card: {error}"))?;
    let mut new = NewStyle::new(&order.name, onnx).map_err(|problem| problem.to_string())?;
    new.card = card;
    Ok(new)
}

async fn run(children: &Children, arguments: &[OsString], allowance: Allowance) -> Result<Ended, Problem> {
    let arguments: Vec<&OsStr> = arguments.iter().map(OsString::as_os_str).collect();
    children.run("train", &arguments, allowance).await
}

/// Process output without the temporary folder's path.
fn clean(said: &str, folder: &Path) -> String {
    said.replace(&format!("{}/", folder.display()), "")
}
