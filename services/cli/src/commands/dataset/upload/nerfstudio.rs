//! Folders whose `transforms.json`, or one file of each part, names pictures, depths and masks.

use cli::exit::Failure;

use super::entries::Entry;
use super::named_role::is_list;
use super::plan::{Assigned, FolderPlan};
use super::poses::{add_poses, count_common_parts, read};
use super::role::Role;
use super::words::PICTURES;

/// Meters of one unit of a depth file, as nerfstudio reads it by default.
const UNIT_M: f64 = 0.001;

/// Makes a scene of each frame whose picture exists.
pub(super) fn plan_nerfstudio(plan: &mut FolderPlan, entries: &[Entry]) -> Result<(), Failure> {
    let lists: Vec<&Entry> = entries
        .iter()
        .filter(|entry| is_list(entry.file_name()))
        .collect();
    if lists.is_empty() {
        return Err(Failure::input("the layout nerfstudio needs transforms.json"));
    }
    let mut assigned = Vec::new();
    for list in &lists {
        assign_frames(plan, list, entries, &mut assigned)?;
    }
    if assigned.iter().any(|assigned| assigned.role == Role::ZDepth) {
        (plan.unit_m, plan.invalid_code) = (Some(UNIT_M), Some(0));
        plan.notes
            .push("depths are read in millimeters, as nerfstudio does; --unit-m changes it".to_owned());
    }
    let names: Vec<&str> = lists.iter().map(|list| list.name.as_str()).collect();
    let reason = format!("no frame of {} names it", names.join(" or "));
    plan.add_unassigned(entries, &assigned, &names, &reason);
    plan.add_scenes(assigned);
    lists.iter().try_for_each(|list| add_poses(plan, &list.path))
}

/// Assigns the files that a list names.
fn assign_frames<'a>(
    plan: &mut FolderPlan,
    list: &Entry,
    entries: &'a [Entry],
    assigned: &mut Vec<Assigned<'a>>,
) -> Result<(), Failure> {
    for frame in &read(&list.path)?.frames {
        let Some(picture) = find_entry(entries, &frame.file_path) else {
            continue;
        };
        let scene = picture.path_stem().to_owned();
        let maps = [
            (Role::ZDepth, &frame.depth_file_path),
            (Role::Instances, &frame.mask_path),
        ];
        for (role, path) in maps {
            let Some(path) = path else { continue };
            match find_entry(entries, path) {
                Some(entry) => assigned.push(Assigned {
                    entry,
                    role,
                    scene: scene.clone(),
                }),
                None => plan
                    .problems
                    .push(format!("{} names {path}, which does not exist", list.name)),
            }
        }
        assigned.push(Assigned {
            entry: picture,
            role: Role::Picture,
            scene,
        });
    }
    Ok(())
}

/// The file of a path in the folder; programs leave the extension of pictures out.
fn find_entry<'a>(entries: &'a [Entry], path: &str) -> Option<&'a Entry> {
    let path = path.replace('\\', "/");
    let path = path.trim_start_matches("./");
    let exact = entries.iter().find(|entry| entry.name == path);
    exact.or_else(|| {
        let mut fitting = entries.iter().filter(|entry| {
            PICTURES.contains(&entry.extension().as_str())
                && count_common_parts(entry.path_stem(), path).is_some()
        });
        match (fitting.next(), fitting.next()) {
            (Some(only), None) => Some(only),
            _ => None,
        }
    })
}
