//! One run, whole: the tables of a spec file.

use std::sync::Arc;

use headway_env::{EnvSpec, GoalHandling, NavSpec, RandomizeSpec};
use headway_planning::ShieldSpec;
use headway_reward::{Progress, Proximity, R, Reward, Sum, Time};
use headway_rl::DqnSpec;
use headway_sensors::{LidarSpec, OdometrySpec};
use headway_sim::{Interval, Quantity, RoomSpec, VehicleSpec, WeightedWorld, WorldSpec};
use serde::{Deserialize, Serialize};

use super::{PolicySpec, ShieldOption};

/// One run but for its seed: where it trains, what drives, what it learns, and how it is evaluated.
///
/// ```
/// use headway_experiments::spec::RunSpec;
/// let run: RunSpec = toml::from_str("[agent]\ngamma = 0.9")?;
/// assert_eq!((run.agent.gamma, run.lidar.n_beams), (0.9, 36));
/// assert!(run.check().is_ok());
/// # Ok::<(), toml::de::Error>(())
/// ```
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RunSpec {
    /// Where the agent trains.
    pub world: WorldSpec,
    /// What drives.
    pub vehicle: VehicleSpec,
    /// What it senses with.
    pub lidar: LidarSpec,
    /// How it knows its own motion.
    pub odometry: OdometrySpec,
    /// Which numbers of the three differ from episode to episode.
    pub randomize: RandomizeSpec,
    /// The decision process: goal handling, actions, observation.
    pub env: EnvSpec,
    /// Who drives in the evaluation: a policy that is trained, or one that need not be.
    pub policy: PolicySpec,
    /// What is paid in training.
    pub reward: Arc<dyn Reward>,
    /// The learner.
    pub agent: DqnSpec,
    /// How long it trains.
    pub train: TrainSpec,
    /// Where and how often the trained policy is evaluated.
    pub evaluate: EvaluateSpec,
}

/// How long a run trains, and by which curriculum.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TrainSpec {
    /// Env steps of the whole training, over all copies of the environment, from `n_envs` to 10^12. All copies step
    /// together, so the number made is this one rounded up to a multiple of `n_envs`.
    pub n_steps: u64,
    /// Copies of the environment that step together, 1 to 65 536.
    pub n_envs: usize,
    /// Env steps between two rows of the training metrics, 1 or more.
    pub log_every: u64,
    /// Worlds to train in first, one after the other: say, with wider gaps or fewer obstacles. After the last of them, and
    /// from the start where there is none, episodes are those of `[world]`.
    pub curriculum: Vec<Stage>,
}

/// A part of a curriculum.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// The fraction of all env steps up to which new episodes come from this world, from 0 to 1 and above that of the stage
    /// before.
    pub until: f64,
    /// The world.
    pub world: WorldSpec,
}

/// Where and how often a trained policy is evaluated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct EvaluateSpec {
    /// Episodes in each world, 1 to 10 000 000.
    pub n_episodes: usize,
    /// The seed of the scenarios: the same ones for every cell and training seed.
    pub seed: u64,
    /// A braking shield around whoever drives; none if not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shield: Option<ShieldOption>,
    /// The worlds; results are told apart by their names.
    pub worlds: Vec<EvaluateWorld>,
}

/// One world that policies are evaluated in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EvaluateWorld {
    /// What tables and plots call it; no blanks at either end.
    pub name: String,
    /// After how many seconds an episode counts as timed out, one control period or more.
    pub time_limit: f64,
    /// The world.
    pub world: WorldSpec,
}

impl Default for TrainSpec {
    fn default() -> Self {
        Self { n_steps: 100_000, n_envs: 32, log_every: 10_000, curriculum: Vec::new() }
    }
}

impl Default for EvaluateSpec {
    /// Both rooms of Liu et al.
    fn default() -> Self {
        let world = |name: &str, time_limit, world| EvaluateWorld { name: name.into(), time_limit, world };
        let small = world("10x15", 60.0, WorldSpec::Room10x15 {});
        let large = world("25x25", 100.0, WorldSpec::Room25x25 {});
        Self { n_episodes: 1000, seed: 1_000_000, shield: None, worlds: vec![small, large] }
    }
}

impl Default for RunSpec {
    /// The recommended MDP and learner: `specs/default.toml` with a comment on every number.
    fn default() -> Self {
        Self {
            world: recommended_world(),
            vehicle: VehicleSpec::default(),
            lidar: LidarSpec::default(),
            odometry: OdometrySpec::default(),
            randomize: RandomizeSpec::default(),
            env: EnvSpec::default(),
            policy: PolicySpec::default(),
            reward: Arc::new(recommended_reward()),
            agent: DqnSpec::default(),
            train: TrainSpec::default(),
            evaluate: EvaluateSpec::default(),
        }
    }
}

impl RunSpec {
    /// The decision process that the agent trains in.
    pub fn training(&self) -> NavSpec {
        NavSpec {
            world: self.world.clone(),
            vehicle: self.vehicle.clone(),
            lidar: self.lidar.clone(),
            odometry: self.odometry,
            randomize: self.randomize.clone(),
            env: self.env.clone(),
            reward: Arc::clone(&self.reward),
        }
    }

    /// The shield around whoever is evaluated, if there is one.
    pub fn shield(&self) -> Option<ShieldSpec> {
        self.evaluate.shield.map(|shield| shield.for_vehicle(&self.vehicle, &self.randomize))
    }

    /// The decision process of one evaluation world: its scenarios, its time limit, and one goal per episode.
    ///
    /// ```
    /// use headway_env::GoalHandling;
    /// use headway_experiments::spec::RunSpec;
    /// let run = RunSpec::default();
    /// let large = run.evaluation(&run.evaluate.worlds[1]);
    /// assert_eq!((large.env.time_limit, large.env.goal), (100.0, GoalHandling::Terminate));
    /// ```
    pub fn evaluation(&self, world: &EvaluateWorld) -> NavSpec {
        let env = EnvSpec { time_limit: world.time_limit, goal: GoalHandling::Terminate, ..self.env.clone() };
        NavSpec { world: world.world.clone(), env, ..self.training() }
    }
}

/// Half the small room, half random rooms: a policy trained in one room only is less at home in others.
fn recommended_world() -> WorldSpec {
    let random = RoomSpec {
        width: Interval::Range([6.0, 12.0]),
        height: Interval::Range([6.0, 12.0]),
        obstacles: Quantity::Density(Interval::Range([0.06, 0.12])),
        ..RoomSpec::default()
    };
    let half = |world| WeightedWorld { weight: 0.5, world };
    WorldSpec::Mixture { worlds: vec![half(WorldSpec::Room10x15 {}), half(WorldSpec::Room(random))] }
}

/// Reach and collision, progress, time, and a penalty for being near things.
fn recommended_reward() -> Sum {
    Sum::default()
        .with(1.0, R { no_collision: 0.0, collision: -50.0, reach: 100.0 })
        .with(40.0, Progress::default())
        .with(-2.5, Time {})
        .with(-5.0, Proximity { margin: 0.2 })
}
