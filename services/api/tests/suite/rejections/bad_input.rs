//! Invalid input is rejected with a problem that names field, value and limit; it has no side effects.

use std::collections::BTreeMap;
use std::path::Path;

use crate::common::bytes::png;
use crate::common::worker::Fake;
use crate::common::{Running, job, start, start_on};
use renderer::worker::client::ClientError;
use serde_json::{Value, json};
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{AssertSqlSafe, ConnectOptions, Connection};
use store::Store;
use tempfile::TempDir;
use wire::messages::Lease;

/// Rows and stored bytes of a folder of a stopped service.
pub(crate) fn counted(data: &TempDir) -> String {
    let runtime = tokio::runtime::Runtime::new().unwrap();
    runtime.block_on(async {
        let store = Store::open(data.path()).await.unwrap();
        let rows = counts(&data.path().join("catalogue.sqlite")).await;
        let counts = format!("{rows:?} {:?}", store.stats());
        store.close().await;
        counts
    })
}

/// The number of rows of every table in a catalogue file, including jobs being deleted.
async fn counts(file: &Path) -> BTreeMap<String, u64> {
    let mut connection = SqliteConnectOptions::new()
        .filename(file)
        .connect()
        .await
        .unwrap();
    let tables: Vec<String> = sqlx::query_scalar("SELECT name FROM sqlite_schema WHERE type = 'table'")
        .fetch_all(&mut connection)
        .await
        .unwrap();
    let mut counts = BTreeMap::new();
    for table in tables {
        let sql = AssertSqlSafe(format!("SELECT count(*) FROM {table}"));
        let rows: i64 = sqlx::query_scalar(sql).fetch_one(&mut connection).await.unwrap();
        counts.insert(table, rows as u64);
    }
    connection.close().await.unwrap();
    counts
}

/// Runs rejections against a service with a job and a scene; afterwards its data must be unchanged and it must still
/// work.
pub(crate) fn nothing_changes(refusals: impl FnOnce(&Running)) {
    let service = start();
    service.submit(&job());
    assert_eq!(service.upload(&[("rgb", &png(8, 6))]).status, 201);
    let data = service.stop();
    let before = counted(&data);
    let service = start_on(data, crate::common::Setup::default());
    let shown = service.shown();
    refusals(&service);
    assert_eq!(service.get("/readyz").status, 200);
    assert_eq!(service.shown(), shown);
    // The existing job is still offered.
    let worker = Fake::register(&service);
    worker.release(&worker.lease(1000).expect("a frame"));
    assert_eq!(counted(&service.stop()), before);
}

/// The job with the value at a JSON pointer replaced; parents are created as needed.
fn job_with(pointer: &str, value: Value) -> Value {
    let mut changed = job();
    let mut place = &mut changed;
    for key in pointer.split('/').skip(1) {
        if place.is_string() || place.is_null() {
            *place = json!({});
        }
        place = &mut place[key];
    }
    *place = value;
    changed
}

#[test]
fn a_bad_description_is_refused_with_the_place_and_the_limit() {
    let optics = "/water/optics";
    let explicit = |more: Value| {
        let mut optics = json!({"absorption_per_m": [0.3, 0.1, 0.1], "scattering_per_m": [0.1, 0.1, 0.1],
                                "veiling_light": [0.1, 0.2, 0.3]});
        optics
            .as_object_mut()
            .unwrap()
            .extend(more.as_object().unwrap().clone());
        optics
    };
    let attenuation =
        |values: Value| json!({"beam_attenuation_per_m": values, "veiling_light": [0.1, 0.2, 0.3]});
    let cases: Vec<(&str, Value, &str, &[&str])> = vec![
        (
            "unknown field",
            job_with("/alhpa", json!(1)),
            "/alhpa",
            &["alhpa", "did_you_mean\":\"alpha", "allowed"],
        ),
        (
            "wrong type",
            job_with("/camera/width", json!("wide")),
            "/camera/width",
            &["camera.width", "wide", "a whole number"],
        ),
        (
            "alpha above 1",
            job_with("/alpha", json!(1.2)),
            "/alpha",
            &["alpha", "1.2", "0..=1"],
        ),
        (
            "alpha as text",
            job_with("/alpha", json!("NaN")),
            "/alpha",
            &["NaN", "a number"],
        ),
        (
            "negative attenuation",
            job_with(optics, attenuation(json!([0.4, -0.1, 0.1]))),
            "/water/optics/beam_attenuation_per_m",
            &["beam_attenuation_per_m[1]", "-0.1", "0..=1000"],
        ),
        (
            "G above c",
            job_with(
                optics,
                explicit(json!({"forward_scatter": {"model": "jaffe", "g_per_m": [9, 0.1, 0.1]}})),
            ),
            "/water/optics/forward_scatter/g_per_m",
            &["g_per_m is 9", "at most the beam attenuation, 0.4"],
        ),
        (
            "law backwards",
            job_with("/alpha", json!({"uniform": [0.8, 0.2]})),
            "/alpha",
            &["a = 0.8 above b = 0.2"],
        ),
        (
            "empty choice",
            job_with("/alpha", json!({"choice": []})),
            "/alpha",
            &["choice", "at least one value"],
        ),
        (
            "count 0",
            job_with("/count", json!(0)),
            "/count",
            &["`count` is 0", "1..=100000000"],
        ),
        (
            "a light of text",
            job_with(
                "/lights",
                json!([{"kind": "haze", "x": 0.5, "y": 0.5, "size": "NaN", "intensity": 1}]),
            ),
            "/lights/0/size",
            &["lights[0].size", "NaN", "a number"],
        ),
        (
            "count 10^12",
            job_with("/count", json!(1_000_000_000_000_u64)),
            "/count",
            &["`count` is 1000000000000", "1..=100000000"],
        ),
        (
            "preset lacks coefficients",
            job_with(optics, json!({"preset": "jerlov-5C/solonenko2015"})),
            "/water/optics",
            &["jerlov-5C/solonenko2015", "unknown at one of its wavelengths"],
        ),
        (
            "unknown style",
            job_with("/water/style", json!("mudy")),
            "/water/style",
            &["mudy", "did_you_mean\":\"muddy", "atlantic"],
        ),
        (
            "scene not uploaded",
            job_with(
                "/scene",
                json!({"kind": "uploaded", "id": "scn_00000000000000000000000000000000"}),
            ),
            "/scene",
            &["scn_", "does not exist"],
        ),
    ];
    nothing_changes(|service| {
        for (name, body, pointer, fragments) in cases {
            let problem = service.post("/v1/jobs", &body).problem(422, "validation");
            let errors = problem["errors"]
                .as_array()
                .unwrap_or_else(|| panic!("{name}: {problem}"));
            let error = errors
                .iter()
                .find(|error| {
                    let found = error["pointer"].as_str();
                    found.is_some_and(|found| found.starts_with(pointer))
                })
                .unwrap_or_else(|| panic!("{name}: {problem}"))
                .to_string();
            for fragment in fragments {
                assert!(error.contains(fragment), "{name}: {fragment} is not in {error}");
            }
        }
    });
}

#[test]
fn all_errors_of_a_description_come_together_with_the_nearest_name() {
    nothing_changes(|service| {
        let mut body = job_with("/alpha", json!(1.2));
        body["metrics"] = json!(["uiqn"]);
        body["count"] = json!(0);
        let problem = service.post("/v1/jobs", &body).problem(422, "validation");
        assert_eq!(problem["errors"].as_array().unwrap().len(), 3, "{problem}");
        assert!(
            problem.to_string().contains(r#""did_you_mean":"uiqm""#),
            "{problem}"
        );
    });
}

#[test]
fn unusual_but_valid_descriptions_are_accepted() {
    let service = start();
    let light = json!([{"kind": "haze", "x": 0.5, "y": 0.5, "size": 0, "intensity": 1}]);
    service.submit(&job_with("/lights", light));
    service.submit(&job_with("/seed", json!(0)));
}

#[test]
fn a_body_that_is_no_json_of_bearable_size_is_refused() {
    nothing_changes(|service| {
        let json = [("content-type", "application/json")];
        service
            .post_with("/v1/jobs", &json, b"{\"alpha\": NaN}")
            .problem(422, "validation");
        let mut light = job_with(
            "/lights",
            json!([{"kind": "haze", "x": 0.5, "y": 0.5, "intensity": 1}]),
        )
        .to_string();
        light = light.replace("\"kind\":\"haze\"", "\"kind\":\"haze\",\"size\":NaN");
        assert!(light.contains("NaN"));
        let problem = service
            .post_with("/v1/jobs", &json, light.as_bytes())
            .problem(422, "validation");
        assert!(
            problem["detail"].as_str().unwrap().contains("column"),
            "{problem}"
        );
        let problem = service
            .post_with("/v1/jobs", &json, b"{\"alpha\": 1, \"alpha\": 1}")
            .problem(422, "validation");
        assert!(problem["detail"].as_str().unwrap().contains("alpha"), "{problem}");
        service
            .post_with("/v1/jobs", &json, &vec![b' '; (1 << 20) + 1])
            .problem(413, "too-large");
        service
            .post_with("/v1/jobs", &[("content-type", "text/plain")], b"{}")
            .problem(415, "unsupported-media-type");
        service
            .post_with("/v1/jobs", &[], b"{}")
            .problem(415, "unsupported-media-type");
    });
}

#[test]
fn bad_queries_are_rejected_with_the_reason() {
    nothing_changes(|service| {
        let problem = service
            .get("/v1/images?filter=uiqn%20%3E%200.5")
            .problem(400, "invalid-filter");
        assert_eq!(problem["position"], 0, "{problem}");
        assert_eq!(problem["did_you_mean"], "uiqm", "{problem}");
        service
            .get("/v1/images?filter=uiqm%20%3E")
            .problem(400, "invalid-filter");
        for parameter in ["order_by", "fields"] {
            let problem = service
                .get(&format!("/v1/images?{parameter}=uiqn"))
                .problem(400, "invalid-filter");
            assert_eq!(problem["parameter"], parameter, "{problem}");
            assert_eq!(
                problem["detail"],
                format!("`{parameter}` names the unknown column `uiqn`; did you mean `uiqm`?")
            );
            assert!(problem["position"].is_null(), "{problem}");
        }
        service
            .get(&format!("/v1/images?filter={}", "x".repeat(5000)))
            .problem(400, "invalid-filter");
        for list in ["images", "jobs", "scenes"] {
            service
                .get(&format!("/v1/{list}?cursor=Zm9yZ2Vk"))
                .problem(400, "invalid-cursor");
            let problem = service
                .get(&format!("/v1/{list}?limit=0"))
                .problem(400, "invalid-query");
            assert!(
                problem["detail"].as_str().unwrap().contains("1..=1000"),
                "{problem}"
            );
            service
                .get(&format!("/v1/{list}?limit=many"))
                .problem(400, "invalid-query");
            let problem = service
                .get(&format!("/v1/{list}?color=red"))
                .problem(400, "invalid-query");
            assert!(problem["detail"].as_str().unwrap().contains("color"), "{problem}");
        }
        service.get("/v1/images/job_x/first").problem(400, "invalid-path");
        service.get("/v1/images/job_x/0").problem(404, "not-found");
        service.get("/v1/jobs/job_x").problem(404, "not-found");
        let problem = service
            .get("/v1/jobs/job_x?wait=61")
            .problem(400, "invalid-query");
        assert!(
            problem["detail"]
                .as_str()
                .unwrap()
                .contains("wait is 61; must be in 0..=60"),
            "{problem}"
        );
        service.get("/v1/no-such-route").problem(404, "not-found");
        let refused = service.post("/v1/datasets", &json!({}));
        refused.problem(405, "method-not-allowed");
        assert_eq!(refused.header("allow"), "GET,HEAD");
    });
}

#[test]
fn a_stale_lease_token_stores_nothing() {
    nothing_changes(|service| {
        let worker = Fake::register(service);
        let lease = worker.lease(1000).expect("a frame");
        let forged = Lease {
            token: lease.token + 1,
            ..lease.clone()
        };
        assert!(matches!(worker.finish(&forged), Err(ClientError::Stale)));
        let mut tried_before = lease.clone();
        tried_before.frames[0].attempt += 1;
        assert!(matches!(worker.finish(&tried_before), Err(ClientError::Stale)));
        worker.release(&lease);
        assert!(matches!(worker.finish(&lease), Err(ClientError::Stale)));
        assert!(matches!(worker.try_fail(&lease, "late"), Err(ClientError::Stale)));
        worker.release(&lease);
    });
}
