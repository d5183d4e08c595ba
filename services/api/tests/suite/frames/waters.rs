//! User-defined waters: checked, stored, used by name, deleted.

use serde_json::{Value, json};

use crate::common::worker::Real;
use crate::common::{Setup, job, start, start_on};

fn quay() -> Value {
    json!({"name": "quay-7", "source": "our transmissometer", "licence": "CC-BY-4.0", "wavelength_nm": [650, 532, 450],
        "absorption_per_m": [0.42, 0.2, 0.5], "scattering_per_m": [1.0, 1.1, 1.3],
        "diffuse_attenuation_per_m": [0.6, 0.4, 0.8], "backscatter_fraction": 0.02})
}

fn in_quay() -> Value {
    let mut job = job();
    job["water"]["optics"] = json!("quay-7");
    job
}

#[test]
fn a_water_is_listed_with_its_derived_values() {
    let service = start();
    let made = service.post("/v1/waters", &quay());
    assert_eq!(made.status, 201, "{}", made.text());
    assert_eq!(made.header("location"), "/v1/waters/quay-7");
    let water = made.json();
    assert_eq!(water["beam_attenuation_per_m"], json!([1.42, 1.3, 1.8]));
    let derived = water["derived"].as_array().unwrap();
    assert!(derived.contains(&json!("beam_attenuation_per_m")) && derived.contains(&json!("veiling_light")));
    assert!(!derived.contains(&json!("backscatter_fraction")), "{derived:?}");
    assert_eq!(service.get("/v1/waters/quay-7").json(), water);
    let list = service.get("/v1/waters").json();
    assert_eq!(list["items"].as_array().unwrap().last(), Some(&water));
    let shipped = service.get("/v1/waters/jerlov-3C%2Fsolonenko2015").json();
    assert_eq!(
        (&shipped["created_at"], &shipped["scattering_per_m"][2]),
        (&Value::Null, &json!(1.5))
    );
    assert_eq!(
        service.get("/v1/waters/jerlov-3C").json()["name"],
        "jerlov-3C/williamson2022"
    );
    service.get("/v1/waters/jerlov-4C").problem(404, "not-found");
}

#[test]
fn every_preset_is_listed_and_unknown_numbers_are_null() {
    let service = start();
    let list = service.get("/v1/waters").json();
    let find_water = |name: &str| {
        let items = list["items"].as_array().unwrap();
        items
            .iter()
            .find(|water| water["name"] == name)
            .cloned()
            .unwrap_or_else(|| panic!("no {name}"))
    };
    assert_eq!(
        list["items"].as_array().unwrap().len(),
        optics::preset::presets().len()
    );
    let partly = find_water("jerlov-5C/solonenko2015");
    assert_eq!(partly["absorption_per_m"], json!([null, 0.117, 0.297]));
    assert!(partly["unrenderable"].is_string() && partly["g_per_m"].is_null());
    let kd = find_water("kd-I/uwcnn-printed");
    assert_eq!(
        (&kd["beam_attenuation_per_m"], &kd["derived"]),
        (&Value::Null, &json!(["diffuse_attenuation_per_m"]))
    );
    assert_eq!(
        find_water("kd-IB/uwcnn-printed")["defects"]
            .as_array()
            .unwrap()
            .len(),
        2
    );
    assert_eq!(
        find_water("kd-I/jerlov1976")["warnings"]
            .as_array()
            .unwrap()
            .len(),
        1
    );
    assert_eq!(find_water("autec-8/petzold1972")["backscatter_fraction"], 0.044);
    assert_eq!(find_water("jerlov-1C/williamson2022")["spread_offset_rad"], 0.009);
}

#[test]
fn frames_in_it_are_rendered_by_workers_that_never_heard_of_it() {
    let service = start();
    assert_eq!(service.post("/v1/waters", &quay()).status, 201);
    let _worker = Real::start(&service);
    let id = service.submit(&in_quay());
    assert_eq!(service.delete("/v1/waters/quay-7").status, 204);
    let ended = service.get(&format!("/v1/jobs/{id}?wait=60")).json();
    assert_eq!(ended["state"], "done", "{ended}");
    let image = service.get(&format!("/v1/images/{id}/0")).json();
    let optics = &image["parameters"]["water"]["optics"];
    assert_eq!(
        (&optics["name"], &optics["scattering_per_m"]),
        (&json!("quay-7"), &json!([1.0, 1.1, 1.3]))
    );
    let found = service
        .get("/v1/images?dataset=tests&filter=water.optics%20=%20%22quay-7%22")
        .json();
    assert!(!found["items"].as_array().unwrap().is_empty());
    service.post("/v1/jobs", &in_quay()).problem(422, "validation");
}

#[test]
fn it_survives_a_restart_and_is_gone_for_good_when_deleted() {
    let service = start();
    let made = service.post("/v1/waters", &quay()).json();
    let service = start_on(service.stop(), Setup::default());
    assert_eq!(service.get("/v1/waters/quay-7").json(), made);
    assert_eq!(service.post("/v1/jobs/preview", &in_quay()).status, 200);
    assert_eq!(service.delete("/v1/waters/quay-7").status, 204);
    service.delete("/v1/waters/quay-7").problem(404, "not-found");
    service.delete("/v1/waters/jerlov-3C").problem(404, "not-found");
    let service = start_on(service.stop(), Setup::default());
    service.get("/v1/waters/quay-7").problem(404, "not-found");
}

#[test]
fn a_name_is_taken_once() {
    let service = start();
    assert_eq!(service.post("/v1/waters", &quay()).status, 201);
    service.post("/v1/waters", &quay()).problem(409, "name-taken");
    let mut shipped = quay();
    for name in ["jerlov-3C", "uuv-simulator"] {
        shipped["name"] = json!(name);
        service.post("/v1/waters", &shipped).problem(409, "name-taken");
    }
}

#[test]
fn all_errors_of_a_water_are_reported_together_and_nothing_is_stored() {
    let service = start();
    let before = service.get("/v1/waters").text();
    let wrong = json!({"name": "a/b", "wavelength_nm": [450, 550, 650], "color": "green",
        "absorption_per_m": [-1, 0.2, 0.5], "veiling_light": [0.1, 0.2]});
    let problem = service.post("/v1/waters", &wrong).problem(422, "validation");
    let pointers: Vec<_> = problem["errors"]
        .as_array()
        .unwrap()
        .iter()
        .map(|e| e["pointer"].as_str().unwrap())
        .collect();
    for pointer in [
        "/color",
        "/name",
        "/source",
        "/absorption_per_m/0",
        "/veiling_light",
        "/wavelength_nm",
    ] {
        assert!(pointers.contains(&pointer), "{pointer}: {pointers:?}");
    }
    let mut missing = quay();
    missing.as_object_mut().unwrap().remove("scattering_per_m");
    service.post("/v1/waters", &missing).problem(422, "validation");
    let mut backwards = quay();
    backwards["jerlov_type"] = json!("IA");
    backwards["absorption_per_m"] = json!([0.8, 0.96, 0.98]);
    let problem = service.post("/v1/waters", &backwards).problem(422, "validation");
    assert!(
        problem.to_string().contains("clear water attenuates"),
        "{problem}"
    );
    service.post("/v1/waters", &json!([])).problem(422, "validation");
    assert_eq!(service.get("/v1/waters").text(), before);
}

#[test]
fn a_k_d_in_place_of_c_is_a_warning_of_the_water_and_of_the_job() {
    let service = start();
    let mut thin = quay();
    let water = thin.as_object_mut().unwrap();
    water.remove("absorption_per_m");
    water.remove("scattering_per_m");
    thin["beam_attenuation_per_m"] = thin["diffuse_attenuation_per_m"].clone();
    let made = service.post("/v1/waters", &thin);
    assert_eq!(made.status, 201, "{}", made.text());
    assert!(
        made.json()["warnings"].to_string().contains("decay of daylight"),
        "{}",
        made.text()
    );
    let accepted = service.post("/v1/jobs", &in_quay());
    assert_eq!(accepted.status, 202);
    assert!(
        accepted.json()["warnings"]
            .to_string()
            .contains("decay of daylight"),
        "{}",
        accepted.text()
    );
}
