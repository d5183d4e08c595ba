//! `ERRORS.md` shows every error text of descriptions for review. `FATHOM_WRITE=1 cargo test -p spec` updates it.

use std::fmt::Write as _;

use serde_json::{Value, json};
use spec::{Draft, Invalid, Job, OwnWater, SceneParts, Uploads, Vocabulary};

use crate::common::vocabulary;
use crate::generated::check_page;

/// Complete documents.
const DOCUMENTS: &[&str] = &[
    "",
    "{",
    "[]",
    "{}",
    r#"{"seed": 1, "seed": 2}"#,
    r#"{"seed": 1e999}"#,
    r#"{"count": 100000000, "alpha": {"grid": [0, 1]}, "scene": {"kind": "procedural", "family": "structure"}}"#,
    r#"{"alpha": 0.5, "scene": {"kind": "procedural", "family": "structure"}}"#,
    r#"{"scene": {"kind": "procedural"}}"#,
    r#"{"scene": {"family": "structure"}}"#,
    r#"{"scene": {"kind": 3}}"#,
    r#"{"scene": {"kind": "procedura", "family": "structure"}}"#,
    r#"{"scene": {"kind": "procedural", "family": "structur"}}"#,
    r#"{"scene": {"kind": "procedural", "family": "structure", "id": "scn_1"}}"#,
    r#"{"scene": {"kind": "procedural", "family": "structure", "light": "baked"}}"#,
    r#"{"scene": {"kind": "files", "rgb": "a.png"}}"#,
    r#"{"scene": {"kind": "collection", "name": "dok"}}"#,
    r#"{"scene": {"kind": "uploaded", "id": "x"}}"#,
    r#"{"scene": {"kind": "uploaded", "id": "scn_gone"}}"#,
    r#"{"scene": {"kind": "uploaded", "id": "scn_flat"}, "artifacts": ["range", "instances", "normals"]}"#,
    r#"{"scene": {"kind": "uploaded", "id": {"choice": ["scn_flat", "scn_deep"]}}, "artifacts": ["instances"]}"#,
    r#"{"scene": {"kind": "uploaded", "id": "scn_flat"}, "camera": {"defocus": {"aperture_m": 0.01, "focus_m": 1}}}"#,
    r#"{"scene": {"kind": "uploaded", "id": "scn_flat"}, "water": {"style": "ranged"}}"#,
    r#"{"scene": {"kind": "uploaded", "id": "scn_shot"}, "camera": {"hfov_deg": 60}}"#,
    r#"{"scene": {"kind": "uploaded", "id": "scn_deep"}, "camera": {"width": 100}}"#,
];

/// Fields of a procedural scene.
const FIELDS: &[&str] = &[
    r#"{"sed": 1}"#,
    r#"{"daylight": "none", "sun_elevation_deg": 30, "wind_m_per_s": 3}"#,
    r#"{"daylight": {"none": true, "sun_elevation_deg": 30}}"#,
    r#"{"alpha": 3, "water": {"style": "muddy"}}"#,
    r#"{"alpha": "x"}"#,
    r#"{"alpha": null}"#,
    r#"{"count": 1.5}"#,
    r#"{"count": {"int": [1, 2]}}"#,
    r#"{"seed": -1}"#,
    r#"{"dataset": "A b"}"#,
    r#"{"encode": {"format": "png", "quality": 9}}"#,
    r#"{"encode": {"format": {"choice": ["png", "webp"]}}}"#,
    r#"{"fidelity": {"tolerance": 0.1, "terms": 2}}"#,
    r#"{"fidelity": {"tolerence": 0.1}}"#,
    r#"{"metrics": ["uiqm", "uiqm"]}"#,
    r#"{"metrics": ["uiqn"]}"#,
    r#"{"enhance": "hscm"}"#,
    r#"{"water": {"style": "mudy"}}"#,
    r#"{"water": {"holes": "reflect"}}"#,
    r#"{"lights": [{"kind": "point", "position_m": [0, 0], "intensity": [1, 1, 1]}]}"#,
    r#"{"labels": {"a b": 1}}"#,
    r#"{"labels": {"x": [1]}}"#,
    r#"{"camera": {"width": 16384, "height": 16384}}"#,
    r#"{"camera": {"bits": 16}, "encode": {"format": "webp"}}"#,
    r#"{"camera": {"port": {"kind": "flat", "glass_m": 0.01}, "distortion": {"k1": -0.9}, "hfov_deg": 160}}"#,
    r#"{"water": {"ambient": 0.1}}"#,
    r#"{"water": {"optics": "clear-kd"}}"#,
    r#"{"water": {"optics": "jerlov-1D"}}"#,
    r#"{"water": {"optics": {"preset": {"choice": ["jerlov-1C", "quay"]}}}}"#,
    r#"{"water": {"optics": {"absorption_per_m": [0.1, 0.1, 0.1]}}}"#,
    r#"{"water": {"optics": {"preset": "jerlov-1C", "forward_scatter": {"g_per_m": [9, 9, 9]}}}}"#,
    r#"{"water": {"optics": {"preset": "jerlov-1C", "forward_scatter": {"g_per_m": {"choice": [[0, 0, 0], [9, 9, 9]]}}}}}"#,
];

const DISTRIBUTIONS: &[&str] = &[
    r#"{"unifrom": [0, 1]}"#,
    r#"{"uniform": 0.5}"#,
    r#"{"uniform": [1, 0]}"#,
    r#"{"uniform": [0, 2]}"#,
    r#"{"uniform": [-1.7e308, 1.7e308]}"#,
    r#"{"uniform": [0, 1], "int": [0, 1]}"#,
    r#"{"uniform": [0, 1], "clip": [0, 1]}"#,
    r#"{"log_uniform": [0, 1]}"#,
    r#"{"int": [0, 0.5]}"#,
    r#"{"int": [1, 0]}"#,
    r#"{"int": [0, 9007199254740993]}"#,
    r#"{"normal": [0.5], "clip": [0, 1]}"#,
    r#"{"normal": [0.5, -1], "clip": [0, 1]}"#,
    r#"{"normal": [0.5, 1]}"#,
    r#"{"normal": [0.5, 1], "clip": [0]}"#,
    r#"{"normal": [0.5, 1], "clip": [1, 0]}"#,
    r#"{"normal": [0.5, 1], "clip": [0, 2]}"#,
    r#"{"choice": []}"#,
    r#"{"choice": 1}"#,
    r#"{"choice": [0, 3]}"#,
    r#"{"choice": [0, 1], "weigths": [1, 1]}"#,
    r#"{"choice": [0, 1], "weights": [1]}"#,
    r#"{"choice": [0, 1], "weights": ["1", 1]}"#,
    r#"{"choice": [0, 1], "weights": [1, -1]}"#,
    r#"{"choice": [0, 1], "weights": [0, 0]}"#,
    r#"{"choice": [0, 1], "weights": [1e308, 1e308]}"#,
];

/// Fields of a procedural scene that break a rule across fields.
const RULES: &[&str] = &[
    r#"{"camera": {"width": {"uniform": [100, 200]}}}"#,
    r#"{"water": {"style": {"uniform": [0, 1]}}}"#,
    r#"{"water": {"depth_m": 3}}"#,
    r#"{"camera": {"frames_per_s": 10}}"#,
    r#"{"camera": {"path": {"frames": 3, "frame": 3}}}"#,
    r#"{"camera": {"path": {"frames": 3, "start": {"position_m": [0, 0, 1], "target_m": [0, 1, 1]}, "end": {"position_m": [0, 0, 1], "target_m": [0, 1, 1]}}}}"#,
    r#"{"camera": {"view": {"yaw_deg": 0}, "path": {"frames": 3, "start": {"position_m": [0, 0, 1], "target_m": [0, 1, 1]}, "end": {"position_m": [0, 0, 1], "target_m": [1, 1, 1]}}}}"#,
    r#"{"camera": {"up": [0, -1, 0]}}"#,
    r#"{"lights": [{"kind": "spot", "position_m": [0, 0, 1], "intensity": [1, 1, 1], "direction": [0, 0, 0]}]}"#,
    r#"{"lights": [{"kind": "haze", "x": 0, "y": 0}, {"kind": "haze", "x": 0, "y": 0, "space": "display"}]}"#,
    r#"{"truth": {"target": 0.1}}"#,
    r#"{"artifacts": ["truth"], "camera": {"distortion": {"k1": 0.1}}}"#,
    r#"{"artifacts": ["truth"], "truth": {"paths_max": 1048576}}"#,
    r#"{"artifacts": ["truth"], "truth": {"budget_s": 0.001}}"#,
    r#"{"artifacts": ["snow_mask"]}"#,
    r#"{"artifacts": ["raw"]}"#,
    r#"{"artifacts": ["enhanced.hscm"]}"#,
    r#"{"enhance": ["hscm"], "artifacts": ["enhanced.hscm.medain"]}"#,
    r#"{"enhance": ["hscm", {"method": "hscm", "cutoff": 16}]}"#,
    r#"{"enhance": [{"steps": [{"clahe": {}}]}]}"#,
    r#"{"enhance": [{"method": "hscm", "gain_low": 3, "median_px": 4}]}"#,
    r#"{"enhance": [{"method": "clahe", "cutoff": 16}]}"#,
    r#"{"metrics": ["matches"]}"#,
    r#"{"metrics": ["matches"], "camera": {"path": {"frames": 1}}}"#,
    r#"{"artifacts": ["flow"]}"#,
    r#"{"artifacts": ["flow"], "camera": {"path": {"frames": 1}}}"#,
    r#"{"artifacts": ["flow"], "camera": {"path": {"frames": 9}, "readout_s": 0.02}}"#,
    r#"{"metrics": ["matches"], "camera": {"path": {"frames": 9}, "readout_s": 0.02}}"#,
    r#"{"artifacts": ["rgb_right"]}"#,
    r#"{"camera": {"stereo": {"baseline_m": 0.1}}}"#,
    r#"{"artifacts": ["disparity"], "camera": {"stereo": {"baseline_m": 0}}}"#,
    r#"{"artifacts": ["disparity"], "camera": {"stereo": {}}}"#,
    r#"{"daylight": {"cloud_cover": 0}}"#,
    r#"{"daylight": "none"}"#,
    r#"{"daylight": {"choice": ["none", "auto"]}}"#,
    r#"{"daylight": "none", "lights": [{"kind": "point", "position_m": [0, 0, 0], "intensity": [1, 1, 1]}], "water": {"optics": {"preset": "jerlov-1C", "veil_gain": {"uniform": [0, 2]}}}}"#,
    r#"{"camera": {"path": {"frames": 3, "start": {"position_m": [0, 0, 1], "target_m": [0, 1, 1]}, "end": {"position_m": [0, 0, {"uniform": [-2, 3]}], "target_m": [0, 1, 1]}}}}"#,
    r#"{"daylight": {"cloud_cover": 0}, "water": {"optics": {"preset": "jerlov-1C", "veil_gain": 2}}}"#,
];

const SITES: &[&str] = &[
    r#"{"site": "tnk"}"#,
    r#"{"site": "tnk", "alpha": 2, "scene": {"cracks": 0.1}}"#,
    r#"{"site": {"choice": ["tank"], "weights": [1, 2]}}"#,
    r#"{"site": {"name": "quay-7", "count": 3}}"#,
    r#"{"site": {"choice": [{"name": "quay-7", "seed": 1}, {"name": "quay-7"}]}}"#,
    r#"{"site": {"choice": [{"name": "a", "alpha": 1}, {"name": "a"}]}}"#,
    r#"{"site": {"choice": ["paper", "tank"]}, "alpha": 0.5}"#,
    r#"{"site": {"choice": ["a", "a", "a", "a", "a", "a", "a", "a", "a", "a", "a", "a", "a", "a", "a", "a", "a"]}}"#,
    r#"{"site": {"choice": ["pipeline", "shaft"]}, "camera": {"path": {"frames": 9}}}"#,
];

const WATERS: &[&str] = &[
    r#"{"name": "quay"}"#,
    r#"{"name": "quay 7", "source": "", "wavelength_nm": [650, 550, 450]}"#,
    r#"{"name": "quay", "source": "measured", "wavelength_nm": [650, 550], "jerlov_type": "4C"}"#,
];

const STORED: &[&str] = &[
    r#"{"alpha": 0.5}"#,
    r#"{"daylight": "auto"}"#,
    r#"{"daylight": "auto", "dataset": "a", "scene": {"family": "shaft", "kind": "gone"}}"#,
    r#"{"daylight": "auto", "scene": {"family": "shaft", "kind": "procedural", "seed": "1"}}"#,
    r#"{"daylight": "auto", "scene": {"family": {"choice": []}, "kind": "procedural"}}"#,
    r#"{"daylight": "auto", "later": 1}"#,
    r#"{"site": {"choice": ["tank"]}}"#,
];

fn check(document: &str, vocabulary: &Vocabulary) -> Result<Job, Invalid> {
    let flat = SceneParts::default();
    let deep = SceneParts { range: true, ..flat };
    let shot = SceneParts { camera: true, ..deep };
    let known = [("scn_flat", flat), ("scn_deep", deep), ("scn_shot", shot)];
    let known = known.map(|(id, parts)| (id.to_owned(), parts));
    Draft::read(document.as_bytes(), vocabulary)?.check(&Uploads::Known(known.into()))
}

fn check_fields(fields: &str) -> Result<Job, Invalid> {
    let mut document: Value = serde_json::from_str(fields).unwrap();
    document["scene"] = json!({"kind": "procedural", "family": "structure"});
    check(&document.to_string(), &vocabulary(false))
}

fn check_distribution(distribution: &str) -> Result<Job, Invalid> {
    check_fields(&format!(
        r#"{{"alpha": {distribution}, "water": {{"style": "muddy"}}}}"#
    ))
}

fn check_site(document: &str) -> Result<Job, Invalid> {
    let names = ["structure", "shaft", "pipeline"].map(str::to_owned);
    let vocabulary = Vocabulary {
        families: names.into(),
        presets: [
            "jerlov-IB/williamson2022",
            "jerlov-II/williamson2022",
            "jerlov-1C/williamson2022",
            "jerlov-3C/williamson2022",
            "jerlov-7C/solonenko2015",
            "jerlov-IB/solonenko2015",
        ]
        .map(str::to_owned)
        .into(),
        ..vocabulary(false)
    };
    check(document, &vocabulary)
}

/// Shows each input with its errors, or with the warnings of a valid one.
fn write_section(
    page: &mut String,
    title: &str,
    inputs: &[&str],
    check: impl Fn(&str) -> Result<Job, Invalid>,
) {
    write!(page, "\n## {title}\n").unwrap();
    for input in inputs {
        write!(page, "\n```json\n{input}\n```\n\n").unwrap();
        match check(input) {
            Ok(job) => {
                assert!(!job.warnings().is_empty(), "accepted without a warning: {input}");
                for warning in job.warnings() {
                    writeln!(page, "- warning: {warning}").unwrap();
                }
            }
            Err(invalid) => {
                for line in invalid.to_string().lines() {
                    writeln!(page, "- {line}").unwrap();
                }
            }
        }
    }
}

fn generate() -> String {
    let mut page =
        "# Error texts of descriptions\n\nGenerated by `FATHOM_WRITE=1 cargo test -p spec`: wrong inputs \
                    with the errors that `fathom` and the API report.\n"
            .to_owned();
    write_section(&mut page, "Documents", DOCUMENTS, |document| {
        check(document, &vocabulary(false))
    });
    let long = [
        "[".repeat(33) + &"]".repeat(33),
        format!(r#"{{"{}": 1}}"#, "k".repeat(257)),
        format!(r#"{{"labels": {{"x": "{}"}}}}"#, "x".repeat(257)),
    ];
    let long = long.each_ref().map(String::as_str);
    write_section(&mut page, "Long documents", &long, |document| {
        check(document, &vocabulary(false))
    });
    write_section(&mut page, "Fields", FIELDS, check_fields);
    write_section(
        &mut page,
        "Distributions of `alpha`",
        DISTRIBUTIONS,
        check_distribution,
    );
    write_section(&mut page, "Rules across fields", RULES, check_fields);
    write_section(&mut page, "Sites", SITES, check_site);
    write_section(&mut page, "Without a service", &DOCUMENTS[16..19], |document| {
        check(document, &vocabulary(true))
    });
    write_section(&mut page, "User-defined waters", WATERS, |water| {
        OwnWater::parse(water.as_bytes(), |_| Ok(())).map(|_| panic!("accepted: {water}"))
    });
    write_section(&mut page, "Stored jobs", STORED, Job::from_canonical);
    page
}

#[test]
fn the_page_of_error_texts_is_up_to_date() {
    check_page("ERRORS.md", |_| generate());
}
