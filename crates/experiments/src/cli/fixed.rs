//! What a protocol fixes, and what makes no difference to it.

use toml::Value;

use crate::Error;
use crate::spec::{Assignment, KeyPath};

/// Who brings the values that an option cannot replace.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Brings {
    /// A classical driver: its name.
    Driver,
    /// A policy file: itself.
    Policy,
    /// A policy file that drives by a spec: what it observes, what it controls and its route, too.
    PolicyOverSpec,
}

const WORLDS: &str = "the protocol drives in the worlds of --worlds";
const RULES: &str = "the protocol fixes it: start, goal, 1 m to reach it, 100 s";
const LEARNING: &str = "makes no difference here: nothing is trained";
const FILE: &str = "the policy file brings it";

/// Paths that an evaluation by the protocol does not read, each with why.
const FIXED: [(&str, &str); 12] = [
    ("world", WORLDS),
    ("evaluate.worlds", WORLDS),
    ("evaluate.n_episodes", "--runs N says how often each world is driven in"),
    ("env.goal", RULES),
    ("env.reach_radius", RULES),
    ("env.time_limit", RULES),
    ("env.obstacle_angle", "makes no difference here: only rewards look at it"),
    ("reward", LEARNING),
    ("agent", LEARNING),
    ("train", LEARNING),
    ("seeds", "makes no difference here: --seed S is the seed of the runs"),
    ("name", "makes no difference here: nothing is written"),
];

/// Refuses assignments that would change nothing.
///
/// # Errors
/// Names the path, the value, and what holds instead.
pub(super) fn check(sets: &[Assignment], brings: Brings) -> Result<(), Error> {
    let brought: &[(&str, &str)] = match brings {
        Brings::Driver => &[
            ("policy.type", "POLICY names the driver"),
            ("env.control", "drivers control speed and yaw rate"),
            ("env.actions", "drivers choose from no list"),
            ("env.observation", "drivers see the scans themselves"),
        ],
        Brings::Policy => &[("policy", FILE)],
        Brings::PolicyOverSpec => &[
            ("policy", FILE),
            ("env.control", FILE),
            ("env.actions", FILE),
            ("env.observation", FILE),
            ("env.route", FILE),
        ],
    };
    for set in sets {
        for path in leaves(&set.path, &set.value) {
            let mut fixed = FIXED.iter().chain(brought);
            let is_fixed = |name: &str| name.parse().is_ok_and(|name: KeyPath| name.is_prefix_of(&path));
            if let Some((_, why)) = fixed.find(|(name, _)| is_fixed(name)) {
                return Err(Error::Input(format!("--set {set}: {path}: {why}")));
            }
        }
    }
    Ok(())
}

/// The paths of all that an assignment replaces.
fn leaves(path: &KeyPath, value: &Value) -> Vec<KeyPath> {
    match value {
        Value::Table(entries) if !entries.is_empty() => {
            let below = entries.iter().flat_map(|(key, value)| match key.parse() {
                Ok(key) => leaves(&path.extend(&key), value),
                Err(_) => vec![path.join(key)],
            });
            below.collect()
        }
        _ => vec![path.clone()],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(set: &str, brings: Brings) -> Option<String> {
        check(&[set.parse().unwrap()], brings).err().map(|error| error.to_string())
    }

    #[test]
    fn what_is_fixed_is_refused_by_its_path() {
        for (set, part) in [
            ("env.time_limit=50", "--set env.time_limit=50: env.time_limit: the protocol fixes it"),
            ("env={ time_limit = 50, route.type = 'none' }", "env.time_limit: the protocol fixes it"),
            ("env={ 'reach_radius' = 2 }", "env.reach_radius: the protocol fixes it"),
            ("world.type=barn", "world.type: the protocol drives in the worlds of --worlds"),
            ("evaluate.worlds=[]", "evaluate.worlds: the protocol"),
            ("evaluate={ n_episodes = 3 }", "evaluate.n_episodes: --runs N"),
            ("agent.gamma=0.9", "agent.gamma: makes no difference here"),
            ("policy.type=vfh", "policy.type: POLICY names the driver"),
        ] {
            let refusal = refusal(set, Brings::Driver).unwrap_or_default();
            assert!(refusal.contains(part), "{set} gives\n{refusal}");
        }
    }

    #[test]
    fn what_a_policy_brings_depends_on_where_the_rest_comes_from() {
        let route = "env.route.type=none";
        assert!(refusal(route, Brings::PolicyOverSpec).is_some_and(|text| text.contains("the policy file brings it")));
        assert_eq!((refusal(route, Brings::Policy), refusal(route, Brings::Driver)), (None, None));
        assert!(refusal("policy.max_speed=1", Brings::Policy).is_some());
        assert_eq!(refusal("policy.max_speed=1", Brings::Driver), None);
    }

    #[test]
    fn conditions_are_free() {
        for set in
            ["vehicle.max_speed=1", "lidar.noise=0.01", "evaluate.shield={}", "evaluate.seed=3", "env.route.type=scans"]
        {
            assert_eq!(refusal(set, Brings::Driver), None, "{set}");
        }
        assert_eq!(
            refusal("randomize={ 'vehicle.actuation.latency' = { uniform = [0.0, 0.1] } }", Brings::Driver),
            None
        );
    }
}
