//! What a step costs in memory: nothing.

use headway_env::{Env, NavEnv, NavSpec, Step};
use headway_sensors::LidarSpec;

#[test]
fn a_step_that_ends_no_episode_allocates_nothing() {
    for n_beams in [36, 360, 4096] {
        let spec = NavSpec { lidar: LidarSpec { n_beams, ..LidarSpec::default() }, ..NavSpec::default() };
        let mut env = NavEnv::new(spec.build().unwrap(), 8);
        let mut step = Step::new(8, env.obs_dim());
        env.reset(0, &mut step.obs).unwrap();
        let mut n_quiet_steps = 0;
        for k in 0..100 {
            let actions: [u32; 8] = std::array::from_fn(|i| (i as u32 + k / 7) % 12);
            let counted = allocation_counter::measure(|| env.step(&actions, &mut step).unwrap());
            if !step.terminated.iter().chain(&step.truncated).any(|ended| *ended) {
                assert_eq!(counted.count_total, 0, "{n_beams} beams, step {k}");
                n_quiet_steps += 1;
            }
        }
        assert!(n_quiet_steps > 50);
    }
}
