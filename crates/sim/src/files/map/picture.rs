//! The picture of a map.

use std::io::Cursor;

use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};

use super::UnknownCells;
use super::cells::Cells;
use super::header::{Header, Mode};
use crate::FieldError;
use crate::files::FileError;
use crate::files::error::quoted;

/// The most cells along a side.
const LONGEST: u32 = 100_000;

/// A picture of bounded size.
pub(super) struct Picture(DynamicImage);

/// Reads a PGM, PPM or PNG picture of bounded size.
pub(super) fn parse(bytes: &[u8], header: &Header, max_cells: u64) -> Result<Picture, FileError> {
    let place = || format!("image {}", quoted(&header.image));
    let malformed = |e: image::ImageError| FileError::malformed(place(), "PGM or PNG picture", e);
    let mut reader = ImageReader::new(Cursor::new(bytes));
    let format = image::guess_format(bytes).ok().filter(|f| matches!(f, ImageFormat::Pnm | ImageFormat::Png));
    let Some(format) = format else {
        return Err(FileError::malformed(place(), "PGM or PNG picture", "it begins like neither"));
    };
    reader.set_format(format);
    let mut limits = Limits::default();
    limits.max_alloc = Some(max_cells.saturating_mul(8));
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(malformed)?;
    let (width, height) = decoder.dimensions();
    if width == 0 || height == 0 || width.max(height) > LONGEST || u64::from(width) * u64::from(height) > max_cells {
        let allowed = format!("from 1 to {LONGEST} a side, and at most {max_cells} cells (max_cells)");
        return Err(FileError::at(place(), FieldError::new("size", format!("{width} x {height}"), allowed)));
    }
    DynamicImage::from_decoder(decoder).map(Picture).map_err(malformed)
}

impl Picture {
    /// Which cells are occupied, by the header's thresholds.
    pub(super) fn cells(&self, header: &Header, unknown: UnknownCells) -> Cells {
        let is_occupied = |lightness: Option<f64>| {
            let known = lightness.and_then(|lightness| occupancy(lightness, header));
            known.unwrap_or(unknown == UnknownCells::Occupied)
        };
        // Lightness is the mean of the colours, from 0 to 1; 16 bits hold all that the formats can.
        let mean = |[r, g, b]: [u16; 3]| (f64::from(r) + f64::from(g) + f64::from(b)) / (3.0 * 65535.0);
        let opaque = |[r, g, b, a]: [u16; 4]| (a == u16::MAX).then(|| mean([r, g, b]));
        let pixels: Vec<bool> = match &self.0 {
            DynamicImage::ImageLuma8(grey) => {
                grey.as_raw().iter().map(|x| is_occupied(Some(f64::from(*x) / 255.0))).collect()
            }
            image => image.to_rgba16().pixels().map(|pixel| is_occupied(opaque(pixel.0))).collect(),
        };
        let n_columns = self.0.width() as usize;
        // A picture begins above, a map below.
        let occupied: Vec<_> = pixels.chunks(n_columns).rev().flatten().copied().collect();
        Cells { n_columns, n_rows: occupied.len() / n_columns, occupied }
    }
}

/// Whether a cell is occupied; none if that is unknown.
fn occupancy(lightness: f64, header: &Header) -> Option<bool> {
    if header.mode == Mode::Raw {
        let percent = (lightness * 255.0).round();
        return (percent <= 100.0).then_some(percent >= 100.0 * header.occupied_thresh);
    }
    let p = if header.is_negated() { lightness } else { 1.0 - lightness };
    if p > header.occupied_thresh {
        Some(true)
    } else if p < header.free_thresh {
        Some(false)
    } else {
        None
    }
}
