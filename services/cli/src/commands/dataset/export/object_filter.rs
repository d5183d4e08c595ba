//! Which objects an export describes.

use std::collections::BTreeSet;

use cli::exit::Failure;
use serde_json::Value;
use spec::InstanceRecord;

use crate::commands::dataset::export::format::Format;

/// Classes of the ground and of walls around the camera, which fill the picture. Detectors need no box of them.
const GROUND: [&str; 2] = ["seabed", "lining"];

/// Options that select objects.
#[derive(Debug, Clone, Default, clap::Args)]
pub(crate) struct ObjectFilter {
    /// Classes of the objects in the formats coco and yolo, comma-separated [default: all but seabed and lining]
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    classes: Vec<String>,
    /// Fewest visible pixels of an object in the formats coco and yolo
    #[arg(long, value_name = "PIXELS")]
    min_pixels: Option<u64>,
    /// Least visibility of an object in the formats coco and yolo: contrast after the water over contrast before it, 0 to 1
    #[arg(long, value_name = "SHARE", value_parser = parse_share)]
    min_visibility: Option<f64>,
}

fn parse_share(text: &str) -> Result<f64, String> {
    let share: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    match (0.0..=1.0).contains(&share) {
        true => Ok(share),
        false => Err(format!("{share} must be 0 to 1")),
    }
}

impl ObjectFilter {
    /// Fails if options are given for a format without objects.
    pub(crate) fn check(&self, format: Format) -> Result<(), Failure> {
        let is_given = !self.classes.is_empty() || self.min_pixels.is_some() || self.min_visibility.is_some();
        if !is_given || format.has_objects() {
            return Ok(());
        }
        Err(Failure::BadInput(format!(
            "--classes, --min-pixels and --min-visibility select objects, which the format {} does not list; use coco or yolo, or \
             --filter for images",
            format.name()
        )))
    }

    /// Adds the options to the settings that must not change when an export is continued.
    pub(crate) fn describe(&self, card: &mut Value) {
        if !self.classes.is_empty() {
            card["classes"] = self.classes.clone().into();
        }
        if let Some(pixels) = self.min_pixels {
            card["min_pixels"] = pixels.into();
        }
        if let Some(share) = self.min_visibility {
            card["min_visibility"] = share.into();
        }
    }

    /// Whether objects of a class are exported.
    pub(crate) fn takes_class(&self, name: &str) -> bool {
        match self.classes.is_empty() {
            true => !GROUND.contains(&name),
            false => self.classes.iter().any(|class| class == name),
        }
    }

    /// Whether an object is exported. One without a visibility has none.
    pub(crate) fn takes(&self, object: &InstanceRecord) -> bool {
        let is_seen = self
            .min_visibility
            .is_none_or(|least| object.visibility.is_some_and(|visibility| visibility >= least));
        self.takes_class(&object.category)
            && is_seen
            && self.min_pixels.is_none_or(|least| object.pixels >= least)
    }

    /// The requested classes that no scene has.
    pub(crate) fn list_absent<'a>(&'a self, present: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
        let present: BTreeSet<&str> = present.collect();
        let wanted = self.classes.iter().map(String::as_str);
        wanted.filter(|class| !present.contains(class)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn object(category: &str, pixels: u64, visibility: Option<f64>) -> InstanceRecord {
        InstanceRecord {
            number: 1,
            category: category.to_owned(),
            bounds: [0, 0, 1, 1],
            pixels,
            host: None,
            range_m: None,
            transmittance: None,
            contrast: None,
            visibility,
            visible: true,
        }
    }

    #[test]
    fn ground_is_left_out_unless_it_is_named() {
        let all = ObjectFilter::default();
        assert!(all.takes(&object("pile", 1, None)));
        assert!(!all.takes(&object("seabed", 900, Some(1.0))));
        let named = ObjectFilter {
            classes: vec!["seabed".to_owned()],
            ..ObjectFilter::default()
        };
        assert!(named.takes(&object("seabed", 900, None)));
        assert!(!named.takes(&object("pile", 900, None)));
        assert_eq!(named.list_absent(["pile"].into_iter()), ["seabed"]);
    }

    #[test]
    fn small_and_faint_objects_are_left_out() {
        let filter = ObjectFilter {
            min_pixels: Some(20),
            min_visibility: Some(0.1),
            ..ObjectFilter::default()
        };
        assert!(filter.takes(&object("pile", 20, Some(0.1))));
        assert!(!filter.takes(&object("pile", 19, Some(0.5))));
        assert!(!filter.takes(&object("pile", 90, Some(0.05))));
        assert!(!filter.takes(&object("pile", 90, None)));
        assert!(filter.check(Format::Folder).is_err() && filter.check(Format::Yolo).is_ok());
    }
}
