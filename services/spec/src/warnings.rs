//! What a user should know about a valid description.

use serde::Deserialize;
use serde_json::Value;

use crate::check::{above, has_lamps, is_traced, may_show, places};
use crate::node::{Law, LawNode, Node};
use crate::vocabulary::Vocabulary;
use crate::water::{Optics, Water};

/// The warnings of a checked description; `written` is what was submitted.
pub(crate) fn find(document: &Node, written: &Value, vocabulary: &Vocabulary) -> Vec<String> {
    let mut warnings = Vec::new();
    let waters = places(document, "water");
    let none_has = |name| waters.iter().all(|(_, water)| water.get(name).is_none());
    if written.get("alpha").is_some() && none_has("style") {
        warnings
            .push("`alpha` weights the style, but `water.style` is not given: it has no effect".to_owned());
    }
    if written.pointer("/water/style_tier").is_some() && none_has("style") {
        warnings.push("`water.style_tier` has no effect without `water.style`".to_owned());
    }
    if written.pointer("/water/multiple").is_some() && !has_lamps(document) {
        warnings.push("`water.multiple` has no effect without lamps".to_owned());
    }
    if !is_traced(document) {
        for (pointer, field) in [("/truth", "truth"), ("/water/phase", "water.phase")] {
            if written.pointer(pointer).is_some() {
                warnings.push(format!(
                    "`{field}` has no effect without the artifact `truth` or `truth_report`"
                ));
            }
        }
    }
    let without_optics = ["range_scale", "depth_m", "ambient", "holes", "turbidity"];
    for name in without_optics.into_iter().filter(|_| none_has("optics")) {
        if written.pointer(&format!("/water/{name}")).is_some() {
            warnings.push(format!("`water.{name}` has no effect without `water.optics`"));
        }
    }
    warnings.extend(waters.iter().filter_map(|(_, water)| optics(water, vocabulary)));
    if has_lamps(document) {
        warnings.extend(waters.iter().filter_map(|(_, water)| lit(water, vocabulary)));
    }
    warnings.extend(from_above(document, &waters));
    let brings_picture = |scene: &Node| scene.get("family").is_none();
    if places(document, "scene")
        .iter()
        .all(|(_, scene)| brings_picture(scene))
    {
        for side in ["width", "height"] {
            if written.pointer(&format!("/camera/{side}")).is_some() {
                warnings.push(format!(
                    "`camera.{side}` has no effect: the scene brings its own size"
                ));
            }
        }
    }
    let values = document.laws().into_iter().flat_map(|law| law.values());
    if let Some(axis) = values.flat_map(Node::laws).find(|law| is_axis(law)) {
        warnings.push(format!(
            "the grid at {} multiplies the frames even where its place is not chosen",
            axis.pointer
        ));
    }
    warnings
}

/// What the rules of waters say of a water that lamps light.
fn lit(water: &Node, vocabulary: &Vocabulary) -> Option<String> {
    let water = Water::deserialize(water.value(&|law| law.draw(0))).ok()?;
    (vocabulary.rules.lit_warning)(&water)
}

/// Fields of light from above that change nothing, and reflectance that nothing lights.
fn from_above(document: &Node, waters: &[(String, &Node)]) -> Vec<String> {
    let lights: Vec<_> = waters
        .iter()
        .flat_map(|(pointer, water)| above(pointer, water))
        .collect();
    let any = |test: &dyn Fn(&Node) -> bool| lights.iter().any(|(_, above)| test(above));
    let names = |above: &Node, wanted: &[&str]| {
        let surfaces = above.get("surfaces");
        surfaces.is_some_and(|node| node.strings("").iter().any(|(_, name)| wanted.contains(name)))
    };
    let shines = |above: &Node| above.get("sun_share").and_then(Node::greatest) > Some(0.0);
    let has_shafts = |above: &Node| {
        let shafts = above.get("shafts");
        shafts.is_some_and(|node| !matches!(node, Node::Constant(Value::Bool(false))))
    };
    let slopes = any(&|above| names(above, &["normal"]));
    let mut warnings = Vec::new();
    let mut idle = |field: &str, is_idle: bool, reason: &str| {
        if is_idle && any(&|above| above.get(field).is_some()) {
            warnings.push(format!("`water.from_above.{field}` has no effect: {reason}"));
        }
    };
    let flat = "`surfaces` is not \"normal\"";
    idle("ambient_rays", !slopes, flat);
    idle("sun_share", !slopes && !any(&has_shafts), flat);
    idle("sun", !any(&shines), "`sun_share` is 0");
    idle("caustics", !any(&shines), "`sun_share` is 0");
    idle(
        "shafts",
        any(&has_shafts) && !any(&|above| above.get("caustics").is_some()),
        "there are no `caustics`",
    );
    let scenes = places(document, "scene");
    let is_reflectance = scenes.iter().any(|(_, scene)| may_show(scene, "albedo"));
    if is_reflectance && !has_lamps(document) && !any(&|above| names(above, &["normal", "depth"])) {
        warnings.push(
            "`scene.light` is \"albedo\", but neither lamps nor `water.from_above.surfaces` light the scene: it is black"
                .to_owned(),
        );
    }
    warnings
}

/// What the rules of waters say of one of these optics.
fn optics(water: &Node, vocabulary: &Vocabulary) -> Option<String> {
    let optics = water.get("optics")?.alternatives("");
    optics.iter().find_map(|(_, optics)| {
        let numbers = Optics::deserialize(optics.value(&|law| law.draw(0))).ok()?;
        (vocabulary.rules.warning)(&numbers)
    })
}

/// Whether this law is a grid of more than one value.
fn is_axis(law: &LawNode) -> bool {
    matches!(law.law, Law::Grid { .. }) && law.values().len() > 1
}
