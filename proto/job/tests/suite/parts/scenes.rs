//! Requirements on scenes that lack a part.

use serde_json::{Value, json};
use spec::{Draft, FieldError, Job, SceneParts, Uploads};

use crate::common::vocabulary;

/// `scn_flat` is only an image; `scn_deep` has a range, `scn_shot` also a camera.
fn check(document: &Value) -> Result<Job, Vec<FieldError>> {
    let flat = SceneParts::default();
    let deep = SceneParts { range: true, ..flat };
    let shot = SceneParts { camera: true, ..deep };
    let known = [("scn_flat", flat), ("scn_deep", deep), ("scn_shot", shot)];
    let known = known.map(|(id, parts)| (id.to_owned(), parts));
    let vocabulary = vocabulary(false);
    let draft = Draft::read(document.to_string().as_bytes(), &vocabulary).unwrap();
    draft
        .check(&Uploads::Known(known.into()))
        .map_err(|invalid| invalid.0)
}

fn over(id: Value, fields: Value) -> Value {
    let mut document = json!({"scene": {"kind": "uploaded", "id": id}});
    for (name, value) in fields.as_object().unwrap() {
        document[name] = value.clone();
    }
    document
}

fn errors(document: &Value) -> Vec<FieldError> {
    check(document)
        .err()
        .unwrap_or_else(|| panic!("accepted: {document}"))
}

fn warnings(document: &Value) -> Vec<String> {
    check(document)
        .unwrap_or_else(|errors| panic!("{errors:#?}"))
        .warnings()
        .to_vec()
}

fn lamp() -> Value {
    json!({"kind": "point", "position_m": [0, 0, 0], "intensity": [1, 1, 1]})
}

#[test]
fn all_missing_ranges_are_reported_with_the_other_errors() {
    let found = errors(&over(
        json!("scn_flat"),
        json!({
            "alpha": 2,
            "water": {"optics": "jerlov-1C", "snow": {"density_per_m3": 1}},
            "lights": [{"kind": "haze", "x": 0, "y": 0}, lamp()],
            "artifacts": ["rgb", "range", "instances", "normals"],
        }),
    ));
    let pointers: Vec<_> = found.iter().map(|error| error.pointer.as_str()).collect();
    let expected = ["/alpha", "/artifacts/1", "/artifacts/2", "/artifacts/3"];
    assert_eq!(pointers, expected);
    assert_eq!(
        found[1].message,
        "the artifact \"range\" needs a range, which scene `scn_flat` lacks"
    );
    assert_eq!(
        found[1].limit.as_deref(),
        Some("only with a scene that has a range")
    );
    let possible = &found[2].allowed;
    assert!(possible.contains(&"rgb".to_owned()) && possible.contains(&"transmittance".to_owned()));
    assert!(
        !["range", "instances", "normals", "boxes"]
            .iter()
            .any(|kind| possible.contains(&(*kind).to_owned()))
    );
    assert_eq!(found[2].value, Some(json!("instances")));
}

#[test]
fn a_picture_without_a_range_passes_the_water_with_a_warning() {
    let fields = json!({
        "water": {"optics": "jerlov-1C", "snow": {"density_per_m3": 1}, "style": "muddy"},
        "lights": [{"kind": "haze", "x": 0, "y": 0}, lamp()],
    });
    let without = "needs a range, which scene `scn_flat` lacks; those frames are rendered without it";
    assert_eq!(
        warnings(&over(json!("scn_flat"), fields.clone())),
        [
            format!("`water.optics` at /water/optics {without}"),
            format!("`water.snow` at /water/snow {without}"),
            format!("the lamp `lights[1]` at /lights/1 {without}"),
        ]
    );
    assert_eq!(warnings(&over(json!("scn_deep"), fields)), [""; 0]);
    let defocused = json!({"camera": {"defocus": {"aperture_m": 0.01, "focus_m": 1}}});
    assert_eq!(
        errors(&over(json!("scn_flat"), defocused))[0].pointer,
        "/camera/defocus"
    );
}

#[test]
fn a_style_with_a_range_input_needs_a_scene_with_a_range() {
    let styled = |scene: &str, style: Value| over(json!(scene), json!({"water": {"style": style}}));
    let found = errors(&styled("scn_flat", json!("ranged")));
    assert_eq!(found.len(), 1, "{found:#?}");
    assert_eq!(found[0].pointer, "/water/style");
    assert_eq!(
        found[0].message,
        "the style \"ranged\" needs a range, which scene `scn_flat` lacks"
    );
    assert_eq!(found[0].value, Some(json!("ranged")));
    assert_eq!(
        found[0].limit.as_deref(),
        Some("only with a scene that has a range")
    );
    // A scene with a range, or a style without one: no warning.
    assert_eq!(warnings(&styled("scn_deep", json!("ranged"))), [""; 0]);
    assert_eq!(warnings(&styled("scn_flat", json!("muddy"))), [""; 0]);
    assert_eq!(
        warnings(&styled("scn_flat", json!({"choice": ["muddy", "ranged"]}))),
        [
            "the style \"ranged\" at /water/style/choice/1 needs a range, which scene `scn_flat` lacks; those frames are rendered without it"
        ]
    );
}

#[test]
fn the_parts_of_a_scene_can_be_requested() {
    let water = json!({"optics": {"preset": "jerlov-1C", "veil_gain": 0.3}});
    let fields = json!({"water": water, "lights": [lamp()], "artifacts": ["rgb", "range"]});
    assert_eq!(warnings(&over(json!("scn_deep"), fields.clone())), [""; 0]);
    let procedural = json!({"scene": {"kind": "procedural", "family": "structure"},
        "artifacts": ["range", "instances", "normals", "boxes", "semantics", "findings"]});
    assert_eq!(warnings(&procedural), [""; 0]);
}

#[test]
fn a_distribution_that_always_needs_a_part_is_rejected_and_one_that_may_causes_a_warning() {
    let waters = |choice: Value| over(json!("scn_flat"), json!({"water": {"choice": choice}}));
    let styles = json!({"water": {"style": {"choice": ["ranged", "ranged"]}}});
    let always = errors(&over(json!("scn_flat"), styles));
    let pointers: Vec<_> = always.iter().map(|error| error.pointer.as_str()).collect();
    assert_eq!(pointers, ["/water/style/choice/0", "/water/style/choice/1"]);
    assert_eq!(
        warnings(&waters(json!([{"style": "muddy"}, {"optics": "jerlov-3C"}]))),
        [
            "`water.optics` at /water/choice/1/optics needs a range, which scene `scn_flat` lacks; those frames are rendered without it"
        ]
    );
    // An artifact is missing whichever scene is drawn.
    let either = over(
        json!("scn_flat"),
        json!({"artifacts": ["rgb", {"choice": ["range", "boxes"]}]}),
    );
    assert_eq!(errors(&either).len(), 2);
    let lists = over(
        json!("scn_flat"),
        json!({"artifacts": {"grid": [["rgb"], ["rgb", "range"]]}}),
    );
    assert!(warnings(&lists)[0].contains("/artifacts/grid/1/1"));
    let lights = json!({"lights": [{"choice": [lamp(), {"kind": "haze", "x": 0, "y": 0}]}]});
    assert!(
        warnings(&over(json!("scn_flat"), lights))[0].contains("the lamp `lights[0]` at /lights/0/choice/0")
    );
}

#[test]
fn a_scene_by_chance_is_warned_of_unless_no_scene_will_do() {
    let water = json!({"water": {"optics": "jerlov-1C"}});
    let some = over(json!({"choice": ["scn_deep", "scn_flat"]}), water.clone());
    assert!(warnings(&some)[0].contains("which scene `scn_flat` lacks"));
    let none = json!({"artifacts": ["range"]});
    assert_eq!(
        errors(&over(json!({"grid": ["scn_flat", "scn_flat"]}), none))[0].message,
        "the artifact \"range\" needs a range, which scene `scn_flat` and another scene lack"
    );
    let mut mixed = water;
    mixed["scene"] = json!({"choice": [{"kind": "procedural", "family": "structure"}, {"kind": "uploaded", "id": "scn_flat"}]});
    assert_eq!(warnings(&mixed).len(), 1);
}

#[test]
fn missing_scenes_are_reported_at_their_pointer() {
    let found = errors(&over(
        json!({"choice": ["scn_deep", "scn_gone"]}),
        json!({"alpha": -1}),
    ));
    let pointers: Vec<_> = found.iter().map(|error| error.pointer.as_str()).collect();
    assert_eq!(pointers, ["/alpha", "/scene/id/choice/1"]);
    assert!(found[1].message.contains("`scn_gone` does not exist"));
}

#[test]
fn a_field_of_view_next_to_a_camera_has_no_effect() {
    let seen = json!({"camera": {"hfov_deg": 60}});
    let found = errors(&over(json!("scn_shot"), seen.clone()));
    assert_eq!((found.len(), found[0].pointer.as_str()), (1, "/camera/hfov_deg"));
    assert_eq!(warnings(&over(json!("scn_deep"), seen)), [""; 0]);
}

#[test]
fn files_have_the_named_parts() {
    let job = |scene: Value| {
        let document =
            json!({"scene": scene, "water": {"optics": "jerlov-1C"}, "artifacts": ["rgb", "range"]});
        Job::parse(document.to_string().as_bytes(), &vocabulary(true))
    };
    assert!(job(json!({"kind": "files", "rgb": "a.png", "z_depth": "d.npy"})).is_ok());
    let refused = job(json!({"kind": "files", "rgb": "a.png"})).unwrap_err().0;
    assert_eq!(refused.len(), 1);
    assert!(
        refused[0].message.ends_with("which the scene of `a.png` lacks"),
        "{}",
        refused[0].message
    );
}

#[test]
fn a_collection_becomes_the_scenes_that_it_has_now() {
    let document = |fields: Value| {
        let mut scene = json!({"kind": "collection", "name": "dock"});
        for (name, value) in fields.as_object().unwrap() {
            scene[name] = value.clone();
        }
        json!({"scene": scene, "count": 2})
    };
    let parse = |document: &Value| Job::parse(document.to_string().as_bytes(), &vocabulary(false));
    let collection = parse(&document(json!({}))).unwrap();
    assert_eq!(collection.frames(), 6);
    assert!(collection.canonical().contains(
        r#""scene":{"each":true,"id":{"grid":["scn_a","scn_b","scn_c"]},"kind":"collection","lighting":"in_air","name":"dock"}"#
    ));
    let ids: Vec<String> = (0..6)
        .map(|index| {
            collection
                .resolve(index)
                .unwrap()
                .scene
                .uploaded_id()
                .unwrap()
                .to_owned()
        })
        .collect();
    assert_eq!(ids, ["scn_a", "scn_b", "scn_c", "scn_a", "scn_b", "scn_c"]);
    assert_eq!(collection.uploaded_scene_ids(), ["scn_a", "scn_b", "scn_c"]);
    // An accepted job does not depend on later changes of the collection.
    let mut grown = vocabulary(false);
    grown.collections.clear();
    let again = Job::parse(collection.canonical().as_bytes(), &grown).unwrap();
    assert_eq!(again.canonical(), collection.canonical());
    assert_eq!(
        Job::from_canonical(collection.canonical()).unwrap().canonical(),
        collection.canonical()
    );

    let drawn = parse(&document(json!({"each": false}))).unwrap();
    assert_eq!(drawn.frames(), 2);
    assert!(drawn.canonical().contains(r#""id":{"choice":["#));

    let unknown = parse(&json!({"scene": {"kind": "collection", "name": "dok"}}))
        .unwrap_err()
        .0;
    assert_eq!((unknown.len(), unknown[0].pointer.as_str()), (1, "/scene/name"));
    assert_eq!(unknown[0].did_you_mean.as_deref(), Some("dock"));
    let wrong = parse(&document(json!({"each": 1}))).unwrap_err().0;
    assert_eq!(wrong[0].message, "`scene.each` must be true or false, but is 1");
    let named = json!({"scene": {"choice": [{"kind": "collection", "name": "dock"}, {"kind": "uploaded", "id": "scn_x"}]}});
    assert_eq!(
        Draft::collections_named(named.to_string().as_bytes()),
        ["dock".to_owned()].into()
    );
}

#[test]
fn a_collection_is_rejected_if_one_of_its_scenes_lacks_a_required_part() {
    let over = |scene: Value, fields: Value| {
        let mut document = fields;
        document["scene"] = scene;
        document
    };
    let known = |id: &str| {
        let range = id != "scn_b";
        let parts = SceneParts {
            range,
            ..SceneParts::default()
        };
        (id.to_owned(), parts)
    };
    let check = |document: &Value| {
        let vocabulary = vocabulary(false);
        let draft = Draft::read(document.to_string().as_bytes(), &vocabulary).unwrap();
        let uploads = Uploads::Known(["scn_a", "scn_b", "scn_c"].map(known).into());
        draft.check(&uploads).map_err(|invalid| invalid.0)
    };
    let asked = json!({"water": {"optics": "jerlov-1C"}, "artifacts": ["rgb", "range", "boxes"]});
    let collection = json!({"kind": "collection", "name": "dock"});
    let refused = check(&over(collection.clone(), asked.clone())).err().unwrap();
    let found: Vec<_> = refused
        .iter()
        .map(|error| (error.pointer.as_str(), error.message.as_str()))
        .collect();
    assert_eq!(
        found,
        [
            (
                "/artifacts/1",
                "the artifact \"range\" needs a range, which scene `scn_b` lacks"
            ),
            (
                "/artifacts/2",
                "the artifact \"boxes\" needs an instance mask, which scene `scn_a` and 2 other scenes lack"
            ),
        ]
    );
    // If chance decides the artifacts or the scene, some frames miss the part.
    let water = json!({"water": {"optics": "jerlov-1C"}});
    let by_chance = json!({"water": {"choice": [{}, {"optics": "jerlov-1C"}]}});
    let drawn = json!({"kind": "collection", "name": "dock", "each": false});
    for document in [over(collection.clone(), by_chance), over(drawn, water.clone())] {
        let accepted = check(&document).unwrap();
        assert!(
            accepted.warnings()[0].contains("which scene `scn_b` lacks"),
            "{:?}",
            accepted.warnings()
        );
    }
    let one_of = json!({"choice": [collection, {"kind": "uploaded", "id": "scn_a"}]});
    let accepted = check(&over(one_of, water)).unwrap();
    assert!(
        accepted
            .warnings()
            .iter()
            .any(|warning| warning.contains("which scene `scn_b` lacks")),
        "{:?}",
        accepted.warnings()
    );
}

#[test]
fn without_a_service_a_collection_is_rejected() {
    let scene = json!({"kind": "collection", "name": "dock", "id": {"grid": ["scn_a", "scn_b"]}});
    let found = Job::parse(json!({"scene": scene}).to_string().as_bytes(), &vocabulary(true));
    let found = found.unwrap_err().0;
    assert_eq!(
        (found.len(), found[0].pointer.as_str()),
        (1, "/scene/kind"),
        "{found:?}"
    );
    assert_eq!(
        found[0].message,
        "`scene.kind` \"collection\" needs a service: upload its scenes there and submit the job with `fathom submit`"
    );
    assert_eq!(found[0].allowed, ["procedural", "uploaded", "files"]);
}

#[test]
fn scene_files_fit_together() {
    let found = |scene: Value| {
        let text = json!({"scene": scene}).to_string();
        let errors = Job::parse(text.as_bytes(), &vocabulary(true)).unwrap_err().0;
        let pointers: Vec<_> = errors.iter().map(|error| error.pointer.as_str()).collect();
        pointers.join(" ")
    };
    let both = json!({"kind": "files", "rgb": "a", "range": "r", "z_depth": "z"});
    assert_eq!(found(both), "/scene/z_depth");
    assert_eq!(
        found(json!({"kind": "files", "rgb": "a", "unit_m": 1, "invalid_code": 0})),
        "/scene/unit_m /scene/invalid_code"
    );
    assert_eq!(found(json!({"kind": "files", "rgb": "a\0b"})), "/scene/rgb");
}
