//! Workers that render true frames and deliver others, under a new name at each visit.
//!
//! Failure of the campaign: a lie stays in a job that ended without `unproven` frames.

mod lies;
mod visits;

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use fathom_tests::{Service, Worker, run};
use serde::Deserialize;
use serde_json::{Value, json};
use spec::{Agreement, FrameRecord, compare_records};

use lies::Lie;
use visits::{Campaign, Identity, Visitor};

const LIMIT: Duration = Duration::from_secs(900);

/// How a liar mixes true frames and lies in a visit.
struct Strategy {
    name: &'static str,
    /// Frames of the job: about half of them are rendered by liars.
    frames: u64,
    visits: u64,
    /// Frames of a visit.
    length: usize,
    is_lie: fn(usize) -> bool,
}

const STRATEGIES: [Strategy; 3] = [
    Strategy {
        name: "one true frame, seven lies, leave",
        frames: 800,
        visits: 50,
        length: 8,
        is_lie: |place| place > 0,
    },
    Strategy {
        name: "eight true frames, four lies, leave",
        frames: 640,
        visits: 26,
        length: 12,
        is_lie: |place| place >= 8,
    },
    Strategy {
        name: "eight true frames, then every second a lie",
        frames: 640,
        visits: 16,
        length: 24,
        is_lie: |place| place >= 8 && place % 2 == 0,
    },
];

fn job(name: &str, frames: u64) -> Value {
    json!({
        "dataset": name, "count": frames, "seed": 5,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
        "camera": {"width": 16, "height": 12, "hfov_deg": 80},
        "metrics": ["uiqm", "uciqe"],
        "artifacts": ["rgb", "range"]
    })
}

fn wait(what: &str, holds: impl Fn() -> bool) {
    let begun = Instant::now();
    while !holds() {
        assert!(begun.elapsed() < LIMIT, "not within {LIMIT:?}: {what}");
        std::thread::sleep(Duration::from_millis(100));
    }
}

fn state(service: &Service, id: &str) -> Value {
    service.get(&format!("/v1/jobs/{id}")).1
}

fn stored(service: &Service, id: &str, frame: u64) -> FrameRecord {
    let (_, image) = service.get(&format!("/v1/images/{id}/{frame}"));
    FrameRecord::deserialize(&image).expect("a stored record")
}

/// Failure: see above. `FATHOM_LIES` multiplies the frames.
#[test]
fn lies_of_ever_new_workers_are_found_before_a_job_is_done() {
    let factor = std::env::var("FATHOM_LIES")
        .ok()
        .and_then(|text| text.parse().ok());
    let factor: u64 = factor.unwrap_or(1);
    let data = tempfile::tempdir().expect("a temporary folder");
    let service = Service::start(data.path(), &["--workers", "0"]);
    println!("| strategy | frames | visits | lies | lies at the end | unproven | seconds |");
    println!("|---|---|---|---|---|---|---|");
    let (mut frames, mut all_lies) = (0, 0);
    for (number, strategy) in STRATEGIES.iter().enumerate() {
        let begun = Instant::now();
        let name = format!("lies-{number}");
        let id = service.submit(&job(&name, factor * strategy.frames));
        let mut campaign = Campaign::with_lies(&Lie::ALL);
        for visit in 0..factor * strategy.visits {
            let identity = Identity::honest(&format!("{name}-{visit}"));
            campaign.visit(&service.url, &identity, strategy.length, strategy.is_lie);
        }
        let honest = Worker::start(&service.url, &format!("honest-{number}"), 1);
        wait("the job ends", || {
            ["done", "done_with_failures"].contains(&state(&service, &id)["state"].as_str().unwrap_or(""))
        });
        drop(honest);
        let end = state(&service, &id);
        let unproven = end["unproven"].as_u64().expect("a number");
        assert_eq!(
            (&end["state"], &end["failed"]),
            (&json!("done"), &json!(0)),
            "{end}"
        );
        let remaining = campaign.truths().filter(|(frame, truth)| {
            let differences = compare_records(truth, &stored(&service, &id, **frame), Agreement::Exact);
            !differences.is_empty()
        });
        let remaining = remaining.count();
        println!(
            "| {} | {} | {} | {} | {remaining} | {unproven} | {:.0} |",
            strategy.name,
            factor * strategy.frames,
            factor * strategy.visits,
            campaign.lies(),
            begun.elapsed().as_secs_f64()
        );
        assert!(campaign.has_every_lie(), "{}", strategy.name);
        assert!(
            remaining == 0 || unproven > 0,
            "{}: {remaining} lies in a job without unproven frames",
            strategy.name
        );
        frames += factor * strategy.frames;
        all_lies += campaign.lies();
    }
    println!("{frames} frames, {all_lies} lies");
    assert!(frames >= 2000);
}

/// Failure: a frame that cannot be checked enters a job without consent, a job waits without a warning, or a frame that
/// was not checked counts as proven.
#[test]
fn workers_that_cannot_be_checked_get_no_frames_without_consent_and_theirs_stay_unproven() {
    let data = tempfile::tempdir().expect("a temporary folder");
    let service = Service::start(data.path(), &["--workers", "0"]);
    let id = service.submit(&job("mixed", 20));
    let other_version = Identity {
        code_version: "9.9.9".to_owned(),
        ..Identity::honest("version")
    };
    let other_machine = Identity {
        cpu_features: "none".to_owned(),
        ..Identity::honest("machine")
    };
    for identity in [&other_version, &other_machine] {
        let mut visitor = Visitor::register(&service.url, identity).expect("a registration");
        assert!(visitor.lease(500).is_none(), "{}", identity.name);
    }
    let warnings = state(&service, &id)["warnings"].to_string();
    assert!(
        warnings.contains("9.9.9") && warnings.contains("finish-elsewhere"),
        "{warnings}"
    );

    // A runtime that no frame used is rejected.
    let mut visitor =
        Visitor::register(&service.url, &Identity::with_runtime("runtime", "1.99")).expect("a registration");
    let lease = visitor.lease(2000).expect("a lease");
    let mut delivered = visitor.render(&lease);
    delivered.record.provenance.onnx_runtime = Some("1.99".to_owned());
    let refused = visitor.deliver(&lease, &delivered).expect_err("a rejection");
    assert!(
        refused.to_string().contains("/provenance/onnx_runtime"),
        "{refused}"
    );
    drop(visitor);

    let (status, row) = service.post(&format!("/v1/jobs/{id}/finish-elsewhere"), &json!({}));
    assert_eq!((status, &row["mixed"]), (200, &json!(true)), "{row}");
    let mut campaign = Campaign::with_lies(&Lie::ALL);
    while campaign.visit(&service.url, &other_version, 20, |_| false) > 0 {}
    wait("the job ends", || state(&service, &id)["state"] == "done");
    let end = state(&service, &id);
    assert_eq!(
        (&end["done"], &end["unproven"]),
        (&json!(20), &json!(20)),
        "{end}"
    );

    // The same description on a machine of another kind: black pictures and flat ranges are found.
    let id = service.submit(&job("other", 20));
    let _ = service.post(&format!("/v1/jobs/{id}/finish-elsewhere"), &json!({}));
    let mut campaign = Campaign::with_lies(&[Lie::Black, Lie::FlatRange]);
    campaign.visit(&service.url, &other_machine, 20, |_| true);
    let honest = Worker::start(&service.url, "honest", 1);
    wait("the job ends", || state(&service, &id)["state"] == "done");
    drop(honest);
    for (frame, truth) in campaign.truths() {
        assert_eq!(
            compare_records(truth, &stored(&service, &id, *frame), Agreement::Exact),
            []
        );
    }
    assert_eq!(state(&service, &id)["unproven"], json!(0));

    // From the beginning, by one kind of machine.
    let (status, row) = service.post(&format!("/v1/jobs/{id}/start-again"), &json!({}));
    assert_eq!(
        (status, &row["done"], &row["mixed"]),
        (200, &json!(0), &Value::Null),
        "{row}"
    );
    let honest = Worker::start(&service.url, "honest-again", 1);
    wait("the job ends", || state(&service, &id)["state"] == "done");
    drop(honest);
}

/// Failure: a verification reports a false record as reproduced.
#[test]
fn verification_compares_the_whole_record() {
    let data = tempfile::tempdir().expect("a temporary folder");
    let service = Service::start(data.path(), &["--workers", "0", "--spot-check", "0"]);
    let id = service.submit(&job("verified", 3));
    let mut campaign = Campaign::with_lies(&[Lie::Metric, Lie::EmptyPlan]);
    campaign.visit(&service.url, &Identity::honest("liar"), 3, |place| place > 0);
    wait("the job ends", || state(&service, &id)["state"] == "done");
    let found = [0, 1, 2].map(|frame| {
        let path = format!("/v1/images/{id}/{frame}/verify");
        let (status, verified) = service.post(&path, &json!({"rerender": true}));
        assert_eq!((status, &verified["intact"]), (200, &json!(true)), "{verified}");
        let pointer = verified["record_differences"][0]["pointer"].as_str();
        (verified["reproduced"] == true, pointer.map(str::to_owned))
    });
    assert_eq!(
        found,
        [
            (true, None),
            (false, Some("/measurements/rgb/uiqm".to_owned())),
            (false, Some("/plan/0".to_owned()))
        ]
    );
    drop(service);
    assert_eq!(
        find_false_records_by_repair(data.path()),
        ["/measurements/rgb/uiqm", "/plan/0"]
    );
}

/// Damages every artifact of a stopped service and repairs them; returns the pointers of the false records that the repair
/// finds.
fn find_false_records_by_repair(data: &Path) -> Vec<String> {
    let script = "import sqlite3, sys\nc = sqlite3.connect(sys.argv[1])\n\
                  c.execute('UPDATE data SET bytes = zeroblob(length(bytes))')\nc.commit()";
    let pack = data.join("packs/pack-000001.sqlite");
    let changed = Command::new("python3").args(["-c", script]).arg(pack).status();
    assert!(changed.is_ok_and(|status| status.success()));
    let output = run(&[
        "scrub",
        "--repair",
        "--json",
        "--data",
        data.to_str().expect("text"),
    ]);
    let findings: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert!(!output.status.success(), "{findings}");
    let damaged = findings["damaged"].as_array().expect("a list");
    assert!(
        damaged.iter().all(|damaged| damaged["repaired"] == true),
        "{findings}"
    );
    let rows = findings["rows"].as_array().expect("a list").iter();
    let pointers = rows.filter_map(|row| row["what"].as_str()?.split(' ').nth(3));
    let mut pointers: Vec<String> = pointers.map(str::to_owned).collect();
    pointers.sort();
    pointers
}
