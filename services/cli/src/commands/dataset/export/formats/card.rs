//! `README.md` of an export: a dataset card with front matter, as Hugging Face and readers of folders know it.

use std::fmt::Write;

use serde_json::{Value, json};
use spec::{ArtifactKind, Encode};

use crate::commands::dataset::export::format::{Format, RECORD};
use crate::commands::dataset::export::formats::class_numbers::ClassNumbers;
use crate::commands::dataset::export::input::origins::Origin;
use crate::commands::dataset::export::role::Z_DEPTH;

/// The content of a card.
pub(crate) struct Card<'a> {
    pub(crate) dataset: &'a str,
    pub(crate) filter: &'a str,
    pub(crate) license: &'a str,
    pub(crate) format: Format,
    /// The kinds of files of each image.
    pub(crate) kinds: &'a [String],
    /// Parts with their images; one without a name: no parts.
    pub(crate) parts: &'a [(Option<String>, u64)],
    pub(crate) origins: &'a [Origin],
    pub(crate) classes: &'a ClassNumbers,
    /// Digest of all rows.
    pub(crate) rows: &'a str,
}

impl Card<'_> {
    pub(crate) fn images(&self) -> u64 {
        self.parts.iter().map(|(_, images)| images).sum()
    }

    /// One sentence about the images.
    pub(crate) fn summary(&self) -> String {
        format!(
            "{} synthetic underwater images of the dataset `{}`, rendered by Fathom {}.",
            self.images(),
            self.dataset,
            env!("CARGO_PKG_VERSION")
        )
    }

    /// The page.
    pub(crate) fn markdown(&self) -> String {
        let mut page = format!(
            "---\n{}---\n\n# {}\n\n{}",
            self.front_matter(),
            self.dataset,
            self.summary()
        );
        // Writing to a string cannot fail, here and below.
        if !self.filter.trim().is_empty() {
            let _ = write!(page, " Only those with `{}`.", self.filter);
        }
        let _ = writeln!(page, "\n\n{}\n", self.usage());
        let _ = writeln!(
            page,
            "Each image has {}. Units and meanings: `fields.json`.",
            self.listed_kinds().join(", ")
        );
        if self.parts.iter().any(|(name, _)| name.is_some()) {
            page.push_str("\n| part | images |\n|---|---|\n");
            for (name, images) in self.parts {
                let _ = writeln!(page, "| {} | {images} |", name.as_deref().unwrap_or_default());
            }
            page.push_str("\nNo scene is in two parts.\n");
        }
        page.push_str(&self.tables());
        page
    }

    /// The kinds of files; formats with times have no file of the record, and z-depth in place of the range.
    fn listed_kinds(&self) -> Vec<&str> {
        let kinds = self.kinds.iter().map(String::as_str);
        match self.format.has_times() {
            true => kinds
                .filter(|kind| *kind != RECORD)
                .map(|kind| if kind == "range" { Z_DEPTH } else { kind })
                .collect(),
            false => kinds.collect(),
        }
    }

    fn tables(&self) -> String {
        let mut text = String::new();
        if !self.classes.all().is_empty() {
            text.push_str("\n## Classes\n\n| id | name |\n|---|---|\n");
            for (name, number) in self.classes.all() {
                let _ = writeln!(text, "| {number} | {} |", cell(name));
            }
        }
        if !self.origins.is_empty() {
            text.push_str("\n## Waters and styles\n\n| name | source | license |\n|---|---|---|\n");
            for Origin {
                name,
                source,
                licence,
            } in self.origins
            {
                let _ = writeln!(text, "| {} | {} | {} |", cell(name), cell(source), cell(licence));
            }
        }
        text
    }

    /// Lines of YAML; the values are JSON, a subset of YAML.
    fn front_matter(&self) -> String {
        let mut tags = vec!["underwater", "synthetic"];
        tags.extend((self.format == Format::WebDataset).then_some("webdataset"));
        let mut lines = vec![
            format!("pretty_name: {}", json!(self.dataset)),
            format!("license: {}", json!(self.license)),
            format!("size_categories: {}", json!([size_category(self.images())])),
            format!("tags: {}", json!(tags)),
        ];
        let patterns = self.patterns();
        if !patterns.is_empty() {
            let files: Vec<Value> = self
                .parts
                .iter()
                .filter(|(_, images)| *images > 0)
                .map(|(name, _): &(Option<String>, u64)| {
                    let folder = name.as_ref().map_or_else(String::new, |name| format!("{name}/"));
                    let paths: Vec<String> = patterns
                        .iter()
                        .map(|pattern| format!("{folder}{pattern}"))
                        .collect();
                    json!({"split": name.as_deref().unwrap_or("train"), "path": paths})
                })
                .collect();
            lines.push(format!(
                "configs: {}",
                json!([{"config_name": "default", "data_files": files}])
            ));
            lines.push(format!("dataset_info: {}", self.dataset_info()));
        }
        lines.join("\n") + "\n"
    }

    /// Sizes of the parts and the digest of the rows. `load_dataset` caches by them, so a grown export is read again.
    fn dataset_info(&self) -> Value {
        let parts = self.parts.iter().filter(|(_, images)| *images > 0);
        let splits: Vec<Value> = parts
            .map(|(name, images)| json!({"name": name.as_deref().unwrap_or("train"), "num_examples": images}))
            .collect();
        json!({"config_name": "default", "description": format!("rows {}", self.rows), "splits": splits})
    }

    /// The files that `load_dataset` reads. All other files would take part in its guess of a format.
    fn patterns(&self) -> Vec<String> {
        // The labels of `yolo` have the names of its pictures.
        let folder = if self.format == Format::Yolo {
            "images/**"
        } else {
            "**"
        };
        let files = |list: &str, kinds: &[String]| {
            let pictures = kinds.iter().filter(|kind| is_picture(kind));
            let pictures = pictures.map(|kind| format!("{folder}/{kind}.*"));
            std::iter::once(list.to_owned()).chain(pictures).collect()
        };
        match self.format {
            Format::WebDataset => vec!["*.tar".to_owned()],
            Format::Parquet => vec!["data/*.parquet".to_owned()],
            Format::Hf => files("metadata.parquet", self.kinds),
            Format::Folder | Format::Coco | Format::Yolo => {
                files("metadata.jsonl", &self.kinds[..self.kinds.len().min(1)])
            }
            Format::Colmap
            | Format::Transforms
            | Format::Mcap
            | Format::Tum
            | Format::Euroc
            | Format::Kitti => Vec::new(),
        }
    }

    /// How to open it.
    fn usage(&self) -> &'static str {
        match self.format {
            Format::Folder => {
                "Open it with `fathom.open(FOLDER)`, or by `metadata.jsonl`, one line for each image."
            }
            Format::WebDataset => {
                "Open it with `webdataset.WebDataset(\"{000000..}.tar\")`, or with `fathom.open(FOLDER)`."
            }
            Format::Parquet => {
                "Open it with `pyarrow.dataset.dataset(\"data\")`, or with `datasets.load_dataset(FOLDER)`."
            }
            Format::Hf => "Open it with `datasets.load_dataset(FOLDER)`.",
            Format::Coco => "Open it with `pycocotools.coco.COCO(\"annotations.json\")`.",
            Format::Yolo => "Open it with `data.yaml`.",
            Format::Colmap => {
                "Each folder is a sequence: its pictures below `images`, its poses in `sparse/0`."
            }
            Format::Transforms => {
                "Each folder is a sequence: its pictures below `images`, its poses in `transforms.json`."
            }
            Format::Mcap => {
                "Each `.mcap` file is a sequence of ROS 2 messages: open it in Foxglove, with `ros2 bag play` or with `rosbags`."
            }
            Format::Tum => {
                "Each folder is a sequence as in the TUM RGB-D benchmark; depth is z-depth, 5000 codes per meter."
            }
            Format::Euroc => {
                "Each folder is a sequence as in the EuRoC benchmark, without an IMU; depth is z-depth in millimeters."
            }
            Format::Kitti => {
                "Sequences and poses are as in the odometry benchmark of KITTI; depth is z-depth, 256 codes per meter."
            }
        }
    }
}

/// Whether the files of a kind are pictures.
fn is_picture(kind: &str) -> bool {
    let kind = ArtifactKind::parse(kind);
    kind.is_some_and(|kind| kind.media_type(Encode::Png).starts_with("image/"))
}

/// The ranges that dataset cards use.
fn size_category(images: u64) -> &'static str {
    match images {
        0..1_000 => "n<1K",
        1_000..10_000 => "1K<n<10K",
        10_000..100_000 => "10K<n<100K",
        100_000..1_000_000 => "100K<n<1M",
        1_000_000..10_000_000 => "1M<n<10M",
        _ => "10M<n<100M",
    }
}

/// Text that stays within a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace(['\n', '\r'], " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_card_names_parts_files_and_terms() {
        let origin = Origin {
            name: "style bay".to_owned(),
            source: "a photo | of mine".to_owned(),
            licence: "CC0-1.0".to_owned(),
        };
        let card = Card {
            dataset: "tour",
            filter: "uiqm > 0.5",
            license: "cc-by-4.0",
            format: Format::WebDataset,
            kinds: &["rgb".to_owned()],
            parts: &[(Some("train".to_owned()), 1200), (Some("val".to_owned()), 0)],
            origins: &[origin],
            classes: &ClassNumbers::default(),
            rows: "abc",
        };
        let page = card.markdown();
        assert!(
            page.starts_with("---\npretty_name: \"tour\"\nlicense: \"cc-by-4.0\"\n"),
            "{page}"
        );
        assert!(
            page.contains(r#"[{"path":["train/*.tar"],"split":"train"}]"#),
            "{page}"
        );
        assert!(
            page.contains("| style bay | a photo \\| of mine | CC0-1.0 |"),
            "{page}"
        );
        assert!(
            page.contains("| val | 0 |") && page.contains("`uiqm > 0.5`") && page.contains("1K<n<10K"),
            "{page}"
        );
    }
}
