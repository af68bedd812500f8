//! What the types cannot say: numbers in range, worlds that can be made, parts that fit together.

use std::collections::BTreeSet;

use headway_env::{EnvError, NavSpec};
use headway_planning::PurePursuit;
use headway_policy::Policy;
use headway_reward::RewardError;
use headway_rl::RlError;
use headway_sim::{BarnSpec, FieldError, FilesSpec, RoomSpec, WorldSpec};

use crate::evaluate::adapt;

use super::names::check_label;
use super::{EvaluateSpec, EvaluateWorld, Fault, KeyPath, PolicySpec, RunSpec, TrainSpec};

impl RunSpec {
    /// Builds everything once, so that what cannot run is found before anything is written; of that it keeps what
    /// [`WorldSource::left_out`](headway_sim::WorldSource::left_out) says of the worlds, those of the training and of the evaluation.
    ///
    /// # Errors
    /// Names the first value that is not allowed, and what is.
    pub fn check(&self) -> Result<BTreeSet<String>, Fault> {
        let mut left_out = BTreeSet::new();
        self.train.check()?;
        self.evaluate.check()?;
        let candidate = self.check_policy()?;
        if self.policy.is_learned() {
            self.agent.validate().map_err(|error| of_agent(&error))?;
            let mdp = self.training().build().map_err(|error| of_env(&error))?;
            left_out.extend(mdp.source().left_out());
            left_out.extend(self.check_curriculum()?);
            check_episodes(&self.training(), &KeyPath::default())?;
            self.check_memory(mdp.obs_dim(), mdp.actions().len())?;
        }
        for (index, world) in self.evaluate.worlds.iter().enumerate() {
            let mut mdp = self.evaluation(world);
            if let Some(policy) = &candidate {
                adapt(&mut mdp.env, policy);
            }
            let built = mdp.build().map_err(|error| in_evaluation(of_env(&error), index))?;
            let at = KeyPath::new(["evaluate", "worlds", &index.to_string()]);
            check_episodes(&mdp, &at).map_err(|fault| in_evaluation(fault, index))?;
            left_out.extend(built.source().left_out());
        }
        Ok(left_out)
    }

    /// How far goals are at least in the worlds of the training, metres.
    pub(crate) fn least_goal_distance(&self) -> f64 {
        nearest_goals(&self.world, KeyPath::default()).0
    }

    /// Builds the world of every stage once: what they leave out.
    fn check_curriculum(&self) -> Result<Vec<String>, Fault> {
        let mut left_out = Vec::new();
        for (index, stage) in self.train.curriculum.iter().enumerate() {
            let mdp = NavSpec { world: stage.world.clone(), ..self.training() };
            let at = KeyPath::new(["train", "curriculum", &index.to_string()]);
            let of_stage = |fault: Fault| match fault.path.segments() {
                [first, ..] if first == "world" => Fault { path: at.extend(&fault.path), ..fault },
                _ => fault,
            };
            let built = mdp.build().map_err(|error| of_stage(of_env(&error)))?;
            check_episodes(&mdp, &at)?;
            left_out.extend(built.source().left_out());
        }
        Ok(left_out)
    }

    /// Refuses a driver with numbers that are not allowed, a file that is no policy for this robot, and such a shield.
    /// The policy of the file, if there is one.
    fn check_policy(&self) -> Result<Option<Policy>, Fault> {
        if let Some(driver) = self.policy.driver() {
            driver.build().map_err(|error| of_field(&error.under("policy")))?;
            driver.suits(&self.vehicle).map_err(|error| of_field(&error.under("vehicle")))?;
        }
        if let Some(shield) = self.shield() {
            shield.build(PurePursuit::default()).map_err(|error| of_field(&error.under("evaluate.shield")))?;
        }
        let PolicySpec::File { path } = &self.policy else { return Ok(None) };
        let policy = Policy::load(path).and_then(|policy| policy.check(&self.vehicle, &self.lidar).map(|()| policy));
        policy.map(Some).map_err(|error| fault("policy.path", &error.to_string()))
    }

    /// Refuses what would need more memory than any machine that this is for: an abort says less.
    fn check_memory(&self, obs_dim: usize, n_actions: usize) -> Result<(), Fault> {
        let agent = &self.agent;
        let layers: Vec<f64> =
            [&[obs_dim], &agent.hidden[..], &[n_actions]].concat().iter().map(|width| *width as f64).collect();
        let n_weights: f64 = layers.windows(2).map(|pair| pair[0] * pair[1]).sum();
        for (path, n_numbers) in [
            // Every observation once; at worst, where every step ends an episode, twice.
            ("agent.replay_capacity", agent.replay_capacity as f64 * obs_dim as f64 * 2.0),
            // Online, target and averaged weights, the gradient, and Adam's two moments.
            ("agent.hidden", n_weights * 6.0),
            // What each layer puts out, and its gradient.
            ("agent.batch_size", agent.batch_size as f64 * layers.iter().sum::<f64>() * 2.0),
            // The n-step queues.
            ("train.n_envs", self.train.n_envs as f64 * agent.n_step as f64 * obs_dim as f64),
        ] {
            let gib = n_numbers * size_of::<f32>() as f64 / f64::from(1 << 30);
            let problem = format!(
                "would need {gib:.0} GiB of memory with {obs_dim} numbers in an observation; at most {MAX_GIB} GiB are allowed"
            );
            require(gib <= MAX_GIB, path, &problem)?;
        }
        Ok(())
    }
}

/// Memory that one part of a run may take, GiB.
const MAX_GIB: f64 = 64.0;

/// Refuses episodes that are over before they begin; `at` is the table that holds the world.
fn check_episodes(mdp: &NavSpec, at: &KeyPath) -> Result<(), Fault> {
    let period = mdp.vehicle.control_period;
    let problem = format!("must be vehicle.control_period, {period} s, or more");
    require(mdp.env.time_limit >= period, "env.time_limit", &problem)?;
    let (distance, room) = nearest_goals(&mdp.world, at.join("world"));
    let problem = format!("must be below every room's start_goal_distance, which is {distance} m in {room}");
    require(mdp.env.reach_radius < distance, "env.reach_radius", &problem)
}

/// The least `start_goal_distance` of the rooms that `world`, which is at a path, may be; and the path of that room.
fn nearest_goals(world: &WorldSpec, at: KeyPath) -> (f64, KeyPath) {
    match world {
        WorldSpec::Room(room) => (room.start_goal_distance, at),
        WorldSpec::Room10x15 {} => (RoomSpec::room_10x15().start_goal_distance, at),
        WorldSpec::Room25x25 {} => (RoomSpec::room_25x25().start_goal_distance, at),
        WorldSpec::Barn(_) => (BarnSpec::goal_rule().distance, at),
        WorldSpec::Files(FilesSpec { start: Some([x, y, _]), goal: Some(goal), .. }) => {
            ((x - goal[0]).hypot(y - goal[1]), at)
        }
        WorldSpec::Files(files) => (files.start_goal_distance, at),
        WorldSpec::Mixture { worlds } => {
            let below = |index: usize| at.join("worlds").join(index.to_string()).join("world");
            let parts = worlds.iter().enumerate().map(|(index, part)| nearest_goals(&part.world, below(index)));
            // There is a part, or the mixture could not have been built.
            parts.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, at.clone()))
        }
    }
}

impl TrainSpec {
    fn check(&self) -> Result<(), Fault> {
        require((1..=65_536).contains(&self.n_envs), "train.n_envs", "must be 1 to 65536")?;
        require(self.log_every >= 1, "train.log_every", "must be 1 or more env steps")?;
        let least = self.n_envs as u64;
        let problem = format!("must be {least} or more: train.n_envs copies of the environment step together");
        require(self.n_steps >= least, "train.n_steps", &problem)?;
        require(self.n_steps <= 1_000_000_000_000, "train.n_steps", "must be 10^12 or less")?;
        let mut before = 0.0;
        for (index, stage) in self.curriculum.iter().enumerate() {
            let is_next = stage.until > before && stage.until <= 1.0;
            let problem = format!("must be above {before} and at most 1: the stages follow each other");
            require(is_next, &format!("train.curriculum.{index}.until"), &problem)?;
            before = stage.until;
        }
        Ok(())
    }
}

impl EvaluateSpec {
    fn check(&self) -> Result<(), Fault> {
        require((1..=10_000_000).contains(&self.n_episodes), "evaluate.n_episodes", "must be 1 to 10000000")?;
        require(!self.worlds.is_empty(), "evaluate.worlds", "must hold at least one world")?;
        for (index, world) in self.worlds.iter().enumerate() {
            world.check(&self.worlds[..index]).map_err(|fault| in_evaluation(fault, index))?;
        }
        Ok(())
    }
}

impl EvaluateWorld {
    fn check(&self, earlier: &[Self]) -> Result<(), Fault> {
        check_label(&self.name).map_err(|problem| fault("name", problem))?;
        let is_new = earlier.iter().all(|other| other.name != self.name);
        require(is_new, "name", "an earlier world has this name; results are told apart by it")
    }
}

fn require(ok: bool, path: &str, problem: &str) -> Result<(), Fault> {
    if ok { Ok(()) } else { Err(fault(path, problem)) }
}

fn fault(path: &str, problem: &str) -> Fault {
    Fault::new(path.split('.'), problem)
}

/// `fault`, found in the decision process or in the entry of the evaluation world `index`.
fn in_evaluation(fault: Fault, index: usize) -> Fault {
    let worlds = KeyPath::new(["evaluate", "worlds", &index.to_string()]);
    let own = match fault.path.segments() {
        [env, key] if env == "env" && key == "time_limit" => worlds.join(key),
        [first, ..] if first == "world" || first == "name" => worlds.extend(&fault.path),
        _ => fault.path,
    };
    Fault { path: own, ..fault }
}

/// What the learner refuses.
fn of_agent(error: &RlError) -> Fault {
    match error {
        RlError::Spec { field, allowed, .. } => {
            fault(&format!("agent.{field}"), &format!("must be {}", in_words(allowed)))
        }
        other => fault("agent", &other.to_string()),
    }
}

/// An interval in words: "[0, 1]" is "in [0, 1]", "> 0" is "above 0".
fn in_words(allowed: &str) -> String {
    match allowed.strip_prefix("> ").or(allowed.strip_prefix(">= ")) {
        Some(bound) if allowed.starts_with(">=") => format!("{bound} or above"),
        Some(bound) => format!("above {bound}"),
        None if allowed.starts_with(['[', '(']) => format!("in {allowed}"),
        None => allowed.to_owned(),
    }
}

fn of_field(error: &FieldError) -> Fault {
    fault(&error.field, &format!("must be {}", error.allowed))
}

/// What the decision process refuses.
fn of_env(error: &EnvError) -> Fault {
    match error {
        EnvError::Field(error) => of_field(error),
        EnvError::World(error) => fault("world", &error.to_string()),
        EnvError::Reward(error) => of_reward(&KeyPath::new(["reward"]), error),
        other => fault("env", &other.to_string()),
    }
}

/// What a reward refuses in its own fields, or in those of a term.
fn of_reward(path: &KeyPath, error: &RewardError) -> Fault {
    match error {
        RewardError::Field { field, allowed, .. } => {
            Fault { path: path.join(*field), problem: format!("must be {allowed}") }
        }
        RewardError::Term { index, source } => {
            let term = path.join("terms").join(index.to_string());
            of_reward(&term.join("reward"), source)
        }
        other => Fault { path: path.clone(), problem: other.to_string() },
    }
}
