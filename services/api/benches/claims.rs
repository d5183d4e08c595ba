//! Cost of a claim with a million frames waiting and a million completed, in one job and in a thousand.

use std::time::{Duration, Instant};

use api::lease_table::{JobEntry, LeaseTable, Millis};
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use wire::messages::Claim;

const EACH: u64 = 1_000_000;

/// Every second frame has its image: the worst case for a million frames.
fn table(jobs: u64) -> LeaseTable {
    let mut table = LeaseTable::new();
    let of_one = EACH / jobs;
    for job in 0..jobs {
        table.add_job(JobEntry {
            id: format!("job_{job:06}"),
            frames: 2 * of_one,
            done: (0..of_one).map(|pair| 2 * pair..2 * pair + 1).collect(),
            ..JobEntry::default()
        });
    }
    table
}

fn claim(table: &mut LeaseTable, token: u64) {
    let now = Millis(token / 1000);
    let grant = table.grant("w", now, token, 0.0).expect("frames wait");
    let (frame, attempt) = grant.frames[0];
    let claim = Claim {
        token,
        job_id: grant.job_id,
        frame,
        attempt,
    };
    table.begin_commit(&claim, now).expect("the lease is fresh");
    table.finish_commit(&claim);
}

fn claims(criterion: &mut Criterion) {
    for jobs in [1, 1000] {
        let mut token = 0;
        let name = format!("claim and commit, 10^6 waiting and 10^6 done in {jobs} jobs");
        criterion.bench_function(&name, |bench| {
            bench.iter_custom(|iterations| {
                let (mut left, mut spent) = (iterations, Duration::ZERO);
                while left > 0 {
                    // A tenth of the queued frames, then a fresh table.
                    let (some, mut table) = (left.min(EACH / 10), table(jobs));
                    let begun = Instant::now();
                    for _ in 0..some {
                        token += 1;
                        claim(&mut table, token);
                    }
                    spent += begun.elapsed();
                    left -= some;
                }
                spent
            });
        });
    }
    criterion.bench_function("take up a job of 10^7 frames", |bench| {
        let entry = || JobEntry {
            id: "job".to_owned(),
            frames: 10_000_000,
            ..JobEntry::default()
        };
        bench.iter_batched(
            || (LeaseTable::new(), entry()),
            |(mut table, entry)| {
                table.add_job(entry);
                table
            },
            BatchSize::SmallInput,
        );
    });
}

criterion_group!(benches, claims);
criterion_main!(benches);
