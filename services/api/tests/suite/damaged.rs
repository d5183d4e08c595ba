//! Damaged rows are left out of lists and named; one of them does not take the others down.

use serde_json::{Value, json};
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{AssertSqlSafe, ConnectOptions, Connection, Executor};

use crate::common::worker::Fake;
use crate::common::{Running, job, start};

/// Changes the catalogue as someone with access to the disk.
fn sabotage(service: &Running, sql: &str) {
    let file = service.folder().join("catalogue.sqlite");
    tokio::runtime::Runtime::new().unwrap().block_on(async {
        let options = SqliteConnectOptions::new().filename(file);
        let mut connection = options.connect().await.unwrap();
        connection.execute(AssertSqlSafe(sql)).await.unwrap();
        connection.close().await.unwrap();
    });
}

fn rendered(frames: u64) -> (Running, String) {
    let service = start();
    let mut job = job();
    job["count"] = json!(frames);
    job["labels"] = json!({"run": "a"});
    let id = service.submit(&job);
    Fake::register(&service).work();
    let ended = service.get(&format!("/v1/jobs/{id}?wait=60")).json();
    assert_eq!(ended["state"], "done", "{ended}");
    (service, id)
}

/// The frames of a page and the rows that it names as damaged.
fn page(service: &Running, query: &str) -> (Vec<u64>, Vec<String>, Value) {
    let answer = service.get(&format!("/v1/images?dataset=tests&{query}"));
    assert_eq!(answer.status, 200, "{query}: {}", answer.text());
    let page = answer.json();
    let frames = page["items"].as_array().unwrap().iter();
    let frames = frames.map(|item| item["frame"].as_u64().unwrap()).collect();
    let damaged = page["damaged"].as_array().cloned().unwrap_or_default();
    let damaged = damaged.iter().map(|name| name.as_str().unwrap().to_owned());
    (frames, damaged.collect(), page["next_cursor"].clone())
}

/// SQL that damages a record: another value, a missing start, no JSON, no UTF-8.
const DAMAGES: [&str; 4] = [
    "replace(record, '0.4', '0.5')",
    "substr(record, 3)",
    "'not JSON'",
    "CAST(x'ff00fe' AS TEXT)",
];

#[test]
fn a_damaged_record_is_left_out_of_every_list_and_named() {
    for damage in DAMAGES {
        let (service, id) = rendered(5);
        assert!(service.get("/readyz").text().starts_with("ready\n"));
        sabotage(
            &service,
            &format!("UPDATE records SET record = {damage} WHERE frame = 2"),
        );
        let name = format!("the record of {id}/2");
        for query in [
            "limit=100",
            "order_by=-uiqm",
            "filter=uiqm%20%3E%200",
            "fields=frame,labels.run&order_by=labels.run",
            "fields=frame,uiqm&offset=1",
        ] {
            let (frames, damaged, next) = page(&service, query);
            assert!(!frames.contains(&2), "{damage} {query}: {frames:?}");
            assert_eq!(damaged, [name.as_str()], "{damage} {query}");
            assert!(
                frames.len() >= 3 && next.is_null(),
                "{damage} {query}: {frames:?}"
            );
        }
        // A filter over the record itself cannot match the damaged one.
        let (frames, _, _) = page(&service, "filter=labels.run%20%3D%20%22a%22");
        assert_eq!(frames, [0, 1, 3, 4], "{damage}");
        for path in [
            "/v1/datasets/tests/metadata.csv".to_owned(),
            "/v1/datasets/tests/metadata.jsonl".to_owned(),
            format!("/v1/jobs/{id}/results"),
        ] {
            let answer = service.get(&path);
            assert_eq!(answer.status, 200, "{damage} {path}: {}", answer.text());
            assert_eq!(answer.header("fathom-damaged"), name, "{damage} {path}");
            let lines = answer.text().lines().count();
            assert_eq!(
                lines,
                if path.ends_with("csv") { 5 } else { 4 },
                "{damage} {path}"
            );
        }
        for path in [
            "/v1/jobs",
            "/v1/datasets/tests",
            "/v1/datasets/tests/stats?metrics=uiqm",
        ] {
            assert_eq!(service.get(path).status, 200, "{damage} {path}");
        }
        service
            .get(&format!("/v1/images/{id}/2"))
            .problem(500, "corrupt-artifact");
        assert_eq!(service.get(&format!("/v1/images/{id}/1")).status, 200);
        let ready = service.get("/readyz");
        assert_eq!(ready.status, 200);
        assert!(
            ready.text().starts_with("degraded\n") && ready.text().contains(&name),
            "{}",
            ready.text()
        );
    }
}

#[test]
fn cursors_pass_damaged_rows_even_if_a_page_has_no_other() {
    let (service, id) = rendered(6);
    sabotage(
        &service,
        "UPDATE records SET record = '{}' WHERE frame IN (1, 2, 3)",
    );
    let (mut frames, mut damaged, mut cursor) = (Vec::new(), Vec::new(), String::new());
    for _ in 0..10 {
        let (some, names, next) = page(&service, &format!("limit=2{cursor}"));
        frames.extend(some);
        damaged.extend(names);
        let Some(next) = next.as_str() else { break };
        cursor = format!("&cursor={next}");
    }
    assert_eq!(frames, [0, 4, 5]);
    let names = [1, 2, 3].map(|frame| format!("the record of {id}/{frame}"));
    assert_eq!(damaged, names);
}

#[test]
fn damaged_rows_of_jobs_datasets_and_scenes_are_left_out_and_named() {
    let (service, id) = rendered(1);
    let mut other = job();
    other["dataset"] = json!("others");
    let kept = service.submit(&other);
    sabotage(
        &service,
        &format!(
            "UPDATE jobs SET done = done + 7 WHERE id = '{id}'; UPDATE datasets SET images = 99 WHERE name = 'tests'"
        ),
    );
    for (path, name, left, damaged) in [
        ("/v1/jobs", "id", kept.as_str(), format!("row {id} of jobs")),
        (
            "/v1/datasets",
            "name",
            "others",
            "row tests of datasets".to_owned(),
        ),
    ] {
        for limit in [1, 100] {
            let answer = service.get(&format!("{path}?limit={limit}"));
            assert_eq!(answer.status, 200, "{path}: {}", answer.text());
            let page = answer.json();
            let mut all = vec![page.clone()];
            if let Some(cursor) = page["next_cursor"].as_str() {
                all.push(
                    service
                        .get(&format!("{path}?limit={limit}&cursor={cursor}"))
                        .json(),
                );
            }
            let items: Vec<&str> = all
                .iter()
                .flat_map(|page| page["items"].as_array().unwrap())
                .map(|item| item[name].as_str().unwrap())
                .collect();
            let names: Vec<&str> = all
                .iter()
                .filter_map(|page| page["damaged"].as_array())
                .flatten()
                .map(|name| name.as_str().unwrap())
                .collect();
            assert_eq!((items, names), (vec![left], vec![damaged.as_str()]), "{path}");
        }
    }
}

#[test]
fn damage_after_the_first_lines_cuts_the_response_and_the_next_one_names_it() {
    let (service, id) = rendered(130);
    sabotage(&service, "UPDATE records SET record = '{}' WHERE frame = 120");
    let path = format!("/v1/jobs/{id}/results");
    let cut = crate::common::agent()
        .get(format!("{}{path}", service.url))
        .call();
    // The connection may end before the header was sent.
    let is_cut = cut.is_err() || cut.is_ok_and(|mut cut| cut.body_mut().read_to_vec().is_err());
    assert!(is_cut, "the client cannot take it for complete");
    let answer = service.get(&path);
    assert_eq!(answer.text().lines().count(), 129);
    assert_eq!(answer.header("fathom-damaged"), format!("the record of {id}/120"));
}
