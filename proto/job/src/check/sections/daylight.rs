//! Daylight, water and scene lighting.

use crate::check::present::Contents;
use crate::check::{Checker, find_values, has_lamps};
use crate::invalid::FieldError;
use crate::node::Node;

/// Fields that decide whether a scene is black.
const LIGHTING: [&str; 3] = ["/daylight", "/lights", "/scene"];

impl Checker<'_> {
    /// A sky needs water, and a reflectance scene needs light.
    pub(crate) fn check_daylight(&mut self, document: &Node, contents: &Contents<'_>) {
        let has_sky = contents.has("daylight.sun_elevation_deg", None);
        if has_sky && !contents.has("water.optics", None) {
            let message =
                "`daylight` is a sky, but needs `water.optics`; add it, or set `daylight` to \"none\"";
            self.refuse(|| FieldError::new("/daylight", message));
        }
        let daylight = document.get("daylight");
        let is_night =
            daylight.is_some_and(|daylight| daylight.strings("").iter().all(|(_, word)| *word == "none"));
        if has_sky
            || !is_night
            || has_lamps(document)
            || LIGHTING.iter().any(|pointer: &&str| {
                self.errors
                    .iter()
                    .any(|error| error.pointer.starts_with(*pointer))
            })
        {
            return;
        }
        for (pointer, scene) in find_values(document, "scene") {
            let lighting = scene.get("lighting").map(|lighting| lighting.strings(""));
            if lighting.into_iter().flatten().any(|(_, word)| word == "water") {
                let message = "`scene.lighting` is \"water\", but `daylight` is \"none\" and there are no lamps: the scene is \
                               black; add a lamp or daylight, or set `scene.lighting` to \"in_air\"";
                self.refuse(|| FieldError::new(&format!("{pointer}/lighting"), message));
            }
        }
    }
}
