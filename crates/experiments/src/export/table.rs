//! One file of an export, written group by group, so that memory does not grow with the study.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::ExportedFile;
use super::column::{Column, TableWriter};
use crate::Error;

/// Rows of a group; the last one has fewer.
const GROUP: usize = 1 << 17;

/// Where the table of this name stands.
pub(super) fn path_of(folder: &Path, name: &str) -> PathBuf {
    folder.join(name).with_extension("parquet")
}

/// A table that is being written, beside its place; dropped before it is placed, it leaves nothing there.
pub(super) struct Table {
    partial: Partial,
    writer: TableWriter<BufWriter<File>>,
    n_rows: usize,
}

/// A table that is written in full, beside its place.
pub(super) struct WholeTable {
    partial: Partial,
    n_rows: usize,
    n_bytes: u64,
}

/// A file beside its place, removed when dropped.
struct Partial {
    path: PathBuf,
    place: PathBuf,
}

impl Partial {
    /// An error of writing: whatever it is, no other argument would have helped.
    fn error(&self, source: impl std::error::Error + Send + Sync + 'static) -> Error {
        Error::io("write", &self.place, io::Error::other(source))
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        // Not there once it is in its place.
        let _ = fs::remove_file(&self.path);
    }
}

impl Table {
    /// Starts `folder/NAME.parquet` with columns like these.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn create(folder: &Path, name: &str, columns: &[Column]) -> Result<Self, Error> {
        let place = path_of(folder, name);
        let path = place.with_extension("parquet.partial");
        let file = File::create(&path).map_err(|error| Error::io("create", &path, error))?;
        let partial = Partial { path, place };
        let writer = TableWriter::new(BufWriter::new(file), name, columns).map_err(|error| partial.error(error))?;
        Ok(Self { partial, writer, n_rows: 0 })
    }

    /// Appends the rows of these columns as a group.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn push(&mut self, columns: &[Column], n_rows: usize) -> Result<(), Error> {
        self.n_rows += n_rows;
        self.writer.push(columns).map_err(|error| self.partial.error(error))
    }

    /// Appends all rows, which come in batches of any size, in groups of [`GROUP`]; one without rows where there are none.
    ///
    /// # Errors
    /// That of a batch, or if it cannot be written.
    pub(super) fn fill<T>(
        mut self,
        batches: impl Iterator<Item = Result<Vec<T>, Error>>,
        columns: impl Fn(&[T]) -> Vec<Column>,
    ) -> Result<Self, Error> {
        let mut rows = Vec::new();
        for batch in batches {
            rows.extend(batch?);
            while rows.len() >= GROUP {
                let rest = rows.split_off(GROUP);
                self.push(&columns(&rows), rows.len())?;
                rows = rest;
            }
        }
        if !rows.is_empty() || self.n_rows == 0 {
            self.push(&columns(&rows), rows.len())?;
        }
        Ok(self)
    }

    /// Ends the file.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn close(self) -> Result<WholeTable, Error> {
        let Self { partial, writer, n_rows } = self;
        let mut file = writer.finish().map_err(|error| partial.error(error))?;
        let closed = file.flush().and_then(|()| file.get_ref().metadata());
        let n_bytes = closed.map_err(|error| partial.error(error))?.len();
        Ok(WholeTable { partial, n_rows, n_bytes })
    }
}

impl WholeTable {
    /// Puts the file in its place.
    ///
    /// # Errors
    /// If the system refuses.
    pub(super) fn place(self) -> Result<ExportedFile, Error> {
        let Self { partial, n_rows, n_bytes } = self;
        fs::rename(&partial.path, &partial.place).map_err(|error| partial.error(error))?;
        Ok(ExportedFile { path: partial.place.clone(), n_rows, n_bytes })
    }
}

#[cfg(test)]
mod tests {
    use parquet::file::metadata::RowGroupMetaData;
    use parquet::file::reader::{FileReader, SerializedFileReader};

    use super::*;

    #[test]
    fn groups_are_bounded_whatever_the_batches() {
        let columns = |rows: &[u64]| vec![Column::counts("row", rows.iter().copied())];
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, sizes: &[usize]| {
            let mut next = 0..;
            let batches = sizes.iter().map(|n| Ok(next.by_ref().take(*n).collect::<Vec<u64>>()));
            let table = Table::create(folder.path(), name, &columns(&[])).unwrap();
            table.fill(batches, columns).unwrap().close().unwrap().place().unwrap()
        };
        let groups = |file: &ExportedFile| {
            let reader = SerializedFileReader::new(File::open(&file.path).unwrap()).unwrap();
            reader.metadata().row_groups().iter().map(RowGroupMetaData::num_rows).collect::<Vec<_>>()
        };
        let n = GROUP + GROUP / 2;
        let (many, one) = (write("many", &[10, n - 20, 10, 0, GROUP]), write("one", &[n + GROUP]));
        assert_eq!((many.n_rows, groups(&many)), (n + GROUP, vec![GROUP as i64, GROUP as i64, GROUP as i64 / 2]));
        assert_eq!(many.n_bytes, fs::metadata(&many.path).unwrap().len());
        let rows = |file: &ExportedFile| {
            let reader = SerializedFileReader::new(File::open(&file.path).unwrap()).unwrap();
            reader.get_row_iter(None).unwrap().map(|row| row.unwrap().to_string()).collect::<Vec<_>>()
        };
        assert!(rows(&many) == rows(&one) && rows(&many)[GROUP] == format!("{{row: {GROUP}}}"));
        assert_eq!(groups(&write("none", &[])), [0]);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3, "nothing half-written is left");
    }
}
