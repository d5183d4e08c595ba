use super::*;
use crate::table;

/// The fields of the documentation, classified by the words of the table, independently of the schema walk.
fn documented() -> Vec<String> {
    let mut names = Vec::new();
    for row in table::rows() {
        // The kinds of an object share their leaves: `scene(files).rgb` is `scene.rgb`.
        let mut path = String::new();
        for (position, part) in row.path.split(['(', ')']).enumerate() {
            path += if position % 2 == 0 { part } else { "" };
        }
        let parts: &[&str] = match row.kind {
            "a number" | "a whole number" | "a string" | "a string or an object" => &[""],
            "a list of three numbers (R, G, B)" => &[".r", ".g", ".b"],
            "a list of three numbers (x, y, z)" => &[".x", ".y", ".z"],
            "a list of two whole numbers (across, down)" => &[".across", ".down"],
            "a list" => &[".count"],
            _ => &[],
        };
        let is_short = row.limit.starts_with("a string is short for");
        // Its only field goes by the name of the object.
        let path = if path == "site.name" {
            "site".to_owned()
        } else {
            path
        };
        // Of a list inside another only the length is a leaf.
        let is_nested = path.matches("[]").count() > 1;
        if path != "count" && !is_short && !is_nested {
            names.extend(parts.iter().map(|part| format!("{path}{part}")));
        }
    }
    names.sort_unstable();
    names.dedup();
    names
}

#[test]
fn every_leaf_of_a_description_has_its_own_name() {
    let Leaves { scalars, lists } = Leaves::of_records();
    let mut names: Vec<String> = scalars
        .iter()
        .filter(|leaf: &&Leaf| leaf.pointer.starts_with("/parameters/") && leaf.name != "water.optics")
        .map(|leaf| leaf.name.clone())
        .collect();
    for of_objects in ["lights", "enhance"] {
        let list = lists.iter().find(|list| list.name == of_objects).unwrap();
        let fields = list.element.iter().filter(|leaf| !leaf.name.is_empty());
        names.extend(fields.map(|leaf| format!("{of_objects}[].{}", leaf.name)));
    }
    names.sort_unstable();
    assert_eq!(names, documented());
    let all: Vec<_> = lists.iter().map(|list| list.name.as_str()).collect();
    assert_eq!(all, ["lights", "enhance", "metrics", "artifacts"]);
}

#[test]
fn units_and_kinds_come_from_the_declaration() {
    let leaves = Leaves::of_records();
    let leaf = |name: &str| leaves.scalars.iter().find(|leaf| leaf.name == name).unwrap();
    assert_eq!(leaf("water.snow.density_per_m3").unit, Some("1/m³"));
    assert_eq!(
        leaf("water.optics.veiling_light.b").pointer,
        "/parameters/water/optics/veiling_light/2"
    );
    assert_eq!(
        (leaf("seed").kind, leaf("scene.seed").kind),
        (LeafKind::Large, LeafKind::Whole)
    );
    assert_eq!(leaf("absorption_per_m.r").unit, Some("1/m"));
    assert_eq!(leaf("lights.count").kind, LeafKind::Length);
    assert_eq!(leaf("camera.hfov_deg").doc, "horizontal field of view");
    let silent = leaves.scalars.iter().find(|leaf| leaf.doc.is_empty());
    assert_eq!(silent, None, "every leaf says what it means");
}
