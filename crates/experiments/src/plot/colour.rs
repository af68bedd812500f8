//! Speeds as colours.

use super::scale::Scale;
use super::svg::{Anchor, Frame, INK, Svg};

/// The colour map "viridis" (van der Walt & Smith, 2015) in eighths: even to the eye, also in grey and for the
/// colour-blind.
pub(crate) const VIRIDIS: [[u8; 3]; 9] = [
    [0x44, 0x01, 0x54],
    [0x47, 0x2d, 0x7b],
    [0x3b, 0x52, 0x8b],
    [0x2c, 0x72, 0x8e],
    [0x21, 0x91, 0x8c],
    [0x28, 0xae, 0x80],
    [0x5e, 0xc9, 0x62],
    [0xad, 0xdc, 0x30],
    [0xfd, 0xe7, 0x25],
];

/// Number of shades that a path shows.
const N_SHADES: usize = 48;

/// The colour at a place in [0, 1] of the map, as `#rrggbb`.
fn colour(place: f64) -> String {
    let place = place.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
    let i = (place as usize).min(VIRIDIS.len() - 2);
    let (from, to) = (VIRIDIS[i], VIRIDIS[i + 1]);
    let mix =
        |k: usize| (f64::from(from[k]) + (place - i as f64) * (f64::from(to[k]) - f64::from(from[k]))).round() as u8;
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

/// Draws a line through points, each stretch coloured by the mean of the speeds at its ends, over a dark edge that keeps
/// light colours visible on white. `top` is the speed of the last colour.
pub(super) fn coloured_line(svg: &mut Svg, points: &[[f64; 2]], speeds: &[f64], top: f64) {
    let common = r#"fill="none" stroke-linejoin="round" stroke-linecap="round""#;
    svg.polyline(points, &format!(r#"{common} stroke="{INK}" stroke-width="4.2""#));
    let shades: Vec<usize> = speeds.windows(2).map(|pair| shade((pair[0] + pair[1]) / 2.0 / top)).collect();
    let mut start = 0;
    for stretch in shades.chunk_by(|a, b| a == b) {
        let colour = colour(stretch[0] as f64 / (N_SHADES - 1) as f64);
        let style = format!(r#"{common} stroke="{colour}" stroke-width="2.8""#);
        svg.polyline(&points[start..=start + stretch.len()], &style);
        start += stretch.len();
    }
}

fn shade(place: f64) -> usize {
    (place.clamp(0.0, 1.0) * (N_SHADES - 1) as f64).round() as usize
}

/// Draws the legend of the colours, labelled on its right.
pub(super) fn colour_bar(svg: &mut Svg, frame: Frame, top: f64) {
    let scale = Scale::new([0.0, top], [frame.bottom(), frame.y]);
    let height = frame.height / N_SHADES as f64;
    for i in 0..N_SHADES {
        // Each shade reaches a little under the next, or hairlines of white would show between them.
        let slice = Frame { y: frame.bottom() - (i + 1) as f64 * height, height: height + 0.5, ..frame };
        let slice = if i == 0 { Frame { height, ..slice } } else { slice };
        svg.rect(slice, &format!(r#"fill="{}""#, colour(i as f64 / (N_SHADES - 1) as f64)));
    }
    svg.rect(frame, &format!(r#"fill="none" stroke="{INK}""#));
    for (value, label) in scale.ticks(5) {
        let y = scale.pixel(value);
        svg.line([frame.right(), y], [frame.right() + 4.0, y], &format!(r#"stroke="{INK}""#));
        svg.text([frame.right() + 7.0, y + 4.0], Anchor::Start, "", &label);
    }
    svg.text_upwards([frame.right() + 44.0, frame.y + frame.height / 2.0], "speed (m/s)");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_runs_from_purple_to_yellow() {
        assert_eq!([colour(-1.0), colour(0.0), colour(0.5)], ["#440154", "#440154", "#21918c"]);
        assert_eq!([colour(1.0), colour(f64::INFINITY)], ["#fde725", "#fde725"]);
        assert_eq!(colour(0.0625), "#461768"); // halfway between the first two
    }
}
