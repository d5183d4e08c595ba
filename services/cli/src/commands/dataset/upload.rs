//! `fathom upload`: uploads pictures with their range as scenes of the service.

mod arguments;
mod color_masks;
mod entries;
mod folder;
mod from_recording;
mod layout;
mod named;
mod named_role;
mod nerfstudio;
mod plan;
mod poses;
mod role;
mod scene;
mod simulators;
mod tum;
mod words;

use cli::exit::Failure;

pub(crate) use arguments::Arguments;
use entries::Unused;
use folder::upload_folder;
use from_recording::{refuse_topics, upload_recording};
use layout::Layout;
use plan::FolderPlan;
use scene::{describe_summary, plan_picture, upload_scene};

use super::recording::is_recording;

/// Runs the command.
pub(crate) fn run(arguments: Arguments) -> Result<(), Failure> {
    if is_recording(&arguments.rgb) {
        return upload_recording(arguments);
    }
    refuse_topics(&arguments)?;
    upload_files(&arguments)
}

fn upload_files(arguments: &Arguments) -> Result<(), Failure> {
    let client = arguments.server.client();
    let named = [&arguments.range, &arguments.z_depth, &arguments.instances];
    if arguments.rgb.is_dir() {
        if named.iter().any(|path| path.is_some()) {
            return Err(Failure::input(
                "--range, --z-depth and --instances are for one picture; the files of a folder are found by their names, see \
                 --layout",
            ));
        }
        return upload_folder(&client, arguments);
    }
    if arguments.layout != Layout::Auto || !arguments.ignore.is_empty() {
        let message = format!(
            "--layout and --ignore are for a folder, but {} is a file",
            arguments.rgb.display()
        );
        return Err(Failure::BadInput(message));
    }
    let plan = FolderPlan::new(Layout::Flat, Unused::default());
    let scene = upload_scene(&client, arguments, &plan, &plan_picture(arguments)?)?;
    println!("{}", scene.value.id);
    eprintln!("{}", describe_summary(&scene.value));
    if !scene.is_new {
        eprintln!("this scene was uploaded before");
    }
    Ok(())
}
