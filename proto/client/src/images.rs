//! Queries for images, page by page.

use std::fmt;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::PAGE_ROWS;
use crate::client::Client;
use crate::error::ClientError;
use crate::pages::PagesRead;
use crate::query::with_query;
use crate::views::Page;

/// The columns of an image that have a value. Which columns there are depends on the query.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ImageRow(pub Map<String, Value>);

impl ImageRow {
    /// The value of a column; null if it has none.
    #[must_use]
    pub fn value(&self, column: &str) -> &Value {
        self.0.get(column).unwrap_or(&Value::Null)
    }

    /// The value of a column of texts.
    #[must_use]
    pub fn text(&self, column: &str) -> Option<&str> {
        self.value(column).as_str()
    }

    /// The value of a column of numbers.
    #[must_use]
    pub fn number(&self, column: &str) -> Option<f64> {
        self.value(column).as_f64()
    }

    /// The value of a column of whole numbers that are never negative.
    #[must_use]
    pub fn count(&self, column: &str) -> Option<u64> {
        self.value(column).as_u64()
    }
}

impl fmt::Display for ImageRow {
    /// As JSON on one line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = serde_json::to_string(&self.0).map_err(|_| fmt::Error)?;
        f.write_str(&text)
    }
}

/// A query for images.
#[derive(Clone, Copy)]
pub struct ImageQuery<'a> {
    /// Only images of this dataset.
    pub dataset: Option<&'a str>,
    /// Only images that fulfill this; blank: all.
    pub filter: &'a str,
    /// A column, with `-` in front the largest first.
    pub order_by: Option<&'a str>,
    /// Columns; empty: all.
    pub fields: &'a [String],
    /// Most rows.
    pub limit: usize,
}

/// The pages of a query; ends after an error.
pub struct ImagePages<'a> {
    client: &'a Client,
    query: ImageQuery<'a>,
    remaining: usize,
    cursor: Option<String>,
    read: PagesRead,
}

#[allow(
    clippy::missing_errors_doc,
    reason = "every request fails with a `ClientError`"
)]
impl Client {
    /// All rows of a query.
    pub fn images(&self, query: ImageQuery<'_>) -> Result<Vec<ImageRow>, ClientError> {
        let pages = self.image_pages(query).collect::<Result<Vec<_>, _>>()?;
        Ok(pages.concat())
    }

    /// The rows of a query page by page.
    #[must_use]
    pub fn image_pages<'a>(&'a self, query: ImageQuery<'a>) -> ImagePages<'a> {
        ImagePages {
            client: self,
            query,
            remaining: query.limit,
            cursor: None,
            read: PagesRead::default(),
        }
    }
}

impl Iterator for ImagePages<'_> {
    type Item = Result<Vec<ImageRow>, ClientError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.remaining == 0 {
            return None;
        }
        let path = self
            .query
            .path(self.remaining.min(PAGE_ROWS), self.cursor.as_deref());
        let page = self.client.get::<Page<ImageRow>>(&path);
        let followed = page.and_then(|page| {
            self.client.report_damage(&page.damaged);
            let next = self.read.follow("/v1/images", &page)?;
            Ok((page.items, next))
        });
        match followed {
            Ok((rows, next)) => {
                self.remaining = match next {
                    Some(_) => self.remaining.saturating_sub(rows.len()),
                    None => 0,
                };
                self.cursor = next;
                Some(Ok(rows))
            }
            Err(error) => {
                self.remaining = 0;
                Some(Err(error))
            }
        }
    }
}

impl ImageQuery<'_> {
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
