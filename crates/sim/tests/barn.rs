//! Worlds like those of BARN are the same as ever, since results that others have depend on them, with a crowd or without.

use headway_sim::{BarnSpec, CrowdMotion, CrowdSpec, Footprint, Interval, Scenario, Shape, WorldSpec};

/// A fingerprint of what stands where: FNV-1a over the bits of all coordinates.
fn fingerprint(scenarios: impl Iterator<Item = Scenario>) -> u64 {
    let mix = |hash: u64, bits: u64| (hash ^ bits).wrapping_mul(0x0100_0000_01b3);
    scenarios.fold(0xcbf2_9ce4_8422_2325, |hash, scenario| {
        let posts = scenario.world.static_obstacles();
        posts
            .iter()
            .fold(mix(hash, posts.len() as u64), |hash, post| mix(mix(hash, post.x.to_bits()), post.y.to_bits()))
    })
}

/// What the first version of the generator drew.
#[test]
fn the_same_seeds_draw_the_same_worlds() {
    let range = |low, high| Interval::Range([low, high]);
    let base = BarnSpec::default();
    let dense = BarnSpec { fill: range(0.2, 0.3), n_smoothings: range(1.0, 6.0), ..base.clone() };
    let narrow = BarnSpec { clearance: range(0.05, 0.45), fill: range(0.1, 0.25), margin: 3.7, ..base.clone() };
    let wide = BarnSpec { clearance: range(0.05, 0.8), fill: range(0.0, 0.2), margin: 1.0, ..base.clone() };
    let lively = BarnSpec { crowd: Some(CrowdSpec::default()), ..base.clone() };
    let jackal = Shape::Box { length: 0.458, width: 0.4156 };
    let cases = [
        (base, jackal.clone(), 0x9bd0_f2f7_a6c0_a3c5),
        (lively, jackal.clone(), 0x9bd0_f2f7_a6c0_a3c5),
        (dense, jackal.clone(), 0xf9f4_628e_59f3_1db8),
        (narrow.clone(), jackal.clone(), 0x7bca_0966_f00f_d200),
        (narrow, Shape::Disc { radius: 0.1 }, 0xe480_d5ba_8ee3_5698),
        (wide, jackal, 0x563f_64d6_39c1_b52b),
    ];
    for (spec, shape, expected) in cases {
        let source = WorldSpec::Barn(spec.clone()).build(&Footprint::new(&shape).unwrap()).unwrap();
        let found: u64 = fingerprint((0..150).map(|index| source.scenario(7, index).unwrap()));
        assert_eq!(found, expected, "{spec:?}");
    }
}

#[test]
fn a_crowd_walks_free_of_the_posts() {
    let vehicle = Footprint::new(&Shape::Box { length: 0.458, width: 0.4156 }).unwrap();
    let random_walk = CrowdMotion::RandomWalk { turning: 0.5 };
    let reciprocal = CrowdMotion::Reciprocal { horizon: 2.0, obstacle_horizon: 1.0 };
    for motion in [CrowdMotion::default(), random_walk, reciprocal] {
        let crowd = CrowdSpec { n_movers: Interval::Range([4.0, 20.0]), motion, ..CrowdSpec::default() };
        let spec = BarnSpec { crowd: Some(crowd.clone()), margin: 1.0, ..BarnSpec::default() };
        let source = WorldSpec::Barn(spec).build(&vehicle).unwrap();
        for index in 0..10 {
            let Scenario { mut world, start, goal, crowd: walkers, .. } = source.scenario(1, index).unwrap();
            assert_eq!(walkers, source.scenario(1, index).unwrap().crowd);
            let (mut walkers, still) = (walkers.unwrap(), world.without_movers().into_owned());
            for mover in walkers.movers() {
                for end in [start.translation.vector.into(), goal] {
                    let apart = (mover.position - end).norm();
                    assert!(apart >= mover.radius + vehicle.circumradius() + crowd.min_gap);
                }
                assert!(still.distance(&mover.position) >= mover.radius + crowd.min_gap);
            }
            for _ in 0..50 {
                walkers.step(&mut world, 0.1, None);
                assert!(walkers.movers().iter().all(|mover| still.distance(&mover.position) > mover.radius));
            }
            // Seen: the nearest thing to a mover's place is the mover.
            let index = world.static_obstacles().len();
            assert!(world.distance(&walkers.movers()[0].position) < 0.0);
            assert_eq!(world.obstacles()[index].x, walkers.movers()[0].position.x);
        }
    }
}

#[test]
fn a_crowd_for_which_there_is_no_place_is_refused_by_name() {
    let vehicle = Footprint::new(&Shape::Disc { radius: 0.2 }).unwrap();
    let refusal = |crowd| {
        let spec = BarnSpec { crowd: Some(crowd), margin: 1.0, ..BarnSpec::default() };
        WorldSpec::Barn(spec).build(&vehicle).unwrap_err().to_string()
    };
    let giants = CrowdSpec { radius: Interval::Fixed(3.0), ..CrowdSpec::default() };
    let error = refusal(giants);
    assert!(error.starts_with("cannot place mover 1 of 6 (radius 3.00 m)"), "{error}");
    let error = refusal(CrowdSpec { min_gap: -1.0, ..CrowdSpec::default() });
    assert!(error.starts_with("crowd.min_gap = -1: must be"), "{error}");
}
