//! The rows of a query: files and rows in memory, processed in passes by several threads.

use std::collections::HashSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::cache::Cache;
use crate::column::Column;
use crate::condition::{Columns, Condition, Mask, Range};
use crate::error::ColumnarError;
use crate::file::ReplicaFile;

/// The column of the job.
const JOB: &str = "job";

/// Some rows.
#[derive(Debug)]
pub enum Part {
    /// A file.
    File {
        /// Which.
        file: Arc<ReplicaFile>,
        /// The requested jobs; `None`: all.
        jobs: Option<HashSet<String>>,
    },
    /// Rows in memory that fulfill the condition: the columns of the query in their order, of at most 65 535 rows.
    Rows(Vec<Arc<Column>>),
}

/// Columns of all rows that fulfill a condition.
#[derive(Debug)]
pub struct Query<'a> {
    /// All rows, in any order.
    pub parts: &'a [Part],
    /// Columns by name.
    pub columns: &'a [String],
    /// Selects rows of files.
    pub condition: Option<&'a Condition>,
    /// Columns that were read before.
    pub cache: &'a Cache,
    /// Number of threads; it does not affect results.
    pub threads: usize,
}

/// The sources of the aggregated rows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Source {
    /// Rows of files.
    pub files: u64,
    /// Rows in memory.
    pub memory: u64,
}

/// A part as a pass sees it.
pub(crate) struct Rows<'a> {
    query: &'a Query<'a>,
    pub(crate) at: usize,
    pub(crate) mask: &'a Mask,
}

/// A query whose condition has been evaluated.
pub(crate) struct Masked<'a> {
    pub(crate) query: &'a Query<'a>,
    masks: Vec<Mask>,
    pub(crate) source: Source,
}

impl<'a> Masked<'a> {
    pub(crate) fn new(query: &'a Query<'a>) -> Result<Self, ColumnarError> {
        query.cache.begin();
        let mut masks = spread(query.parts.len(), query.threads, Vec::new, |masks, at| {
            masks.push((at, query.mask(at)?));
            Ok(())
        })?
        .concat();
        masks.sort_unstable_by_key(|(at, _)| *at);
        let masks: Vec<Mask> = masks.into_iter().map(|(_, mask)| mask).collect();
        let mut source = Source::default();
        for (part, mask) in query.parts.iter().zip(&masks) {
            match part {
                Part::File { file, .. } => source.files += mask.count(file.rows()) as u64,
                Part::Rows(columns) => {
                    source.memory += columns.first().map_or(0, |column| column.len()) as u64
                }
            }
        }
        Ok(Self { query, masks, source })
    }

    /// A pass over the parts that have rows. Each thread folds some parts into a separate value.
    pub(crate) fn pass<T: Send>(
        &self,
        empty: impl Fn() -> T + Sync,
        fold: impl Fn(&mut T, &Rows<'_>) -> Result<(), ColumnarError> + Sync,
    ) -> Result<Vec<T>, ColumnarError> {
        let parts = self.query.parts.len();
        spread(parts, self.query.threads, empty, |folded, at| {
            let mask = &self.masks[at];
            if *mask == Mask::None {
                return Ok(());
            }
            let query = self.query;
            fold(folded, &Rows { query, at, mask })
        })
    }
}

impl Rows<'_> {
    /// A column of the query by its place.
    pub(crate) fn column(&self, place: usize) -> Result<Arc<Column>, ColumnarError> {
        match &self.query.parts[self.at] {
            Part::Rows(columns) => Ok(Arc::clone(&columns[place])),
            Part::File { file, .. } => self.query.cache.read(file, &self.query.columns[place]),
        }
    }

    /// The bounds of a column without reading it, if every row of the part is in the query and has a value.
    pub(crate) fn range(&self, place: usize) -> Option<Range> {
        match &self.query.parts[self.at] {
            Part::File { file, .. } if *self.mask == Mask::All => file
                .range(&self.query.columns[place])
                .filter(|range| !range.any_missing),
            _ => None,
        }
    }

    /// Number of rows in the query.
    pub(crate) fn count(&self) -> u64 {
        let rows = match &self.query.parts[self.at] {
            Part::File { file, .. } => file.rows(),
            Part::Rows(columns) => columns.first().map_or(0, |column| column.len()),
        };
        self.mask.count(rows) as u64
    }

    /// Calls `visit` with the positions of the rows in the query.
    #[inline]
    pub(crate) fn visit(&self, rows: usize, mut visit: impl FnMut(usize)) {
        match self.mask {
            Mask::None => {}
            Mask::All => (0..rows).for_each(visit),
            Mask::Some(mask) => {
                for (at, counts) in mask.iter().enumerate() {
                    if *counts {
                        visit(at);
                    }
                }
            }
        }
    }
}

impl Query<'_> {
    fn mask(&self, at: usize) -> Result<Mask, ColumnarError> {
        match &self.parts[at] {
            Part::Rows(columns) => Ok(match columns.first() {
                Some(column) if !column.is_empty() => Mask::All,
                _ => Mask::None,
            }),
            Part::File { file, jobs } => {
                let columns = OfFile {
                    file,
                    cache: self.cache,
                };
                let mask = match jobs {
                    None => Mask::All,
                    Some(jobs) => of_jobs(&*columns.column(JOB)?, jobs),
                };
                match self.condition {
                    Some(condition) if mask != Mask::None => Ok(mask.and(condition.mask(&columns)?)),
                    _ => Ok(mask),
                }
            }
        }
    }
}

fn of_jobs(column: &Column, jobs: &HashSet<String>) -> Mask {
    let Column::Texts { codes, texts } = column else {
        return Mask::None;
    };
    let is_requested: Vec<bool> = texts.iter().map(|text| jobs.contains(&**text)).collect();
    Mask::from_rows(
        codes
            .iter()
            .map(|code: &u16| is_requested.get(usize::from(*code)).copied().unwrap_or(false))
            .collect(),
    )
}

struct OfFile<'a> {
    file: &'a ReplicaFile,
    cache: &'a Cache,
}

impl Columns for OfFile<'_> {
    type Error = ColumnarError;

    fn column(&self, name: &str) -> Result<Arc<Column>, ColumnarError> {
        self.cache.read(self.file, name)
    }

    fn range(&self, name: &str) -> Option<Range> {
        self.file.range(name)
    }
}

/// Folds the numbers below `items` into one value for each thread.
fn spread<T: Send>(
    items: usize,
    threads: usize,
    empty: impl Fn() -> T + Sync,
    fold: impl Fn(&mut T, usize) -> Result<(), ColumnarError> + Sync,
) -> Result<Vec<T>, ColumnarError> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut folded = empty();
        loop {
            let item = next.fetch_add(1, Ordering::Relaxed);
            if item >= items {
                return Ok(folded);
            }
            fold(&mut folded, item)?;
        }
    };
    let threads = threads.min(items).max(1);
    if threads == 1 {
        return work().map(|folded| vec![folded]);
    }
    std::thread::scope(|scope| {
        let all: Vec<_> = (1..threads).map(|_| scope.spawn(work)).collect();
        let own = work();
        let others = all.into_iter().map(|thread| {
            thread
                .join()
                .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        });
        std::iter::once(own).chain(others).collect()
    })
}
