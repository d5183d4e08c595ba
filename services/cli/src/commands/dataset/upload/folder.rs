//! Uploads a folder: plans its scenes, uploads them, and reports scenes and unused files.

use std::path::Path;

use cli::exit::Failure;
use cli::plural::count;
use cli::progress::Progress;
use client::Client;

use super::arguments::Arguments;
use super::entries::{Entries, list_entries};
use super::layout::Layout;
use super::named::{choose_layout, plan_words};
use super::nerfstudio::plan_nerfstudio;
use super::plan::FolderPlan;
use super::poses::add_poses;
use super::role::Role;
use super::scene::{describe_summary, upload_scene};
use super::simulators::{add_isaac_parts, add_kubric_camera};
use super::tum::plan_tum;

/// Uploads every scene of a folder. Scenes are identified by their content, so an interrupted upload can be repeated.
pub(super) fn upload_folder(client: &Client, arguments: &Arguments) -> Result<(), Failure> {
    let mut plan = plan_folder(&arguments.rgb, arguments)?;
    if let Some(path) = arguments.pose.as_deref() {
        add_poses(&mut plan, path)?;
    }
    if arguments.pose.is_some() || plan.layout == Layout::Nerfstudio {
        let posed = plan.scenes.iter().filter(|scene| scene.has_pose()).count();
        plan.notes
            .push(format!("{posed} of {} pictures have a pose", plan.scenes.len()));
        if let (0, Some(path)) = (posed, &arguments.pose) {
            plan.problems.push(format!(
                "no frame of {} has a `transform_matrix`; leave --pose out or give a file with poses",
                path.display()
            ));
        }
    }
    if arguments.camera().is_given() && plan.scenes.iter().any(|scene| scene.camera.is_given()) {
        plan.notes
            .push("the camera of the options replaces those of the files".to_owned());
    }
    eprintln!(
        "layout {}: {}",
        plan.layout.name(),
        count(plan.scenes.len(), "scene")
    );
    if plan.problems.is_empty() && plan.scenes.is_empty() {
        report_unused(&plan);
        let message = format!("{} holds no picture of a scene", arguments.rgb.display());
        return Err(Failure::BadInput(message));
    }
    if plan.problems.is_empty() {
        check_cameras(&mut plan, arguments);
        check_options(&mut plan, arguments);
    } else {
        report_unused(&plan);
    }
    plan.check()?;
    for note in &plan.notes {
        eprintln!("note: {note}");
    }
    upload_scenes(client, arguments, &plan)
}

/// Assigns the files of a folder by its layout.
fn plan_folder(folder: &Path, arguments: &Arguments) -> Result<FolderPlan, Failure> {
    let Entries { files, unused } = list_entries(folder, &arguments.ignore)?;
    let mut files = files;
    if let Some(path) = arguments.classes.iter().chain(&arguments.pose).next() {
        let given = path.canonicalize().ok();
        files.retain(|entry| entry.path.canonicalize().ok() != given);
    }
    let layout = choose_layout(arguments.layout, &files)?;
    let mut plan = FolderPlan::new(layout, unused);
    plan.is_recognized = arguments.layout == Layout::Auto;
    match layout {
        Layout::Tum => plan_tum(&mut plan, &files)?,
        Layout::Nerfstudio => plan_nerfstudio(&mut plan, &files)?,
        _ => plan_words(&mut plan, &files),
    }
    match layout {
        Layout::Isaac => add_isaac_parts(&mut plan, &files)?,
        Layout::Kubric => add_kubric_camera(&mut plan, &files)?,
        _ => {}
    }
    Ok(plan)
}

/// A z-depth without a camera is a problem before the first upload.
fn check_cameras(plan: &mut FolderPlan, arguments: &Arguments) {
    if arguments.camera().is_given() {
        return;
    }
    let without = plan
        .scenes
        .iter()
        .filter(|scene| scene.files.contains_key(&Role::ZDepth) && !scene.camera.is_given());
    let (scenes, first) = (
        without.clone().count(),
        without.map(|scene| scene.name.clone()).next(),
    );
    if let Some(first) = first {
        plan.problems.push(format!(
            "{} with a z-depth but without a camera, `{first}` first; give --hfov-deg or --focal-px",
            count(scenes, "scene")
        ));
    }
}

/// Options for parts that no scene has are problems.
fn check_options(plan: &mut FolderPlan, arguments: &Arguments) {
    if arguments.classes.is_some() && !plan.has(Role::Instances) {
        let message = "--classes is for masks, but no scene has a mask";
        plan.problems.push(message.to_owned());
    }
    // An EXR picture may contain distances.
    let may_have_range = plan.has(Role::Range)
        || plan.has(Role::ZDepth)
        || plan
            .scenes
            .iter()
            .flat_map(|scene| scene.files.values())
            .any(|path| {
                path.extension()
                    .is_some_and(|end| end.eq_ignore_ascii_case("exr"))
            });
    if may_have_range {
        return;
    }
    for (option, is_given) in [
        ("--unit-m", arguments.unit_m.is_some()),
        ("--invalid-code", arguments.invalid_code.is_some()),
    ] {
        if is_given {
            let message = format!("{option} is for distances, but no scene has distances");
            plan.problems.push(message);
        }
    }
}

fn upload_scenes(client: &Client, arguments: &Arguments, plan: &FolderPlan) -> Result<(), Failure> {
    let mut progress = Progress::new("upload", "scenes", plan.scenes.len() as u64);
    let mut counts = Counts::default();
    let mut refused = Vec::new();
    for (done, scene) in plan.scenes.iter().enumerate() {
        match upload_scene(client, arguments, plan, scene) {
            Ok(received) => {
                counts.add(&received.value, received.is_new);
                println!("{} {}", received.value.id, scene.name);
                eprintln!("{}: {}", scene.name, describe_summary(&received.value));
            }
            // The others may be good.
            Err(Failure::BadInput(message)) => refused.push(format!("{}: {message}", scene.picture_name())),
            Err(error) => return Err(error),
        }
        progress.set(done as u64 + 1);
    }
    progress.finish();
    report_unused(plan);
    eprintln!("{}", counts.describe());
    match refused.len() {
        0 => Ok(()),
        refusals => Err(Failure::BadInput(format!(
            "{} rejected:\n{}",
            count(refusals, "picture"),
            refused.join("\n")
        ))),
    }
}

fn report_unused(plan: &FolderPlan) {
    if plan.unused.is_empty() {
        eprintln!("all files of the folder are used");
    } else {
        eprintln!("{}", plan.unused.to_table());
    }
}

/// The scenes of a folder by their parts.
#[derive(Default)]
struct Counts {
    scenes: usize,
    known: usize,
    with_range: usize,
    with_mask: usize,
    with_pose: usize,
}

impl Counts {
    fn add(&mut self, scene: &client::SceneView, is_new: bool) {
        self.scenes += 1;
        self.known += usize::from(!is_new);
        self.with_range += usize::from(scene.range_digest.is_some());
        self.with_mask += usize::from(scene.instances_digest.is_some());
        self.with_pose += usize::from(scene.world_from_camera.is_some());
    }

    fn describe(&self) -> String {
        let Self {
            scenes,
            known,
            with_range,
            with_mask,
            with_pose,
        } = self;
        format!(
            "{}: {with_range} with range, {} without, {with_mask} with mask, {with_pose} with pose; {known} uploaded before",
            count(scenes, "scene"),
            scenes - with_range
        )
    }
}
