use std::sync::Arc;

use catalogue::JobRow;
use wire::messages::{Claim, FrameClaim};

use super::super::table::TERM_MS;
use super::*;

/// A dispatch with a job of one frame, the worker's id, and its clock.
fn one_frame() -> (Dispatch, String, Arc<AtomicU64>) {
    let hand = Arc::new(AtomicU64::new(0));
    let read = Arc::clone(&hand);
    let clock = Clock::from_functions(move || read.load(Ordering::SeqCst), || 0);
    let dispatch = Dispatch::new(clock, Rules::default());
    dispatch.add_job(job("job_a"));
    let worker = dispatch.register(about(), false).unwrap();
    (dispatch, worker, hand)
}

fn job(id: &str) -> OpenJob {
    OpenJob::from(JobRow {
        id: id.to_owned(),
        dataset: "bay".to_owned(),
        state: JobState::Queued,
        frames: 1,
        done: 0,
        failed: 0,
        bytes: 0,
        version: 1,
        created_at: UnixMs(0),
        started_at: None,
        finished_at: None,
        digest: None,
        set: None,
        unproven: 0,
        mixed: false,
        distrusted: false,
        warnings: Vec::new(),
        price: None,
        owner: None,
        priority: 0,
        spec_digest: format!("digest of {id}"),
    })
}

fn about() -> RegisterRequest {
    RegisterRequest {
        name: "local-1".to_owned(),
        slots: 1,
        ..RegisterRequest::default()
    }
}

async fn token(dispatch: &Dispatch, worker: &str) -> Option<u64> {
    let granted = dispatch.lease(worker, Duration::ZERO, 0.0).await;
    granted.ok().flatten().map(|granted| granted.hand_over().token)
}

#[tokio::test]
async fn an_undelivered_lease_is_freed_without_a_strike() {
    let (dispatch, worker, _) = one_frame();
    drop(
        dispatch
            .lease(&worker, Duration::ZERO, 0.0)
            .await
            .ok()
            .flatten()
            .unwrap(),
    );
    let granted = dispatch
        .lease(&worker, Duration::ZERO, 0.0)
        .await
        .ok()
        .flatten()
        .unwrap();
    let lease = granted.hand_over();
    assert_eq!(lease.frames, [FrameClaim { frame: 0, attempt: 1 }]);
    assert_eq!(lease.spec_digest, "digest of job_a");
}

#[tokio::test]
async fn a_silent_workers_frame_is_offered_after_its_term_with_a_larger_token() {
    let (dispatch, worker, hand) = one_frame();
    let first = token(&dispatch, &worker).await.unwrap();
    hand.store(u64::from(TERM_MS) - 1, Ordering::SeqCst);
    assert!(dispatch.expire().is_empty());
    assert_eq!(token(&dispatch, &worker).await, None);
    hand.store(u64::from(TERM_MS), Ordering::SeqCst);
    assert_eq!(dispatch.expire().len(), 1);
    hand.store(60_000, Ordering::SeqCst);
    assert!(token(&dispatch, &worker).await.unwrap() > first);
}

#[tokio::test]
async fn a_dead_childs_frame_is_offered_again_and_its_id_is_dropped() {
    let (dispatch, worker, hand) = one_frame();
    token(&dispatch, &worker).await.unwrap();
    let (registered, events) = dispatch.drop_workers_named("remote");
    assert!(!registered && events.is_empty());
    let (registered, events) = dispatch.drop_workers_named("local-1");
    assert!(registered && events.len() == 1);
    assert!(dispatch.lease(&worker, Duration::ZERO, 0.0).await.is_err());
    assert!(dispatch.workers().is_empty());
    hand.store(1_000, Ordering::SeqCst);
    let next = dispatch.register(about(), false).unwrap();
    assert!(token(&dispatch, &next).await.is_some());
}

#[tokio::test(start_paused = true)]
async fn only_a_cancel_ends_a_heartbeat_early() {
    let (dispatch, worker, _) = one_frame();
    let token = token(&dispatch, &worker).await.unwrap();
    let dispatch = Arc::new(dispatch);
    let wait = Duration::from_secs(5);
    let begun = Instant::now();
    let quiet = dispatch.beat(&worker, &[token], wait).await.ok().unwrap();
    assert_eq!((quiet, begun.elapsed()), (BeatResponse::default(), wait));
    // Also for a lease missing from the heartbeat.
    let beat = {
        let (dispatch, worker) = (Arc::clone(&dispatch), worker.clone());
        tokio::spawn(async move { dispatch.beat(&worker, &[], wait).await.ok() })
    };
    tokio::task::yield_now().await;
    let begun = Instant::now();
    dispatch.cancel("job_a");
    assert_eq!(beat.await.unwrap().unwrap().cancelled, [token]);
    assert_eq!(begun.elapsed(), Duration::ZERO);
    // Only once.
    let again = dispatch.beat(&worker, &[], Duration::ZERO).await.ok().unwrap();
    assert_eq!(again, BeatResponse::default());
}

#[tokio::test]
async fn a_worker_that_commits_no_frames_is_dismissed_at_the_third() {
    let hand = Arc::new(AtomicU64::new(0));
    let read = Arc::clone(&hand);
    let clock = Clock::from_functions(move || read.load(Ordering::SeqCst), || 0);
    let rules = Rules {
        frame_limit_ms: 60_000,
        ..Rules::default()
    };
    let dispatch = Dispatch::new(clock, rules);
    for job_id in ["job_a", "job_b", "job_c"] {
        dispatch.add_job(job(job_id));
    }
    let worker = dispatch.register(about(), true).unwrap();
    let mut now = 0;
    for stalls in 1..=3 {
        let token = token(&dispatch, &worker).await.unwrap();
        let begun = now;
        let event = loop {
            let beat = dispatch
                .beat(&worker, &[token], Duration::ZERO)
                .await
                .ok()
                .unwrap();
            assert!(beat.lost.is_empty());
            now += 5000;
            hand.store(now, Ordering::SeqCst);
            if let Some(event) = dispatch.expire().pop() {
                break event;
            }
        };
        assert_eq!(now - begun, 60_000);
        assert!(
            event.error.contains("held this frame for 60 s"),
            "{}",
            event.error
        );
        assert_eq!(dispatch.workers().is_empty(), stalls == 3);
    }
    assert_eq!(dispatch.dismissed_own(), ["local-1"]);
    assert!(dispatch.register(about(), true).is_none());
}

#[tokio::test(start_paused = true)]
async fn a_waiting_worker_is_woken_by_a_new_job() {
    let (dispatch, worker, _) = one_frame();
    token(&dispatch, &worker).await.unwrap();
    let dispatch = Arc::new(dispatch);
    let waiting = {
        let (dispatch, worker) = (Arc::clone(&dispatch), worker.clone());
        tokio::spawn(async move {
            let granted = dispatch.lease(&worker, Duration::from_secs(60), 0.0).await;
            granted.ok().flatten().map(|granted| granted.hand_over().job_id)
        })
    };
    tokio::task::yield_now().await;
    let begun = Instant::now();
    dispatch.add_job(job("job_b"));
    assert_eq!(waiting.await.unwrap().as_deref(), Some("job_b"));
    assert_eq!(begun.elapsed(), Duration::ZERO);
}

/// Failure: a worker that may not render any open job looks at all of them with every commit of the others.
#[tokio::test(start_paused = true)]
async fn commits_do_not_wake_waiting_workers() {
    const COMMITS: u64 = 50;
    let toolchain = Toolchain {
        code_version: "1".to_owned(),
        cpu_features: String::new(),
        onnx_runtime: None,
    };
    let rules = Rules {
        reference: Some(toolchain.clone()),
        ..Rules::default()
    };
    let dispatch = Arc::new(Dispatch::new(Clock::from_functions(|| 0, || 0), rules));
    let mut many = job("job_a");
    many.row.frames = COMMITS + 1;
    dispatch.add_job(many);
    let same = RegisterRequest {
        code_version: "1".to_owned(),
        ..about()
    };
    let (worker, misfit) = (
        dispatch.register(same, true).unwrap(),
        dispatch.register(about(), false).unwrap(),
    );
    let waiting = {
        let dispatch = Arc::clone(&dispatch);
        tokio::spawn(async move {
            let granted = dispatch.lease(&misfit, Duration::from_secs(60), 0.0).await;
            granted.ok().flatten().is_some()
        })
    };
    tokio::task::yield_now().await;
    let first = dispatch.next_token.load(Ordering::Relaxed);
    for _ in 0..COMMITS {
        let granted = dispatch.lease(&worker, Duration::ZERO, 0.0).await;
        let lease = granted.ok().flatten().unwrap().hand_over();
        let claim = Claim {
            token: lease.token,
            job_id: lease.job_id.clone(),
            frame: lease.frames[0].frame,
            attempt: 1,
        };
        dispatch.begin_commit(&claim, &toolchain).unwrap();
        dispatch.table(|table, _| table.finish_commit(&claim));
        tokio::task::yield_now().await;
    }
    let looks = dispatch.next_token.load(Ordering::Relaxed) - first;
    assert_eq!(looks, COMMITS, "the others are those of the misfit");
    waiting.abort();
}
