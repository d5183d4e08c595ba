//! Size: a job is a formula, not a list.

use crate::fixture::Fixture;

const FRAMES: u64 = 10_000_000;
/// A few pages, each written at most twice: to the log and to the file.
const MOST_BYTES: u64 = 128 << 10;

#[tokio::test]
async fn ten_million_frames_are_one_row() {
    let db = Fixture::new().await;
    db.job("job_small", "bay", 1, 0).await;
    let size = || std::fs::metadata(db.file()).unwrap().len() + db.catalogue.wal_bytes();
    let before = size();
    db.job("job_large", "bay", FRAMES, 0).await;
    let grown = size() - before;
    assert!(grown <= MOST_BYTES, "{grown} bytes for one job");
    let counts = db.counts().await;
    assert_eq!((counts["jobs"], counts["images"], counts["failures"]), (2, 0, 0));
    let open = db.open_job("job_large").await;
    assert_eq!(
        (open.row.frames, open.done.len(), open.failed.len()),
        (FRAMES, 0, 0)
    );
    // Its last frame is like any other.
    synthetic::fill(&db.catalogue, "job_large", FRAMES - 1..FRAMES, 0)
        .await
        .unwrap();
    let open = db.open_job("job_large").await;
    assert_eq!(open.done.first(), Some(&(FRAMES - 1..FRAMES)));
}

#[tokio::test]
async fn finished_frames_are_found_whatever_their_gaps() {
    let db = Fixture::new().await;
    db.job("job_a", "bay", FRAMES, 0).await;
    assert!(db.open_job("job_a").await.done.is_empty());
    // The first and the last run have 8192 frames, which are counted, and a few more, which are listed.
    let runs = [0..8195, 8197..8198, 9000..9001, 20_000..28_200];
    for run in runs.clone() {
        synthetic::fill(&db.catalogue, "job_a", run, 0).await.unwrap();
    }
    let first = 0..5;
    db.job("job_b", "bay", FRAMES, first.end).await;
    assert_eq!(db.open_job("job_a").await.done, runs);
    assert_eq!(db.open_job("job_b").await.done, [first]);
    // The last frame that SQLite can number.
    let last = i64::MAX as u64 - 1..i64::MAX as u64;
    db.job("job_c", "bay", last.end, 0).await;
    synthetic::fill(&db.catalogue, "job_c", last.clone(), 0)
        .await
        .unwrap();
    assert_eq!(db.open_job("job_c").await.done, [last]);
}
