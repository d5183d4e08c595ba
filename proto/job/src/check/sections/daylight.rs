//! Daylight, water and scene lighting.

use crate::check::present::Contents;
use crate::check::sections::lights::can_lack_lamps;
use crate::check::{Checker, find_values, has_lamps};
use crate::invalid::{FieldError, quote};
use crate::node::Node;

/// Fields that decide whether a scene is black.
const LIGHTING: [&str; 3] = ["/daylight", "/lights", "/scene"];

/// Fields of `water.optics` that set the constant veil of the published model.
const VEILS: [&str; 2] = ["veiling_light", "veil_gain"];

impl Checker<'_> {
    /// A sky needs water, a night has no veil, and a reflectance scene needs light.
    pub(crate) fn check_daylight(&mut self, document: &Node, contents: &Contents<'_>) {
        let has_sky = contents.has("daylight.sun_elevation_deg", None);
        if has_sky && !contents.has("water.optics", None) {
            let message =
                "`daylight` is a sky, but needs `water.optics`; add it, or set `daylight` to \"none\"";
            self.refuse(|| FieldError::new("/daylight", message));
        }
        self.refuse_veils_by_night(document);
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

    /// The veil of the published model is scattered daylight, so that a night has none.
    fn refuse_veils_by_night(&mut self, document: &Node) {
        if !can_be_night(document) {
            return;
        }
        for (pointer, water) in find_values(document, "water") {
            let pointer = format!("{pointer}/optics");
            let optics = water.get("optics").map(|optics| optics.alternatives(&pointer));
            for (pointer, optics) in optics.into_iter().flatten() {
                self.refuse_veils_of_optics(&pointer, optics);
            }
        }
    }

    fn refuse_veils_of_optics(&mut self, pointer: &str, optics: &Node) {
        for name in VEILS {
            let Some(veil) = optics.get(name).filter(|veil| can_shine(veil)) else {
                continue;
            };
            let value = match veil {
                Node::Constant(value) => format!("is {}", quote(value)),
                _ => "can be above 0".to_owned(),
            };
            let message = format!(
                "`water.optics.{name}` {value}, but `daylight` is \"none\", and a night has no veil: set `daylight` to \
                 \"auto\", which keeps it, or remove `water.optics.{name}`"
            );
            self.refuse(|| {
                FieldError::new(&format!("{pointer}/{name}"), message)
                    .value(&veil.canonical())
                    .limit("not with `daylight` \"none\"")
            });
        }
    }
}

/// Warns of frames that are black while others have light.
pub(crate) fn find_black_frames(document: &Node) -> Option<String> {
    let is_black = can_be_night(document) && can_lack_lamps(document) && can_be_reflectance(document);
    is_black.then(|| {
        "a frame can have `daylight` \"none\" and no lamps, and `scene.lighting` is \"water\": it is black; add a lamp to each \
         choice of `lights`, or give those frames daylight"
            .to_owned()
    })
}

/// Whether a frame can be described as night.
fn can_be_night(document: &Node) -> bool {
    let daylight = document.get("daylight").map(|daylight| daylight.strings(""));
    daylight.into_iter().flatten().any(|(_, word)| word == "none")
}

/// Whether a frame can have a scene of reflectance.
fn can_be_reflectance(document: &Node) -> bool {
    find_values(document, "scene").iter().any(|(_, scene)| {
        let lighting = scene.get("lighting").map(|lighting| lighting.strings(""));
        lighting.into_iter().flatten().any(|(_, word)| word == "water")
    })
}

/// Whether a veil can have a value above 0.
fn can_shine(veil: &Node) -> bool {
    veil.alternatives("").iter().any(|(_, veil)| match veil {
        Node::List(channels) => channels
            .iter()
            .any(|channel| channel.greatest().is_some_and(|light| light > 0.0)),
        _ => veil.greatest().is_some_and(|gain| gain > 0.0),
    })
}
