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
    // Single frames, and runs that end within, at and after the frames of one count.
    let runs = [3..4, 6..8200, 8201..8202, 8203..16_600, 90_000..90_001];
    for run in runs.clone() {
        synthetic::fill(&db.catalogue, "job_a", run, 0).await.unwrap();
    }
    db.job("job_b", "bay", FRAMES, 5).await;
    assert_eq!(db.open_job("job_a").await.done, runs);
    assert_eq!(db.open_job("job_b").await.done, [0..5]);
}
