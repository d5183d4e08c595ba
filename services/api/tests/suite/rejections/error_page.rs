//! `ERRORS.md` shows the error responses of the API for review. `FATHOM_WRITE=1 cargo test -p api --test suite
//! error_page` updates it.

use std::fmt::Write as _;

use serde_json::{Value, json};

use crate::common::bytes::png;
use crate::common::{Answer, Running, Setup, job, start, start_with};

const JSON: (&str, &str) = ("content-type", "application/json");

/// Paths of GET requests.
const READS: &[&str] = &[
    "/v1/nothing",
    "/v1/jobs?limit=0",
    "/v1/jobs?limit=x",
    "/v1/jobs?page=1",
    "/v1/jobs?state=finished",
    "/v1/jobs?cursor=x",
    "/v1/jobs/job_1",
    "/v1/jobs/job_1?wait=61",
    "/v1/images?filter=uiqm%20%3E",
    "/v1/images?filter=nope%20%3E%201",
    "/v1/images?order_by=nope",
    "/v1/images?fields=nope",
    "/v1/images?cursor=x&offset=3",
    "/v1/images/job_1/0",
    "/v1/images/job_1/x",
    "/v1/images/job_1/0/artifacts/rgb",
    "/v1/datasets/none",
    "/v1/datasets/tests/stats",
    "/v1/datasets/tests/stats?metrics=nope",
    "/v1/datasets/tests/stats?metrics=uiqm&by=alpha:0",
    "/v1/datasets/tests/histogram?column=nope",
    "/v1/datasets/tests/histogram?column=uiqm&min=0",
    "/v1/datasets/tests/histogram?column=uiqm&bins=0",
    "/v1/datasets/tests/density?x=uiqm&y=alpha&bins=401",
    "/v1/datasets/tests/versions/1",
    "/v1/scenes/scn_1",
    "/v1/collections/none",
    "/v1/waters/none",
    "/v1/sets/job_1",
    "/v1/styles/trainings/trn_1",
    "/v1/lists/none",
    "/v1/lists/styles",
    "/problems/none",
];

type Headers = &'static [(&'static str, &'static str)];

struct Post {
    path: &'static str,
    headers: Headers,
    body: &'static str,
}

const fn post(path: &'static str, headers: Headers, body: &'static str) -> Post {
    Post { path, headers, body }
}

/// Requests with a body.
const WRITES: &[Post] = &[
    post("/livez", &[JSON], "{}"),
    post("/v1/jobs", &[("content-type", "text/plain")], "{}"),
    post("/v1/jobs", &[JSON, ("content-encoding", "gzip")], "{}"),
    post("/v1/jobs", &[JSON], ""),
    post("/v1/jobs", &[JSON], "[]"),
    post("/v1/jobs", &[JSON], r#"{"alpha": 3}"#),
    post("/v1/jobs", &[JSON, ("idempotency-key", "")], "{}"),
    post("/v1/jobs?again=maybe", &[JSON], "{}"),
    post("/v1/jobs", &[JSON, ("origin", "https://evil.example")], "{}"),
    post("/v1/jobs", &[JSON, ("host", "evil.example")], "{}"),
    post("/v1/jobs/preview?frames=101", &[JSON], "{}"),
    post("/v1/jobs/job_1/cancel", &[], ""),
    post("/v1/renders", &[JSON, ("prefer", "wait=x")], "{}"),
    post(
        "/v1/renders",
        &[JSON],
        r#"{"count": 2, "scene": {"kind": "procedural", "family": "structure"}}"#,
    ),
    post("/v1/scenes", &[JSON], "{}"),
    post("/v1/waters", &[JSON], r#"{"name": "a b"}"#),
    post("/v1/sets", &[JSON], "[]"),
    post("/v1/sets", &[JSON], r#"{"uri": 1, "url": 2}"#),
    post("/v1/sets", &[JSON], r#"{"url": "s3://bucket/set"}"#),
    post("/v1/images/job_1/0/verify?rerender=x", &[JSON], "{}"),
    post("/v1/worker/register", &[JSON], "{}"),
    post(
        "/v1/worker/register",
        &[("content-type", "application/x-protobuf")],
        "",
    ),
];

/// Forms: path and text fields.
const FORMS: &[(&str, Headers)] = &[
    ("/v1/scenes", &[("name", "a")]),
    ("/v1/scenes", &[("rgb", "no image"), ("size_px", "9")]),
    (
        "/v1/scenes",
        &[
            ("rgb", "PNG"),
            ("fx", "0"),
            ("focal_px", "10"),
            ("unit_m", "-1"),
            ("invalid_code", "70000"),
            ("hfov_deg", "180"),
        ],
    ),
    (
        "/v1/scenes",
        &[
            ("rgb", "PNG"),
            ("classes", "{"),
            ("pose", "[]"),
            ("collection", "A b"),
        ],
    ),
    ("/v1/scenes", &[("rgb", "PNG"), ("cx", "3")]),
    ("/v1/enhance?method=hscn", &[("picture", "PNG")]),
    ("/v1/enhance?method=hscm", &[("picture", "no image")]),
    ("/v1/enhance", &[("picture", "PNG")]),
    ("/v1/measure?metrics=uiqn", &[("picture", "PNG")]),
    ("/v1/measure?metrics=psnr", &[("picture", "PNG")]),
    ("/v1/styles", &[("name", "A b")]),
    ("/v1/styles/train", &[("name", "dock"), ("steps", "0")]),
];

fn write_problem(page: &mut String, request: &str, answer: &Answer) {
    assert!(answer.status >= 400, "{request}: {}", answer.status);
    let problem = answer.json();
    let kind = problem["type"].as_str().unwrap().trim_start_matches("/problems/");
    write!(page, "\n### `{request}`\n\n{} {kind}: ", answer.status).unwrap();
    writeln!(
        page,
        "{}. {}",
        problem["title"].as_str().unwrap(),
        problem["detail"].as_str().unwrap()
    )
    .unwrap();
    for (position, error) in problem["errors"].as_array().into_iter().flatten().enumerate() {
        let separator = if position == 0 { "\n" } else { "" };
        let (pointer, message) = (&error["pointer"], &error["message"]);
        let (pointer, message) = (pointer.as_str().unwrap(), message.as_str().unwrap());
        writeln!(page, "{separator}- `{pointer}`: {message}").unwrap();
    }
}

fn write_requests(page: &mut String, service: &Running) {
    page.push_str("\n## Reads\n");
    for path in READS {
        write_problem(page, &format!("GET {path}"), &service.get(path));
    }
    page.push_str("\n## Writes\n");
    for Post { path, headers, body } in WRITES {
        let shown: Vec<_> = headers
            .iter()
            .filter(|header| **header != JSON)
            .map(|(name, value)| format!(" {name}: {value}"))
            .collect();
        let request = format!("POST {path}{} {body}", shown.concat());
        let answer = service.post_with(path, headers, body.as_bytes());
        write_problem(page, request.trim(), &answer);
    }
    write_problem(
        page,
        "DELETE /v1/waters/uuv-simulator",
        &service.delete("/v1/waters/uuv-simulator"),
    );
    page.push_str("\n## Forms\n");
    let image = png(8, 6);
    for (path, fields) in FORMS {
        let shown: Vec<_> = fields
            .iter()
            .map(|(name, value)| format!(" {name}={value}"))
            .collect();
        let fields: Vec<(&str, &[u8])> = fields
            .iter()
            .map(|(name, value)| match *value {
                "PNG" => (*name, image.as_slice()),
                text => (*name, text.as_bytes()),
            })
            .collect();
        let request = format!("POST {path}{}", shown.concat());
        write_problem(page, &request, &service.form(path, &fields));
    }
}

/// Errors that depend on an existing job.
fn write_states(page: &mut String, service: &Running) {
    page.push_str("\n## States\n");
    let key = [JSON, ("idempotency-key", "k-1")];
    let answer = service.post_with("/v1/jobs", &key, job().to_string().as_bytes());
    let id = answer.json()["id"].as_str().unwrap().to_owned();
    let mut other = job();
    other["seed"] = json!(8);
    let mut states = String::new();
    let reused = service.post_with("/v1/jobs", &key, other.to_string().as_bytes());
    write_problem(&mut states, "POST /v1/jobs with a used Idempotency-Key", &reused);
    let path = "/v1/datasets/tests/versions";
    write_problem(
        &mut states,
        &format!("POST {path}"),
        &service.post(path, &Value::Null),
    );
    write_problem(
        &mut states,
        "DELETE /v1/datasets/tests",
        &service.delete("/v1/datasets/tests"),
    );
    let events = service.get_with(&format!("/v1/jobs/{id}/events"), &[("last-event-id", "x")]);
    write_problem(&mut states, "GET /v1/jobs/job_…/events last-event-id: x", &events);
    assert_eq!(
        service
            .post(&format!("/v1/jobs/{id}/cancel"), &Value::Null)
            .status,
        200
    );
    for verb in ["pause", "resume", "retry-failed"] {
        let answer = service.post(&format!("/v1/jobs/{id}/{verb}"), &Value::Null);
        if answer.status >= 400 {
            write_problem(&mut states, &format!("POST /v1/jobs/job_…/{verb}"), &answer);
        }
    }
    page.push_str(&states.replace(&id, "job_…"));
}

fn write_tokens(page: &mut String) {
    page.push_str("\n## Tokens\n");
    let service = start_with(Setup {
        token: Some("read:look-only"),
        ..Setup::default()
    });
    let bearers: [(&str, Headers); 2] = [
        ("no token", &[]),
        ("an unknown token", &[("authorization", "Bearer x")]),
    ];
    for (name, headers) in bearers {
        let answer = service.get_with("/v1/jobs", headers);
        write_problem(page, &format!("GET /v1/jobs with {name}"), &answer);
    }
    let headers = [JSON, ("authorization", "Bearer look-only")];
    let answer = service.post_with("/v1/jobs", &headers, b"{}");
    write_problem(page, "POST /v1/jobs with the scope `read`", &answer);
}

#[test]
fn the_page_of_error_responses_is_up_to_date() {
    let mut page =
        "# Error responses of the API\n\nGenerated by `FATHOM_WRITE=1 cargo test -p api --test suite \
                    error_page`. The errors of descriptions are in [the schema's page](../../proto/job/ERRORS.md).\n"
            .to_owned();
    let service = start();
    write_requests(&mut page, &service);
    write_states(&mut page, &service);
    write_tokens(&mut page);
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/ERRORS.md");
    if std::env::var_os("FATHOM_WRITE").is_some() {
        std::fs::write(path, &page).unwrap();
    }
    let written = std::fs::read_to_string(path).unwrap_or_default();
    let differs = written.lines().zip(page.lines()).find(|(old, new)| old != new);
    assert!(
        written == page,
        "ERRORS.md is out of date: run FATHOM_WRITE=1 cargo test -p api --test suite error_page and review it; {differs:?}"
    );
}
