//! A catalogue to ask.

use std::cell::LazyCell;
use std::sync::Arc;

use catalogue::{Catalogue, CatalogueError, ImageQuery};
use tokio::runtime::Runtime;

struct Asked {
    runtime: Runtime,
    catalogue: Arc<Catalogue>,
    _folder: tempfile::TempDir,
}

thread_local! {
    static ASKED: LazyCell<Asked> = LazyCell::new(|| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
        let metrics = synthetic::metrics();
        let path = folder.path().join("catalogue.sqlite");
        let catalogue = runtime.block_on(async {
            let catalogue = Arc::new(Catalogue::open(&path, &metrics).await.expect("a new catalogue"));
            catalogue.insert_job(synthetic::job("job_a", "fuzz", 20, 0)).await.expect("a job");
            synthetic::fill(&catalogue, "job_a", 0..20, 0).await.expect("rows");
            catalogue
        });
        Asked { runtime, catalogue, _folder: folder }
    });
}

/// Everything, a page of a few rows.
pub fn all() -> ImageQuery {
    ImageQuery {
        limit: 5,
        ..ImageQuery::default()
    }
}

/// Asks; only what is the caller's fault may be refused.
pub fn ask(query: ImageQuery) {
    ASKED.with(|asked| {
        let told = format!("{query:?}");
        match asked.runtime.block_on(asked.catalogue.images(query)) {
            Ok(page) => assert!(page.items.len() <= 5),
            Err(CatalogueError::Filter(_) | CatalogueError::Cursor) => {}
            Err(error) => panic!("{told}: {error}"),
        }
    });
}
