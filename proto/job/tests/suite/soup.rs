//! Random input: no panics, and valid descriptions keep their guarantees.

use proptest::prelude::*;
use serde_json::{Value, json};
use spec::{Job, fields::MAX_FRAMES};

use crate::common::{document_with, vocabulary};

/// A number or a distribution within a..=b.
fn number(a: f64, b: f64) -> BoxedStrategy<Value> {
    let ends = (a..=b, a..=b).prop_map(|(x, y)| (x.min(y), x.max(y)));
    let leaf = prop_oneof![
        (a..=b).prop_map(|x| json!(x)),
        ends.clone().prop_map(|(x, y)| json!({"uniform": [x, y]})),
        (ends, -2.0..2.0, 0.0..3.0)
            .prop_map(|((x, y), mean, sd)| json!({"normal": [mean, sd], "clip": [x, y]})),
        prop::collection::vec(a..=b, 1..4).prop_map(|values| json!({"grid": values})),
    ];
    leaf.prop_recursive(2, 8, 3, |inner| {
        prop::collection::vec((inner, 0.0..2.0), 1..4).prop_map(|pairs| {
            let (values, mut weights): (Vec<_>, Vec<_>) = pairs.into_iter().unzip();
            weights[0] += 0.1;
            json!({"choice": values, "weights": weights})
        })
    })
    .boxed()
}

fn optics() -> impl Strategy<Value = Value> {
    let custom = (number(0.5, 2.0), number(0.0, 0.5)).prop_map(|(c, g)| {
        json!({"beam_attenuation_per_m": [c, 1, 0.5], "veiling_light": [0.1, 0.2, 0.3],
            "forward_scatter": {"model": "jaffe", "g_per_m": [g, 0, 0.5], "spread_px_per_m": [1, 1, 1]}})
    });
    prop_oneof![
        Just(json!("jerlov-1C")),
        Just(json!({"choice": ["jerlov-1C", "jerlov-3C"]})),
        custom
    ]
}

fn description() -> impl Strategy<Value = Value> {
    let light = (number(-1.0, 2.0), number(0.0, 1.0), any::<bool>()).prop_map(|(x, intensity, add)| {
        let blend = if add { "add" } else { "over" };
        json!({"kind": "haze", "x": x, "y": 0.5, "intensity": intensity, "blend": blend})
    });
    (
        1_u64..20,
        any::<u64>(),
        number(0.0, 1.0),
        number(0.1, 5.0),
        optics(),
        prop::collection::vec(light, 0..3),
        prop_oneof![
            Just(json!("atlantic")),
            Just(json!({"choice": ["atlantic", "muddy"]}))
        ],
    )
        .prop_map(|(count, seed, alpha, scale, optics, lights, style)| {
            let water = json!({"range_scale": scale, "optics": optics, "style": style});
            document_with(
                json!({"count": count, "seed": seed, "alpha": alpha, "water": water, "lights": lights,
                "camera": {"width": {"int": [1, 100]}, "hfov_deg": {"log_uniform": [10, 100]}}}),
            )
        })
}

/// A valid description, or a job that mixes two of them as sites.
fn description_or_mix() -> impl Strategy<Value = Value> {
    let mix = (description(), description(), any::<bool>()).prop_map(|(first, second, in_turn)| {
        let sites = [("first", &first), ("second", &second)].map(|(name, description)| {
            let mut site = description.as_object().unwrap().clone();
            site.retain(|field, _| field != "count" && field != "seed");
            site.insert("name".to_owned(), json!(name));
            site
        });
        let law = if in_turn { "grid" } else { "choice" };
        json!({"count": first["count"], "seed": first["seed"], "site": {law: sites}})
    });
    prop_oneof![2 => description(), 1 => mix]
}

/// Any value of a document.
fn place(document: &mut Value, mut at: usize) -> Option<&mut Value> {
    if at == 0 {
        return Some(document);
    }
    at -= 1;
    let children: Vec<&mut Value> = match document {
        Value::Array(items) => items.iter_mut().collect(),
        Value::Object(fields) => fields.values_mut().collect(),
        _ => return None,
    };
    for child in children {
        let size = size(child);
        if at < size {
            return place(child, at);
        }
        at -= size;
    }
    None
}

fn size(value: &Value) -> usize {
    1 + match value {
        Value::Array(items) => items.iter().map(size).sum(),
        Value::Object(fields) => fields.values().map(size).sum(),
        _ => 0,
    }
}

fn odd() -> impl Strategy<Value = Value> {
    prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        any::<u64>().prop_map(Value::from),
        any::<f64>().prop_map(Value::from),
        ".{0,12}".prop_map(Value::from),
        Just(json!([])),
        Just(json!({})),
        Just(json!({"choice": [{"choice": [1, "x", {}]}], "weights": [1]})),
        Just(json!({"grid": [1, [2], {"uniform": [0, 1]}]})),
        Just(json!({"normal": [1e308, 1e308], "clip": [-1e308, 1e308]})),
        Just(json!({"int": [-1, i64::MAX]})),
        Just(json!({"kind": "haze"})),
    ]
}

fn no_law(value: &Value) -> bool {
    match value {
        Value::Array(items) => items.iter().all(no_law),
        Value::Object(fields) => {
            let laws = ["choice", "grid", "int", "log_uniform", "normal", "uniform"];
            fields.keys().all(|key| !laws.contains(&key.as_str())) && fields.values().all(no_law)
        }
        _ => true,
    }
}

fn parse(document: &Value) -> Result<Job, spec::Invalid> {
    Job::parse(document.to_string().as_bytes(), &vocabulary(false))
}

/// Resolves some frames of a job, valid or not, and checks their guarantees.
fn try_frames(job: &Job) {
    assert!((1..=MAX_FRAMES).contains(&job.frames()));
    for index in [0, 1, job.frames() / 2, job.frames() - 1] {
        let Ok(frame) = job.resolve(index) else {
            assert!(
                index >= job.frames(),
                "frame {index} of {}: {:?}",
                job.canonical(),
                job.resolve(index)
            );
            continue;
        };
        assert!((0.0..=1.0).contains(&frame.alpha));
        assert!((1..=16_384).contains(&frame.camera.width) && (1.0..=170.0).contains(&frame.camera.hfov_deg));
        assert!(
            frame
                .haze()
                .iter()
                .all(|light| (0.0..=1.0).contains(&light.intensity))
        );
        assert!(frame.water.range_scale > 0.0 && frame.water.range_scale <= 1000.0);
        assert!(no_law(&frame.parameters), "{}", frame.parameters);
        assert_eq!(
            frame.artifacts.len(),
            frame.parameters["artifacts"].as_array().unwrap().len()
        );
        // The parameters of a frame are a job of one frame that yields the same frame. It is rejected only if a field
        // needs a value that only another frame had.
        let alone = match parse(&frame.parameters) {
            Ok(alone) => alone,
            Err(invalid) => {
                let is_need = |limit: &String| limit.starts_with("needs ");
                assert!(
                    invalid
                        .0
                        .iter()
                        .all(|error| error.limit.as_ref().is_some_and(is_need)),
                    "{invalid}"
                );
                continue;
            }
        };
        assert_eq!(alone.frames(), 1);
        assert_eq!(alone.resolve(0).unwrap().parameters, frame.parameters);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(Job::parse(&bytes, &vocabulary(true)).is_err());
    }

    #[test]
    fn json_like_text_never_panics(text in r#"[\[\]{}:,"a-z0-9.eE+\- \\]{0,80}"#) {
        prop_assert!(Job::parse(text.as_bytes(), &vocabulary(true)).is_err());
    }

    #[test]
    fn valid_descriptions_keep_their_promises(document in description_or_mix()) {
        let job = parse(&document).unwrap();
        try_frames(&job);
        let again = Job::parse(job.canonical().as_bytes(), &vocabulary(false)).unwrap();
        prop_assert_eq!(job.canonical(), again.canonical());
    }

    #[test]
    fn frames_do_not_depend_on_the_count(document in description_or_mix(), more in 20_u64..1000) {
        let few = parse(&document).unwrap();
        let cells = few.frames() / document["count"].as_u64().unwrap_or(1);
        prop_assume!(cells * more <= 100_000_000);
        let mut document = document;
        document["count"] = json!(more);
        let many = parse(&document).unwrap();
        for index in 0..few.frames().min(5) {
            prop_assert_eq!(few.resolve(index), many.resolve(index));
        }
    }

    #[test]
    fn mutated_descriptions_never_panic(document in description_or_mix(), at in 0_usize..60, odd in odd(), more in odd(), also in 0_usize..60) {
        let mut document = document;
        for (at, value) in [(at, odd), (also, more)] {
            if let Some(place) = place(&mut document, at) {
                *place = value;
            }
        }
        if let Ok(job) = parse(&document) {
            try_frames(&job);
        }
    }

    #[test]
    fn cut_descriptions_never_panic(document in description_or_mix(), cut in 0.0..1.0) {
        let text = document.to_string();
        let cut = (cut * text.len() as f64) as usize;
        prop_assert!(Job::parse(&text.as_bytes()[..cut], &vocabulary(false)).is_err());
    }
}
