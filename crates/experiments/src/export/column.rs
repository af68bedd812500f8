//! Typed columns, and Parquet files made of them.
//!
//! Knows nothing of runs: whoever has rows hands each column an iterator over their values.

use std::io::Write;
use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as PhysicalType};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::Result;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{Type, TypePtr};

/// A column of a table: a name, and a value for each row, or none.
#[derive(Debug)]
pub(super) struct Column {
    name: String,
    values: Values,
    levels: Levels,
}

/// The values that are there, one after the other.
#[derive(Debug)]
enum Values {
    Texts(Vec<ByteArray>),
    /// Bits of unsigned numbers.
    Counts(Vec<i64>),
    Numbers(Vec<f64>),
    Flags(Vec<bool>),
}

/// Which rows the values belong to.
#[derive(Debug)]
enum Levels {
    /// Each row has one.
    Required,
    /// The rows with a 1 have one, those with a 0 none.
    Optional(Vec<i16>),
    /// A row has a list of them, or none: Dremel's definition and repetition levels.
    Lists { definition: Vec<i16>, repetition: Vec<i16> },
}

impl Column {
    pub(super) fn texts<T: AsRef<str>>(name: &str, texts: impl Iterator<Item = T>) -> Self {
        Self::required(name, Values::Texts(texts.map(|text| ByteArray::from(text.as_ref())).collect()))
    }

    pub(super) fn counts(name: &str, counts: impl Iterator<Item = u64>) -> Self {
        Self::required(name, Values::Counts(counts.map(u64::cast_signed).collect()))
    }

    pub(super) fn numbers(name: &str, numbers: impl Iterator<Item = f64>) -> Self {
        Self::required(name, Values::Numbers(numbers.collect()))
    }

    pub(super) fn flags(name: &str, flags: impl Iterator<Item = bool>) -> Self {
        Self::required(name, Values::Flags(flags.collect()))
    }

    pub(super) fn optional_counts(name: &str, counts: impl Iterator<Item = Option<u64>>) -> Self {
        let (counts, levels) = split(counts.map(|count| count.map(u64::cast_signed)));
        Self { name: name.to_owned(), values: Values::Counts(counts), levels }
    }

    pub(super) fn optional_numbers(name: &str, numbers: impl Iterator<Item = Option<f64>>) -> Self {
        let (numbers, levels) = split(numbers);
        Self { name: name.to_owned(), values: Values::Numbers(numbers), levels }
    }

    /// Lists of numbers; an empty one is none.
    pub(super) fn optional_lists<'a>(name: &str, lists: impl Iterator<Item = &'a [f64]>) -> Self {
        let (mut numbers, mut definition, mut repetition) = (Vec::new(), Vec::new(), Vec::new());
        for list in lists {
            numbers.extend_from_slice(list);
            definition.resize(definition.len() + list.len().max(1), if list.is_empty() { 0 } else { 2 });
            repetition.push(0);
            repetition.resize(definition.len(), 1);
        }
        let levels = Levels::Lists { definition, repetition };
        Self { name: name.to_owned(), values: Values::Numbers(numbers), levels }
    }

    fn required(name: &str, values: Values) -> Self {
        Self { name: name.to_owned(), values, levels: Levels::Required }
    }

    fn schema(&self) -> Result<TypePtr> {
        let (physical, logical) = match self.values {
            Values::Texts(_) => (PhysicalType::BYTE_ARRAY, Some(LogicalType::String)),
            Values::Counts(_) => (PhysicalType::INT64, Some(LogicalType::integer(64, false))),
            Values::Numbers(_) => (PhysicalType::DOUBLE, None),
            Values::Flags(_) => (PhysicalType::BOOLEAN, None),
        };
        let primitive = |name: &str, repetition| {
            let builder = Type::primitive_type_builder(name, physical).with_logical_type(logical.clone());
            builder.with_repetition(repetition).build().map(Arc::new)
        };
        let group = |name: &str, repetition, field, logical| {
            let builder = Type::group_type_builder(name).with_repetition(repetition).with_logical_type(logical);
            builder.with_fields(vec![field]).build().map(Arc::new)
        };
        match self.levels {
            Levels::Required => primitive(&self.name, Repetition::REQUIRED),
            Levels::Optional(_) => primitive(&self.name, Repetition::OPTIONAL),
            Levels::Lists { .. } => {
                let element = primitive("element", Repetition::REQUIRED)?;
                let list = group("list", Repetition::REPEATED, element, None)?;
                group(&self.name, Repetition::OPTIONAL, list, Some(LogicalType::List))
            }
        }
    }

    fn write(&self, writer: &mut SerializedColumnWriter<'_>) -> Result<()> {
        match &self.values {
            Values::Texts(texts) => self.write_as::<ByteArrayType>(texts, writer),
            Values::Counts(counts) => self.write_as::<Int64Type>(counts, writer),
            Values::Numbers(numbers) => self.write_as::<DoubleType>(numbers, writer),
            Values::Flags(flags) => self.write_as::<BoolType>(flags, writer),
        }
    }

    fn write_as<T: DataType>(&self, values: &[T::T], writer: &mut SerializedColumnWriter<'_>) -> Result<()> {
        let (definition, repetition) = match &self.levels {
            Levels::Required => (None, None),
            Levels::Optional(definition) => (Some(&definition[..]), None),
            Levels::Lists { definition, repetition } => (Some(&definition[..]), Some(&repetition[..])),
        };
        writer.typed::<T>().write_batch(values, definition, repetition).map(|_| ())
    }
}

/// The values that are there, and where.
fn split<T>(values: impl Iterator<Item = Option<T>>) -> (Vec<T>, Levels) {
    let (mut there, mut definition) = (Vec::new(), Vec::new());
    for value in values {
        definition.push(i16::from(value.is_some()));
        there.extend(value);
    }
    (there, Levels::Optional(definition))
}

/// A Parquet file that is being written, a row group at a time: the same bytes for the same values in the same groups.
pub(super) struct TableWriter<W: Write + Send> {
    writer: SerializedFileWriter<W>,
}

impl<W: Write + Send> TableWriter<W> {
    /// Starts the file of a table with columns like these; their values are not looked at.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn new(sink: W, name: &str, columns: &[Column]) -> Result<Self> {
        let fields = columns.iter().map(Column::schema).collect::<Result<_>>()?;
        let schema = Type::group_type_builder(name).with_fields(fields).build()?;
        let created_by = concat!("headway ", env!("CARGO_PKG_VERSION")).to_owned();
        let properties = WriterProperties::builder().set_created_by(created_by).build();
        Ok(Self { writer: SerializedFileWriter::new(sink, Arc::new(schema), Arc::new(properties))? })
    }

    /// Appends the rows of these columns as a group.
    ///
    /// # Errors
    /// If the columns have different numbers of rows, or it cannot be written.
    pub(super) fn push(&mut self, columns: &[Column]) -> Result<()> {
        let mut group = self.writer.next_row_group()?;
        for column in columns {
            let mut writer = group.next_column()?.expect("a writer for each column of the schema");
            column.write(&mut writer)?;
            writer.close()?;
        }
        group.close().map(|_| ())
    }

    /// Ends the file.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn finish(self) -> Result<W> {
        self.writer.into_inner()
    }
}

#[cfg(test)]
mod tests {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    use super::*;

    fn rows(file: Vec<u8>) -> Vec<Vec<Field>> {
        let mut stored = tempfile::tempfile().unwrap();
        stored.write_all(&file).unwrap();
        let reader = SerializedFileReader::new(stored).unwrap();
        let rows = reader.get_row_iter(None).unwrap();
        rows.map(|row| row.unwrap().into_columns().into_iter().map(|(_, field)| field).collect()).collect()
    }

    fn parquet(name: &str, columns: &[Column]) -> Result<Vec<u8>> {
        let mut table = TableWriter::new(Vec::new(), name, columns)?;
        table.push(columns)?;
        table.finish()
    }

    fn columns() -> Vec<Column> {
        vec![
            Column::texts("text", ["a", "", "ä · b"].into_iter()),
            Column::counts("count", [0, 7, u64::MAX].into_iter()),
            Column::numbers("number", [0.1, -0.0, f64::INFINITY].into_iter()),
            Column::flags("flag", [true, false, true].into_iter()),
            Column::optional_counts("optional_count", [None, Some(3), None].into_iter()),
            Column::optional_numbers("optional_number", [Some(2.5), None, Some(f64::MIN_POSITIVE)].into_iter()),
            Column::optional_lists("list", [&[1.0, 2.0][..], &[], &[3.0]].into_iter()),
        ]
    }

    #[test]
    fn what_is_written_is_read() {
        let rows = rows(parquet("table", &columns()).unwrap());
        let column = |k: usize| rows.iter().map(|row| row[k].clone()).collect::<Vec<_>>();
        assert_eq!(column(0), ["a", "", "ä · b"].map(|text| Field::Str(text.into())));
        assert_eq!(column(1), [0, 7, u64::MAX].map(Field::ULong));
        assert_eq!(column(2), [0.1, -0.0, f64::INFINITY].map(Field::Double));
        assert_eq!(column(3), [true, false, true].map(Field::Bool));
        assert_eq!(column(4), [Field::Null, Field::ULong(3), Field::Null]);
        assert_eq!(column(5), [Field::Double(2.5), Field::Null, Field::Double(f64::MIN_POSITIVE)]);
        let lists: Vec<String> = column(6).iter().map(Field::to_string).collect();
        assert_eq!(lists, ["[1.0, 2.0]", "null", "[3.0]"]);
    }

    #[test]
    fn equal_values_give_equal_bytes() {
        assert_eq!(parquet("table", &columns()).unwrap(), parquet("table", &columns()).unwrap());
    }

    #[test]
    fn tables_may_be_empty_but_not_ragged() {
        let empty = [Column::texts("text", [""; 0].into_iter()), Column::counts("count", std::iter::empty())];
        assert!(rows(parquet("table", &empty).unwrap()).is_empty());
        let ragged = [Column::texts("text", ["a"].into_iter()), Column::counts("count", [1, 2].into_iter())];
        assert!(parquet("table", &ragged).is_err());
    }
}
