//! A minimal service: the worker protocol over the real lease table, with faults on demand.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard};
use std::thread;
use std::time::{Duration, Instant};

use api::lease_table::{JobEntry, LeaseTable, Millis, TERM_MS};
use prost::Message;
use sha2::{Digest, Sha256};
use spec::{FrameRecord, Job, RangeFile, RangeKind, SceneFiles, hex};
use wire::decode;
use wire::messages::{
    BeatRequest, CommitRequest, CommitResponse, FailRequest, FrameClaim, Lease, LeaseRequest, LeaseResponse,
    PutArtifactsRequest, RegisterRequest, RegisterResponse, ReleaseRequest,
};

#[derive(Default)]
pub(crate) struct State {
    pub(crate) table: LeaseTable,
    specs: BTreeMap<String, Job>,
    pub(crate) workers: BTreeSet<String>,
    pub(crate) images: BTreeMap<u64, FrameRecord>,
    pub(crate) commits: u64,
    /// Number of requests for a description.
    pub(crate) fetched: u32,
    pub(crate) failures: Vec<(u64, String, bool)>,
    blobs: BTreeMap<String, Vec<u8>>,
    scene: Option<SceneFiles<String>>,
    tokens: u64,
    /// Number of responses to commits to lose from now on.
    pub(crate) lost_answers: u32,
    /// Whether every call returns 503.
    pub(crate) away: bool,
    /// Whether every call returns 401.
    pub(crate) strict: bool,
    /// Protocol version, if not that of the worker.
    pub(crate) protocol: Option<u32>,
}

/// Response of a call.
enum Answer {
    Message(Vec<u8>),
    Problem(u16, &'static str),
    /// The connection breaks.
    Nothing,
}

pub(crate) struct FakeService {
    pub(crate) url: String,
    state: Arc<Mutex<State>>,
}

impl FakeService {
    pub(crate) fn start() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let url = format!("http://{}", listener.local_addr().unwrap());
        let state: Arc<Mutex<State>> = Arc::default();
        let shared = Arc::clone(&state);
        let begun = Instant::now();
        thread::spawn(move || {
            for stream in listener.incoming() {
                let state = Arc::clone(&shared);
                thread::spawn(move || serve(stream.unwrap(), &state, begun));
            }
        });
        Self { url, state }
    }

    pub(crate) fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap()
    }

    pub(crate) fn add_job(&self, id: &str, job: &Job) {
        let mut state = self.state();
        state.specs.insert(id.to_owned(), job.clone());
        state.table.add_job(JobEntry {
            id: id.to_owned(),
            frames: job.frames(),
            ..JobEntry::default()
        });
    }

    /// An uploaded scene, returned for every id.
    pub(crate) fn add_scene(&self, rgb: Vec<u8>, range: Vec<u8>) {
        let digest = |bytes: &[u8]| hex(&Sha256::digest(bytes));
        let mut state = self.state();
        state.scene = Some(SceneFiles {
            rgb: digest(&rgb),
            range: Some(RangeFile {
                file: digest(&range),
                kind: RangeKind::Range,
                unit_m: Some(1.0),
                invalid_code: None,
            }),
            instances: None,
            intrinsics: None,
            classes: None,
            world_from_camera: None,
            hfov_deg: None,
            scale: None,
        });
        state.blobs.extend([(digest(&rgb), rgb), (digest(&range), range)]);
    }

    /// Effect of a restart: workers and leases are dropped, images are kept.
    pub(crate) fn restart(&self) {
        let mut state = self.state();
        state.workers.clear();
        state.table = LeaseTable::new();
        let done = state
            .images
            .keys()
            .map(|&frame| frame..frame + 1)
            .collect::<Vec<_>>();
        let jobs: Vec<(String, u64)> = state
            .specs
            .iter()
            .map(|(id, job)| (id.clone(), job.frames()))
            .collect();
        for (id, frames) in jobs {
            state.table.add_job(JobEntry {
                id,
                frames,
                done: done.clone(),
                ..JobEntry::default()
            });
        }
    }

    /// Waits until a condition of the state holds.
    pub(crate) fn wait(&self, what: &str, mut until: impl FnMut(&State) -> bool) {
        let limit = Instant::now() + Duration::from_secs(30);
        while !until(&self.state()) {
            assert!(Instant::now() < limit, "waited too long: {what}");
            thread::sleep(Duration::from_millis(2));
        }
    }
}

fn serve(stream: TcpStream, state: &Mutex<State>, begun: Instant) {
    let mut reader = BufReader::new(stream.try_clone().unwrap());
    while let Some((path, body)) = request(&mut reader) {
        let now = Millis(begun.elapsed().as_millis() as u64);
        let answer = answer(&mut state.lock().unwrap(), &path, &body, now);
        let (status, body) = match answer {
            Answer::Message(body) => (200, body),
            Answer::Problem(status, slug) => (
                status,
                format!("{{\"type\": \"/problems/{slug}\", \"title\": \"{slug}\", \"detail\": \"\"}}").into(),
            ),
            Answer::Nothing => return,
        };
        let head = format!("HTTP/1.1 {status} X\r\ncontent-length: {}\r\n\r\n", body.len());
        if (&stream).write_all(&[head.as_bytes(), &body].concat()).is_err() {
            return;
        }
        // A long poll without the waiting.
        if path.ends_with("/lease") && body.is_empty() {
            thread::sleep(Duration::from_millis(5));
        }
    }
}

fn request(reader: &mut BufReader<TcpStream>) -> Option<(String, Vec<u8>)> {
    let (mut line, mut path, mut length) = (String::new(), None, 0);
    loop {
        line.clear();
        if reader.read_line(&mut line).ok()? == 0 {
            return None;
        }
        if line == "\r\n" {
            break;
        }
        if path.is_none() {
            path = line.split(' ').nth(1).map(str::to_owned);
        }
        if let Some((name, value)) = line.split_once(':')
            && name.eq_ignore_ascii_case("content-length")
        {
            length = value.trim().parse().unwrap();
        }
    }
    let mut body = vec![0; length];
    reader.read_exact(&mut body).ok()?;
    Some((path?, body))
}

const STALE: Answer = Answer::Problem(409, "stale-lease");
const UNKNOWN_WORKER: Answer = Answer::Problem(404, "unknown-worker");

fn answer(state: &mut State, path: &str, body: &[u8], now: Millis) -> Answer {
    if state.away {
        return Answer::Problem(503, "overloaded");
    }
    if state.strict {
        return Answer::Problem(401, "unauthorized");
    }
    match path.strip_prefix("/v1/worker/").unwrap() {
        "register" => register(state, decode(body).unwrap(), now),
        "lease" => lease(state, &decode(body).unwrap(), now),
        "beat" => {
            let beat: BeatRequest = decode(body).unwrap();
            if !state.workers.contains(&beat.worker_id) {
                return UNKNOWN_WORKER;
            }
            let beat = state.table.beat(&beat.worker_id, &beat.tokens, now);
            Answer::Message(beat.encode_to_vec())
        }
        "artifacts" => {
            let put: PutArtifactsRequest = decode(body).unwrap();
            let claim = put.claim.unwrap();
            if state.table.check(&claim).is_err() {
                return STALE;
            }
            for artifact in put.artifacts {
                assert_eq!(hex(&Sha256::digest(&artifact.data)), artifact.digest);
                state.blobs.insert(artifact.digest, artifact.data);
            }
            Answer::Message(Vec::new())
        }
        "commit" => commit(state, decode(body).unwrap(), now),
        "fail" => {
            let FailRequest {
                claim,
                error,
                retryable,
                ..
            } = decode(body).unwrap();
            let claim = claim.unwrap();
            let frame = claim.frame;
            match state.table.fail(&claim, retryable, &error, now) {
                Err(_) => STALE,
                Ok(_) => {
                    state.failures.push((frame, error, retryable));
                    Answer::Message(Vec::new())
                }
            }
        }
        "release" => {
            let ReleaseRequest { token, .. } = decode(body).unwrap();
            state.table.release(token, now);
            Answer::Message(Vec::new())
        }
        get => match get.split_once('/').unwrap() {
            ("scenes", _) => Answer::Message(serde_json::to_vec(state.scene.as_ref().unwrap()).unwrap()),
            ("jobs", id) => {
                state.fetched += 1;
                Answer::Message(state.specs[id].canonical().into())
            }
            ("blobs", digest) => Answer::Message(state.blobs[digest].clone()),
            _ => panic!("unexpected call {path}"),
        },
    }
}

fn register(state: &mut State, about: RegisterRequest, now: Millis) -> Answer {
    state.tokens += 1;
    let worker_id = format!("wrk_{}", state.tokens);
    state.table.register(&worker_id, about, now);
    state.workers.insert(worker_id.clone());
    let registered = RegisterResponse {
        worker_id,
        lease_term_ms: TERM_MS,
        beat_ms: 20,
        protocol: state.protocol.unwrap_or(wire::VERSION),
    };
    Answer::Message(registered.encode_to_vec())
}

fn lease(state: &mut State, want: &LeaseRequest, now: Millis) -> Answer {
    if !state.workers.contains(&want.worker_id) {
        return UNKNOWN_WORKER;
    }
    state.tokens += 1;
    let Some(grant) = state
        .table
        .grant(&want.worker_id, now, state.tokens, want.frame_ms)
    else {
        return Answer::Message(Vec::new());
    };
    let frames = grant.frames.into_iter();
    let frames = frames.map(|(frame, attempt)| FrameClaim { frame, attempt });
    let lease = Lease {
        token: grant.token,
        spec_digest: state.specs[&grant.job_id].digest(),
        job_id: grant.job_id,
        frames: frames.collect(),
        term_ms: TERM_MS,
    };
    Answer::Message(LeaseResponse { lease: Some(lease) }.encode_to_vec())
}

fn commit(state: &mut State, commit: CommitRequest, now: Millis) -> Answer {
    let (record, claim) = (commit.record().unwrap(), commit.claim.unwrap());
    let frame = claim.frame;
    if state.table.begin_commit(&claim, now).is_err() {
        return STALE;
    }
    assert!(
        record
            .artifacts
            .iter()
            .all(|artifact| state.blobs.contains_key(&artifact.digest))
    );
    state.table.finish_commit(&claim);
    state.commits += 1;
    state.images.insert(frame, record);
    if state.lost_answers > 0 {
        state.lost_answers -= 1;
        return Answer::Nothing;
    }
    Answer::Message(CommitResponse { already_there: false }.encode_to_vec())
}
