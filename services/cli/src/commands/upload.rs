//! `fathom upload`: pictures of the user's own with their range, as scenes of the service.

use std::path::{Path, PathBuf};

use cli::exit::Failure;
use cli::files;
use cli::progress::Progress;
use cli::remote::{Remote, ServerArguments};
use ureq::unversioned::multipart::{Form, Part};

/// Options of `fathom upload`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The picture (PNG, JPEG, WebP, or NPY with linear radiance), or a folder of pictures: NAME.png with NAME.range.png or
    /// NAME.z_depth.npy and NAME.instances.png beside it
    rgb: PathBuf,
    /// Distances along the line of sight (16-bit PNG or NPY)
    #[arg(long, value_name = "FILE", conflicts_with = "z_depth")]
    range: Option<PathBuf>,
    /// Distances along the optical axis (16-bit PNG or NPY)
    #[arg(long, value_name = "FILE")]
    z_depth: Option<PathBuf>,
    /// Metres of one unit of the range file
    #[arg(long, value_name = "METRES")]
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
    #[command(flatten)]
    server: ServerArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let remote = Remote::new(&arguments.server);
    if arguments.rgb.is_dir() {
        return folder(&remote, arguments);
    }
    let parts = Parts {
        rgb: arguments.rgb.clone(),
        range: arguments.range.clone(),
        z_depth: arguments.z_depth.clone(),
        instances: arguments.instances.clone(),
    };
    let (id, known) = upload(&remote, arguments, &parts)?;
    println!("{id}");
    if known {
        eprintln!("this scene was uploaded before");
    }
    Ok(())
}

/// The files of one scene.
struct Parts {
    rgb: PathBuf,
    range: Option<PathBuf>,
    z_depth: Option<PathBuf>,
    instances: Option<PathBuf>,
}

/// Uploads every picture of a folder with the files that belong to it. Scenes are found again by their content, so that an
/// interrupted upload is simply repeated.
fn folder(remote: &Remote, arguments: &Arguments) -> Result<(), Failure> {
    if arguments.range.is_some() || arguments.z_depth.is_some() || arguments.instances.is_some() {
        let message = "a folder's range, depth and instance files are found by their names: NAME.range.png, NAME.z_depth.npy, \
                       NAME.instances.png beside NAME.png";
        return Err(Failure::BadInput(message.to_owned()));
    }
    let scenes = scenes(&arguments.rgb)?;
    if scenes.is_empty() {
        let message = format!("{} holds no PNG, JPEG or WebP", arguments.rgb.display());
        return Err(Failure::BadInput(message));
    }
    let mut progress = Progress::new("upload", scenes.len() as u64);
    let (mut refused, mut known) = (Vec::new(), 0);
    for (done, parts) in scenes.iter().enumerate() {
        let name = parts.rgb.file_name().unwrap_or_default().to_string_lossy();
        match upload(remote, arguments, parts) {
            Ok((id, again)) => {
                known += usize::from(again);
                println!("{id} {name}");
            }
            // The others may be good.
            Err(Failure::BadInput(message)) => refused.push(format!("{name}: {message}")),
            Err(error) => return Err(error),
        }
        progress.set(done as u64 + 1);
    }
    progress.finish();
    eprintln!(
        "{} scenes, {known} of them uploaded before",
        scenes.len() - refused.len()
    );
    match refused.is_empty() {
        true => Ok(()),
        false => Err(Failure::BadInput(format!(
            "{} pictures were refused:\n{}",
            refused.len(),
            refused.join("\n")
        ))),
    }
}

const COMPANIONS: [&str; 3] = ["range", "z_depth", "instances"];

/// The pictures of a folder, each with the companions that its name says.
fn scenes(folder: &Path) -> Result<Vec<Parts>, Failure> {
    let role = |path: &Path| {
        let stem = path.file_stem()?.to_str()?;
        let (_, role) = stem.rsplit_once('.')?;
        COMPANIONS.iter().copied().find(|known| *known == role)
    };
    let pictures = files::pictures(folder)?
        .into_iter()
        .filter(|path| role(path).is_none());
    let parts = |rgb: PathBuf| {
        let companion = |role: &str| {
            let named = ["png", "npy"].map(|extension| rgb.with_extension(format!("{role}.{extension}")));
            named.into_iter().find(|path| path.is_file())
        };
        let [range, z_depth, instances] = COMPANIONS.map(companion);
        Parts {
            range,
            z_depth,
            instances,
            rgb,
        }
    };
    Ok(pictures.map(parts).collect())
}

/// Uploads one scene; answers its id, and whether it was known.
fn upload(remote: &Remote, arguments: &Arguments, parts: &Parts) -> Result<(String, bool), Failure> {
    let files = [
        ("rgb", Some(&parts.rgb)),
        ("range", parts.range.as_ref()),
        ("z_depth", parts.z_depth.as_ref()),
        ("instances", parts.instances.as_ref()),
    ];
    let mut contents = Vec::new();
    for (name, path) in files {
        if let Some(path) = path {
            contents.push((name, files::read(path)?));
        }
    }
    let range_file = parts.range.is_some() || parts.z_depth.is_some();
    let numbers = [
        // Without a range file the service would refuse what belongs to one.
        (
            "unit_m",
            arguments.unit_m.filter(|_| range_file).map(|v| v.to_string()),
        ),
        (
            "invalid_code",
            arguments
                .invalid_code
                .filter(|_| range_file)
                .map(|v| v.to_string()),
        ),
        ("focal_px", arguments.focal_px.map(|v| v.to_string())),
        ("hfov_deg", arguments.hfov_deg.map(|v| v.to_string())),
        ("cx", arguments.cx.map(|v| v.to_string())),
        ("cy", arguments.cy.map(|v| v.to_string())),
    ];
    let mut form = Form::new();
    for (name, value) in &numbers {
        if let Some(value) = value {
            form = form.text(name, value);
        }
    }
    for (name, bytes) in &contents {
        form = form.part(name, Part::bytes(bytes).file_name(name));
    }
    let answer = remote.post_form("/v1/scenes", form)?;
    let scene = answer.json()?;
    let id = scene
        .get("id")
        .and_then(serde_json::Value::as_str)
        .unwrap_or_default();
    Ok((id.to_owned(), answer.status == 200))
}
