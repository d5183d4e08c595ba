//! Selects the images of a page with the replica: the tables would read all images of a dataset to sort or to skip them.

use std::sync::Arc;

use columnar::{Sorted, Start};
use serde_json::Value;

use super::order::{Order, identity};
use crate::aggregation::aggregate::ImageSet;
use crate::catalogue::Catalogue;
use crate::error::CatalogueError;
use crate::query::cursor;
use crate::query::filter::{Column, Kind};
use crate::types::ImageQuery;

/// The job and the frame of an image.
pub(super) type ImageKey = (Arc<str>, i64);

impl Catalogue {
    /// The images of a page and the first one of the next, in order. `None`: the replica lacks a column, or the tables are faster.
    pub(super) async fn top_k(&self, query: &ImageQuery) -> Result<Option<Vec<ImageKey>>, CatalogueError> {
        let order = Order::parse(&self.columns, query.order_by.as_deref())?;
        // Following cursors in the order of an index reads it once in total, with any filter.
        let is_unfiltered = query.filter.is_none() || query.cursor.is_some();
        let follows_index = order.column.is_none() && query.offset == 0 && is_unfiltered;
        let (Some(dataset), false) = (query.dataset.as_deref(), follows_index) else {
            return Ok(None);
        };
        let Some((job, frame)) = self.columns.get("job").zip(self.columns.get("frame")) else {
            return Ok(None);
        };
        let start = start(query, order.column.as_ref())?;
        let order_by = order.column.is_some().then_some((2, order.descending));
        let columns: Vec<Column> = [job, frame].into_iter().chain(order.column).collect();
        let images = ImageSet {
            dataset,
            columns: &columns,
            filter: query.filter.as_deref(),
        };
        let places = columnar::Order {
            by: order_by,
            job: 0,
            frame: 1,
        };
        let most = query.limit as usize + 1;
        if !self.is_in_replica(&images)? {
            return Ok(None);
        }
        let selected = self.aggregate(&images, move |query| {
            columnar::top_k(query, &places, &start, most)
        });
        match selected.await {
            // An unknown dataset has an empty page.
            Err(CatalogueError::NotFound { .. }) => Ok(Some(Vec::new())),
            selected => selected.map(Some),
        }
    }
}

fn start(query: &ImageQuery, column: Option<&Column>) -> Result<Start, CatalogueError> {
    let Some(text) = &query.cursor else {
        return Ok(Start::Behind(query.offset));
    };
    let place = cursor::read(&identity(query), text)?;
    let wrong = || CatalogueError::Cursor;
    let job = place[1].as_str().ok_or_else(wrong)?.to_owned();
    let frame = place[2].as_i64().ok_or_else(wrong)?;
    let value = match (&place[0], column.map(|column| column.kind)) {
        (Value::Null, _) | (_, None) => None,
        (Value::String(text), Some(Kind::Text)) => Some(Sorted::Text(text.clone())),
        (value, Some(Kind::Number)) => Some(Sorted::Number(value.as_f64().ok_or_else(wrong)?)),
        (value, Some(Kind::Whole | Kind::Large | Kind::Bool)) => {
            let held = value.as_i64().or(value.as_f64().map(|number| number as i64));
            Some(Sorted::Whole(held.ok_or_else(wrong)?))
        }
        _ => return Err(wrong()),
    };
    Ok(Start::After(value, job, frame))
}
