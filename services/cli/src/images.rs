//! Questions to the service about its images.

use serde_json::Value;

use crate::exit::Failure;
use crate::remote::{Remote, query_value};

/// Rows that one request asks for.
const PAGE_ROWS: usize = 500;

/// A question about images.
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

    /// Hands on the rows page by page, up to the limit.
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
            take(rows)?;
            cursor = page["next_cursor"].as_str().map(str::to_owned);
            if cursor.is_none() {
                break;
            }
        }
        Ok(())
    }

    fn path(&self, limit: usize, cursor: Option<&str>) -> String {
        let mut path = format!("/v1/images?limit={limit}");
        let fields = (!self.fields.is_empty()).then(|| self.fields.join(","));
        let filter = (!self.filter.trim().is_empty()).then_some(self.filter);
        let parameters = [
            ("dataset", self.dataset),
            ("filter", filter),
            ("order_by", self.order_by),
            ("fields", fields.as_deref()),
            ("cursor", cursor),
        ];
        for (name, value) in parameters {
            if let Some(value) = value {
                path.push_str(&format!("&{name}={}", query_value(value)));
            }
        }
        path
    }
}
