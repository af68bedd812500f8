//! What the registry says without any plugin.

use headway_reward::{RewardError, check_tag, registry, testing};

const TAGS: [&str; 8] = ["heading", "progress", "proximity", "r", "r_couple", "steady_speed", "sum", "time"];

#[test]
fn lists_our_rewards_sorted() {
    let tags: Vec<_> = registry().unwrap().iter().map(|entry| entry.tag).collect();
    assert_eq!(tags, TAGS);
}

#[test]
fn shows_the_default_fields() {
    let show = |tag| {
        let entry = registry().unwrap().into_iter().find(|entry| entry.tag == tag).unwrap();
        toml::to_string(&*entry.default.unwrap()).unwrap()
    };
    assert_eq!(show("r"), "type = \"r\"\nno_collision = 10.0\ncollision = -100.0\nreach = 100.0\n");
    assert_eq!(
        show("r_couple"),
        "type = \"r_couple\"\ndesired_speed = 1.2\ncollision = -100.0\nside = 20.0\nfront = 10.0\notherwise = 10.0\n\
         angle_threshold = 0.5235987755982989\nspeed_width = 2.0\n"
    );
    assert_eq!(show("sum"), "type = \"sum\"\nterms = []\n");
    assert_eq!(show("time"), "type = \"time\"\n");
}

#[test]
fn every_default_passes_the_checks() {
    for entry in registry().unwrap() {
        assert_eq!(testing::check(&*entry.default.unwrap()), Ok(()), "{}", entry.tag);
    }
}

#[test]
fn a_known_tag_passes() {
    for tag in TAGS {
        assert_eq!(check_tag(tag), Ok(()));
    }
}

#[test]
fn an_unknown_tag_lists_the_known_ones_and_says_what_plugins_need() {
    let error = check_tag("smooth/needless_braking").unwrap_err();
    assert_eq!(error, RewardError::Unknown { tag: "smooth/needless_braking".to_owned(), known: TAGS.to_vec() });
    assert_eq!(
        error.to_string(),
        "unknown reward `smooth/needless_braking`: this binary knows heading, progress, proximity, r, r_couple, steady_speed, \
         sum, \
         time. A plugin's rewards are known only to a binary that links the plugin and names it, as in \
         `use my_rewards as _;` in its main.rs: without that line the linker drops the plugin"
    );
}
