//! Bounds on lists that a service returns page by page.

use std::collections::HashSet;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};

use crate::error::ClientError;
use crate::views::Page;

/// Most pages of a list: 5 · 10^8 rows on full pages.
const MOST_PAGES: usize = 1_000_000;
/// Most pages in a row without a row: pages of damaged rows only.
const MOST_EMPTY: usize = 1000;

/// The pages read so far.
#[derive(Default)]
pub(crate) struct PagesRead {
    cursors: HashSet<u64>,
    empty: usize,
}

impl PagesRead {
    /// The cursor of the next page, if there is one.
    pub(crate) fn follow<T>(&mut self, path: &str, page: &Page<T>) -> Result<Option<String>, ClientError> {
        let Some(cursor) = &page.next_cursor else {
            return Ok(None);
        };
        self.empty = if page.items.is_empty() { self.empty + 1 } else { 0 };
        let is_useless = page.items.is_empty() && page.damaged.is_empty();
        let mut hasher = DefaultHasher::new();
        cursor.hash(&mut hasher);
        let is_new = self.cursors.insert(hasher.finish());
        if is_useless || !is_new || self.empty > MOST_EMPTY || self.cursors.len() >= MOST_PAGES {
            return Err(ClientError::EndlessList {
                path: path.to_owned(),
                pages: self.cursors.len(),
            });
        }
        Ok(Some(cursor.clone()))
    }
}
