//! Recordings as folders of scenes, which the Python package unpacks.

use std::ffi::OsString;

use anyhow::{Context, anyhow};
use cli::exit::Failure;
use tempfile::TempDir;

use super::arguments::Arguments;
use super::folder::upload_folder;
use super::layout::Layout;
use crate::commands::dataset::recording::{Given, run_module};

/// Exit status of the module if some frames are missing and the others were written.
const SOME_FRAMES: u8 = 1;
const LIST: &str = "transforms.json";

/// Uploads the frames of a recording as scenes with the names of their times.
pub(super) fn upload_recording(arguments: Arguments) -> Result<(), Failure> {
    check_options(&arguments)?;
    let folder = TempDir::with_prefix("fathom-upload-").context("cannot create a temporary folder")?;
    let status = run_module(&list_arguments(&arguments, &folder))?;
    let is_partial = status == SOME_FRAMES && folder.path().join(LIST).exists();
    if status != 0 && !is_partial {
        return Err(Failure::Reported(status));
    }
    let recording = arguments.rgb.display().to_string();
    let arguments = Arguments {
        rgb: folder.path().to_owned(),
        layout: Layout::Nerfstudio,
        ..arguments
    };
    upload_folder(&arguments.server.client(), &arguments)?;
    match is_partial {
        false => Ok(()),
        true => Err(anyhow!("{recording}: some frames are missing for the reasons above").into()),
    }
}

/// Options for files have no meaning for a recording.
fn check_options(arguments: &Arguments) -> Result<(), Failure> {
    let files = [
        ("--range", arguments.range.is_some()),
        ("--z-depth", arguments.z_depth.is_some()),
        ("--instances", arguments.instances.is_some()),
        ("--classes", arguments.classes.is_some()),
        ("--pose", arguments.pose.is_some()),
        ("--unit-m", arguments.unit_m.is_some()),
        ("--invalid-code", arguments.invalid_code.is_some()),
        ("--scale", arguments.scale.is_some()),
        ("--layout", arguments.layout != Layout::Auto),
        ("--ignore", !arguments.ignore.is_empty()),
    ];
    if let Some((option, _)) = files.iter().find(|(_, is_given)| *is_given) {
        let recording = arguments.rgb.display();
        return Err(Failure::BadInput(format!(
            "{option} is for files, but {recording} is a recording; give its topics, such as --image and --depth"
        )));
    }
    if arguments.image.is_none() {
        let message = format!("{} is a recording; give --image TOPIC", arguments.rgb.display());
        return Err(Failure::BadInput(message));
    }
    Ok(())
}

fn list_arguments(arguments: &Arguments, folder: &TempDir) -> Vec<OsString> {
    let mut options = arguments.recorded.list_given();
    options.extend(arguments.image.iter().map(|topic| Given::new("--image", topic)));
    let every = arguments.every.map(|count| count.to_string());
    options.extend(every.iter().map(|count| Given::new("--every", count)));
    let mut listed = vec![OsString::from("--unpack")];
    listed.extend(options.iter().map(Given::join));
    listed.push("--".into());
    listed.extend([arguments.rgb.clone().into(), folder.path().into()]);
    listed
}

/// Options for recordings have no meaning for files.
pub(super) fn refuse_topics(arguments: &Arguments) -> Result<(), Failure> {
    let mut given: Vec<&str> = arguments.image.iter().map(|_| "--image").collect();
    given.extend(arguments.recorded.list_given().iter().map(|given| given.name));
    given.extend(arguments.every.iter().map(|_| "--every"));
    match given.first() {
        None => Ok(()),
        Some(option) => Err(Failure::BadInput(format!(
            "{option} is for recordings, but {} is none; a recording is a .bag, .mcap or .db3 file or a folder with them",
            arguments.rgb.display()
        ))),
    }
}
