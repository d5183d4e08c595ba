//! What of a dataset is exported, and what it cannot give, found out before the first file is written.

use cli::exit::Failure;
use cli::known;
use cli::remote::{Remote, encode, with_query};
use serde::Deserialize;
use serde_json::Value;

use super::Arguments;
use super::frame::RECORD;
use super::posed::PosedScenes;

/// A column of the dataset.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct Column {
    pub(super) name: String,
    /// `number`, `text` or `bool`.
    #[serde(default)]
    pub(super) kind: String,
    #[serde(default)]
    pub(super) unit: Option<String>,
}

/// Images of a dataset with what is wanted of each.
pub(super) struct Selection {
    pub(super) images: u64,
    /// The kinds wanted, the picture first, without repetition.
    pub(super) kinds: Vec<String>,
    pub(super) columns: Vec<Column>,
}

/// What frames must have that may have a pose: a camera path, or an uploaded scene.
const MAY_HAVE_POSE: &str = "(camera.path.frames is not null or scene.id is not null)";
/// Frames whose pose must come from their scene.
const POSE_OF_SCENE: &str = "camera.path.frames is null and scene.id is not null";

impl Selection {
    /// Asks the service. Refuses what no image, or not every image, can give.
    pub(super) fn ask(remote: &Remote, arguments: &Arguments) -> Result<Self, Failure> {
        let dataset = known::dataset(remote, &arguments.dataset)?;
        let columns: Vec<Column> = serde_json::from_value(dataset["columns"].clone()).unwrap_or_default();
        // A column may not pass for the path of a file, which is what readers of image folders take such names for.
        let columns = columns
            .into_iter()
            .filter(|column| !column.name.ends_with("file_name"));
        let mut selection = Self {
            images: 0,
            kinds: kinds(arguments),
            columns: columns.collect(),
        };
        selection.check_kinds(arguments)?;
        selection.images = count(remote, arguments, None)?;
        selection.check_every_image(remote, arguments)?;
        Ok(selection)
    }

    pub(super) fn column_names(&self) -> Vec<String> {
        self.columns.iter().map(|column| column.name.clone()).collect()
    }

    /// The kinds that are artifacts.
    fn artifacts(&self) -> impl Iterator<Item = &String> {
        self.kinds.iter().filter(|kind| *kind != RECORD)
    }

    /// Refuses kinds that no image has.
    fn check_kinds(&self, arguments: &Arguments) -> Result<(), Failure> {
        let there = self
            .columns
            .iter()
            .filter_map(|column| column.name.strip_prefix("artifacts."));
        let there: Vec<&str> = there.collect();
        let missing: Vec<&str> = self
            .artifacts()
            .map(String::as_str)
            .filter(|kind| !there.contains(kind))
            .collect();
        if there.is_empty() || missing.is_empty() {
            return Ok(());
        }
        let needs = match missing.iter().any(|kind| arguments.format.kinds().contains(kind)) {
            true => format!(
                "; the format {} is made of it: name it in /artifacts of the job",
                arguments.format.name()
            ),
            false => String::new(),
        };
        Err(Failure::BadInput(format!(
            "no image of `{}` has an artifact `{}`; there is {}{needs}",
            arguments.dataset,
            missing.join("`, `"),
            there.join(", ")
        )))
    }

    /// Refuses what only some of the images can give.
    fn check_every_image(&self, remote: &Remote, arguments: &Arguments) -> Result<(), Failure> {
        let format = arguments.format.name();
        if arguments.format.needs_poses() {
            let needed = format!(
                "the format {format} is made of poses: give /camera/path in the job, or upload scenes with their pose"
            );
            self.check_images(remote, arguments, MAY_HAVE_POSE, &needed)?;
            let of_scenes = joined(&arguments.filter, Some(POSE_OF_SCENE));
            let lacking = PosedScenes::new(remote).without(&arguments.dataset, &of_scenes)?;
            if let Some(scenes) = lacking {
                return Err(Failure::BadInput(format!(
                    "the format {format} is made of poses, which the scenes {scenes} came without: upload them with `pose`, or leave \
                     their images out with --filter"
                )));
            }
        }
        for kind in self.artifacts() {
            let needed = format!("there is no artifact `{kind}` of them; leave it out of --kinds");
            let condition = format!("artifacts.{kind} is not null");
            self.check_images(remote, arguments, &condition, &needed)?;
        }
        Ok(())
    }

    fn check_images(
        &self,
        remote: &Remote,
        arguments: &Arguments,
        condition: &str,
        needed: &str,
    ) -> Result<(), Failure> {
        let there = count(remote, arguments, Some(condition))?;
        if there >= self.images {
            return Ok(());
        }
        let lacking = self.images - there;
        let or = match there {
            0 => String::new(),
            _ => format!(
                ", or take the others with --filter '{}'",
                joined(&arguments.filter, Some(condition))
            ),
        };
        Err(Failure::BadInput(format!(
            "{lacking} of {} images of `{}` cannot be exported: {needed}{or}",
            self.images, arguments.dataset
        )))
    }
}

fn kinds(arguments: &Arguments) -> Vec<String> {
    let mut kinds: Vec<String> = Vec::new();
    let needed = arguments.format.kinds().iter().map(|kind| (*kind).to_owned());
    for kind in arguments.kinds.iter().cloned().chain(needed) {
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    kinds
}

fn joined(filter: &str, condition: Option<&str>) -> String {
    match condition {
        None => filter.to_owned(),
        Some(condition) if filter.trim().is_empty() => condition.to_owned(),
        Some(condition) => format!("({filter}) and {condition}"),
    }
}

/// How many images the filter takes, together with a condition; fails where the filter is wrong.
fn count(remote: &Remote, arguments: &Arguments, condition: Option<&str>) -> Result<u64, Failure> {
    let path = format!("/v1/datasets/{}/stats", encode(&arguments.dataset));
    let filter = joined(&arguments.filter, condition);
    let parameters = [("metrics", Some("total_ms")), ("filter", Some(filter.as_str()))];
    let stats: Value = remote.get(&with_query(&path, &parameters))?;
    let groups = stats["groups"].as_array().into_iter().flatten();
    Ok(groups.filter_map(|group| group["count"].as_u64()).sum())
}
