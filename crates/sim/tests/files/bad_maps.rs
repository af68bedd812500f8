//! Maps that are refused, and what is said.

use headway_sim::files::{MapSpec, WorldFile, to_map};
use headway_sim::{Room, World};

use crate::common::{YAML, read_map};

const PICTURE: &[u8] = b"P2 3 2 255 0 254 254 254 254 254";

fn refusal(yaml: &str, picture: &[u8]) -> String {
    read_map(yaml, picture, &MapSpec::default()).unwrap_err().to_string()
}

#[test]
fn each_fault_of_the_yaml_is_named() {
    let bomb = (1..30).fold(String::from("a0: &a0 [x, x]\n"), |text, k| {
        format!("{text}a{k}: &a{k} [*a{}, *a{}, *a{}, *a{}]\n", k - 1, k - 1, k - 1, k - 1)
    });
    let cases = [
        (String::new(), "no well-formed map of map_server: "),
        ("image: [".into(), "no well-formed map of map_server: "),
        ("- image".into(), "no well-formed map of map_server: "),
        (YAML.replace("image: a.pgm\n", ""), "missing field `image`"),
        (YAML.replace("resolution: 0.5\n", ""), "missing field `resolution`"),
        (YAML.replace("free_thresh: 0.196\n", ""), "missing field `free_thresh`"),
        (YAML.replace("0.5", "fine"), "line 2"),
        (YAML.replace("[-1, 2, 0]", "here"), "line 3"),
        (format!("{YAML}mode: colour\n"), "colour"),
        (format!("{YAML}image: b.pgm\n"), "duplicate"),
        (format!("{YAML}headway: {{begin: [0, 0, 0]}}\n"), "begin"),
        (YAML.replace("a.pgm", "''"), "image = '': must be the name of a PGM or PNG file"),
        (YAML.replace("resolution: 0.5", "resolution: 0"), "resolution = 0: must be from 0.0001 to 1000"),
        (YAML.replace("resolution: 0.5", "resolution: -1"), "resolution = -1: must be from 0.0001 to 1000"),
        (YAML.replace("resolution: 0.5", "resolution: .nan"), "resolution = NaN: must be from 0.0001 to 1000"),
        (YAML.replace("[-1, 2, 0]", "[-1, 2]"), "origin = 2 numbers: must be [x, y, yaw]"),
        (YAML.replace("[-1, 2, 0]", "[-1, 2e9, 0]"), "origin.y = 2000000000: must be from -1000000 to 1000000"),
        (YAML.replace("[-1, 2, 0]", "[-1, 2, .inf]"), "origin.yaw = inf: must be from"),
        (YAML.replace("0.65", "65"), "occupied_thresh = 65: must be from 0 to 1"),
        (YAML.replace("0.196", "-0.1"), "free_thresh = -0.1: must be from 0 to 1"),
        (
            YAML.replace("0.196", "0.9"),
            "free_thresh = 0.9: must be at most occupied_thresh = 0.65: are the two swapped?",
        ),
        (YAML.replace("negate: 0", "negate: 2"), "negate = 2: must be 0, 1, false or true"),
        (YAML.replace("negate: 0", "negate: perhaps"), "negate must be 0, 1, false or true"),
        (format!("{YAML}headway: {{start: [1]}}\n"), "headway: start = [1.0]: must be [x, y, yaw], or"),
        (format!("{YAML}headway: {{start: [1, 2, 3, 4]}}\n"), "headway: start = [1.0, 2.0, 3.0, 4.0]: must be"),
        (format!("{YAML}headway: {{goal: [1, .nan]}}\n"), "headway: goal = NaN: must be from"),
        (format!("{YAML}{bomb}"), "no well-formed map of map_server: "),
        (format!("{YAML}deep: {}\n", "[".repeat(100_000)), "no well-formed map of map_server: "),
        (format!("{YAML}#{}\n", " ".repeat(1 << 20)), "must be at most 1048576 bytes of YAML"),
    ];
    for (yaml, wanted) in cases {
        let error = refusal(&yaml, PICTURE);
        assert!(error.contains(wanted), "{error}\n  wanted: {wanted}");
        assert!(error.len() < 600, "{error}");
    }
}

#[test]
fn each_fault_of_the_picture_is_named() {
    let bomb = b"P5 60000 60000 255 ".to_vec();
    let long = b"P5 200000 1 255 ".to_vec();
    let cases: [(&[u8], &str); 10] = [
        (b"", "image 'a.pgm': no well-formed PGM or PNG picture: it begins like neither"),
        (b"GIF89a", "image 'a.pgm': no well-formed PGM or PNG picture: it begins like neither"),
        (b"P2 x 2 255 0", "image 'a.pgm': no well-formed PGM or PNG picture: "),
        (b"P2 3 2 255 0 0 0 0 0", "image 'a.pgm': no well-formed PGM or PNG picture: "),
        (b"P5 3 2 255 \0\0", "image 'a.pgm': no well-formed PGM or PNG picture: "),
        (b"P2 1 1 255 256", "image 'a.pgm': no well-formed PGM or PNG picture: "),
        (b"P2 0 2 255", "image 'a.pgm': "),
        (b"\x89PNG\r\n\x1a\n", "image 'a.pgm': no well-formed PGM or PNG picture: "),
        (
            &bomb,
            "image 'a.pgm': size = 60000 x 60000: must be from 1 to 100000 a side, and at most 64000000 cells (max_cells)",
        ),
        (&long, "image 'a.pgm': size = 200000 x 1: must be from 1 to 100000 a side"),
    ];
    for (picture, wanted) in cases {
        let error = refusal(YAML, picture);
        assert!(error.contains(wanted), "{error}\n  wanted: {wanted}");
    }
    let chequered: String = (0..500 * 500).map(|k| if (k + k / 500) % 2 == 0 { " 0" } else { " 254" }).collect();
    let error = refusal(YAML, format!("P2 500 500 255{chequered}").as_bytes());
    assert_eq!(error, "image: boxes = more than 100000: must be at most 100000: are the thresholds right?");
}

#[test]
fn resolutions_to_write_in_are_checked() {
    let world = World::new(Room::new(10.0, 10.0), vec![]).unwrap();
    let file = WorldFile { name: String::new(), world, start: None, goal: None, unsupported: vec![] };
    let error = |resolution| to_map(&file, resolution, "a.pgm").unwrap_err().to_string();
    assert_eq!(error(0.0), "resolution = 0: must be from 0.0001 to 1000");
    assert_eq!(error(1e-3), "resolution = 0.001: must be one that makes at most 64000000 cells of a 10 x 10 m room");
}

#[test]
fn a_file_may_end_anywhere() {
    for end in 0..YAML.len() {
        let _ = read_map(&YAML[..end], PICTURE, &MapSpec::default());
    }
    let mut png = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut png);
    image::ImageEncoder::write_image(encoder, &[0; 60], 5, 4, image::ExtendedColorType::Rgb8).unwrap();
    for end in 0..png.len() - 12 {
        assert!(read_map(YAML, &png[..end], &MapSpec::default()).is_err());
    }
    for place in 0..png.len() {
        let mut spoilt = png.clone();
        spoilt[place] ^= 0x55;
        let _ = read_map(YAML, &spoilt, &MapSpec::default());
    }
    for end in 0..PICTURE.len() - 2 {
        assert!(read_map(YAML, &PICTURE[..end], &MapSpec::default()).is_err());
    }
}
