//! Sealed versions of datasets over HTTP.

use serde_json::{Value, json};
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{ConnectOptions, Connection, Executor};

use crate::common::worker::Fake;
use crate::common::{Running, job, start};

/// Changes the catalogue without the service.
fn sabotage(service: &Running, sql: &'static str) {
    let file = service.folder().join("catalogue.sqlite");
    tokio::runtime::Runtime::new().unwrap().block_on(async {
        let mut connection = SqliteConnectOptions::new()
            .filename(file)
            .connect()
            .await
            .unwrap();
        connection.execute(sql).await.unwrap();
        connection.close().await.unwrap();
    });
}

fn verify(service: &Running, wish: Value) -> Value {
    let answer = service.post("/v1/datasets/tests/versions/1/verify", &wish);
    assert_eq!(answer.status, 200, "{}", answer.text());
    answer.json()
}

fn seal(service: &Running) -> crate::common::Answer {
    service.post("/v1/datasets/tests/versions", &json!(null))
}

#[test]
fn a_dataset_is_sealed_queried_and_unsealed() {
    let service = start();
    seal(&service).problem(404, "not-found");
    let id = service.submit(&job());
    let sent = seal(&service).problem(409, "job-state");
    assert!(sent["detail"].as_str().unwrap().contains(&id), "{sent}");
    Fake::register(&service).work();
    let sealed = seal(&service);
    assert_eq!(sealed.status, 201, "{}", sealed.text());
    assert_eq!(sealed.header("location"), "/v1/datasets/tests/versions/1");
    let version = sealed.json();
    assert_eq!(
        (&version["name"], &version["images"]),
        (&json!("tests@1"), &json!(2))
    );
    assert_eq!(
        (seal(&service).status, seal(&service).json()),
        (200, version.clone())
    );

    let detail = service.get("/v1/datasets/tests/versions/1").json();
    assert_eq!(
        (&detail["root"], &detail["parts"][0]["id"]),
        (&version["root"], &json!(id))
    );
    assert_eq!(detail["parts"][0]["description"]["seed"], 7);
    assert_eq!(
        service.get("/v1/datasets/tests/versions").json()["items"],
        json!([version])
    );
    let mut more = job();
    more["seed"] = json!(8);
    service.submit(&more);
    Fake::register(&service).work();
    assert_eq!(seal(&service).json()["name"], "tests@2");
    let count = |dataset: &str| {
        let rows = service
            .get(&format!("/v1/images?dataset={dataset}&fields=frame"))
            .json();
        let lines = service
            .get(&format!("/v1/datasets/{dataset}/metadata.jsonl"))
            .text();
        let stats = service
            .get(&format!("/v1/datasets/{dataset}/stats?metrics=uiqm"))
            .json();
        let images = service.get(&format!("/v1/datasets/{dataset}")).json()["images"].as_u64();
        let count = rows["items"].as_array().unwrap().len() as u64;
        assert_eq!((lines.lines().count() as u64, images), (count, Some(count)));
        assert_eq!(stats["groups"][0]["count"], count);
        count
    };
    assert_eq!((count("tests@1"), count("tests@2"), count("tests")), (2, 4, 4));
    service.get("/v1/datasets/tests@3").problem(404, "not-found");
    service
        .get("/v1/datasets/tests/versions/3")
        .problem(404, "not-found");
    service
        .get("/v1/datasets/tests/versions/x")
        .problem(400, "invalid-path");

    for path in [format!("/v1/jobs/{id}"), "/v1/datasets/tests".to_owned()] {
        let sent = service.delete(&path).problem(409, "sealed");
        assert!(
            sent["detail"].as_str().unwrap().contains("fathom rm tests@"),
            "{sent}"
        );
    }
    for number in [1, 2] {
        let path = format!("/v1/datasets/tests/versions/{number}");
        assert_eq!(service.delete(&path).status, 204);
        service.delete(&path).problem(404, "not-found");
    }
    assert_eq!(service.delete("/v1/datasets/tests").status, 200);
}

#[test]
fn changes_since_sealing_are_found_and_named() {
    let service = start();
    let id = service.submit(&job());
    Fake::register(&service).work();
    let root = seal(&service).json()["root"].clone();
    let found = verify(&service, json!({"bytes": true}));
    assert_eq!(
        (&found["intact"], &found["root"], &found["computed"]),
        (&json!(true), &root, &root)
    );
    assert_eq!(
        (&found["images"], &found["artifacts"]),
        (&json!(2), &json!(2)),
        "{found}"
    );

    // A parameter in a record.
    sabotage(
        &service,
        "UPDATE records SET record = json_set(record, '$.parameters.alpha', 0.75) WHERE frame = 1",
    );
    let found = verify(&service, json!({}));
    assert_eq!(
        (&found["intact"], &found["damages"]),
        (&json!(false), &json!(2)),
        "{found}"
    );
    let named = json!({"job": id, "frame": 1, "reason": "the digest of its record differs from its row"});
    assert_eq!(found["damaged"][0], named);
    assert_ne!(found["computed"], root);
    // A record and its row together: only the root reveals it.
    sabotage(
        &service,
        "UPDATE records SET record = json_remove(record, '$.frame')",
    );
    let found = verify(&service, json!({}));
    assert!(
        found["damaged"][0]["reason"]
            .as_str()
            .unwrap()
            .starts_with("its record cannot be read")
    );
    service
        .post("/v1/datasets/tests/versions/1/verify", &json!({"byte": true}))
        .problem(400, "invalid-body");
}
