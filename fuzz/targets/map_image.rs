//! Maps and their pictures: any bytes are read or refused, and a map's map is the same.
//!
//! The first byte chooses mode, negation and what unknown cells are; the rest is the picture.
#![no_main]

use headway_sim::files::{MapSpec, UnknownCells, parse_map, to_map};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Some((&choice, picture)) = bytes.split_first() else { return };
    let mode = ["trinary", "scale", "raw", "trinary"][usize::from(choice % 4)];
    let negate = choice / 4 % 2;
    let unknown = if choice / 8 % 2 == 0 { UnknownCells::Free } else { UnknownCells::Occupied };
    let yaml = format!(
        "image: a.png\nresolution: 0.05\norigin: [-1.3, 2.7, 0]\nnegate: {negate}\nmode: {mode}\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
    );
    let spec = MapSpec { unknown, max_cells: 100_000 };
    if let Ok(file) = parse_map(yaml.as_bytes(), &spec, |_| Ok(picture.to_vec())) {
        let map = to_map(&file, 0.05, "a.pgm").expect("a map's cells make a map");
        let again = parse_map(map.yaml.as_bytes(), &spec, |_| Ok(map.pgm.clone())).expect("what we write, we read");
        assert_eq!(again.world.obstacles(), file.world.obstacles());
        assert_eq!(again.world.room(), file.world.room());
    }
});
