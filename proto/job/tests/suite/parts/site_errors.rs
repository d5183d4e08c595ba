//! Errors of sites.

use serde_json::{Value, json};
use spec::{MAX_ERRORS, SITES};

use super::sites::{errors, mixed};

#[test]
fn an_unknown_site_comes_with_the_known_ones() {
    let error = errors(&json!({"site": "shfat"})).remove(0);
    assert_eq!(error.pointer, "/site");
    assert_eq!(error.did_you_mean.as_deref(), Some("shaft"));
    assert_eq!(error.allowed.len(), SITES.len());
    let error = errors(&json!({"site": {"choice": ["shaft", "tnak"]}})).remove(0);
    assert_eq!(
        (error.pointer.as_str(), error.did_you_mean.as_deref()),
        ("/site/choice/1", Some("tank"))
    );
}

fn error_pointers(document: &Value) -> Vec<String> {
    let found = errors(document).into_iter();
    found.map(|error| error.pointer).collect()
}

#[test]
fn the_other_errors_are_listed_next_to_those_of_the_site() {
    // Fields of the site do not count as missing: the scene, its kind, the preset of the water.
    let overrides = json!({
        "site": "tnk", "alpha": 2, "sed": 1, "scene": {"cracks": 0.1}, "camera": {"width": 0},
        "water": {"optics": {"backscatter_fraction": 0.02}, "snow": null},
    });
    let found = error_pointers(&overrides);
    assert_eq!(found, ["/site", "/sed", "/camera/width", "/alpha"]);
    // A null removes a field, but not the site.
    let nulls = json!({"site": null, "lights": null, "seed": -1});
    assert_eq!(error_pointers(&nulls), ["/site", "/seed"]);
    // The known sites of a mix are checked.
    let mixed = json!({"site": {"choice": ["tank", "tnk"]}, "alpha": 0.5});
    assert_eq!(error_pointers(&mixed), ["/site/choice/1", "/alpha"]);
    let own = json!({"site": {"name": "quay", "count": 3, "alpha": 2}});
    assert_eq!(
        error_pointers(&own),
        ["/site/count", "/site/alpha", "/site/scene"]
    );
}

#[test]
fn bad_sites_are_rejected_at_their_pointer() {
    let cases = [
        (json!(7), "/site", "must be a string or a distribution"),
        (
            json!({"nam": "shaft"}),
            "/site",
            "must be a string or a distribution",
        ),
        (json!({"choice": []}), "/site", "`choice` is empty"),
        (
            json!({"choice": ["shaft"], "weights": [1, 2]}),
            "/site",
            "`weights` has 2 numbers; must have 1, one per value",
        ),
        (json!({"uniform": [0, 1]}), "/site", "yields a number"),
        (json!({"name": "a b"}), "/site", "must be 1 to 64"),
        (json!({"name": "x", "seed": 4}), "/site/seed", "next to `site`"),
        (
            json!({"grid": ["tank", {"name": "tank", "alpha": 1}]}),
            "/site/grid/1",
            "two different sites",
        ),
        (json!({"grid": vec!["tank"; 17]}), "/site", "must be at most 16"),
    ];
    for (site, pointer, message) in cases {
        let error = errors(&json!({"site": site})).remove(0);
        assert_eq!(error.pointer, pointer, "{site}: {error:?}");
        assert!(error.message.contains(message), "{site}: {error:?}");
    }
}

#[test]
fn errors_of_a_mix_name_the_field_and_the_site_if_it_is_not_every_site() {
    let mut document = mixed();
    document["water"] = json!({"depth_m": -2});
    document["scene"] = json!({"cracks": 3});
    let found = errors(&document);
    let places: Vec<_> = found
        .iter()
        .map(|error| (error.pointer.as_str(), error.message.as_str()))
        .collect();
    assert_eq!(places.len(), 2, "{places:#?}");
    assert_eq!(places[0].0, "/scene/cracks");
    assert!(places[1].1.starts_with("`water.depth_m` is -2"), "{places:#?}");

    // The wall has neither lamps nor a fixed scene; the job does not name the shaft.
    let error = errors(&json!({
        "site": {"choice": ["paper", "tank"]}, "water": {"snow": null}, "artifacts": ["raw"],
    }));
    assert_eq!(error.len(), 1, "{error:#?}");
    assert_eq!(error[0].pointer, "/artifacts/0");
    assert!(
        error[0]
            .message
            .starts_with("site `paper`: the artifact \"raw\" needs"),
        "{error:#?}"
    );

    let own = json!({"name": "own", "scene": {"kind": "procedural", "family": "strcture"}});
    let error = errors(&json!({"site": {"choice": ["tank", own]}})).remove(0);
    assert_eq!(error.pointer, "/site/choice/1/scene/family");
    assert!(error.message.starts_with("site `own`: "), "{error:?}");
}

#[test]
fn at_most_a_hundred_errors_of_all_sites_are_listed() {
    let labels: serde_json::Map<_, _> = (0..60).map(|n| (format!("x{n}"), json!(1))).collect();
    let own = |name: &str, field: &str| {
        let mut fields: serde_json::Map<_, _> = labels
            .iter()
            .map(|(key, value)| (format!("{field}{key}"), value.clone()))
            .collect();
        fields.insert("name".to_owned(), name.into());
        Value::from(fields)
    };
    let found = errors(&json!({"site": {"choice": [own("a", "p"), own("b", "q")]}}));
    assert_eq!(found.len(), MAX_ERRORS + 1);
    assert!(found[MAX_ERRORS].message.contains("more than 100 errors"));
}
