//! SVG as PNG, for slides and papers whose programs take no SVG.

use std::collections::BTreeSet;
use std::sync::Arc;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Group, Node, Options, Tree, fontdb};

/// Most pixels of a picture: 1 GB while it is drawn, and as much again while it is encoded.
const MAX_PIXELS: f64 = (1 << 28) as f64;

/// Why a picture cannot be a PNG.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PngError {
    /// It is no SVG, or none that can be read.
    #[error("it is no SVG: {0}")]
    NotSvg(String),
    /// It would have more pixels than can be drawn.
    #[error(
        "it would have {width} x {height} pixels, of which there may be {} at most: the greatest scale that fits is {greatest_scale}",
        MAX_PIXELS
    )]
    TooLarge {
        /// Pixels from left to right.
        width: f64,
        /// Pixels from top to bottom.
        height: f64,
        /// The greatest scale that fits, in hundredths.
        greatest_scale: f64,
    },
}

/// Draws SVG as PNG, the same on every machine: it brings its font along, DejaVu Sans, which has Latin, Greek, Cyrillic and most signs.
///
/// ```
/// use headway_experiments::plot::{PngError, PngRenderer, small_multiples};
///
/// let renderer = PngRenderer::default();
/// let picture = renderer.picture(&small_multiples(&[])).unwrap();
/// assert!(picture.png(2.0).unwrap().starts_with(b"\x89PNG"));
/// assert!(picture.unpainted().is_empty());
/// assert!(matches!(picture.png(1e6), Err(PngError::TooLarge { .. })));
/// assert!(matches!(renderer.picture("no picture"), Err(PngError::NotSvg(_))));
/// ```
#[derive(Debug)]
pub struct PngRenderer {
    options: Options<'static>,
}

impl Default for PngRenderer {
    fn default() -> Self {
        let mut fonts = fontdb::Database::new();
        for font in [dejavu::sans::regular(), dejavu::sans::bold()] {
            fonts.load_font_source(fontdb::Source::Binary(Arc::new(font)));
        }
        // Whatever family an SVG names, this one is what is left.
        fonts.set_serif_family("DejaVu Sans");
        Self { options: Options { fontdb: Arc::new(fonts), ..Options::default() } }
    }
}

impl PngRenderer {
    /// Reads an SVG and lays its words out.
    ///
    /// # Errors
    /// [`PngError::NotSvg`].
    pub fn picture(&self, svg: &str) -> Result<Picture, PngError> {
        let tree = Tree::from_str(svg, &self.options).map_err(|error| PngError::NotSvg(error.to_string()))?;
        Ok(Picture { tree })
    }
}

/// A picture that can be drawn; see [`PngRenderer`].
#[derive(Debug)]
pub struct Picture {
    tree: Tree,
}

impl Picture {
    /// Its width and height as a PNG, pixels, with `scale` of them for each of the SVG's, positive.
    ///
    /// # Errors
    /// [`PngError::TooLarge`].
    pub fn size(&self, scale: f64) -> Result<[u32; 2], PngError> {
        let [width, height] = self.sides(scale);
        if width * height <= MAX_PIXELS {
            return Ok([width as u32, height as u32]);
        }
        let [w, h] = [self.tree.size().width(), self.tree.size().height()].map(f64::from);
        let hundredths = (100.0 * (MAX_PIXELS / (w * h)).sqrt()).floor();
        // Sides are rounded, perhaps upwards.
        let fits = |scale: &f64| self.sides(*scale).iter().product::<f64>() <= MAX_PIXELS;
        let greatest_scale = [hundredths, hundredths - 1.0].map(|n| n / 100.0).into_iter().find(fits).unwrap_or(0.0);
        Err(PngError::TooLarge { width, height, greatest_scale })
    }

    /// The signs in its words that its font has no glyph for; boxes stand for them.
    pub fn unpainted(&self) -> BTreeSet<char> {
        unpainted(self.tree.root())
    }

    /// The PNG, with `scale` pixels for each of the SVG's, positive.
    ///
    /// # Errors
    /// [`PngError::TooLarge`].
    pub fn png(&self, scale: f64) -> Result<Vec<u8>, PngError> {
        let [width, height] = self.size(scale)?;
        let mut pixels = Pixmap::new(width, height).expect("sides of one pixel to 2^28");
        let scale = scale as f32;
        resvg::render(&self.tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
        Ok(pixels.encode_png().expect("memory takes all that is written to it"))
    }

    /// Width and height, whole pixels.
    fn sides(&self, scale: f64) -> [f64; 2] {
        [self.tree.size().width(), self.tree.size().height()].map(|side| (f64::from(side) * scale).round().max(1.0))
    }
}

/// The signs without a glyph in a part of a picture.
fn unpainted(group: &Group) -> BTreeSet<char> {
    let of_node = |node: &Node| match node {
        Node::Group(group) => unpainted(group),
        Node::Text(text) => {
            let glyphs = text.layouted().iter().flat_map(|span| &span.positioned_glyphs);
            // Fonts keep glyph 0 for what they lack.
            glyphs.filter(|glyph| glyph.id.0 == 0).flat_map(|glyph| glyph.text.chars()).collect()
        }
        Node::Path(_) | Node::Image(_) => BTreeSet::new(),
    };
    group.children().iter().flat_map(of_node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: f64, height: f64, text: &str) -> Picture {
        let svg = format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}"><g><text y="20">{text}</text></g></svg>"#
        );
        PngRenderer::default().picture(&svg).unwrap()
    }

    #[test]
    fn the_greatest_scale_fits_and_a_greater_one_does_not() {
        for [width, height] in [[1000.0, 3000.0], [1340.0, 4870.3], [7.3, 90_000.4], [16_384.0, 16_384.0]] {
            let picture = picture(width, height, "");
            let Err(PngError::TooLarge { greatest_scale, .. }) = picture.size(1e4) else {
                panic!("{width} x {height}")
            };
            assert!(picture.size(greatest_scale).is_ok(), "{width} x {height} at {greatest_scale}");
            // A hundredth more may fit by rounding.
            assert!(picture.size(greatest_scale + 0.02).is_err(), "{width} x {height} at {greatest_scale}");
        }
        assert_eq!(picture(16_384.0, 16_384.0, "").size(1.0), Ok([16_384, 16_384]));
        let message = picture(1000.0, 1000.0, "").size(20.0).unwrap_err().to_string();
        let limit =
            "20000 x 20000 pixels, of which there may be 268435456 at most: the greatest scale that fits is 16.38";
        assert!(message.ends_with(limit), "{message}");
    }

    #[test]
    fn signs_without_a_glyph_are_named() {
        let unpainted = |text: &str| picture(200.0, 40.0, text).unpainted().into_iter().collect::<String>();
        assert_eq!(unpainted("success \u{3c4} m/s\u{b3} \u{2013} ж"), "");
        assert_eq!(unpainted("速い R 速"), "い速");
    }
}
