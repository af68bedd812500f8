//! SDF worlds: any bytes are read or refused, and what is read comes back from what is written.
#![no_main]

use headway_sim::files::{SdfSpec, Unsupported, parse_sdf, to_sdf};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let spec = SdfSpec { unsupported: Unsupported::Ignore, ..SdfSpec::default() };
    match parse_sdf(bytes, &spec) {
        Ok(file) => {
            let again = parse_sdf(to_sdf(&file).as_bytes(), &spec).expect("what we write, we read");
            assert_eq!(again.world.obstacles(), file.world.obstacles());
            assert_eq!(again.world.room(), file.world.room());
            assert_eq!((again.start, again.goal), (file.start, file.goal));
        }
        Err(error) => assert!(error.to_string().len() < 200_000),
    }
});
