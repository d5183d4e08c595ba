//! The exported images and columns. A dataset that lacks what the format needs is refused before the first file is written.

use cli::exit::Failure;
use cli::known;
use client::{Client, ColumnInfo, StatisticsQuery};

use crate::commands::dataset::export::arguments::Arguments;
use crate::commands::dataset::export::format::{Format, RECORD};
use crate::commands::dataset::export::input::one_camera::{check_sequences, require_lens};
use crate::commands::dataset::export::input::posed::PosedScenes;
use crate::commands::dataset::export::input::times::{SEQUENCE, STAMP};
use crate::commands::dataset::export::role::{RIGHT, check_kinds};

/// The images and columns of an export.
pub(crate) struct Selection {
    pub(crate) images: u64,
    /// The kinds of files, the picture first, without repetition.
    pub(crate) kinds: Vec<String>,
    pub(crate) columns: Vec<ColumnInfo>,
}

/// Matches frames that may have a pose: those with a camera path or an uploaded scene.
const MAY_HAVE_POSE: &str = "(camera.path.frames is not null or scene.id is not null)";
/// Matches frames whose pose must be that of their scene.
const POSE_OF_SCENE: &str = "camera.path.frames is null and scene.id is not null";

impl Selection {
    /// Reads the columns of the dataset, and checks that every image has what the export needs.
    pub(crate) fn read(client: &Client, arguments: &Arguments) -> Result<Self, Failure> {
        let dataset = known::dataset(client, &arguments.dataset)?;
        // Readers of image folders take columns of such names for paths of files.
        let columns = dataset
            .columns
            .into_iter()
            .filter(|column| !column.name.ends_with("file_name"));
        let mut selection = Self {
            images: 0,
            kinds: kinds(arguments),
            columns: columns.collect(),
        };
        if arguments.format.has_times() {
            check_kinds(arguments.format, &selection.kinds)?;
        }
        selection.check_kinds(arguments)?;
        selection.images = count(client, arguments, None)?;
        if arguments.format.has_times() {
            selection.add_right_pictures(client, arguments)?;
        }
        selection.check_every_image(client, arguments)?;
        Ok(selection)
    }

    pub(crate) fn column_names(&self) -> Vec<String> {
        self.columns.iter().map(|column| column.name.clone()).collect()
    }

    fn artifacts(&self) -> impl Iterator<Item = &String> {
        self.kinds.iter().filter(|kind| *kind != RECORD)
    }

    /// Adds the right pictures of stereo pairs if every image has one; the format tum has one camera.
    fn add_right_pictures(&mut self, client: &Client, arguments: &Arguments) -> Result<(), Failure> {
        let column = format!("artifacts.{RIGHT}");
        let is_known = self.columns.iter().any(|info| info.name == column);
        if !is_known || arguments.format == Format::Tum || self.kinds.iter().any(|kind| kind == RIGHT) {
            return Ok(());
        }
        let pairs = count(client, arguments, Some(&format!("{column} is not null")))?;
        if pairs == self.images && self.images > 0 {
            self.kinds.push(RIGHT.to_owned());
        }
        Ok(())
    }

    /// The columns of exported rows: those of the service, and for formats with times those of the sequence.
    pub(crate) fn add_time_columns(&mut self) {
        let columns = [(SEQUENCE, "text", None), (STAMP, "number", Some("ns"))];
        self.columns.extend(
            columns.map(|(name, kind, unit): (_, _, Option<&str>)| ColumnInfo {
                name: name.to_owned(),
                kind: kind.to_owned(),
                unit: unit.map(str::to_owned),
            }),
        );
    }

    fn check_kinds(&self, arguments: &Arguments) -> Result<(), Failure> {
        let present = self
            .columns
            .iter()
            .filter_map(|column| column.name.strip_prefix("artifacts."))
            .filter(|kind| *kind != "count");
        let present: Vec<&str> = present.collect();
        let missing: Vec<&str> = self
            .artifacts()
            .map(String::as_str)
            .filter(|kind| !present.contains(kind))
            .collect();
        if present.is_empty() || missing.is_empty() {
            return Ok(());
        }
        let needs = match missing.iter().any(|kind| arguments.format.kinds().contains(kind)) {
            true => format!(
                "; the format {} needs it: add it to `artifacts` of the job",
                arguments.format.name()
            ),
            false => String::new(),
        };
        Err(Failure::BadInput(format!(
            "no image of `{}` has an artifact `{}`, only {}{needs}",
            arguments.dataset,
            missing.join("`, `"),
            present.join(", ")
        )))
    }

    /// Checks that every image has the artifacts and the pose that the export needs.
    fn check_every_image(&self, client: &Client, arguments: &Arguments) -> Result<(), Failure> {
        let format = arguments.format.name();
        if arguments.format.needs_poses() {
            let needed = format!(
                "the format {format} is made of poses: give /camera/path in the job, or upload scenes with their pose"
            );
            self.check_images(client, arguments, MAY_HAVE_POSE, &needed)?;
            let of_scenes = joined(&arguments.filter, Some(POSE_OF_SCENE));
            let lacking = PosedScenes::new(client).list_unposed(&arguments.dataset, &of_scenes)?;
            if let Some(scenes) = lacking {
                return Err(Failure::BadInput(format!(
                    "the format {format} needs poses, which the scenes {scenes} lack: upload them with `pose`, or leave their \
                     images out with --filter"
                )));
            }
        }
        if let Some((condition, needed)) = require_lens(arguments.format) {
            self.check_images(client, arguments, &condition, needed)?;
        }
        if arguments.format.has_times() {
            check_sequences(client, arguments)?;
        }
        for kind in self.artifacts() {
            let needed = format!("they have no artifact `{kind}`; remove it from --kinds");
            let condition = format!("artifacts.{kind} is not null");
            self.check_images(client, arguments, &condition, &needed)?;
        }
        Ok(())
    }

    fn check_images(
        &self,
        client: &Client,
        arguments: &Arguments,
        condition: &str,
        needed: &str,
    ) -> Result<(), Failure> {
        let present = count(client, arguments, Some(condition))?;
        if present >= self.images {
            return Ok(());
        }
        let lacking = self.images - present;
        let or = match present {
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

/// The number of images that the filter matches together with a condition.
fn count(client: &Client, arguments: &Arguments, condition: Option<&str>) -> Result<u64, Failure> {
    let query = StatisticsQuery {
        metrics: "total_ms",
        filter: &joined(&arguments.filter, condition),
        ..StatisticsQuery::default()
    };
    let groups = client.statistics(&arguments.dataset, query)?.groups;
    Ok(groups.iter().map(|group| group.count).sum())
}
