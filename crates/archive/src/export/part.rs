//! One file of Parquet: rows are collected by column, and written in groups.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use parquet::basic::{Compression, Type};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, FloatType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::parser::parse_message_type;
use postgres::Row;

use crate::fault::ArchiveFault;

/// The columns; docs/archive.md explains them.
pub const SCHEMA: &str = "message gaiter {
    required binary station (STRING);
    required binary scan (STRING);
    required int64 first_seen (TIMESTAMP(MICROS,true));
    optional binary patient (STRING);
    required binary outcome (STRING);
    optional float stature_mm;
    optional float crotch_height_mm;
    optional binary side (STRING);
    optional binary level (STRING);
    optional float height_mm;
    optional float girth_mm;
    optional float girth_sd_mm;
}";

/// Rows in a group: what DuckDB takes at a time, and some 30 MB here.
const GROUP: usize = 122_880;

/// A file that is being written, under another name until it is whole.
pub struct Part {
    path: PathBuf,
    new: PathBuf,
    writer: SerializedFileWriter<File>,
    columns: Vec<Column>,
    /// How many rows are collected.
    rows: usize,
}

/// The collected cells of a column.
enum Column {
    Text(Cells<ByteArrayType>),
    Figure(Cells<FloatType>),
    Time(Cells<Int64Type>),
}

/// Values, and for each row 1 if it has one.
struct Cells<D: DataType> {
    values: Vec<D::T>,
    present: Vec<i16>,
}

impl Part {
    /// Begins the file, and makes its folder.
    ///
    /// # Errors
    /// Those of the disk.
    pub fn create(path: &Path) -> Result<Part, ArchiveFault> {
        path.parent().map_or(Ok(()), fs::create_dir_all)?;
        let new = path.with_extension("new");
        let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
        let schema = Arc::new(parse_message_type(SCHEMA)?);
        let columns = schema.get_fields().iter().map(|field| Column::of(field.get_physical_type()));
        let columns = columns.collect();
        let writer = SerializedFileWriter::new(File::create(&new)?, schema, Arc::new(properties))?;
        Ok(Part { path: path.to_owned(), new, writer, columns, rows: 0 })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// Those of the disk.
    pub fn push(&mut self, row: &Row) -> Result<(), ArchiveFault> {
        for (number, column) in self.columns.iter_mut().enumerate() {
            match column {
                Column::Text(cells) => {
                    let text: Option<String> = row.get(number);
                    cells.push(text.map(|text| ByteArray::from(text.into_bytes())));
                }
                Column::Figure(cells) => cells.push(row.get(number)),
                Column::Time(cells) => cells.push(row.get(number)),
            }
        }
        self.rows += 1;
        if self.rows >= GROUP {
            self.write_group()?;
        }
        Ok(())
    }

    /// Writes what is left, and gives the file its name.
    ///
    /// # Errors
    /// Those of the disk.
    pub fn finish(mut self) -> Result<(), ArchiveFault> {
        self.write_group()?;
        self.writer.into_inner()?.sync_all()?;
        fs::rename(self.new, self.path)?;
        Ok(())
    }

    fn write_group(&mut self) -> Result<(), ParquetError> {
        if self.rows == 0 {
            return Ok(());
        }
        let mut group = self.writer.next_row_group()?;
        for column in &mut self.columns {
            let Some(mut writer) = group.next_column()? else { break };
            match column {
                Column::Text(cells) => cells.write(&mut writer)?,
                Column::Figure(cells) => cells.write(&mut writer)?,
                Column::Time(cells) => cells.write(&mut writer)?,
            }
            writer.close()?;
        }
        group.close()?;
        self.rows = 0;
        Ok(())
    }
}

impl Column {
    fn of(kind: Type) -> Column {
        match kind {
            Type::FLOAT => Column::Figure(Cells::new()),
            Type::INT64 => Column::Time(Cells::new()),
            _ => Column::Text(Cells::new()),
        }
    }
}

impl<D: DataType> Cells<D> {
    fn new() -> Cells<D> {
        Cells { values: Vec::new(), present: Vec::new() }
    }

    fn push(&mut self, value: Option<D::T>) {
        self.present.push(i16::from(value.is_some()));
        self.values.extend(value);
    }

    fn write(&mut self, writer: &mut SerializedColumnWriter<'_>) -> Result<(), ParquetError> {
        let writer = writer.typed::<D>();
        let is_optional = writer.get_descriptor().max_def_level() > 0;
        writer.write_batch(&self.values, is_optional.then_some(&self.present[..]), None)?;
        self.values.clear();
        self.present.clear();
        Ok(())
    }
}
