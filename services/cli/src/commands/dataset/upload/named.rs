//! Layouts whose names and folders tell the role of each file.

use super::entries::Entry;
use super::layout::Layout;
use super::plan::{Assigned, FolderPlan};
use super::role::Role;
use super::words::{MAPS, PICTURES, Vocabulary, fits_role, is_companion_name, split_numbered};

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
            _ => {
                let reason = format!("the layout {} does not use it", plan.layout.name());
                plan.unused.add(&entry.name, &reason);
            }
        }
    }
    plan.add_scenes(assigned);
}

/// Role and scene of a name.
struct Named {
    role: Role,
    scene: String,
}

/// Reads a role from the file's name, or else from the first folder that has one. The rest of the path is the scene.
fn find_named(entry: &Entry, vocabulary: &Vocabulary) -> Option<Named> {
    let own = split_name(entry.stem(), vocabulary);
    let mut folders: Vec<&str> = entry
        .folder()
        .split('/')
        .filter(|folder| !folder.is_empty())
        .collect();
    let position = folders
        .iter()
        .position(|folder| vocabulary.find_role(folder).is_some());
    let folder_role = position.and_then(|position| vocabulary.find_role(folders.remove(position)));
    let (role, rest) = match (own, folder_role) {
        (Some((role, rest)), Some(folder_role)) if role == folder_role => (role, rest),
        // `rgb/depth_test_1.png` is a picture: the folder decides.
        (_, Some(role)) => (role, entry.stem()),
        (Some((role, rest)), None) => (role, rest),
        (None, None) => return None,
    };
    folders.push(rest);
    Some(Named {
        role,
        scene: folders.join("/"),
    })
}

/// The role of a name such as `depth_0001` or `0001_depth`, and the rest of the name.
fn split_name<'a>(stem: &'a str, vocabulary: &Vocabulary) -> Option<(Role, &'a str)> {
    if let Some((word, number)) = split_numbered(stem)
        && let Some(role) = vocabulary.find_role(word)
    {
        return Some((role, number));
    }
    let mut ends = stem.match_indices(['_', '-', '.']);
    ends.find_map(|(position, _)| {
        let role = vocabulary.find_role(&stem[position + 1..])?;
        (position > 0).then_some((role, &stem[..position]))
    })
}

/// Assigns the files of `NAME.png` with `NAME.ROLE.png`.
pub(super) fn plan_flat(plan: &mut FolderPlan, entries: &[Entry]) {
    let mut assigned = Vec::new();
    for entry in entries {
        let extension = entry.extension();
        let (scene, role) = split_flat(entry);
        let is_picture = PICTURES.contains(&extension.as_str());
        match role {
            Some(role) if fits_role(role, &extension) => assigned.push(Assigned { entry, role, scene }),
            None if is_picture && !is_companion_of_picture(entry, entries) => assigned.push(Assigned {
                entry,
                role: Role::Picture,
                scene,
            }),
            _ if is_companion_name(entry.stem(), &extension) => {
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

/// Whether a picture file is named like a map of another picture, such as `0001_mask.png` of `0001.png`.
fn is_companion_of_picture(entry: &Entry, entries: &[Entry]) -> bool {
    if !is_companion_name(entry.stem(), "") {
        return false;
    }
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
        Some(role) => format!("`{}` must be one of {}", role.field(), MAPS.join(", ")),
        None => "name it NAME.range, NAME.z_depth or NAME.instances with its extension, as its picture NAME"
            .to_owned(),
    };
    format!(
        "{} looks like a part of a scene but is not used; {remedy}, or give --ignore \"{}\"",
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
