//! A service over a fresh data folder on a free port, over real HTTP; and a worker that renders nothing.

use std::path::{Path, PathBuf};
use std::time::Duration;

use api::{Clock, Config, EngineOptions, Limits, PriceLimits, Service, Surroundings};
use serde_json::{Value, json};
use style::Library;
use tempfile::TempDir;
use tokio::runtime::Runtime;
use ureq::Agent;
use ureq::http::HeaderMap;

pub(crate) mod bytes;
pub(crate) mod worker;

/// Settings of a test.
pub(crate) struct Setup {
    pub(crate) token: Option<&'static str>,
    pub(crate) limits: Limits,
    pub(crate) prices: PriceLimits,
    pub(crate) clock: Clock,
    /// Instead of the shipped styles and one that needs ONNX Runtime.
    pub(crate) library: Option<Library>,
    /// Program for decoding and trying styles; the default rejects every style.
    pub(crate) program: &'static str,
    /// Store of a broker whose workers render the jobs.
    pub(crate) broker_store: Option<PathBuf>,
    /// Worker processes; without them the service renders no pictures of forms.
    pub(crate) workers: usize,
}

impl Default for Setup {
    fn default() -> Self {
        Self {
            token: None,
            limits: Limits {
                reserve_bytes: 0,
                ..Limits::default()
            },
            prices: PriceLimits::default(),
            clock: Clock::system(),
            library: None,
            program: env!("CARGO_BIN_EXE_api-child"),
            broker_store: None,
            workers: 0,
        }
    }
}

/// A running service.
pub(crate) struct Running {
    runtime: Runtime,
    service: Option<Service>,
    pub(crate) data: TempDir,
    folder: PathBuf,
    pub(crate) url: String,
    pub(crate) token: Option<&'static str>,
}

/// A response.
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) headers: HeaderMap,
    pub(crate) body: Vec<u8>,
}

impl Answer {
    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|_| panic!("no JSON: {}", self.text()))
    }

    pub(crate) fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    pub(crate) fn header(&self, name: &str) -> &str {
        self.headers.get(name).map_or("", |value| value.to_str().unwrap())
    }

    /// Checks the status and the problem type.
    pub(crate) fn problem(&self, status: u16, slug: &str) -> Value {
        assert_eq!(self.status, status, "{}", self.text());
        assert_eq!(self.header("content-type"), "application/problem+json");
        let problem = self.json();
        assert_eq!(problem["type"], format!("/problems/{slug}"), "{problem}");
        assert_eq!(problem["status"], status);
        assert_eq!(problem["instance"], self.header("x-request-id"));
        assert!(
            problem["title"].is_string() && problem["detail"].is_string(),
            "{problem}"
        );
        problem
    }
}

pub(crate) fn start() -> Running {
    start_with(Setup::default())
}

pub(crate) fn start_with(setup: Setup) -> Running {
    start_on(tempfile::tempdir().unwrap(), setup)
}

pub(crate) fn start_on(data: TempDir, setup: Setup) -> Running {
    let folder = data.path().to_owned();
    start_at(data, folder, setup)
}

/// A service over a folder that the caller removes.
pub(crate) fn start_in_folder(folder: &Path, setup: Setup) -> Running {
    start_at(tempfile::tempdir().unwrap(), folder.to_owned(), setup)
}

fn start_at(data: TempDir, folder: PathBuf, setup: Setup) -> Running {
    let runtime = Runtime::new().unwrap();
    let mut config = config(&folder, setup.token);
    config.program = setup.program.into();
    config.prices = setup.prices;
    config.workers = setup.workers;
    if let Some(store) = setup.broker_store {
        config.stores = vec![store.display().to_string()];
        config.engine = Some(EngineOptions {
            url: "nats://127.0.0.1:1".to_owned(),
            token: None,
            lease_s: 15.0,
            replicas: 1,
        });
    }
    if let Some(library) = setup.library {
        config.library = library;
    }
    let style_runtime = Err("ONNX Runtime was not found; run scripts/get-onnxruntime.sh".to_owned());
    let surroundings = Surroundings {
        clock: setup.clock,
        style_runtime,
        limits: setup.limits,
    };
    let service = runtime.block_on(api::start_in(config, surroundings)).unwrap();
    let url = format!("http://{}", service.address());
    Running {
        runtime,
        service: Some(service),
        data,
        folder,
        url,
        token: setup.token,
    }
}

pub(crate) fn config(data: &Path, token: Option<&str>) -> Config {
    Config {
        data: data.to_owned(),
        listen: "127.0.0.1:0".parse().unwrap(),
        workers: 0,
        slots_per_worker: 1,
        program: "/bin/false".into(),
        hosts: Vec::new(),
        token: token.map(str::to_owned),
        styles: None,
        onnxruntime: None,
        library: library(data),
        stores: Vec::new(),
        engine: None,
        buckets: std::sync::Arc::new(|place, _| Err(api::Unread::Gone(place.set.clone()))),
        style_trial: Duration::from_secs(10),
        frame_limit: Duration::from_secs(600),
        prices: PriceLimits::default(),
        mix_workers: false,
        spot_check: 0,
    }
}

/// The shipped styles, and one that only ONNX Runtime can run.
fn library(data: &Path) -> Library {
    let folder = data.join("styles");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("foreign.onnx"), b"a network of another form").unwrap();
    Library::embedded().unwrap().with_dir(&folder).unwrap()
}

/// A client with a separate connection whose errors are responses.
pub(crate) fn agent() -> Agent {
    let builder = Agent::config_builder().http_status_as_error(false);
    builder
        .timeout_global(Some(Duration::from_secs(90)))
        .build()
        .into()
}

fn answer(response: Result<ureq::http::Response<ureq::Body>, ureq::Error>) -> Answer {
    let (parts, mut body) = response.expect("the service answers").into_parts();
    Answer {
        status: parts.status.as_u16(),
        headers: parts.headers,
        body: body.read_to_vec().unwrap(),
    }
}

impl Running {
    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    pub(crate) fn get(&self, path: &str) -> Answer {
        self.get_with(path, &[])
    }

    pub(crate) fn get_with(&self, path: &str, headers: &[(&str, &str)]) -> Answer {
        let request = agent().get(format!("{}{path}", self.url));
        answer(
            headers
                .iter()
                .fold(request, |request, (name, value)| request.header(*name, *value))
                .call(),
        )
    }

    pub(crate) fn post(&self, path: &str, body: &Value) -> Answer {
        self.post_with(
            path,
            &[("content-type", "application/json")],
            body.to_string().as_bytes(),
        )
    }

    pub(crate) fn post_with(&self, path: &str, headers: &[(&str, &str)], body: &[u8]) -> Answer {
        let request = agent().post(format!("{}{path}", self.url));
        answer(
            headers
                .iter()
                .fold(request, |request, (name, value)| request.header(*name, *value))
                .send(body),
        )
    }

    pub(crate) fn delete(&self, path: &str) -> Answer {
        answer(agent().delete(format!("{}{path}", self.url)).call())
    }

    /// A scene upload with these fields.
    pub(crate) fn upload(&self, fields: &[(&str, &[u8])]) -> Answer {
        self.form("/v1/scenes", fields)
    }

    /// A form with these fields.
    pub(crate) fn form(&self, path: &str, fields: &[(&str, &[u8])]) -> Answer {
        const BOUNDARY: &str = "----fathom-test-boundary";
        let mut body = Vec::new();
        for (name, bytes) in fields {
            let head = format!("--{BOUNDARY}\r\nContent-Disposition: form-data; name=\"{name}\"\r\n\r\n");
            body.extend_from_slice(head.as_bytes());
            body.extend_from_slice(bytes);
            body.extend_from_slice(b"\r\n");
        }
        body.extend_from_slice(format!("--{BOUNDARY}--\r\n").as_bytes());
        let content_type = format!("multipart/form-data; boundary={BOUNDARY}");
        self.post_with(path, &[("content-type", &content_type)], &body)
    }

    /// Submits a job that must be accepted.
    pub(crate) fn submit(&self, job: &Value) -> String {
        let answer = self.post("/v1/jobs", job);
        assert_eq!(answer.status, 202, "{}", answer.text());
        answer.json()["id"].as_str().unwrap().to_owned()
    }

    /// Numbers of rows and stored bytes, as the API shows them.
    pub(crate) fn shown(&self) -> [usize; 3] {
        ["/v1/jobs", "/v1/scenes", "/v1/images"].map(|list| {
            let page = self.get(&format!("{list}?limit=1000")).json();
            page["items"].as_array().unwrap_or_else(|| panic!("{page}")).len()
        })
    }

    /// Stops the service in order and returns its folder.
    pub(crate) fn stop(mut self) -> TempDir {
        let service = self.service.take().expect("it is stopped once");
        self.runtime.block_on(service.stop()).unwrap();
        self.data
    }
}

/// A small valid job; two frames.
pub(crate) fn job() -> Value {
    json!({
        "dataset": "tests", "count": 2, "seed": 7,
        "scene": {"kind": "procedural", "family": "structure", "seed": 3},
        "camera": {"width": 32, "height": 24, "hfov_deg": 80},
        "water": {"optics": "jerlov-3C"},
        "metrics": ["uiqm", "uciqe"]
    })
}
