//! Size: a job is a formula, not a list.

use crate::fixture::Fixture;

const FRAMES: u64 = 10_000_000;
/// A few pages, each written at most twice: to the log and to the file.
const MOST_BYTES: u64 = 128 << 10;

#[tokio::test]
async fn ten_million_frames_are_one_row() {
    let at = Fixture::new().await;
    at.job("job_small", "bay", 1, 0).await;
    let size = || std::fs::metadata(at.file()).unwrap().len() + at.catalogue.wal_bytes();
    let before = size();
    at.job("job_large", "bay", FRAMES, 0).await;
    let grown = size() - before;
    assert!(grown <= MOST_BYTES, "{grown} bytes for one job");
    let counts = at.counts().await;
    assert_eq!((counts["jobs"], counts["images"], counts["failures"]), (2, 0, 0));
    let open = at.open_job("job_large").await;
    assert_eq!(
        (open.row.frames, open.done.len(), open.failed.len()),
        (FRAMES, 0, 0)
    );
    // Its last frame is like any other.
    synthetic::fill(&at.catalogue, "job_large", FRAMES - 1..FRAMES, 0)
        .await
        .unwrap();
    let open = at.open_job("job_large").await;
    assert_eq!(open.done.first(), Some(&(FRAMES - 1..FRAMES)));
}
