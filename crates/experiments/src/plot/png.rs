//! SVG as PNG, for slides and papers whose programs take no SVG.

use std::sync::Arc;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

/// Most pixels of a picture: 1 GB while it is drawn.
const MAX_PIXELS: f64 = (1 << 28) as f64;

/// Draws the pictures of this crate as PNG, each the same on every machine: it brings its font along, DejaVu Sans, which has Latin,
/// Greek, Cyrillic and most signs.
///
/// ```
/// use headway_experiments::plot::{PngRenderer, small_multiples};
///
/// let renderer = PngRenderer::default();
/// let png = renderer.png(&small_multiples(&[]), 2.0).unwrap();
/// assert!(png.starts_with(b"\x89PNG"));
/// assert_eq!(renderer.png(&small_multiples(&[]), 1e6), None, "too large");
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
        Self { options: Options { fontdb: Arc::new(fonts), ..Options::default() } }
    }
}

impl PngRenderer {
    /// The PNG of a picture of this crate, with `scale` pixels for each of the SVG's, positive; nothing if it would be too large.
    ///
    /// # Panics
    /// If `svg` is none.
    pub fn png(&self, svg: &str, scale: f64) -> Option<Vec<u8>> {
        let tree = Tree::from_str(svg, &self.options).expect("the pictures of this crate are SVG");
        let [width, height] = [tree.size().width(), tree.size().height()].map(|side| (f64::from(side) * scale).round());
        let mut pixels =
            if width * height <= MAX_PIXELS { Pixmap::new(width as u32, height as u32)? } else { return None };
        let scale = scale as f32;
        resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
        pixels.encode_png().ok()
    }
}
