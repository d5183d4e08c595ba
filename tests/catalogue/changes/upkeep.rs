//! Copies and checks.

use catalogue::Catalogue;

use crate::fixture::Fixture;

#[tokio::test]
async fn a_copy_made_while_images_come_in_opens_and_is_sound() {
    let fixture = Fixture::new().await;
    fixture.job("job_a", "bay", 3000, 100).await;
    let copy = fixture.folder.path().join("copy.sqlite");
    let (filled, copied) = tokio::join!(
        synthetic::fill(&fixture.catalogue, "job_a", 100..3000, 0),
        fixture.catalogue.backup(&copy)
    );
    filled.unwrap();
    copied.unwrap();
    let restored = Catalogue::open(&copy, &synthetic::metrics()).await.unwrap();
    assert_eq!(restored.integrity_check().await.unwrap(), [""; 0]);
    let job = restored.job("job_a").await.unwrap().unwrap();
    assert!(job.done >= 100, "{}", job.done);
    let last = restored.results("job_a", None, u32::MAX).await.unwrap().rows;
    assert_eq!(last.len() as u64, job.done);
    // It goes on where the copy ends.
    synthetic::fill(&std::sync::Arc::new(restored), "job_a", 0..3000, 0)
        .await
        .unwrap();
    assert!(
        fixture.catalogue.backup(&copy).await.is_err(),
        "a file that is there stays"
    );
}

#[tokio::test]
async fn a_check_names_the_counter_that_is_wrong() {
    let fixture = Fixture::new().await;
    fixture.job("job_a", "bay", 3, 2).await;
    assert!(fixture.catalogue.wal_bytes() > 0);
    fixture.is_sound().await;
    fixture
        .sabotage("UPDATE jobs SET done = 3 WHERE id = 'job_a'")
        .await;
    let found = fixture.catalogue.integrity_check().await.unwrap();
    assert!(found.contains(&"counted images of job_a".to_owned()), "{found:?}");
    assert!(found.contains(&"sums of dataset of bay".to_owned()), "{found:?}");
}
