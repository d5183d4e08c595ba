//! Layouts whose names and folders tell the role of each file.

use super::entries::Entry;
use super::layout::Layout;
use super::named_role::find_named;
use super::plan::{Assigned, FolderPlan};
use super::role::Role;
use super::words::{
    PICTURES, Vocabulary, fits_role, is_companion_folder, is_companion_name, is_data, list_extensions,
};

/// Assigns the files of a layout of words.
pub(super) fn plan_named(plan: &mut FolderPlan, entries: &[Entry], vocabulary: &Vocabulary) {
    let mut assigned = Vec::new();
    for entry in entries {
        match find_named(entry, vocabulary) {
            Some(named) if fits_role(named.role, &entry.extension()) => assigned.push(Assigned {
                entry,
                role: named.role,
                scene: named.scene,
            }),
            // A simulator writes known files; a folder of common names may hold anything.
            _ if plan.is_recognized
                && plan.layout == Layout::Parallel
                && is_companion(entry)
                && is_data(&entry.extension()) =>
            {
                plan.problems.push(describe_lookalike(entry, None));
            }
            _ => {
                let reason = format!("the layout {} does not use it", plan.layout.name());
                plan.unused.add(&entry.name, &reason);
            }
        }
    }
    plan.add_scenes(assigned);
}

/// Assigns the files of `NAME.png` with `NAME.ROLE.png`.
pub(super) fn plan_flat(plan: &mut FolderPlan, entries: &[Entry]) {
    let mut assigned = Vec::new();
    let is_suspect = find_suspects(entries, plan.is_recognized);
    let pictures = extensions_of_pictures(entries);
    for entry in entries {
        let extension = entry.extension();
        let (scene, role) = split_flat(entry);
        let is_picture = pictures.contains(&extension.as_str());
        match role {
            Some(role) if fits_role(role, &extension) => assigned.push(Assigned { entry, role, scene }),
            None if is_picture && !is_suspect(entry) => assigned.push(Assigned {
                entry,
                role: Role::Picture,
                scene,
            }),
            _ if is_picture || is_companion_name(entry.stem(), &extension) => {
                let message = describe_lookalike(entry, role);
                plan.problems.push(message);
            }
            _ => plan
                .unused
                .add(&entry.name, "neither a picture nor a companion of one"),
        }
    }
    plan.add_scenes(assigned);
}

/// Arrays are pictures in a folder without other pictures.
fn extensions_of_pictures(entries: &[Entry]) -> &'static [&'static str] {
    let has_pictures = entries
        .iter()
        .any(|entry| PICTURES.contains(&entry.extension().as_str()));
    if has_pictures { PICTURES } else { &["npy"] }
}

/// Tells which picture files may be maps of others. If the layout was recognized and some pictures have no word for such data in
/// their names, all those that have one; otherwise those that begin with the name of another picture.
fn find_suspects(entries: &[Entry], is_recognized: bool) -> impl Fn(&Entry) -> bool {
    let is_plain = |entry: &Entry| PICTURES.contains(&entry.extension().as_str()) && !is_companion(entry);
    let is_strict = is_recognized && entries.iter().any(is_plain);
    move |entry| is_companion(entry) && (is_strict || is_companion_of_picture(entry, entries))
}

/// Whether a file or one of its folders has the name of data about pictures.
fn is_companion(entry: &Entry) -> bool {
    is_companion_name(entry.stem(), "") || entry.folder().split('/').any(is_companion_folder)
}

/// The scene of a name, and the role that its last part names.
fn split_flat(entry: &Entry) -> (String, Option<Role>) {
    let stem = entry.path_stem();
    let role = entry.stem().rsplit_once('.').and_then(|(_, role)| {
        Some(match role.to_ascii_lowercase().as_str() {
            "range" => Role::Range,
            "z_depth" => Role::ZDepth,
            "instances" => Role::Instances,
            "classes" => Role::Classes,
            "pose" => Role::Pose,
            _ => return None,
        })
    });
    let scene = match (role, stem.rsplit_once('.')) {
        (Some(_), Some((scene, _))) => scene,
        _ => stem,
    };
    (scene.to_owned(), role)
}

/// Whether the name of a picture file begins with that of another, such as `0001_mask.png` of `0001.png`.
fn is_companion_of_picture(entry: &Entry, entries: &[Entry]) -> bool {
    let stem = entry.path_stem();
    entries.iter().any(|other| {
        let rest = stem.strip_prefix(other.path_stem());
        other.name != entry.name
            && PICTURES.contains(&other.extension().as_str())
            && rest.is_some_and(|rest| rest.starts_with(['_', '-', '.', ' ']))
    })
}

fn describe_lookalike(entry: &Entry, role: Option<Role>) -> String {
    let remedy = match role {
        Some(role) => format!("`{}` must be one of {}", role.field(), list_extensions(role)),
        None => "name it NAME.range, NAME.z_depth or NAME.instances with its extension, as its picture NAME; if it is a picture, give --layout flat"
            .to_owned(),
    };
    format!(
        "{} looks like a part of a scene but is not used; {remedy}; to leave it out, give --ignore \"{}\"",
        entry.name,
        entry.file_name()
    )
}

/// Layouts of numbered names.
pub(super) fn plan_words(plan: &mut FolderPlan, entries: &[Entry]) {
    match plan.layout.vocabulary() {
        Some(vocabulary) => plan_named(plan, entries, vocabulary),
        None => plan_flat(plan, entries),
    }
}

/// The layout of a folder that is chosen or recognized.
pub(super) fn choose_layout(layout: Layout, entries: &[Entry]) -> Result<Layout, cli::exit::Failure> {
    match layout {
        Layout::Auto => Layout::detect(entries),
        given => Ok(given),
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::super::entries::Unused;
    use super::*;

    fn plan_of(layout: Layout, names: &[&str]) -> FolderPlan {
        let entry = |name: &&str| Entry {
            path: PathBuf::from(name),
            name: (*name).to_owned(),
        };
        let entries: Vec<Entry> = names.iter().map(entry).collect();
        let mut plan = FolderPlan::new(layout, Unused::default());
        plan.is_recognized = true;
        plan_words(&mut plan, &entries);
        plan
    }

    fn listed(plan: &FolderPlan) -> Vec<String> {
        let scenes = plan.scenes.iter();
        scenes
            .map(|scene| {
                let fields: Vec<&str> = scene.files.keys().map(|role| role.field()).collect();
                format!("{}: {}", scene.name, fields.join(" "))
            })
            .collect()
    }

    #[test]
    fn flat_names_match_whatever_their_case_and_extension() {
        let plan = plan_of(
            Layout::Flat,
            &[
                "0001.png",
                "0001.z_depth.tif",
                "0002.png",
                "0002.Range.npy",
                "sub/0001.png",
                "notes.txt",
            ],
        );
        assert_eq!(
            listed(&plan),
            ["0001: rgb z_depth", "0002: rgb range", "sub/0001: rgb"]
        );
        assert!(plan.problems.is_empty() && !plan.unused.is_empty());
    }

    #[test]
    fn lookalikes_and_duplicates_are_problems() {
        let plan = plan_of(
            Layout::Flat,
            &[
                "0001.png",
                "0001_mask.png",
                "0002.npz",
                "0003.jpg",
                "0003.png",
                "0009.range.npy",
            ],
        );
        let problems = plan.problems.join("\n");
        for name in [
            "0001_mask.png",
            "0002.npz",
            "0003.jpg and 0003.png",
            "0009.range.npy",
        ] {
            assert!(problems.contains(name), "{name}: {problems}");
        }
        assert!(plan.check().is_err());
    }

    #[test]
    fn maps_beside_pictures_are_never_pictures() {
        for names in [
            ["a.png", "mask_a.png"],
            ["a.png", "aDepth.png"],
            ["x_leftImg8bit.png", "x_gtFine_labelIds.png"],
            ["imgs/1.png", "gt/1.png"],
            ["left/1.png", "SegmentationClass/1.png"],
            ["images/1.png", "annotations/1.png"],
        ] {
            let plan = plan_of(Layout::Flat, &names);
            assert!(plan.problems.join("\n").contains(names[1]), "{names:?}");
        }
        let pictures = plan_of(
            Layout::Flat,
            &["depth_test_1.png", "depth_test_2.png", "README.md"],
        );
        assert_eq!((pictures.scenes.len(), pictures.problems.len()), (2, 0));
        let arrays = plan_of(Layout::Flat, &["a.npy", "b.npy"]);
        assert_eq!(listed(&arrays), ["a: rgb", "b: rgb"]);
        let rest = plan_of(Layout::Parallel, &["rgb/1.png", "depth/1.png", "gt/1.png"]);
        assert!(rest.problems.join("\n").contains("gt/1.png"));
        let notes = plan_of(
            Layout::Parallel,
            &["rgb/1.png", "masks/1.png", "masks/readme.txt"],
        );
        assert!(notes.problems.is_empty() && notes.unused.to_table().contains("masks/readme.txt"));
    }

    #[test]
    fn numbered_names_of_each_program_become_scenes() {
        let isaac = [
            "rgb_0000.png",
            "distance_to_camera_0000.npy",
            "instance_segmentation_0000.png",
            "normals_0000.png",
        ];
        let plan = plan_of(Layout::Isaac, &isaac);
        assert_eq!(listed(&plan), ["0000: rgb range instances"]);
        assert!(plan.unused.to_table().contains("normals_0000.png"));
        let kubric = plan_of(
            Layout::Kubric,
            &["rgba_00003.png", "depth_00003.tiff", "segmentation_00003.png"],
        );
        assert_eq!(listed(&kubric), ["00003: rgb range instances"]);
        let gazebo = plan_of(
            Layout::Gazebo,
            &[
                "images/image_0001.png",
                "labels_maps/labels_0001.png",
                "colored_maps/colored_0001.png",
            ],
        );
        assert_eq!(listed(&gazebo), ["0001: rgb instances"]);
        let suffixed = plan_of(Layout::Gazebo, &["a_rgb.png", "a_depth.npy"]);
        assert_eq!(listed(&suffixed), ["a: rgb z_depth"]);
        let parallel = plan_of(
            Layout::Parallel,
            &["rgb/cam0/1.png", "depth/cam0/1.png", "masks/cam0/1_mask.png"],
        );
        assert_eq!(listed(&parallel), ["cam0/1: rgb z_depth instances"]);
    }
}
