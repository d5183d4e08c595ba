//! One group of rows of a Parquet file, read column by column.

use std::sync::Arc;

use bytes::Bytes;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};
use parquet::schema::types::{ColumnDescriptor, SchemaDescriptor};

/// A column of whole numbers with the variable part of its name.
pub(crate) type Named = (String, Vec<Option<i64>>);

/// A group of rows.
pub(crate) struct Group<'a> {
    reader: Box<dyn RowGroupReader + 'a>,
    schema: Arc<SchemaDescriptor>,
    /// How many.
    pub(crate) rows: usize,
}

impl<'a> Group<'a> {
    pub(crate) fn open(file: &'a SerializedFileReader<Bytes>, number: usize) -> Result<Self, String> {
        let reader = file.get_row_group(number).map_err(|error| error.to_string())?;
        let rows = reader.metadata().num_rows();
        Ok(Self {
            rows: usize::try_from(rows).map_err(|_| format!("a group has {rows} rows"))?,
            schema: reader.metadata().schema_descr_ptr(),
            reader,
        })
    }

    /// The values of a column of whole numbers.
    pub(crate) fn numbers(&self, name: &str) -> Result<Vec<Option<i64>>, String> {
        match self.column(name)? {
            (ColumnReader::Int64ColumnReader(reader), column) => self.values(reader, column),
            _ => Err(format!("column {name} holds no whole numbers")),
        }
    }

    /// The values of a column of text.
    pub(crate) fn texts(&self, name: &str) -> Result<Vec<Option<ByteArray>>, String> {
        match self.column(name)? {
            (ColumnReader::ByteArrayColumnReader(reader), column) => self.values(reader, column),
            _ => Err(format!("column {name} holds no text")),
        }
    }

    /// The columns of whole numbers with this prefix and suffix, by the part of their name in between.
    pub(crate) fn numbers_within(&self, head: &str, tail: &str) -> Result<Vec<Named>, String> {
        let mut found = Vec::new();
        for column in self.schema.columns() {
            let name = column.name();
            if let Some(middle) = name.strip_prefix(head).and_then(|rest| rest.strip_suffix(tail)) {
                found.push((middle.to_owned(), self.numbers(name)?));
            }
        }
        Ok(found)
    }

    fn column(&self, name: &str) -> Result<(ColumnReader, &ColumnDescriptor), String> {
        let columns = self.schema.columns();
        let position = columns.iter().position(|column| column.name() == name);
        let position = position.ok_or_else(|| format!("column {name} is missing"))?;
        let column = &columns[position];
        if column.max_rep_level() > 0 {
            return Err(format!("column {name} holds lists"));
        }
        let reader = self.reader.get_column_reader(position);
        Ok((reader.map_err(|error| error.to_string())?, column))
    }

    fn values<T: DataType>(
        &self,
        mut reader: ColumnReaderImpl<T>,
        column: &ColumnDescriptor,
    ) -> Result<Vec<Option<T::T>>, String> {
        let name = column.name();
        let (mut levels, mut found): (Vec<i16>, Vec<T::T>) = (Vec::new(), Vec::new());
        reader
            .read_records(self.rows, Some(&mut levels), None, &mut found)
            .map_err(|error| error.to_string())?;
        let most = column.max_def_level();
        let mut found = found.into_iter();
        let values: Vec<_> = match most {
            0 => found.by_ref().map(Some).collect(),
            _ => levels
                .iter()
                .map(|&level| (level == most).then(|| found.next()).flatten())
                .collect(),
        };
        if values.len() != self.rows || found.next().is_some() {
            return Err(format!(
                "column {name} has {} values for {} rows",
                values.len(),
                self.rows
            ));
        }
        Ok(values)
    }
}
