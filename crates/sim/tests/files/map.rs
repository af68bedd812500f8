//! What maps become, by hand.

use headway_sim::files::{MapSpec, UnknownCells};
use headway_sim::{Obstacle, Room, Shape};

use crate::common::{YAML, read_map};

fn boxes(yaml: &str, picture: &[u8], unknown: UnknownCells) -> usize {
    read_map(yaml, picture, &MapSpec { unknown, ..MapSpec::default() }).unwrap().world.obstacles().len()
}

#[test]
fn cells_lie_where_the_origin_says() {
    // Black is upper left.
    let file = read_map(YAML, b"P2 3 2 255 0 254 254 254 254 254", &MapSpec::default()).unwrap();
    let wanted = Obstacle { shape: Shape::Box { length: 0.5, width: 0.5 }, x: -0.75, y: 2.75, yaw: 0.0 };
    assert_eq!(file.world.obstacles(), [wanted]);
    assert_eq!(file.world.room(), Room { x: -1.0, y: 2.0, width: 1.5, height: 1.0 });
    assert_eq!((file.name.as_str(), file.start.is_none()), ("a", true));
}

#[test]
fn thresholds_are_map_servers() {
    // 254 is free; 205, the grey of map_saver, is p = 0.196078 and unknown; 89 is p = 0.65098 and occupied, 90 unknown.
    let picture = b"P2 4 2 255  254 205 89 90  254 254 254 254";
    assert_eq!(boxes(YAML, picture, UnknownCells::Free), 1);
    let file = read_map(YAML, picture, &MapSpec { unknown: UnknownCells::Occupied, ..MapSpec::default() }).unwrap();
    assert!(matches!(file.world.obstacles(), [Obstacle { shape: Shape::Box { length, .. }, .. }] if *length == 1.5));
    for negate in ["1", "true"] {
        let yaml = YAML.replace("negate: 0", &format!("negate: {negate}"));
        assert_eq!(boxes(&yaml, b"P2 4 1 255  255 0 0 255", UnknownCells::Free), 2);
    }
    // Percent: 64 is free, 65 occupied, 101 unknown.
    let raw = format!("{YAML}mode: raw\n");
    assert_eq!(boxes(&raw, b"P2 5 1 255  64 65 0 101 100", UnknownCells::Free), 2);
    assert_eq!(boxes(&raw, b"P2 5 1 255  64 65 0 101 0", UnknownCells::Occupied), 2);
}

#[test]
fn every_kind_of_picture_is_read() {
    let binary = [b"P5 3 1 255 ".as_slice(), &[0, 254, 0]].concat();
    let coloured = [b"P6 3 1 255 ".as_slice(), &[0, 0, 0, 254, 254, 254, 0, 0, 0]].concat();
    for picture in [&b"P2\n# by hand\n3 1\n255\n0 254 0\n"[..], &binary, &coloured] {
        assert_eq!(boxes(YAML, picture, UnknownCells::Free), 2);
    }
    let png = |pixels: &[u8], colour| {
        let mut bytes = Vec::new();
        let encoder = image::codecs::png::PngEncoder::new(&mut bytes);
        image::ImageEncoder::write_image(encoder, pixels, 3, 1, colour).unwrap();
        bytes
    };
    assert_eq!(boxes(YAML, &png(&[0, 254, 0], image::ExtendedColorType::L8), UnknownCells::Free), 2);
    // The middle one is white, but see-through: nobody has been there.
    let rgba = png(&[0, 0, 0, 255, 254, 254, 254, 0, 254, 254, 254, 255], image::ExtendedColorType::Rgba8);
    assert_eq!(boxes(YAML, &rgba, UnknownCells::Free), 1);
    let file = read_map(YAML, &rgba, &MapSpec { unknown: UnknownCells::Occupied, ..MapSpec::default() }).unwrap();
    assert!(matches!(file.world.obstacles(), [Obstacle { shape: Shape::Box { length, .. }, .. }] if *length == 1.0));
}

#[test]
fn a_turned_map_has_turned_boxes() {
    let yaml = YAML.replace("[-1, 2, 0]", "[-1, 2, 1.5707963267948966]");
    let file = read_map(&yaml, b"P2 3 2 255 254 254 254 0 254 254", &MapSpec::default()).unwrap();
    // The lower left cell, from (0, 0) to (0.5, 0.5) on the map, lies left of the corner now.
    let cell = &file.world.obstacles()[0];
    assert!((cell.x + 1.25).abs() < 1e-12 && (cell.y - 2.25).abs() < 1e-12);
    let Room { x, y, width, height } = file.world.room();
    assert!([(x, -2.0), (y, 2.0), (width, 1.0), (height, 1.5)].iter().all(|(a, b)| (a - b).abs() < 1e-12));
}

#[test]
fn other_keys_are_passed_over_and_ours_are_read() {
    let yaml = format!("{YAML}author: somebody\nheadway: {{start: [0, 2.5, 0], goal: [-0.5, 2.75]}}\n");
    let file = read_map(&yaml, b"P2 3 2 255 254 254 254 254 254 254", &MapSpec::default()).unwrap();
    assert_eq!(file.start.unwrap().translation.x, 0.0);
    assert_eq!(file.goal.unwrap().y, 2.75);
}
