//! Event files: a header, then an event for each row of metrics.
//!
//! Of TensorFlow's `Event` message five fields are needed, written here by hand in the wire format of protocol buffers: a key of field
//! number and wire type, then the value.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use super::record::{framed, unframed};
use crate::train::MetricsRow;

/// What the first event of a file says.
const FILE_VERSION: &str = "brain.Event:2";

/// Bytes of the wall time, with which every event begins: a key and a double.
const WALL_TIME: usize = 1 + 8;

/// An event file that is being written.
#[derive(Debug)]
pub struct EventFile {
    file: File,
}

impl EventFile {
    /// Starts the file at `path`, in place of what was there, and the folders above it.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn create(path: &Path, time: SystemTime) -> io::Result<Self> {
        path.parent().map_or(Ok(()), fs::create_dir_all)?;
        let mut file = File::create(path)?;
        file.write_all(&framed(&header(time)))?;
        Ok(Self { file })
    }

    /// Appends the numbers of a row, each a scalar under its own name, at the row's env step.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn push(&mut self, row: &MetricsRow, time: SystemTime) -> io::Result<()> {
        self.file.write_all(&framed(&scalars(row, time)))
    }
}

/// Whether the bytes are a whole event file of just these rows, whenever they were written.
pub(super) fn holds(file: &[u8], rows: &[MetricsRow]) -> bool {
    let any = UNIX_EPOCH;
    let expected: Vec<Vec<u8>> = std::iter::once(header(any)).chain(rows.iter().map(|row| scalars(row, any))).collect();
    let are_expected = |events: Vec<&[u8]>| {
        let says_as_much = |(event, expected): (&&[u8], &Vec<u8>)| event.get(WALL_TIME..) == expected.get(WALL_TIME..);
        events.len() == expected.len() && events.iter().zip(&expected).all(says_as_much)
    };
    unframed(file).is_some_and(are_expected)
}

/// `Event { wall_time = 1, file_version = 3 }`.
fn header(time: SystemTime) -> Vec<u8> {
    Message::default().double(1, seconds(time)).bytes(3, FILE_VERSION.as_bytes()).0
}

/// `Event { wall_time = 1, step = 2, summary = 5 }` with a `Summary { repeated Value { tag = 1, simple_value = 2 } value = 1 }`.
fn scalars(row: &MetricsRow, time: SystemTime) -> Vec<u8> {
    let values = row.scalars().into_iter().fold(Message::default(), |values, (tag, number)| {
        let value = Message::default().bytes(1, tag.as_bytes()).float(2, number as f32);
        values.bytes(1, &value.0)
    });
    Message::default().double(1, seconds(time)).integer(2, row.env_steps).bytes(5, &values.0).0
}

fn seconds(time: SystemTime) -> f64 {
    time.duration_since(UNIX_EPOCH).map_or(0.0, |since| since.as_secs_f64())
}

/// The wire types of protocol buffers that occur here.
#[derive(Debug, Clone, Copy)]
enum Wire {
    Varint = 0,
    Bits64 = 1,
    Bytes = 2,
    Bits32 = 5,
}

/// A message as far as it is written.
#[derive(Debug, Default)]
struct Message(Vec<u8>);

impl Message {
    fn integer(self, field: u8, value: u64) -> Self {
        self.key(field, Wire::Varint).varint(value)
    }

    fn double(self, field: u8, value: f64) -> Self {
        self.key(field, Wire::Bits64).raw(&value.to_le_bytes())
    }

    fn float(self, field: u8, value: f32) -> Self {
        self.key(field, Wire::Bits32).raw(&value.to_le_bytes())
    }

    fn bytes(self, field: u8, value: &[u8]) -> Self {
        self.key(field, Wire::Bytes).varint(value.len() as u64).raw(value)
    }

    fn key(self, field: u8, wire: Wire) -> Self {
        self.varint(u64::from(field << 3 | wire as u8))
    }

    /// Seven bits a byte, the lowest first; all but the last have their eighth bit set.
    fn varint(mut self, mut value: u64) -> Self {
        while value >= 0x80 {
            self.0.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.0.push(value as u8);
        self
    }

    fn raw(mut self, bytes: &[u8]) -> Self {
        self.0.extend_from_slice(bytes);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn the_wire_format_by_hand() {
        // The two examples of the protocol buffers' own guide: 150 in field 1, "testing" in field 2.
        assert_eq!(Message::default().integer(1, 150).0, [0x08, 0x96, 0x01]);
        let testing = [0x12, 0x07, b't', b'e', b's', b't', b'i', b'n', b'g'];
        assert_eq!(Message::default().bytes(2, b"testing").0, testing);
        assert_eq!(Message::default().float(2, 1.0).0, [0x15, 0, 0, 0x80, 0x3f]);
        assert_eq!(Message::default().double(1, 1.0).0, [0x09, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f]);
        assert_eq!(Message::default().integer(2, u64::MAX).0.len(), 1 + 10);
    }

    #[test]
    fn the_header_names_the_version() {
        let header = header(UNIX_EPOCH + Duration::from_millis(1500));
        assert_eq!(header[1..9], 1.5f64.to_le_bytes());
        assert_eq!(header[9..], [&[0x1a, 13][..], b"brain.Event:2"].concat());
    }
}
