//! The YAML of maps: any bytes are read or refused.
#![no_main]

use headway_sim::files::{MapSpec, parse_map};
use libfuzzer_sys::fuzz_target;

const PICTURE: &[u8] = b"P2 4 3 255  0 0 255 255  205 255 255 255  255 99 100 101";

fuzz_target!(|yaml: &[u8]| {
    let _ = parse_map(yaml, &MapSpec::default(), |_| Ok(PICTURE.to_vec()));
});
