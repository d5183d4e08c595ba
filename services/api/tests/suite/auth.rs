//! Tokens and their scopes.

use crate::common::{Running, Setup, config, job, start_with};

fn status(service: &Running, secret: Option<&str>, post: bool) -> u16 {
    let bearer = secret.map(|secret| format!("Bearer {secret}"));
    let mut headers = vec![("content-type", "application/json")];
    headers.extend(bearer.as_deref().map(|value| ("authorization", value)));
    if post {
        service
            .post_with("/v1/jobs", &headers, job().to_string().as_bytes())
            .status
    } else {
        service.get_with("/v1/jobs", &headers).status
    }
}

#[test]
fn a_token_permits_only_its_scopes() {
    let service = start_with(Setup {
        token: Some("boss,read:eyes,submit:hands"),
        ..Setup::default()
    });
    for (secret, read, submit) in [
        (Some("boss"), 200, 202),
        (Some("eyes"), 200, 403),
        (Some("hands"), 403, 202),
        (Some("wrong"), 401, 401),
        (None, 401, 401),
    ] {
        assert_eq!(status(&service, secret, false), read, "{secret:?} reads");
        assert_eq!(status(&service, secret, true), submit, "{secret:?} submits");
    }
    let missing = service.get("/v1/jobs");
    missing.problem(401, "unauthorized");
    assert!(missing.header("www-authenticate").starts_with("Bearer"));
    let problem = service
        .get_with("/v1/jobs", &[("authorization", "Bearer hands")])
        .problem(403, "forbidden");
    assert_eq!(problem["scope"], "read");
}

#[test]
fn probes_need_no_token_and_unknown_routes_are_not_hidden_behind_one() {
    let service = start_with(Setup {
        token: Some("boss"),
        ..Setup::default()
    });
    for path in ["/livez", "/readyz", "/version", "/openapi.json"] {
        assert_eq!(service.get(path).status, 200, "{path}");
    }
    service.get("/nowhere").problem(404, "not-found");
    service.get("/metrics").problem(401, "unauthorized");
}

#[test]
fn the_page_needs_no_token_but_its_requests_do() {
    let service = start_with(Setup {
        token: Some("boss"),
        ..Setup::default()
    });
    for path in ["/", "/assets/app.js", "/assets/page.css", "/assets/chart.csv"] {
        let response = service.get(path);
        assert_eq!(response.status, 200, "{path}");
        let policy = response.header("content-security-policy");
        assert!(policy.starts_with("default-src 'none'"), "{path}: {policy}");
        let again = service.get_with(path, &[("if-none-match", response.header("etag"))]);
        assert_eq!(again.status, 304, "{path}");
    }
    service.get("/assets/absent.js").problem(404, "not-found");
    service.get("/v1/datasets").problem(401, "unauthorized");
}

#[test]
fn a_service_that_others_can_reach_does_not_start_without_a_token() {
    let data = tempfile::tempdir().unwrap();
    let mut config = config(data.path(), None);
    config.listen = "0.0.0.0:0".parse().unwrap();
    let runtime = tokio::runtime::Runtime::new().unwrap();
    let error = runtime
        .block_on(api::start(config))
        .err()
        .expect("it must not start");
    assert!(error.to_string().contains("FATHOM_TOKEN"), "{error}");
}

#[test]
fn a_second_service_on_the_same_directory_does_not_start() {
    let service = start_with(Setup::default());
    let second = config(service.data.path(), None);
    let runtime = tokio::runtime::Runtime::new().unwrap();
    let error = runtime
        .block_on(api::start(second))
        .err()
        .expect("it must not start");
    assert!(error.to_string().contains("another service"), "{error}");
    assert_eq!(service.get("/readyz").status, 200);
}
