//! Binding values to statements and reading them from rows.

use client::UnixMs;
use serde::de::DeserializeOwned;
use sqlx::query::Query;
use sqlx::sqlite::{Sqlite, SqliteArguments, SqliteRow};
use sqlx::{Decode, Error, Row, Type};

use crate::query::filter::Bind;

pub(crate) type Statement<'q> = Query<'q, Sqlite, SqliteArguments>;

/// Binds a value of a column.
pub(crate) fn bound<'q>(statement: Statement<'q>, value: Option<&Bind>) -> Statement<'q> {
    match value {
        None => statement.bind(None::<f64>),
        Some(Bind::Number(number)) => statement.bind(*number),
        Some(Bind::Whole(number)) => statement.bind(*number),
        Some(Bind::Text(text)) => statement.bind(text.clone()),
    }
}

/// The columns of a row, read one after the other.
pub(crate) struct Cells<'r> {
    row: &'r SqliteRow,
    next: usize,
}

impl<'r> Cells<'r> {
    pub(crate) fn new(row: &'r SqliteRow) -> Self {
        Self { row, next: 0 }
    }

    pub(crate) fn take<T: Decode<'r, Sqlite> + Type<Sqlite>>(&mut self) -> Result<T, Error> {
        self.next += 1;
        self.row.try_get(self.next - 1)
    }

    /// A number that is never negative; SQLite has signed ones only.
    pub(crate) fn count(&mut self) -> Result<u64, Error> {
        self.take::<i64>().map(|number| number as u64)
    }

    pub(crate) fn time(&mut self) -> Result<UnixMs, Error> {
        self.count().map(UnixMs)
    }

    /// A value stored as JSON.
    pub(crate) fn json<T: DeserializeOwned>(&mut self) -> Result<Option<T>, Error> {
        let text = self.take::<Option<&str>>()?;
        let value = text.map(serde_json::from_str).transpose();
        value.map_err(|error| Error::Decode(error.into()))
    }

    pub(crate) fn optional_time(&mut self) -> Result<Option<UnixMs>, Error> {
        let time = self.take::<Option<i64>>()?;
        Ok(time.map(|ms| UnixMs(ms as u64)))
    }
}
