//! What a folder becomes: scenes with their files, unused files, and problems.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use cli::exit::Failure;
use serde_json::Value;

use super::entries::{Entry, Unused};
use super::layout::Layout;
use super::role::Role;

/// Numbers of a camera, as the form takes them.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct CameraNumbers {
    pub(super) focal_px: Option<f64>,
    pub(super) hfov_deg: Option<f64>,
    pub(super) cx: Option<f64>,
    pub(super) cy: Option<f64>,
}

impl CameraNumbers {
    pub(super) fn is_given(&self) -> bool {
        self.focal_px.is_some() || self.hfov_deg.is_some()
    }
}

/// A scene to upload.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct ScenePlan {
    /// Name in a collection.
    pub(super) name: String,
    /// Its files by role, at most one of each.
    pub(super) files: BTreeMap<Role, PathBuf>,
    /// The pose in the format of the service, if it is not in a file of the scene.
    pub(super) pose: Option<Vec<u8>>,
    /// The camera, if a file describes it.
    pub(super) camera: CameraNumbers,
    /// Classes of the colors or numbers of its mask, as Isaac Sim writes them.
    pub(super) mask_classes: Option<Value>,
}

impl ScenePlan {
    pub(super) fn has_pose(&self) -> bool {
        self.pose.is_some() || self.files.contains_key(&Role::Pose)
    }

    /// File name of the picture.
    pub(super) fn picture_name(&self) -> String {
        let picture = self.files.get(&Role::Picture).and_then(|path| path.file_name());
        picture.map_or_else(|| self.name.clone(), |name| name.to_string_lossy().into_owned())
    }
}

/// A folder as scenes.
pub(super) struct FolderPlan {
    pub(super) layout: Layout,
    /// Whether the layout was recognized and not chosen: ambiguous names are then problems.
    pub(super) is_recognized: bool,
    pub(super) scenes: Vec<ScenePlan>,
    pub(super) unused: Unused,
    /// Reasons to upload nothing.
    pub(super) problems: Vec<String>,
    /// Readings that are not obvious.
    pub(super) notes: Vec<String>,
    /// Meters of one unit of the distances, if the layout defines it.
    pub(super) unit_m: Option<f64>,
    /// The code for "no distance", if the layout defines it.
    pub(super) invalid_code: Option<u16>,
}

/// A file with its role in the scene of a name.
pub(super) struct Assigned<'a> {
    pub(super) entry: &'a Entry,
    pub(super) role: Role,
    pub(super) scene: String,
}

impl FolderPlan {
    pub(super) fn new(layout: Layout, unused: Unused) -> Self {
        Self {
            layout,
            is_recognized: false,
            scenes: Vec::new(),
            unused,
            problems: Vec::new(),
            notes: Vec::new(),
            unit_m: None,
            invalid_code: None,
        }
    }

    /// Whether any scene has a file of a role.
    pub(super) fn has(&self, role: Role) -> bool {
        self.scenes.iter().any(|scene| scene.files.contains_key(&role))
    }

    /// Adds the files without a role to the unused ones, except the lists of these names.
    pub(super) fn add_unassigned(
        &mut self,
        entries: &[Entry],
        assigned: &[Assigned<'_>],
        lists: &[&str],
        reason: &str,
    ) {
        let used: BTreeSet<&str> = assigned
            .iter()
            .map(|assigned| assigned.entry.name.as_str())
            .chain(lists.iter().copied())
            .collect();
        for entry in entries {
            if !used.contains(entry.name.as_str()) {
                self.unused.add(&entry.name, reason);
            }
        }
    }

    /// Makes a scene of each picture with the other files of its name. Two files of one role, and files without a
    /// picture, are problems.
    pub(super) fn add_scenes(&mut self, assigned: Vec<Assigned<'_>>) {
        let mut scenes: BTreeMap<String, BTreeMap<Role, &Entry>> = BTreeMap::new();
        for Assigned { entry, role, scene } in assigned {
            let files = scenes.entry(scene.clone()).or_default();
            match files.get(&role) {
                None => {
                    files.insert(role, entry);
                }
                Some(other) => self.problems.push(format!(
                    "{} and {} are both `{}` of the scene `{scene}`; rename one or give --ignore",
                    other.name,
                    entry.name,
                    role.field()
                )),
            }
        }
        for (name, mut files) in scenes {
            if !files.contains_key(&Role::Picture) {
                for (role, entry) in files {
                    self.problems.push(format!(
                        "{} is `{}` of the scene `{name}`, which has no picture; give the picture the same name, or give --ignore",
                        entry.name,
                        role.field()
                    ));
                }
                continue;
            }
            if let (Some(range), Some(z_depth)) = (
                files.get(&Role::Range).copied(),
                files.get(&Role::ZDepth).copied(),
            ) {
                let reason = format!("{} holds the distances of the scene", range.name);
                self.unused.add(&z_depth.name, &reason);
                files.remove(&Role::ZDepth);
            }
            self.scenes.push(ScenePlan {
                name,
                files: files
                    .into_iter()
                    .map(|(role, entry)| (role, entry.path.clone()))
                    .collect(),
                ..ScenePlan::default()
            });
        }
    }

    /// Fails with all problems.
    pub(super) fn check(&self) -> Result<(), Failure> {
        /// Most problems that a message lists.
        const MOST: usize = 20;
        if self.problems.is_empty() {
            return Ok(());
        }
        let listed = self.problems[..self.problems.len().min(MOST)].join("\n  ");
        let more = match self.problems.len().saturating_sub(MOST) {
            0 => String::new(),
            more => format!("\n  and {more} more"),
        };
        Err(Failure::BadInput(format!(
            "nothing was uploaded for these reasons (layout {}):\n  {listed}{more}",
            self.layout.name()
        )))
    }
}
