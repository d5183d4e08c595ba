//! Rejected descriptions: all errors together, each with its location and limit.

use serde_json::{Value, json};
use spec::{FieldError, Job, MAX_ERRORS};

use crate::common::{document_with, errors, only_error, vocabulary};

fn pointers(errors: &[FieldError]) -> Vec<&str> {
    errors.iter().map(|error| error.pointer.as_str()).collect()
}

#[test]
fn all_errors_are_reported_together() {
    let found = errors(&json!({
        "scene": {"kind": "procedural", "family": "structur"},
        "alpha": 1.5,
        "water": {"style": "atlantc", "optics": {"beam_attenuation_per_m": [-1, 0, 0]}, "range_scale": 0},
        "lights": [{"kind": "haze", "x": "NaN", "y": 0}],
        "artefacts": ["rgb"],
    }));
    assert_eq!(
        pointers(&found),
        [
            "/artefacts",
            "/scene/family",
            "/water/optics/beam_attenuation_per_m/0",
            "/water/range_scale",
            "/water/style",
            "/alpha",
            "/lights/0/x",
        ]
    );
    let meant: Vec<_> = found
        .iter()
        .filter_map(|error| error.did_you_mean.as_deref())
        .collect();
    assert_eq!(meant, ["artifacts", "structure", "atlantic"]);
    assert_eq!(found[4].allowed, ["atlantic", "mediterranean", "muddy", "ranged"]);
}

#[test]
fn an_error_names_field_value_and_limit() {
    let error = only_error(json!({"alpha": 1.5}));
    assert_eq!(error.message, "`alpha` is 1.5; must be 0..=1");
    assert_eq!(
        (error.value, error.limit.as_deref()),
        (Some(json!(1.5)), Some("0..=1"))
    );
}

#[test]
fn errors_serialize_without_empty_members() {
    let error = only_error(json!({"alpha": 1.5}));
    let text = json!({"pointer": "/alpha", "message": error.message, "value": 1.5, "limit": "0..=1"});
    assert_eq!(serde_json::to_value(&error).unwrap(), text);
}

#[test]
fn numbers_outside_their_limits_are_refused() {
    let refused = [
        (json!({"count": 0}), "/count", "1..=100000000"),
        (json!({"count": 1_000_000_000_000_u64}), "/count", "1..=100000000"),
        (json!({"count": 1.5}), "/count", "whole numbers in 1..=100000000"),
        (json!({"seed": -1}), "/seed", "0..=18446744073709551615"),
        (
            json!({"seed": 1e300}),
            "/seed",
            "whole numbers in 0..=18446744073709551615",
        ),
        (json!({"camera": {"width": 16_385}}), "/camera/width", "1..=16384"),
        (json!({"camera": {"height": 0}}), "/camera/height", "1..=16384"),
        (
            json!({"camera": {"width": 16_384, "height": 16_384}}),
            "/camera",
            "64000000 pixels",
        ),
        (
            json!({"camera": {"hfov_deg": 180}}),
            "/camera/hfov_deg",
            "1..=170",
        ),
        (
            json!({"water": {"range_scale": 0}}),
            "/water/range_scale",
            "above 0, at most 1000",
        ),
        (json!({"water": {"depth_m": -1}}), "/water/depth_m", "0..=12000"),
        (
            json!({"water": {"optics": "jerlov-1C", "holes": {"range_m": 0}}}),
            "/water/holes/range_m",
            "0.001..=100000",
        ),
        (
            json!({"fidelity": {"tolerance": 0}}),
            "/fidelity/tolerance",
            "1e-7..=1",
        ),
        (json!({"fidelity": {"terms": 65}}), "/fidelity/terms", "1..=64"),
        (
            json!({"encode": {"format": "jpeg", "quality": 0}}),
            "/encode/quality",
            "1..=100",
        ),
        (
            json!({"labels": {"a": "x".repeat(257)}}),
            "/labels/a",
            "at most 256 characters",
        ),
    ];
    for (fields, pointer, limit) in refused {
        let error = only_error(fields.clone());
        assert_eq!(
            (error.pointer.as_str(), error.limit.as_deref()),
            (pointer, Some(limit)),
            "{fields}"
        );
    }
}

#[test]
fn values_of_the_wrong_kind_report_the_expected_one() {
    let refused = [
        (
            json!({"alpha": "NaN"}),
            "`alpha` must be a number or a distribution, but is the string \"NaN\"",
        ),
        (
            json!({"alpha": null}),
            "`alpha` must be a number or a distribution, but is null; omit the field instead",
        ),
        (
            json!({"count": "3"}),
            "`count` must be a whole number, but is the string \"3\"",
        ),
        (
            json!({"lights": {}}),
            "`lights` must be a list or a distribution, but is an object",
        ),
        (
            json!({"water": []}),
            "`water` must be an object or a distribution, but is an empty list",
        ),
        (
            json!({"water": {"optics": 3}}),
            "`water.optics` must be a string or an object or a distribution, but is 3",
        ),
        (
            json!({"labels": {"a": [1]}}),
            "`labels.a` must be a number, string or boolean or a distribution, but is a list of 1",
        ),
        (
            json!({"water": {"optics": {"preset": "jerlov-1C", "veiling_light": [1, 2]}}}),
            "`water.optics.veiling_light` must be a list of three numbers (R, G, B) or a distribution, but is a list of 2",
        ),
    ];
    for (fields, message) in refused {
        assert_eq!(only_error(fields).message, message);
    }
    assert_eq!(
        errors(&json!([]))[0].message,
        "the description must be an object, but is an empty list"
    );
}

#[test]
fn unknown_names_suggest_the_nearest() {
    let refused = [
        (
            json!({"water": {"optics": "jerlov-3c"}}),
            "/water/optics",
            Some("jerlov-3C/williamson2022"),
        ),
        (
            json!({"water": {"optics": {"g_per_m": 1}}}),
            "/water/optics/g_per_m",
            None,
        ),
        (json!({"metrics": ["uiqm", "uqm"]}), "/metrics/1", Some("uiqm")),
        (
            json!({"metrics": ["uiqm@table"]}),
            "/metrics/0",
            Some("uiqm@table1"),
        ),
        (json!({"enhance": ["HSCM"]}), "/enhance/0", Some("hscm")),
        (
            json!({"artifacts": ["scatered"]}),
            "/artifacts/0",
            Some("scattered"),
        ),
        (
            json!({"fidelity": {"tolerence": 1e-3}}),
            "/fidelity",
            Some("tolerance"),
        ),
        (
            json!({"encode": {"format": "jpg"}}),
            "/encode/format",
            Some("jpeg"),
        ),
        (json!({"camera": {"hfov": 60}}), "/camera/hfov", Some("hfov_deg")),
    ];
    for (fields, pointer, meant) in refused {
        let error = only_error(fields.clone());
        assert_eq!(
            (error.pointer.as_str(), error.did_you_mean.as_deref()),
            (pointer, meant),
            "{fields}"
        );
        assert!(!error.allowed.is_empty(), "{fields}");
    }
}

#[test]
fn tags_must_be_present_and_constant() {
    let scene = |scene: Value| errors(&json!({"scene": scene})).remove(0);
    assert_eq!(scene(json!({})).message, "`scene.kind` is missing");
    assert_eq!(scene(json!({})).allowed, ["procedural", "uploaded", "collection"]);
    assert!(
        scene(json!({"kind": {"choice": ["uploaded"]}}))
            .message
            .contains("a choice of whole objects")
    );
    assert!(
        scene(json!({"kind": "files", "rgb": "a.png"}))
            .message
            .contains("works only with `fathom render`")
    );
    assert!(
        scene(json!({"kind": "uploaded"}))
            .message
            .starts_with("`scene.id` is missing")
    );
    assert_eq!(errors(&json!({}))[0].pointer, "/scene");
    let quality = only_error(json!({"encode": {"quality": 3}}));
    assert_eq!(
        quality.message,
        "`quality` belongs to format \"jpeg\", not to \"png\""
    );
    for field in ["count", "seed", "dataset"] {
        let error = only_error(json!({field: {"choice": [1, 2]}}));
        assert_eq!(error.message, format!("`{field}` cannot be a distribution"));
    }
}

#[test]
fn fidelity_is_exactly_one_of_three() {
    for fidelity in [json!({}), json!({"terms": 3, "tolerance": 1e-3})] {
        assert_eq!(
            only_error(json!({"fidelity": fidelity})).limit.as_deref(),
            Some("exactly one")
        );
    }
}

#[test]
fn a_removed_field_names_the_new_one() {
    let found = errors(&document_with(json!({
        "scene": {"kind": "procedural", "family": "structure", "light": "albedo"},
        "water": {"ambient": "exposed", "from_above": {"sun_share": 0.5, "sun": {"elevation_deg": 30}, "caustics": {}}},
        "lights": [{"kind": "point", "position_m": [0, 0, 0], "intensity": [1, 1, 1], "shadow": "soft"}],
        "enhance": ["ibla_hybrid"],
        "fidelity": {"variant": "noise"}, "rays": "auto"
    })));
    let messages: Vec<_> = found
        .iter()
        .map(|error| (error.pointer.as_str(), error.message.as_str()))
        .collect();
    let expected = [
        ("/scene/light", "`\"lighting\": \"water\"`"),
        ("/water/ambient", "`daylight`"),
        ("/water/from_above/sun_share", "`daylight.cloud_cover`"),
        (
            "/water/from_above/sun/elevation_deg",
            "`daylight.sun_elevation_deg`",
        ),
        ("/water/from_above/caustics", "`daylight.wind_m_per_s`"),
        ("/lights/0/shadow", "casts shadows"),
        ("/enhance/0", "\"ibla\""),
        ("/fidelity/variant", "`\"fidelity\": \"picture\"`"),
        ("/rays", "remove it"),
    ];
    for (pointer, text) in expected {
        let is_found = messages
            .iter()
            .any(|(at, message)| *at == pointer && message.contains(text));
        assert!(is_found, "{pointer} {text}: {messages:#?}");
    }
    assert_eq!(found.len(), expected.len(), "{messages:#?}");
}

#[test]
fn repeated_names_are_refused_even_if_only_possible() {
    assert_eq!(
        only_error(json!({"metrics": ["uiqm", "uicm", "uiqm"]})).pointer,
        "/metrics/2"
    );
    let choice = json!({"artifacts": ["rgb", {"choice": ["range", "rgb"]}]});
    assert_eq!(only_error(choice).pointer, "/artifacts/1/choice/1");
}

#[test]
fn lights_agree_on_their_space() {
    let light = |space: &str| json!({"kind": "haze", "x": 0, "y": 0, "space": space});
    let lights = json!({"lights": [light("linear"), {"choice": [light("linear"), light("display")]}]});
    assert_eq!(only_error(lights).pointer, "/lights/1/choice/1/space");
    assert_eq!(
        only_error(json!({"lights": vec![light("linear"); 65]})).message,
        "`lights` has 65 elements; must be at most 64"
    );
}

#[test]
fn labels_are_few_and_have_plain_names() {
    let beyond = only_error(json!({"labels": {"a": -9.3e18}})).message;
    assert!(beyond.contains("write it as text to keep all digits"), "{beyond}");
    let many: serde_json::Map<_, _> = (0..33).map(|i| (format!("l{i}"), json!(i))).collect();
    assert_eq!(
        only_error(json!({"labels": many})).message,
        "`labels` has 33 entries; must be at most 32"
    );
    for name in ["", "a b", "ü", "a/b", &"n".repeat(65)] {
        assert!(
            only_error(json!({"labels": {name: 1}}))
                .limit
                .unwrap()
                .starts_with("1 to 64")
        );
    }
}

#[test]
fn duplicate_keys_and_broken_text_are_refused() {
    let parse = |text: &str| Job::parse(text.as_bytes(), &vocabulary(false)).unwrap_err().0;
    assert_eq!(parse(r#"{"alpha": 0, "alpha": 1}"#)[0].pointer, "/alpha");
    assert!(
        parse(r#"{"alpha": NaN}"#)[0]
            .message
            .starts_with("not valid JSON")
    );
}

#[test]
fn the_list_of_errors_is_limited() {
    let names: serde_json::Map<_, _> = (0..5000).map(|i| (format!("unknown{i}"), json!(i))).collect();
    let found = errors(&document_with(Value::Object(names)));
    assert_eq!(found.len(), MAX_ERRORS + 1);
    assert!(found[MAX_ERRORS].message.contains("more than 100 errors"));
}

#[test]
fn a_canonical_form_beyond_the_size_limit_is_refused() {
    let water = format!(
        r#"{{"scene":{{"kind":"procedural","family":"structure"}},"water":{{"choice":[{}]}}}}"#,
        vec!["{}"; 50_000].join(",")
    );
    let found = Job::parse(water.as_bytes(), &vocabulary(false)).unwrap_err().0;
    let message = &found[0].message;
    assert!(message.contains("with its defaults"), "{message}");
}

#[test]
fn all_errors_read_as_lines() {
    let text = json!({"alpha": 2, "scene": {"kind": "procedural", "family": "structur"}}).to_string();
    let invalid = Job::parse(text.as_bytes(), &vocabulary(false)).unwrap_err();
    assert_eq!(
        invalid.to_string(),
        "/scene/family: `scene.family` \"structur\" is not a known scene family; did you mean `structure`?\n\
         /alpha: `alpha` is 2; must be 0..=1"
    );
}
