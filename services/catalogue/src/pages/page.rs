//! Pages of images: filter, order, fields, and cursors that begin the next page where the last one ended.

use std::collections::BTreeSet;

use client::Page;
use futures::TryStreamExt;
use serde_json::{Value, json};
use sqlx::sqlite::{SqliteConnection, SqliteRow};

use super::order::{Order, identity};
use super::top_k::ImageKey;
use crate::catalogue::{Catalogue, within};
use crate::damage::DamageLog;
use crate::digests::record_row::About;
use crate::error::CatalogueError;
use crate::query::column_value::{column, stored, value};
use crate::query::columns::Columns;
use crate::query::cursor;
use crate::query::filter::{Bind, Kind};
use crate::query::list_page::no_next_page;
use crate::query::record_reader::{Place, Reader, Wanted};
use crate::query::select::Select;
use crate::types::ImageQuery;

/// Every column of a dataset with ten enhancements are some hundreds; SQLite returns at most 2000.
const MOST_FIELDS: usize = 1000;
/// A page ends with the row that reaches this size, about that of its JSON: a thousand ordinary rows have 2 MB.
const PAGE_BYTES: usize = 8 << 20;

impl Catalogue {
    /// A page of images with the requested number of rows, or fewer if they are large. Each is an object without missing values.
    ///
    /// # Errors
    /// [`CatalogueError::Filter`] for filter, order or fields; [`CatalogueError::Cursor`]; [`CatalogueError::Timeout`].
    pub async fn images(&self, query: ImageQuery) -> Result<Page<Value>, CatalogueError> {
        Ok(self.image_page(&query).await?.into_objects())
    }

    /// The page of [`Catalogue::images`] as JSON text, without an object for each row.
    ///
    /// # Errors
    /// As [`Catalogue::images`].
    pub async fn images_as_json(&self, query: ImageQuery) -> Result<String, CatalogueError> {
        Ok(self.image_page(&query).await?.to_json()?)
    }

    async fn image_page(&self, query: &ImageQuery) -> Result<ImagePage, CatalogueError> {
        if query.cursor.is_some() && query.offset > 0 {
            let message = "and `cursor` both set the start of a page; use only one of them";
            return Err(CatalogueError::refused_parameter("offset", message));
        }
        if let Some(found) = self.top_k(query).await? {
            let statement = PageStatement::of_rows(&self.columns, query, &found)?;
            if found.is_empty() {
                return Ok(statement.add_names(Page::whole(Vec::new())));
            }
            let (page, rows) = within(read_rows(
                &mut *self.reader().await?,
                &statement,
                query,
                &self.damage,
            ))
            .await?;
            // Else some of them have gone since they were found.
            if rows == found.len() || page.next_cursor.is_some() {
                return Ok(statement.add_names(page));
            }
        }
        let statement = PageStatement::new(&self.columns, query)?;
        let (page, _) = within(read_rows(
            &mut *self.reader().await?,
            &statement,
            query,
            &self.damage,
        ))
        .await?;
        Ok(statement.add_names(page))
    }
}

/// A page of images with their cells in the order of the names.
pub(super) struct ImagePage {
    pub(super) names: Vec<String>,
    pub(super) page: Page<Vec<Cell>>,
}

/// A value of an image; most columns are empty in most images.
pub(super) struct Cell {
    /// Index of its name.
    pub(super) name: usize,
    pub(super) value: Value,
}

impl ImagePage {
    pub(super) fn into_objects(self) -> Page<Value> {
        let Self { names, page } = self;
        let rows = page.items.into_iter().map(|cells: Vec<Cell>| {
            let pairs = cells
                .into_iter()
                .map(|cell| (names[cell.name].clone(), cell.value));
            Value::Object(pairs.collect())
        });
        Page {
            items: rows.collect(),
            next_cursor: page.next_cursor,
            damaged: page.damaged,
        }
    }
}

/// A page without damaged rows, and how many rows were read for it.
async fn read_rows(
    connection: &mut SqliteConnection,
    statement: &PageStatement,
    query: &ImageQuery,
    damage: &DamageLog,
) -> Result<(Page<Vec<Cell>>, usize), CatalogueError> {
    let mut rows = statement.sql.statement().fetch(connection);
    let (mut page, mut bytes, mut read) = (Page::whole(Vec::new()), 0, 0);
    let mut last = None;
    while let Some(row) = rows.try_next().await? {
        read += 1;
        if read > query.limit as usize || bytes >= PAGE_BYTES {
            let place = last.ok_or_else(|| no_next_page(&page.damaged))?;
            page.next_cursor = Some(cursor::write(&statement.identity, &place));
            break;
        }
        if let Some(item) = damage.skip(statement.item(&row), &mut page.damaged)? {
            bytes += statement.size(&item);
            page.items.push(item);
            last = Some(statement.place(&row)?);
        } else {
            // Its place may be damaged too; the next page then names the row again.
            last = statement.place(&row).ok().or(last);
        }
    }
    Ok((page, read))
}

/// The statement of a page; its first columns are those of [`Columns::of_record`].
pub(super) struct PageStatement {
    pub(super) sql: Select,
    /// The fields of an item, by name.
    fields: Vec<(String, Shown)>,
    /// Columns of filter and order, whose values must be those of the record.
    compared: Vec<(usize, Kind, Place)>,
    /// Reads the values of both from a record.
    reader: Reader,
    /// Position of the order's column.
    key: Option<usize>,
    /// The identity of the query in its cursors.
    pub(super) identity: String,
}

/// The source of a field's value.
enum Shown {
    Record(Place),
    Cell(usize, Kind),
}

impl PageStatement {
    pub(super) fn new(columns: &Columns, query: &ImageQuery) -> Result<Self, CatalogueError> {
        let (mut statement, order) = Self::unordered(columns, query)?;
        let sql = &mut statement.sql;
        if let Some(text) = &query.cursor {
            order.push_start(sql, &cursor::read(&statement.identity, text)?)?;
        }
        order.push_order(sql);
        sql.push(" LIMIT ? OFFSET ?");
        sql.bind(Bind::Whole(i64::from(query.limit) + 1));
        sql.bind(Bind::Whole(i64::try_from(query.offset).unwrap_or(i64::MAX)));
        Ok(statement)
    }

    /// A page whose images are known, including the first one of the next page.
    pub(super) fn of_rows(
        columns: &Columns,
        query: &ImageQuery,
        rows: &[ImageKey],
    ) -> Result<Self, CatalogueError> {
        let (mut statement, order) = Self::unordered(columns, query)?;
        let places = vec!["(?, ?)"; rows.len()].join(", ");
        let sql = &mut statement.sql;
        sql.push(&format!(
            " AND (images.job_id, images.frame) IN (VALUES {places})"
        ));
        for (job, frame) in rows {
            sql.bind(Bind::Text(job.to_string()));
            sql.bind(Bind::Whole(*frame));
        }
        order.push_order(sql);
        Ok(statement)
    }

    /// All rows of the query, and their order.
    fn unordered(columns: &Columns, query: &ImageQuery) -> Result<(Self, Order), CatalogueError> {
        let names = if query.fields.is_empty() {
            columns.names()
        } else {
            query.fields.clone()
        };
        if names.len() > MOST_FIELDS {
            let message = format!("has {} names; must be at most {MOST_FIELDS}", names.len());
            return Err(CatalogueError::refused_parameter("fields", &message));
        }
        let (filter, dataset) = (query.filter.as_deref(), query.dataset.as_deref());
        let mut selected = columns.of_record();
        let mut fields = Vec::with_capacity(names.len());
        let mut wanted = Wanted::default();
        for name in names.into_iter().collect::<BTreeSet<_>>() {
            let column = column(columns, &name, "fields")?;
            let shown = match &column.found {
                Some(found) => Shown::Record(wanted.add(found)),
                None => {
                    selected.push(column.clone());
                    Shown::Cell(selected.len() - 1, column.kind)
                }
            };
            fields.push((name, shown));
        }
        let order = Order::parse(columns, query.order_by.as_deref())?;
        let key = order.column.as_ref().map(|_| selected.len());
        let recorded = Select::filter(columns, filter)?.map_or_else(Vec::new, |filter| filter.recorded);
        let mut compared = Vec::new();
        for column in order.column.iter().cloned().chain(recorded) {
            // SQLite has no truth values, and reads some numbers of JSON in their last digit.
            if let Some(found) = column.found.as_ref().filter(|found| !found.is_label()) {
                compared.push((selected.len(), column.kind, wanted.add(found)));
            }
            selected.push(column);
        }
        let statement = Self {
            sql: Select::new(columns, &selected, filter, dataset)?,
            fields,
            compared,
            reader: wanted.reader(),
            key,
            identity: identity(query),
        };
        Ok((statement, order))
    }

    /// The fields of a row that have a value.
    fn item(&self, row: &SqliteRow) -> Result<Vec<Cell>, CatalogueError> {
        let (about, record) = About::verified(row)?;
        let record = self.reader.read(record)?;
        for (at, kind, place) in &self.compared {
            if value(row, *at, *kind)? != record.value(place) {
                return Err(CatalogueError::damaged_image(
                    "a parameter or metric",
                    about.image(),
                ));
            }
        }
        let mut cells = Vec::new();
        for (name, (_, shown)) in self.fields.iter().enumerate() {
            let value = match shown {
                Shown::Record(place) => record.value(place),
                Shown::Cell(at, kind) => value(row, *at, *kind)?,
            };
            if !value.is_null() {
                cells.push(Cell { name, value });
            }
        }
        Ok(cells)
    }

    /// About the length of an item as JSON.
    fn size(&self, item: &[Cell]) -> usize {
        /// Quotes, colon, comma and a number of usual length.
        const BESIDE: usize = 16;
        item.iter()
            .map(|cell| self.fields[cell.name].0.len() + BESIDE + cell.value.as_str().map_or(0, str::len))
            .sum()
    }

    fn add_names(&self, page: Page<Vec<Cell>>) -> ImagePage {
        ImagePage {
            names: self.fields.iter().map(|(name, _)| name.clone()).collect(),
            page,
        }
    }

    /// The position of a row: the value of the order column, job, frame.
    fn place(&self, row: &SqliteRow) -> Result<Value, CatalogueError> {
        let key = self.key.map(|at| stored(row, at)).transpose()?;
        Ok(json!([key, stored(row, 0)?, stored(row, 1)?]))
    }
}
