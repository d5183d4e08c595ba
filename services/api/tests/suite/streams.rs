//! Streaming responses: events, lines of records, tables.

use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use crate::common::worker::Fake;
use crate::common::{Running, Setup, job, start, start_with};
use api::Limits;
use serde_json::{Value, json};

/// An event: kind, id, data.
type Event = (String, String, Value);

/// Reads events until the stream ends or this many have arrived.
fn events(service: &Running, job: &str, last: Option<&str>, most: usize) -> Vec<Event> {
    let mut stream = TcpStream::connect(service.url.trim_start_matches("http://")).unwrap();
    let last = last.map_or_else(String::new, |id| format!("last-event-id: {id}\r\n"));
    write!(
        stream,
        "GET /v1/jobs/{job}/events HTTP/1.0\r\nhost: localhost\r\n{last}\r\n"
    )
    .unwrap();
    let mut found = Vec::new();
    let mut event = (String::new(), String::new(), Value::Null);
    for line in BufReader::new(stream).lines() {
        let line = line.unwrap();
        match line.split_once(": ") {
            Some(("event", kind)) => event.0 = kind.to_owned(),
            Some(("id", id)) => event.1 = id.to_owned(),
            Some(("data", data)) => event.2 = serde_json::from_str(data).unwrap(),
            _ if line.is_empty() && !event.0.is_empty() => {
                found.push(std::mem::take(&mut event));
                if found.len() == most {
                    break;
                }
            }
            _ => {}
        }
    }
    found
}

fn kinds(events: &[Event]) -> Vec<&str> {
    events.iter().map(|(kind, ..)| kind.as_str()).collect()
}

#[test]
fn events_tell_the_life_of_a_job_and_end_with_it() {
    let service = start();
    let mut many = job();
    many["count"] = json!(6);
    let id = service.submit(&many);
    let sent = std::thread::scope(|scope| {
        let following = scope.spawn(|| events(&service, &id, None, usize::MAX));
        let worker = Fake::register(&service);
        for _ in 0..2 {
            std::thread::sleep(Duration::from_millis(700));
            let lease = worker.lease(1000).expect("a frame");
            worker.finish(&lease).unwrap();
        }
        let lease = worker.lease(1000).expect("a frame");
        worker.fail(&lease, "the lens is fogged");
        worker.work();
        following.join().unwrap()
    });
    assert_eq!(kinds(&sent[..2]), ["progress", "state"]);
    assert_eq!(sent[1].2["state"], "queued");
    let states: Vec<_> = sent.iter().filter(|(kind, ..)| kind == "state").collect();
    assert_eq!(
        states.last().unwrap().2["state"],
        "done_with_failures",
        "{sent:?}"
    );
    let problem = &sent
        .iter()
        .find(|(kind, ..)| kind == "problem")
        .expect("a problem")
        .2;
    assert_eq!(problem["frames"][0]["error"], "the lens is fogged", "{problem}");
    let progress: Vec<_> = sent.iter().filter(|(kind, ..)| kind == "progress").collect();
    assert!(progress.len() >= 3, "{sent:?}");
    assert_eq!(
        progress.last().unwrap().2,
        json!({"done": 5, "failed": 1, "frames": 6})
    );

    // A client that saw the end gets 204; one that saw less gets the end.
    let end = &sent.last().unwrap().1;
    let path = format!("/v1/jobs/{id}/events");
    assert_eq!(service.get_with(&path, &[("last-event-id", end)]).status, 204);
    let rest = events(&service, &id, Some(&sent[1].1), usize::MAX);
    assert_eq!(kinds(&rest), ["problem", "progress", "state"], "{rest:?}");
    assert_eq!(rest[2].1, *end);
    service
        .get_with(&path, &[("last-event-id", "yesterday")])
        .problem(400, "invalid-header");
    service.get("/v1/jobs/job_x/events").problem(404, "not-found");
}

#[test]
fn progress_comes_twice_a_second_at_most() {
    let service = start();
    let mut many = job();
    many["count"] = json!(40);
    let id = service.submit(&many);
    let begun = Instant::now();
    let sent = std::thread::scope(|scope| {
        let following = scope.spawn(|| events(&service, &id, None, usize::MAX));
        Fake::register(&service).work();
        following.join().unwrap()
    });
    let progress = sent.iter().filter(|(kind, ..)| kind == "progress").count();
    let most = begun.elapsed().as_millis() / 500 + 2;
    assert!(progress as u128 <= most, "{progress} in {:?}", begun.elapsed());
}

#[test]
fn followers_of_a_deleted_job_are_notified() {
    let service = start();
    let id = service.submit(&job());
    let sent = std::thread::scope(|scope| {
        let following = scope.spawn(|| events(&service, &id, None, usize::MAX));
        std::thread::sleep(Duration::from_millis(300));
        assert_eq!(service.delete(&format!("/v1/jobs/{id}")).status, 200);
        following.join().unwrap()
    });
    assert_eq!(sent.last().unwrap().2["state"], "deleted", "{sent:?}");
}

#[test]
fn readers_that_never_read_are_few_and_are_cut_off() {
    let limits = Limits {
        streams: 3,
        caller_percent: 100,
        unread: Duration::from_millis(500),
        ..Limits::default()
    };
    let service = start_with(Setup {
        limits,
        ..Setup::default()
    });
    let id = service.submit(&job());
    let follow = || {
        let mut stream = TcpStream::connect(service.url.trim_start_matches("http://")).unwrap();
        write!(
            stream,
            "GET /v1/jobs/{id}/events HTTP/1.1\r\nhost: localhost\r\n\r\n"
        )
        .unwrap();
        stream
    };
    let held: Vec<_> = (0..3).map(|_| follow()).collect();
    std::thread::sleep(Duration::from_millis(300));
    service
        .get(&format!("/v1/jobs/{id}/events"))
        .problem(503, "overloaded");
    assert_eq!(
        service.get(&format!("/v1/jobs/{id}")).status,
        200,
        "others have their own places"
    );
    assert_eq!(
        Fake::register(&service).lease(1000).map(|lease| lease.job_id),
        Some(id.clone())
    );
    drop(held);
    // A permit is free when the service next writes to the connection, or detects that it is closed.
    while service.get(&format!("/v1/jobs/{id}/results")).status == 503 {
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn results_and_errors_can_be_read_in_every_state() {
    let service = start();
    let mut many = job();
    many["count"] = json!(230);
    let id = service.submit(&many);
    let lines = |what: &str| {
        let answer = service.get(&format!("/v1/jobs/{id}/{what}"));
        assert_eq!(
            (answer.status, answer.header("content-type")),
            (200, "application/x-ndjson")
        );
        let text = answer.text();
        text.lines()
            .map(|line| serde_json::from_str::<Value>(line).unwrap())
            .collect::<Vec<_>>()
    };
    assert!(lines("results").is_empty() && lines("errors").is_empty());
    let worker = Fake::register(&service);
    let lease = worker.lease(1000).expect("a frame");
    worker.fail(&lease, "no light");
    worker.finish(&worker.lease(1000).expect("a frame")).unwrap();
    assert_eq!((lines("results").len(), lines("errors").len()), (1, 1));
    assert_eq!(
        service.post(&format!("/v1/jobs/{id}/pause"), &json!({})).status,
        200
    );
    assert_eq!(lines("results").len(), 1);
    assert_eq!(
        service.post(&format!("/v1/jobs/{id}/resume"), &json!({})).status,
        200
    );
    worker.work();
    let frames: Vec<_> = lines("results")
        .iter()
        .map(|record| record["frame"].as_u64().unwrap())
        .collect();
    assert_eq!(
        frames,
        (1..230).collect::<Vec<_>>(),
        "more than two batches, in order"
    );
    let errors = lines("errors");
    assert_eq!(
        (&errors[0]["frame"], &errors[0]["given_up"], &errors[0]["error"]),
        (&json!(0), &json!(true), &json!("no light"))
    );
    service.get("/v1/jobs/job_x/results").problem(404, "not-found");
    service.get("/v1/jobs/job_x/errors").problem(404, "not-found");
}

#[test]
fn a_dataset_is_a_table_with_the_same_cells_in_both_forms() {
    let service = start();
    let mut labeled = job();
    labeled["labels"] = json!({"run": "a, \"b\""});
    let id = service.submit(&labeled);
    Fake::register(&service).work();
    let answer = service.get("/v1/datasets/tests/metadata.jsonl");
    assert_eq!(answer.status, 200, "{}", answer.text());
    let text = answer.text();
    let rows: Vec<Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(rows.len(), 2);
    assert_eq!(
        (&rows[1]["job"], &rows[1]["uiqm"]),
        (&json!(id), &json!(1.5)),
        "{}",
        rows[1]
    );
    let csv = service.get("/v1/datasets/tests/metadata.csv?filter=uiqm%20%3E%201");
    assert!(
        csv.header("content-type").starts_with("text/csv"),
        "{}",
        csv.text()
    );
    let text = csv.text();
    let mut lines = text.split_terminator("\r\n");
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert!(head.contains(&"uiqm") && head.contains(&"labels.run"), "{head:?}");
    assert_eq!(lines.count(), 1);
    assert!(text.contains("\"a, \"\"b\"\"\"") && text.contains(&id), "{text}");
    let columns = service.get("/v1/datasets/tests").json();
    let names: Vec<_> = columns["columns"]
        .as_array()
        .unwrap()
        .iter()
        .map(|c| c["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, head, "the dataset says which columns its table has");

    for form in ["jsonl", "csv"] {
        service
            .get(&format!("/v1/datasets/none/metadata.{form}"))
            .problem(404, "not-found");
        service
            .get(&format!(
                "/v1/datasets/tests/metadata.{form}?filter=nothing%20%3E%201"
            ))
            .problem(400, "invalid-filter");
    }
}

#[test]
fn a_histogram_counts_every_value_once() {
    let service = start();
    service.submit(&job());
    Fake::register(&service).work();
    let bins = service
        .get("/v1/datasets/tests/histogram?column=uiqm&bins=4&min=0&max=1")
        .json();
    assert_eq!(bins["counts"], json!([0, 0, 1, 0]), "{bins}");
    assert_eq!(
        (&bins["above"], &bins["edges"][4]),
        (&json!(1), &json!(1.0)),
        "{bins}"
    );
    for (wrong, slug) in [
        ("column=uiqn", "invalid-filter"),
        ("column=uiqm&bins=0", "invalid-filter"),
        ("column=uiqm&bins=5000", "invalid-filter"),
        ("column=uiqm&min=1", "invalid-query"),
        ("column=uiqm&min=1&max=0", "invalid-filter"),
        ("column=uiqm&min=NaN&max=1", "invalid-filter"),
        ("bins=3", "invalid-query"),
    ] {
        service
            .get(&format!("/v1/datasets/tests/histogram?{wrong}"))
            .problem(400, slug);
    }
    service
        .get("/v1/datasets/none/histogram?column=uiqm")
        .problem(404, "not-found");
}

#[test]
fn a_density_counts_every_pair_once() {
    let service = start();
    service.submit(&job());
    Fake::register(&service).work();
    let cells = service
        .get("/v1/datasets/tests/density?x=frame&y=uiqm&bins=2&mean_of=frame")
        .json();
    assert_eq!(cells["counts"].as_array().map(Vec::len), Some(4), "{cells}");
    let counts = cells["counts"].as_array().unwrap().iter();
    assert_eq!(counts.filter_map(Value::as_u64).sum::<u64>(), 2, "{cells}");
    assert_eq!(
        (&cells["x"]["max"], &cells["missing"]),
        (&json!(1.0), &json!(0)),
        "{cells}"
    );
    for (wrong, slug) in [
        ("x=uiqn&y=uiqm", "invalid-filter"),
        ("x=uiqm&y=water.style", "invalid-filter"),
        ("x=uiqm&y=uiqm&bins=401", "invalid-filter"),
        ("x=uiqm", "invalid-query"),
    ] {
        service
            .get(&format!("/v1/datasets/tests/density?{wrong}"))
            .problem(400, slug);
    }
    service
        .get("/v1/datasets/none/density?x=uiqm&y=frame")
        .problem(404, "not-found");
}
