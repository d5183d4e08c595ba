//! Answers of the mirror are those of the tables, whatever it holds and whatever became of what it held.

use catalogue::{CountedSource, Histogram2dColumns, ImageQuery};
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::fixture::Fixture;

/// So few images that many files are made of few.
const ROWS: u16 = 40;
/// True of every image, but the mirror has no such column: a question with it goes to the tables alone.
const TABLES_ALONE: &str = "digest is not null";

const FILTERS: [&str; 14] = [
    "",
    "alpha > 0.5",
    "alpha between 0.2 and 0.6 and not failed",
    "alpha is null or uiqm < 0.3",
    "not (water.style in (\"muddy\", \"atlantic\"))",
    "water.style != \"muddy\" and frame >= 17",
    "frame in (1, 5, 9) or warned",
    "frame < 30.5 and frame > 2.5",
    "job = \"job_a\" or hscm.uiqm > 0.9",
    "seed = 42 and seed < 18446744073709551615",
    "hscm.uiqm is not null and not hscm.uiqm <= 0.25",
    "uiqm >= 0 and uiqm <= 1",
    "water.optics = \"jerlov-5C\" and created_ms > 0",
    "uiqm > 7",
];

/// What happens to a catalogue.
#[derive(Debug, Clone)]
enum Step {
    Insert(u64),
    Mirror,
    Delete,
    Sweep,
    Reopen(u64),
    Restart,
    Lose,
    Damage,
}

fn step() -> impl Strategy<Value = Step> {
    prop_oneof![
        4 => (1u64..90).prop_map(Step::Insert),
        4 => Just(Step::Mirror),
        1 => Just(Step::Delete),
        2 => Just(Step::Sweep),
        1 => (0u64..60).prop_map(Step::Reopen),
        1 => Just(Step::Restart),
        1 => Just(Step::Lose),
        1 => Just(Step::Damage),
    ]
}

/// A catalogue with two jobs of one dataset and one of another.
struct World {
    at: Fixture,
    /// Frames that were stored, by job.
    next: [u64; 3],
    /// Grows with each job that takes the place of a deleted one.
    generation: u64,
}

impl World {
    async fn new() -> Self {
        let at = Fixture::new().await;
        for (job, dataset) in [("job_a", "bay"), ("job_b", "bay"), ("job_c", "cove")] {
            at.job(job, dataset, 100_000, 0).await;
        }
        Self {
            at,
            next: [0; 3],
            generation: 0,
        }
    }

    fn name(&self, place: usize) -> String {
        match (place, self.generation) {
            (0, _) => "job_a".to_owned(),
            (1, 0) => "job_b".to_owned(),
            (1, generation) => format!("job_b{generation}"),
            _ => "job_c".to_owned(),
        }
    }

    async fn insert(&mut self, images: u64) {
        for image in 0..images {
            let place = [0, 1, 1, 2][(image % 4) as usize];
            let job = self.name(place);
            let mut record = synthetic::record(&job, self.next[place]);
            // Some lack a parameter or a measurement.
            match self.next[place] % 7 {
                0 => drop(record.parameters.as_object_mut().unwrap().remove("alpha")),
                1 => drop(record.measurements.remove("hscm")),
                2 => record.parameters["alpha"] = json!(0.5),
                _ => {}
            }
            self.at.catalogue.insert_image(&job, &record, 5).await.unwrap();
            self.next[place] += 1;
        }
    }

    fn files(&self) -> Vec<std::path::PathBuf> {
        let folder = std::fs::read_dir(self.at.folder.path().join("mirror"));
        let entries = folder.into_iter().flatten().flatten();
        let mut files: Vec<_> = entries.map(|entry| entry.path()).collect();
        files.sort();
        files
    }

    async fn step(mut self, step: &Step) -> Self {
        let catalogue = &self.at.catalogue;
        match step {
            Step::Insert(images) => self.insert(*images).await,
            Step::Mirror => while catalogue.replicate_some(ROWS).await.unwrap() {},
            Step::Delete => {
                catalogue.delete_job(&self.name(1)).await.unwrap();
                self.generation += 1;
                self.next[1] = 0;
                self.at.job(&self.name(1), "bay", 100_000, 0).await;
            }
            Step::Sweep => drop(catalogue.sweep().await.unwrap()),
            Step::Reopen(frame) => drop(catalogue.reopen("job_a", vec![*frame, frame + 1]).await.unwrap()),
            Step::Restart => self.at = self.at.reopen().await,
            Step::Lose => self
                .files()
                .first()
                .map_or((), |file| std::fs::remove_file(file).unwrap()),
            Step::Damage => {
                if let Some(file) = self.files().last() {
                    let mut bytes = std::fs::read(file).unwrap();
                    let middle = bytes.len() / 2;
                    bytes[middle] ^= 1;
                    std::fs::write(file, bytes).unwrap();
                }
            }
        }
        self
    }

    /// All kinds of answers under a filter, and where the images of each were read.
    async fn answers(&self, filter: &str) -> (Vec<Value>, Vec<CountedSource>) {
        let (catalogue, filter) = (&self.at.catalogue, Some(filter));
        let metrics = ["uiqm", "hscm.uiqm", "frame", "seed", "alpha"].map(str::to_owned);
        let (mut answers, mut sources) = (Vec::new(), Vec::new());
        for (column, range) in [
            ("alpha", None),
            ("hscm.uiqm", Some((0.2, 0.4))),
            ("seed", None),
            ("uiqm", None),
        ] {
            let got = catalogue
                .histogram("bay", filter, column, 7, range)
                .await
                .unwrap();
            sources.push(got.source);
            answers.push(json!([got.edges, got.counts, got.below, got.above, got.missing]));
        }
        for mean_of in [None, Some("hscm.uiqm"), Some("frame")] {
            let columns = Histogram2dColumns {
                x: "alpha",
                y: "uiqm",
                mean_of,
            };
            let got = catalogue.histogram_2d("bay", filter, columns, 5).await.unwrap();
            sources.push(got.source);
            answers.push(json!([got.x, got.y, got.counts, got.means, got.missing]));
        }
        for by in [
            "water.style",
            "water.optics,alpha:0.25",
            "warned,seed",
            "frame:20,job,failed",
        ] {
            let got = catalogue
                .grouped_stats("bay", &metrics, by, filter)
                .await
                .unwrap();
            sources.push(got.source);
            answers.push(json!(got.groups));
        }
        for by in [None, Some("alpha"), Some("frame"), Some("failed")] {
            let got = catalogue.stats("bay", &metrics, by, filter).await.unwrap();
            sources.push(got.source);
            answers.push(json!(got.groups));
        }
        (answers, sources)
    }

    /// Pages in several orders, from several ranks on, and where each goes on.
    async fn pages(&self, filter: &str) -> Vec<Value> {
        let mut pages = Vec::new();
        for order in ["", "-alpha", "water.style", "-seed", "hscm.uiqm"] {
            for offset in [0, 61, 1000] {
                let mut query = ImageQuery {
                    dataset: Some("bay".to_owned()),
                    filter: Some(filter.to_owned()).filter(|filter| !filter.is_empty()),
                    order_by: Some(order.to_owned()),
                    limit: 9,
                    offset,
                    fields: vec!["job".to_owned(), "frame".to_owned()],
                    ..ImageQuery::default()
                };
                for _ in 0..2 {
                    let page = self.at.catalogue.images(query.clone()).await.unwrap();
                    pages.push(json!([order, offset, page.items, page.next_cursor.is_some()]));
                    let Some(next) = page.next_cursor else { break };
                    (query.cursor, query.offset) = (Some(next), 0);
                }
            }
        }
        pages
    }

    /// Asks the same with and without the mirror. Returns how many images were read from it.
    async fn agree(&self, filter: &str) -> u64 {
        let tables = match filter {
            "" => TABLES_ALONE.to_owned(),
            _ => format!("({filter}) and {TABLES_ALONE}"),
        };
        let (got, sources) = self.answers(filter).await;
        let (expected, alone) = self.answers(&tables).await;
        for (at, (got, expected)) in got.iter().zip(&expected).enumerate() {
            assert_eq!(got, expected, "answer {at} under `{filter}`");
        }
        let alone_pages = self.pages(&tables).await;
        for (got, expected) in self.pages(filter).await.iter().zip(&alone_pages) {
            assert_eq!(got, expected, "a page under `{filter}`");
        }
        for (source, alone) in sources.iter().zip(&alone) {
            assert_eq!(alone.mirror, 0);
            assert_eq!(source.mirror + source.catalogue, alone.catalogue, "{filter}");
        }
        sources.iter().map(|source| source.mirror).sum()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn answers_are_those_of_the_tables_whatever_is_mirrored(steps in prop::collection::vec(step(), 1..14), filter in 0..FILTERS.len()) {
        let runtime = tokio::runtime::Runtime::new().unwrap();
        runtime.block_on(async {
            let mut world = World::new().await;
            world.insert(70).await;
            for step in &steps {
                world = world.step(step).await;
                world.agree(FILTERS[filter]).await;
            }
            world.at.is_sound().await;
        });
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn every_kind_of_filter_is_answered_from_the_mirror() {
    let mut world = World::new().await;
    world.insert(330).await;
    world = world.step(&Step::Mirror).await;
    assert_eq!(world.files().len(), 8);
    for filter in FILTERS {
        let read = world.agree(filter).await;
        assert!(read > 0 || filter == "uiqm > 7", "{filter}");
    }
    assert_eq!(world.at.catalogue.check_replica().await.unwrap(), [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_damaged_or_missing_file_is_found_and_written_anew() {
    let mut world = World::new().await;
    world.insert(330).await;
    for step in [Step::Mirror, Step::Damage, Step::Lose, Step::Restart] {
        world = world.step(&step).await;
    }
    let findings = world.at.catalogue.check_replica().await.unwrap();
    assert_eq!(findings.len(), 2, "{findings:?}");
    world = world.step(&Step::Mirror).await;
    assert_eq!(world.at.catalogue.check_replica().await.unwrap(), [""; 0]);
    assert_eq!(world.files().len(), 8);
    assert!(world.agree("alpha > 0.5").await > 0);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_file_that_the_tables_do_not_confirm_is_found() {
    let mut world = World::new().await;
    world.insert(330).await;
    world = world.step(&Step::Mirror).await;
    world
        .at
        .sabotage("UPDATE images SET alpha = 0.125 WHERE rowid = 7")
        .await;
    let findings = world.at.catalogue.check_replica().await.unwrap();
    assert!(
        matches!(&findings[..], [one] if one.ends_with("alpha differs from the catalogue")),
        "{findings:?}"
    );
    world = world.step(&Step::Mirror).await;
    assert_eq!(world.at.catalogue.check_replica().await.unwrap(), [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_backup_has_no_mirror_and_makes_its_own() {
    let mut world = World::new().await;
    world.insert(330).await;
    world = world.step(&Step::Delete).await;
    while world.at.catalogue.sweep().await.unwrap() {}
    world = world.step(&Step::Mirror).await;
    let copy = tempfile::tempdir().unwrap();
    let path = copy.path().join("catalogue.sqlite");
    world.at.catalogue.backup(&path).await.unwrap();
    let restored = catalogue::Catalogue::open(&path, &synthetic::metrics())
        .await
        .unwrap();
    let count = async || restored.histogram("bay", None, "uiqm", 3, None).await.unwrap();
    let before = count().await;
    assert_eq!(before.source.mirror, 0);
    while restored.replicate_some(ROWS).await.unwrap() {}
    let after = count().await;
    assert!(after.source.mirror > 0);
    assert_eq!(before.counts, after.counts);
}
