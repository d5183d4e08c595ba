//! One group of rows of a Parquet file, read column by column.

use std::sync::Arc;

use bytes::Bytes;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};
use parquet::schema::types::{ColumnDescriptor, SchemaDescriptor};

/// A column of whole numbers with the variable part of its name.
pub(crate) type Named = (String, Vec<Option<i64>>);

/// Most rows of a group: ten times as many as are written.
const MOST_ROWS: i64 = 20_000;
/// Most unpacked bytes of a group: its records were gathered in 4 MiB, the other columns are a fraction.
const MOST_BYTES: i64 = 64 << 20;

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
        let (rows, bytes) = (reader.metadata().num_rows(), reader.metadata().total_byte_size());
        if !(0..=MOST_ROWS).contains(&rows) || !(0..=MOST_BYTES).contains(&bytes) {
            return Err(format!(
                "a group has {rows} rows and {bytes} bytes; must be at most {MOST_ROWS} and {MOST_BYTES}"
            ));
        }
        Ok(Self {
            rows: rows as usize,
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
            (ColumnReader::ByteArrayColumnReader(reader), column) => {
                let values = self.values(reader, column)?;
                // Rows may share the bytes of a dictionary, so that few bytes become many texts.
                let bytes: usize = values.iter().flatten().map(ByteArray::len).sum();
                if bytes as i64 > MOST_BYTES {
                    return Err(format!(
                        "column {name} of a group has {bytes} bytes; must be at most {MOST_BYTES}"
                    ));
                }
                Ok(values)
            }
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

#[cfg(test)]
mod tests {
    use parquet::file::writer::SerializedFileWriter;

    use super::*;
    use crate::rows::cells::{Cell, Gathered, Kind, compressed, schema};

    /// A file with a column of texts, all of this length.
    fn file(rows: usize, length: usize) -> Bytes {
        let schema = schema([("record", Kind::Text)].into_iter()).unwrap();
        let properties = Arc::new(compressed().build());
        let mut writer = SerializedFileWriter::new(Vec::new(), Arc::new(schema), properties).unwrap();
        let mut column = Gathered::new(Kind::Text);
        let text = "x".repeat(length);
        (0..rows).for_each(|_| column.push(Some(Cell::Text(text.clone()))));
        let mut group = writer.next_row_group().unwrap();
        column.write(&mut group).unwrap();
        group.close().unwrap();
        writer.into_inner().unwrap().into()
    }

    fn texts(file: &Bytes) -> Result<usize, String> {
        let reader = SerializedFileReader::new(file.clone()).unwrap();
        Group::open(&reader, 0)?.texts("record").map(|texts| texts.len())
    }

    #[test]
    fn few_bytes_do_not_become_many() {
        assert_eq!(texts(&file(500, 20_000)), Ok(500));
        // A dictionary of one text, and pages of one text each.
        for (rows, length) in [(2000, 200_000), (30, 3 << 20), (100_000, 1)] {
            let bomb = file(rows, length);
            println!("{} bytes for {rows} texts of {length}", bomb.len());
            assert!(bomb.len() < 200_000);
            let refused = texts(&bomb);
            assert!(
                refused.as_ref().is_err_and(|why| why.contains("must be at most")),
                "{refused:?}"
            );
        }
    }
}
