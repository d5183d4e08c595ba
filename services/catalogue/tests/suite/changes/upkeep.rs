//! Copies and checks.

use catalogue::Catalogue;

use crate::fixture::Fixture;

#[tokio::test]
async fn a_copy_made_while_images_come_in_opens_and_is_sound() {
    let at = Fixture::new().await;
    at.job("job_a", "bay", 3000, 100).await;
    let copy = at.folder.path().join("copy.sqlite");
    let (filled, copied) = tokio::join!(
        synthetic::fill(&at.catalogue, "job_a", 100..3000, 0),
        at.catalogue.backup(&copy)
    );
    filled.unwrap();
    copied.unwrap();
    let restored = Catalogue::open(&copy, &synthetic::metrics()).await.unwrap();
    assert_eq!(restored.integrity_check().await.unwrap(), [""; 0]);
    let job = restored.job("job_a").await.unwrap().unwrap();
    assert!(job.done >= 100, "{}", job.done);
    let last = restored.results("job_a", None, u32::MAX).await.unwrap();
    assert_eq!(last.len() as u64, job.done);
    // It goes on where the copy ends.
    synthetic::fill(&std::sync::Arc::new(restored), "job_a", 0..3000, 0)
        .await
        .unwrap();
    assert!(
        at.catalogue.backup(&copy).await.is_err(),
        "a file that is there stays"
    );
}

#[tokio::test]
async fn a_check_names_the_counter_that_is_wrong() {
    let at = Fixture::new().await;
    at.job("job_a", "bay", 3, 2).await;
    assert!(at.catalogue.wal_bytes() > 0);
    at.is_sound().await;
    at.sabotage("UPDATE jobs SET done = 3 WHERE id = 'job_a'").await;
    let found = at.catalogue.integrity_check().await.unwrap();
    assert!(found.contains(&"counted images of job_a".to_owned()), "{found:?}");
    assert!(found.contains(&"sums of dataset of bay".to_owned()), "{found:?}");
}
