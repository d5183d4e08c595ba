use serde_json::{Value, json};
use spec::{FieldError, Job, KnownNetwork, Vocabulary};

/// Test names; `local` allows files.
pub(crate) fn vocabulary(local: bool) -> Vocabulary {
    let names = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
    let water = json!({
        "absorption_per_m": [0.4, 0.2, 0.5], "scattering_per_m": [1.0, 1.1, 1.3],
        "diffuse_attenuation_per_m": [0.6, 0.4, 0.8], "backscatter_fraction": 0.02
    });
    let Value::Object(water) = water else {
        unreachable!("an object stands above")
    };
    Vocabulary {
        families: names(&["structure"]),
        presets: names(&[
            "jerlov-1C/williamson2022",
            "jerlov-3C/williamson2022",
            "uuv-simulator",
            "clear-kd",
        ]),
        rules: optics::water::RULES,
        cameras: names(&["inspection-flat-port"]),
        sensors: names(&["machine-vision-1/1.8", "ideal"]),
        camera_rules: camera::rules::RULES,
        unrenderable_presets: vec![("clear-kd".to_owned(), "it has no beam attenuation".to_owned())],
        waters: [("quay".to_owned(), water)].into(),
        styles: names(&["atlantic", "mediterranean", "muddy", "ranged"]),
        range_styles: names(&["ranged"]),
        enhancers: vec![network("for-64x48", Some([64, 48])), network("for-any", None)],
        metric_networks: Vec::new(),
        path_metrics: names(&["matches"]),
        metrics: names(&[
            "matches",
            "entropy",
            "uicm",
            "uism",
            "uiconm",
            "uiqm",
            "uiqm@table1",
            "uciqe",
            "psnr",
            "ssim",
        ]),
        collections: [("dock", vec!["scn_a", "scn_b", "scn_c"]), ("quay", vec![])]
            .map(|(name, ids)| (name.to_owned(), ids.into_iter().map(str::to_owned).collect()))
            .into(),
        local,
    }
}

fn network(name: &str, size: Option<[usize; 2]>) -> KnownNetwork {
    KnownNetwork {
        name: name.to_owned(),
        digest: String::new(),
        size,
    }
}

/// The minimal description with these fields; adds a style if `alpha` needs one.
pub(crate) fn document_with(fields: Value) -> Value {
    let mut document = json!({"scene": {"kind": "procedural", "family": "structure"}});
    let Value::Object(fields) = fields else {
        return fields;
    };
    if fields.contains_key("alpha") {
        document["water"] = json!({"style": "muddy"});
    }
    for (key, value) in fields {
        document[key] = value;
    }
    document
}

pub(crate) fn job(document: &Value) -> Job {
    let text = document.to_string();
    Job::parse(text.as_bytes(), &vocabulary(false)).unwrap_or_else(|errors| panic!("{text}\n{errors}"))
}

/// The job of the minimal description with these fields.
pub(crate) fn job_with(fields: Value) -> Job {
    job(&document_with(fields))
}

pub(crate) fn errors(document: &Value) -> Vec<FieldError> {
    match Job::parse(document.to_string().as_bytes(), &vocabulary(false)) {
        Ok(_) => panic!("accepted: {document}"),
        Err(errors) => errors.0,
    }
}

/// The only error of the minimal description with these fields.
pub(crate) fn only_error(fields: Value) -> FieldError {
    let mut found = errors(&document_with(fields.clone()));
    assert_eq!(found.len(), 1, "{fields}: {found:#?}");
    found.remove(0)
}

pub(crate) fn parameters(job: &Job, index: u64) -> Value {
    job.resolve(index).unwrap().parameters
}
