//! Queries for the images of a service.

use serde_json::Value;

use crate::exit::Failure;
use crate::remote::{PAGE_ROWS, Remote, with_query};

/// A query for images.
pub struct Question<'a> {
    pub dataset: Option<&'a str>,
    pub filter: &'a str,
    pub order_by: Option<&'a str>,
    /// Columns; none: all.
    pub fields: &'a [String],
    pub limit: usize,
}

impl Question<'_> {
    /// All rows up to the limit.
    pub fn ask(&self, remote: &Remote) -> Result<Vec<Value>, Failure> {
        let mut rows = Vec::new();
        self.pages(remote, |mut page| {
            rows.append(&mut page);
            Ok(())
        })?;
        Ok(rows)
    }

    /// Passes the rows on page by page, up to the limit.
    pub fn pages(
        &self,
        remote: &Remote,
        mut take: impl FnMut(Vec<Value>) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let mut left = self.limit;
        let mut cursor: Option<String> = None;
        while left > 0 {
            let path = self.path(left.min(PAGE_ROWS), cursor.as_deref());
            let mut page = remote.get(&path)?;
            let rows = page["items"]
                .as_array_mut()
                .map(std::mem::take)
                .unwrap_or_default();
            left = left.saturating_sub(rows.len());
            let is_last = rows.is_empty();
            take(rows)?;
            cursor = page["next_cursor"].as_str().map(str::to_owned);
            if cursor.is_none() || is_last {
                break;
            }
        }
        Ok(())
    }

    fn path(&self, limit: usize, cursor: Option<&str>) -> String {
        let (limit, fields) = (limit.to_string(), self.fields.join(","));
        let parameters = [
            ("limit", Some(limit.as_str())),
            ("dataset", self.dataset),
            ("filter", Some(self.filter)),
            ("order_by", self.order_by),
            ("fields", Some(&fields)),
            ("cursor", cursor),
        ];
        with_query("/v1/images", &parameters)
    }
}
