//! `fathom upload`: uploads pictures with their range as scenes of the service.

mod poses;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use cli::exit::Failure;
use cli::files;
use cli::progress::Progress;
use cli::remote::ServerArguments;
use client::{Client, Received, SceneView};
use imaging::codec::{FilePlane, decode_plane};
use serde_json::json;
use ureq::unversioned::multipart::{Form, Part};

/// Options of `fathom upload`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The picture (PNG, JPEG, WebP; NPY or EXR with linear radiance), or a folder of pictures: NAME.png with NAME.range.png or
    /// NAME.z_depth.npy, NAME.instances.png, NAME.classes.json and NAME.pose.json next to it
    rgb: PathBuf,
    /// Distances along the line of sight (16-bit PNG, NPY, or EXR with a channel Z)
    #[arg(long, value_name = "FILE", conflicts_with = "z_depth")]
    range: Option<PathBuf>,
    /// Distances along the optical axis (16-bit PNG, NPY, or EXR with a channel Z)
    #[arg(long, value_name = "FILE")]
    z_depth: Option<PathBuf>,
    /// Meters of one unit of the range file
    #[arg(long, value_name = "METERS")]
    unit_m: Option<f64>,
    /// The code that means "no return" in an integer range file
    #[arg(long, value_name = "CODE")]
    invalid_code: Option<u16>,
    /// Focal length in pixels
    #[arg(long, value_name = "PIXELS", conflicts_with = "hfov_deg")]
    focal_px: Option<f64>,
    /// Horizontal field of view in degrees
    #[arg(long, value_name = "DEGREES")]
    hfov_deg: Option<f64>,
    /// Column of the principal point in pixels [default: the middle]
    #[arg(long, value_name = "PIXELS")]
    cx: Option<f64>,
    /// Row of the principal point in pixels [default: the middle]
    #[arg(long, value_name = "PIXELS")]
    cy: Option<f64>,
    /// Instance mask (8- or 16-bit PNG, 0 = background)
    #[arg(long, value_name = "FILE")]
    instances: Option<PathBuf>,
    /// Classes of the mask's objects: JSON such as {"1": "pile", "2": "chain"}, or categories and segments_info as in COCO's
    /// panoptic annotations. Of a folder: of all its masks, which need not show every object
    #[arg(long, value_name = "FILE")]
    classes: Option<PathBuf>,
    /// Where the camera was: JSON {"world_from_camera": [[…], […], […], [0, 0, 0, 1]]}, the rows of the matrix from camera axes (right,
    /// down, ahead) to the world, meters. Of a folder: the transforms.json of nerfstudio, which names its pictures
    #[arg(long, value_name = "FILE")]
    pose: Option<PathBuf>,
    /// The collection that the scenes join, under the names of their files: a job may then name the collection
    #[arg(long, value_name = "NAME")]
    collection: Option<String>,
    #[command(flatten)]
    server: ServerArguments,
}

/// Optional files next to a picture, by their part of the form.
const COMPANIONS: [&str; 3] = ["range", "z_depth", "instances"];

/// The files of one scene.
struct Files {
    rgb: PathBuf,
    companions: Vec<(&'static str, PathBuf)>,
    classes: Option<PathBuf>,
    /// JSON of where the camera was.
    pose: Option<Vec<u8>>,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let client = arguments.server.client();
    let named = [&arguments.range, &arguments.z_depth, &arguments.instances];
    let named = COMPANIONS.into_iter().zip(named);
    let companions: Vec<_> = named
        .filter_map(|(role, path)| Some((role, path.clone()?)))
        .collect();
    if arguments.rgb.is_dir() {
        if !companions.is_empty() {
            return Err(Failure::input(
                "a folder's range, depth and instance files are found by their names: NAME.range.png, NAME.z_depth.npy, \
                 NAME.instances.png next to NAME.png",
            ));
        }
        return upload_folder(&client, arguments);
    }
    let rgb = arguments.rgb.clone();
    let classes = arguments.classes.clone();
    let pose = arguments.pose.as_deref().map(files::read).transpose()?;
    let files = Files {
        rgb,
        companions,
        classes,
        pose,
    };
    let scene = upload(&client, arguments, &files)?;
    println!("{}", scene.value.id);
    if !scene.is_new {
        eprintln!("this scene was uploaded before");
    }
    Ok(())
}

/// Uploads every picture of a folder with its files. Scenes are identified by their content, so an interrupted upload can be repeated.
fn upload_folder(client: &Client, arguments: &Arguments) -> Result<(), Failure> {
    let mut scenes = scenes(&arguments.rgb)?;
    if scenes.is_empty() {
        let message = format!("{} holds no PNG, JPEG, WebP or EXR", arguments.rgb.display());
        return Err(Failure::BadInput(message));
    }
    if let Some(path) = &arguments.pose {
        let poses = poses::read(path)?;
        for files in scenes.iter_mut().filter(|files| files.pose.is_none()) {
            files.pose = files.rgb.file_stem().and_then(|stem| poses.get(stem).cloned());
        }
        let posed = scenes.iter().filter(|files| files.pose.is_some()).count();
        eprintln!("{posed} of {} pictures have a pose", scenes.len());
    }
    let mut progress = Progress::new("upload", "scenes", scenes.len() as u64);
    let (mut refused, mut known) = (Vec::new(), 0);
    for (done, files) in scenes.iter().enumerate() {
        let name = files.rgb.file_name().unwrap_or_default().to_string_lossy();
        match upload(client, arguments, files) {
            Ok(scene) => {
                known += usize::from(!scene.is_new);
                println!("{} {name}", scene.value.id);
            }
            // The others may be good.
            Err(Failure::BadInput(message)) => refused.push(format!("{name}: {message}")),
            Err(error) => return Err(error),
        }
        progress.set(done as u64 + 1);
    }
    progress.finish();
    let uploaded = scenes.len() - refused.len();
    eprintln!("{uploaded} scenes, {known} of them uploaded before");
    match refused.len() {
        0 => Ok(()),
        count => Err(Failure::BadInput(format!(
            "{count} pictures were refused:\n{}",
            refused.join("\n")
        ))),
    }
}

/// The pictures of a folder, each with its companions.
fn scenes(folder: &Path) -> Result<Vec<Files>, Failure> {
    let is_companion = |path: &PathBuf| {
        let stem = path.file_stem().and_then(|stem| stem.to_str());
        let role = stem.and_then(|stem| stem.rsplit_once('.'));
        role.is_some_and(|(_, role)| COMPANIONS.contains(&role))
    };
    let pictures = files::with_extensions(folder, &["png", "jpg", "jpeg", "webp", "exr"])?.into_iter();
    pictures
        .filter(|path| !is_companion(path))
        .map(|rgb: PathBuf| {
            let companions = COMPANIONS
                .into_iter()
                .filter_map(|role: &'static str| {
                    let named = ["png", "npy", "exr"]
                        .map(|extension| rgb.with_extension(format!("{role}.{extension}")));
                    Some((role, named.into_iter().find(|path| path.is_file())?))
                })
                .collect();
            let beside = |extension: &str| Some(rgb.with_extension(extension)).filter(|path| path.is_file());
            let pose = beside("pose.json").as_deref().map(files::read).transpose()?;
            Ok(Files {
                classes: beside("classes.json"),
                rgb,
                companions,
                pose,
            })
        })
        .collect()
}

/// Uploads one scene.
fn upload(client: &Client, arguments: &Arguments, files: &Files) -> Result<Received<SceneView>, Failure> {
    let companions = files.companions.iter().map(|(role, path)| (*role, path));
    let contents = [("rgb", &files.rgb)]
        .into_iter()
        .chain(companions)
        .map(|(role, path): (&'static str, &PathBuf)| Ok((role, files::read(path)?)));
    let mut contents = contents.collect::<Result<Vec<_>, Failure>>()?;
    let mask = contents.iter().find(|(role, _)| *role == "instances");
    if let Some(classes) = classes(arguments, files, mask.map(|(_, mask)| mask.as_slice()))? {
        contents.push(("classes", classes));
    }
    contents.extend(files.pose.clone().map(|pose| ("pose", pose)));
    // The service refuses fields of a range without a range file.
    let has_range = files.companions.iter().any(|(role, _)| *role != "instances");
    let stem = files
        .rgb
        .file_stem()
        .map(|stem| stem.to_string_lossy().into_owned());
    let number = |value: Option<f64>| value.map(|value| value.to_string());
    let numbers = [
        ("unit_m", number(arguments.unit_m.filter(|_| has_range))),
        (
            "invalid_code",
            number(arguments.invalid_code.filter(|_| has_range).map(f64::from)),
        ),
        ("focal_px", number(arguments.focal_px)),
        ("hfov_deg", number(arguments.hfov_deg)),
        ("cx", number(arguments.cx)),
        ("cy", number(arguments.cy)),
        ("collection", arguments.collection.clone()),
        ("name", arguments.collection.as_ref().and(stem)),
    ];
    let given = numbers
        .iter()
        .filter_map(|(name, value)| Some((*name, value.as_deref()?)));
    let form = given.fold(Form::new(), |form, (name, value)| form.text(name, value));
    let form = contents.iter().fold(form, |form, (name, bytes)| {
        form.part(name, Part::bytes(bytes).file_name(name))
    });
    Ok(client.post_form("/v1/scenes", form)?)
}

/// The classes of a picture, or those of its folder that its mask shows.
fn classes(arguments: &Arguments, files: &Files, mask: Option<&[u8]>) -> Result<Option<Vec<u8>>, Failure> {
    if let Some(path) = &files.classes {
        return Ok(Some(files::read(path)?));
    }
    let (Some(path), Some(mask)) = (&arguments.classes, mask) else {
        return Ok(None);
    };
    let classes = scenes::classes::read(&files::read(path)?);
    let classes = classes.map_err(|wrong| Failure::BadInput(format!("{}:\n{wrong}", path.display())))?;
    let shown: BTreeSet<u16> = match decode_plane(mask) {
        Ok(FilePlane::Codes(codes)) => codes.data().iter().copied().collect(),
        // The service reports the error.
        _ => return Ok(None),
    };
    let shown = classes.only(|number| shown.contains(&number));
    Ok(Some(json!(shown).to_string().into_bytes()))
}
