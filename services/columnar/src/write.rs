//! Writing a file: whole and on the disk, or not there.

use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;

use crate::column::{Column, Kind, NO_TEXT, raised};
use crate::error::ColumnarError;
use crate::file::{ABOUT, About, Named, footer, sha256};

/// One page for each column: a query reads all of it anyway.
const PAGE_BYTES: usize = 4 << 20;
/// A column of more distinct values than fit is stored as it is: a dictionary would not make it smaller.
const DICTIONARY_BYTES: usize = 64 << 10;

/// Writes columns into a new file of a folder; returns its name and digest. Columns without a value are left out. The columns are not
/// compressed: repeated values are dictionary-encoded, and compressing the others would save little and slow down reading.
///
/// # Errors
/// [`ColumnarError`]; then no file is left.
pub fn write(
    folder: &Path,
    columns: &[(String, Kind, Column)],
    about: About,
) -> Result<Named, ColumnarError> {
    let columns: Vec<_> = columns.iter().filter(|(.., column)| !column.is_void()).collect();
    let bytes = encoded(&columns, about.clone())?;
    let digest = footer(&bytes)
        .map(sha256)
        .ok_or_else(|| parquet::errors::ParquetError::General("a file without a footer".to_owned()))?;
    let name = format!("{}-{}-{}.parquet", about.first_row, about.last_row, &digest[..16]);
    let (unfinished, path) = (folder.join(format!(".{name}")), folder.join(&name));
    let store = || {
        std::fs::create_dir_all(folder)?;
        let mut file = File::create(&unfinished)?;
        file.write_all(&bytes)?;
        file.sync_all()?;
        std::fs::rename(&unfinished, &path)?;
        File::open(folder)?.sync_all()
    };
    if let Err(error) = store() {
        let _ = std::fs::remove_file(&unfinished);
        return Err(ColumnarError::io(&path)(error));
    }
    Ok(Named {
        name,
        digest,
        bytes: bytes.len() as u64,
    })
}

fn encoded(columns: &[&(String, Kind, Column)], mut about: About) -> Result<Vec<u8>, ColumnarError> {
    let fields = columns.iter().map(|(name, kind, _)| field(name, *kind));
    let fields = fields.collect::<Result<_, _>>()?;
    let schema = Type::group_type_builder("rows").with_fields(fields).build()?;
    let properties = WriterProperties::builder()
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .set_offset_index_disabled(true)
        .set_data_page_size_limit(PAGE_BYTES)
        .set_data_page_row_count_limit(usize::MAX)
        .set_dictionary_page_size_limit(DICTIONARY_BYTES)
        .build();
    let mut writer = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    for (_, _, column) in columns {
        write_column(&mut group, column)?;
    }
    let ranges: Vec<(u64, u64)> = group
        .close()?
        .columns()
        .iter()
        .map(|chunk| chunk.byte_range())
        .collect();
    writer.flush().map_err(parquet::errors::ParquetError::from)?;
    let bytes = writer.inner();
    about.checksums = ranges
        .iter()
        .map(|(start, length)| crc32fast::hash(&bytes[*start as usize..(start + length) as usize]))
        .collect();
    let about = serde_json::to_string(&about)
        .map_err(|error| parquet::errors::ParquetError::General(error.to_string()))?;
    writer.append_key_value_metadata(KeyValue::new(ABOUT.to_owned(), about));
    Ok(writer.into_inner()?)
}

fn field(name: &str, kind: Kind) -> Result<Arc<Type>, parquet::errors::ParquetError> {
    let (physical, logical) = match kind {
        Kind::Number => (Physical::DOUBLE, None),
        Kind::Whole => (Physical::INT64, None),
        Kind::Large => (Physical::INT64, Some(LogicalType::integer(64, false))),
        Kind::Flag => (Physical::BOOLEAN, None),
        Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
    };
    let builder = Type::primitive_type_builder(name, physical)
        .with_repetition(Repetition::OPTIONAL)
        .with_logical_type(logical);
    builder.build().map(Arc::new)
}

fn write_column<W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    column: &Column,
) -> Result<(), ColumnarError> {
    let mut writer = group
        .next_column()?
        .ok_or_else(|| parquet::errors::ParquetError::General("the schema has fewer columns".to_owned()))?;
    match column {
        Column::Missing(_) => {}
        Column::Numbers(values) => {
            let levels: Vec<i16> = values.iter().map(|value| i16::from(!value.is_nan())).collect();
            let values: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
            writer
                .typed::<DoubleType>()
                .write_batch(&values, Some(&levels), None)?;
        }
        Column::Wholes {
            kind,
            values,
            missing,
        } => {
            let is_present = |at: usize| !missing.get(at).copied().unwrap_or(false);
            let levels: Vec<i16> = (0..values.len()).map(|at| i16::from(is_present(at))).collect();
            let present = (0..values.len())
                .filter(|at| is_present(*at))
                .map(|at| values[at]);
            if *kind == Kind::Flag {
                let flags: Vec<bool> = present.map(|value| value != 0).collect();
                writer
                    .typed::<BoolType>()
                    .write_batch(&flags, Some(&levels), None)?;
            } else {
                let is_large = *kind == Kind::Large;
                let values: Vec<i64> = present
                    .map(|value| if is_large { raised(value) as i64 } else { value })
                    .collect();
                writer
                    .typed::<Int64Type>()
                    .write_batch(&values, Some(&levels), None)?;
            }
        }
        Column::Texts { codes, texts } => {
            let levels: Vec<i16> = codes.iter().map(|code| i16::from(*code != NO_TEXT)).collect();
            let texts: Vec<ByteArray> = texts.iter().map(|text| ByteArray::from(&**text)).collect();
            let present = codes.iter().filter(|code| **code != NO_TEXT);
            let values: Vec<ByteArray> = present.map(|code| texts[usize::from(*code)].clone()).collect();
            writer
                .typed::<ByteArrayType>()
                .write_batch(&values, Some(&levels), None)?;
        }
    }
    Ok(writer.close()?)
}

#[cfg(test)]
mod tests;
