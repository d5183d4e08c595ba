//! `fathom bag`: puts the images of a recording into water. The Python package does the work.

use std::ffi::OsString;
use std::path::PathBuf;

use cli::exit::Failure;
use cli::styles::StyleArguments;

use crate::commands::dataset::recording::{CameraArguments, Given, run_module};

/// Options of `fathom bag`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The recording: a .bag, .mcap or .db3 file, or the folder of a ROS 2 recording
    #[arg(value_name = "IN")]
    recording: PathBuf,
    /// The recording to write. Its name states its kind: .bag, .mcap, .db3, or a folder
    out: PathBuf,
    /// The job as JSON; it needs no scene
    #[arg(long, value_name = "FILE")]
    job: PathBuf,
    /// Pictures: Image or CompressedImage
    #[arg(long, value_name = "TOPIC")]
    image: String,
    #[command(flatten)]
    camera: CameraArguments,
    /// Also add the range along the ray, as DEPTH/underwater
    #[arg(long)]
    range: bool,
    /// Draw random values of the job once (`stream`), or for each `frame` [default: stream]
    #[arg(long, value_name = "WHEN")]
    vary: Option<String>,
    #[command(flatten)]
    style: StyleArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match run_module(&list_arguments(arguments))? {
        0 => Ok(()),
        status => Err(Failure::Reported(status)),
    }
}

fn list_arguments(arguments: &Arguments) -> Vec<OsString> {
    let Arguments { style, camera, .. } = arguments;
    let mut options = camera.list_given();
    options.push(Given::new("--job", &arguments.job));
    options.push(Given::new("--image", &arguments.image));
    options.extend(arguments.vary.iter().map(|vary| Given::new("--vary", vary)));
    options.extend(style.styles.iter().map(|folder| Given::new("--styles", folder)));
    options.extend(
        style
            .onnxruntime
            .iter()
            .map(|file| Given::new("--onnxruntime", file)),
    );
    options.extend(arguments.range.then(|| Given::flag("--range")));
    let mut listed: Vec<OsString> = options.iter().map(Given::join).collect();
    listed.push("--".into());
    listed.extend([arguments.recording.clone().into(), arguments.out.clone().into()]);
    listed
}

#[cfg(test)]
mod tests {
    use clap::{FromArgMatches, Parser};

    use super::*;

    #[test]
    fn python_receives_every_option() {
        let given = "fathom bag --job=j.json --image=/a --depth=/b --camera-info=/c --rectified --slop-s=0.1 --stamps=header --world=map \
                     --pose-topic=/p --pose-axes=body --range --vary=frame --styles=s --onnxruntime=o -- in.bag -out.bag";
        let matches = crate::commands::command()
            .try_get_matches_from(given.split_whitespace())
            .unwrap();
        let bag = Arguments::from_arg_matches(matches.subcommand_matches("bag").unwrap()).unwrap();
        let mut forwarded: Vec<String> = list_arguments(&bag)
            .into_iter()
            .map(|argument| argument.into_string().unwrap())
            .collect();
        let mut expected: Vec<&str> = given.split_whitespace().skip(2).collect();
        assert_eq!(forwarded[forwarded.len() - 3..], expected[expected.len() - 3..]);
        forwarded.sort();
        expected.sort();
        assert_eq!(forwarded, expected);
        assert!(crate::commands::Arguments::try_parse_from(["fathom", "bag", "in.bag"]).is_err());
    }
}
