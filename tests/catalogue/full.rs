//! A disk that is full: the call says so, questions are answered, and writing goes on when there is space.
//!
//! The disk is a small file system in memory: [`on_a_small_disk`] runs on it. Where none can be mounted the test fails.

use std::path::Path;
use std::sync::Arc;

use catalogue::{Catalogue, CatalogueError, ImageQuery, InsertJob};

#[path = "../src/small_disk.rs"]
mod small_disk;

const DISK: &str = "size=40m";
const BALLAST_BYTES: usize = 12 << 20;

#[test]
fn a_full_disk_stops_writing_and_nothing_else() {
    small_disk::run("full::on_a_small_disk", DISK);
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "run by the test above, on a small disk"]
async fn on_a_small_disk() {
    let folder = std::env::var_os(small_disk::FOLDER).expect("started by the test above");
    let folder = Path::new(&folder);
    std::fs::write(folder.join("ballast"), vec![7; BALLAST_BYTES]).unwrap();
    let path = folder.join("catalogue.sqlite");
    let catalogue = Arc::new(Catalogue::open(&path, &synthetic::metrics()).await.unwrap());
    catalogue
        .insert_job(synthetic::job("job_a", "bay", 1_000_000, 0))
        .await
        .unwrap();

    let first = fill(&catalogue).await;
    assert!(first > 100, "{first}");
    let mut next = 900_000;
    for _ in 0..5 {
        // Many images did not fit; a few may still, one by one.
        let refused = loop {
            next += 1;
            let late = synthetic::record("job_a", next);
            if let Err(error) = catalogue.insert_image("job_a", &late, 0).await {
                break error;
            }
        };
        assert!(matches!(refused, CatalogueError::Full { .. }), "{refused}");
        assert_eq!(catalogue.image("job_a", next).await.unwrap(), None);
        let job = catalogue.job("job_a").await.unwrap().unwrap();
        assert!(job.done >= first, "what was acknowledged is there");
        assert_eq!(
            catalogue
                .results("job_a", None, u32::MAX)
                .await
                .unwrap()
                .rows
                .len() as u64,
            job.done
        );
        let page = catalogue.images(ImageQuery {
            filter: Some("uiqm > 0.5".to_owned()),
            limit: 20,
            ..ImageQuery::default()
        });
        assert_eq!(page.await.unwrap().items.len(), 20);
    }
    assert_eq!(catalogue.integrity_check().await.unwrap(), [""; 0]);

    // Space comes back: the same catalogue writes on.
    std::fs::remove_file(folder.join("ballast")).unwrap();
    let job = synthetic::job("job_b", "bay", 5, 0);
    assert!(matches!(
        catalogue.insert_job(job).await.unwrap(),
        InsertJob::Created(_)
    ));
    let second = fill(&catalogue).await;
    assert!(second > first + 100, "{second} after {first}");
    assert_eq!(catalogue.integrity_check().await.unwrap(), [""; 0]);

    // So does another one, begun on the full disk.
    drop(catalogue);
    let catalogue = Catalogue::open(&path, &synthetic::metrics()).await.unwrap();
    assert!(catalogue.job("job_a").await.unwrap().unwrap().done >= second);
    assert_eq!(catalogue.integrity_check().await.unwrap(), [""; 0]);
}

/// Stores images until the disk is full; answers how many of the job were acknowledged or found.
async fn fill(catalogue: &Arc<Catalogue>) -> u64 {
    let result = synthetic::fill(catalogue, "job_a", 0..100_000, 0).await;
    assert!(matches!(result, Err(CatalogueError::Full { .. })), "{result:?}");
    catalogue.job("job_a").await.unwrap().unwrap().done
}
