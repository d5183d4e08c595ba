//! Daylight, the water that it shines into, and the scene that it lights.

use super::{Checker, has_lamps, places};
use crate::invalid::FieldError;
use crate::node::Node;

impl Checker<'_> {
    /// A sky needs water and sets its veil; reflectance needs light.
    pub(super) fn daylight(&mut self, document: &Node) {
        let waters: Vec<_> = places(document, "water");
        let optics: Vec<_> = waters
            .iter()
            .filter_map(|(pointer, water)| Some((pointer, water.get("optics")?)))
            .flat_map(|(pointer, optics)| optics.alternatives(&format!("{pointer}/optics")))
            .collect();
        let skies: Vec<_> = places(document, "daylight")
            .into_iter()
            .filter(|(_, daylight)| daylight.get("sun_elevation_deg").is_some())
            .collect();
        for (pointer, _) in &skies {
            if optics.is_empty() {
                let message = "`daylight` describes a sky, but `water.optics` is not given: there is no water for it to light";
                self.refuse(|| FieldError::new(pointer, message));
            }
        }
        for (pointer, optics) in &optics {
            for field in ["veiling_light", "veil_gain"] {
                if optics.get(field).is_some() && !skies.is_empty() {
                    let message = format!(
                        "`water.optics.{field}` is given, but `daylight` describes a sky, which sets the veil; remove one of them"
                    );
                    self.refuse(|| FieldError::new(&format!("{pointer}/{field}"), message));
                }
            }
        }
        self.unlit_scene(document, !skies.is_empty());
    }

    /// A scene of reflectance in a night without lamps is black.
    fn unlit_scene(&mut self, document: &Node, has_sky: bool) {
        let is_night = places(document, "daylight")
            .iter()
            .all(|(_, daylight)| daylight.strings("").iter().any(|(_, word)| *word == "none"));
        if has_sky || !is_night || has_lamps(document) {
            return;
        }
        for (pointer, scene) in places(document, "scene") {
            let lighting = scene.get("lighting").map(|lighting| lighting.strings(""));
            let is_reflectance = lighting.into_iter().flatten().any(|(_, word)| word == "water");
            if is_reflectance {
                let message = "`scene.lighting` is \"water\", but `daylight` is \"none\" and there are no lamps: the scene is \
                               black; add a lamp or daylight, or set `scene.lighting` to \"in_air\"";
                self.refuse(|| FieldError::new(&format!("{pointer}/lighting"), message));
            }
        }
    }
}
