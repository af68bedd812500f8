//! What the types cannot say: numbers in range, worlds that can be made, parts that fit together.

use headway_env::EnvError;
use headway_reward::RewardError;
use headway_rl::RlError;

use super::{EvaluateSpec, EvaluateWorld, Fault, KeyPath, RunSpec, TrainSpec};

impl RunSpec {
    /// Builds everything once and throws it away, so that what cannot run is found before anything is written.
    ///
    /// # Errors
    /// Names the first value that is not allowed, and what is.
    pub fn check(&self) -> Result<(), Fault> {
        self.train.check()?;
        self.evaluate.check()?;
        self.agent.validate().map_err(|error| of_agent(&error))?;
        self.training().build().map_err(|error| of_env(&error))?;
        for (index, world) in self.evaluate.worlds.iter().enumerate() {
            let built = self.evaluation(world).build();
            built.map_err(|error| in_evaluation(of_env(&error), index))?;
        }
        Ok(())
    }
}

impl TrainSpec {
    fn check(&self) -> Result<(), Fault> {
        require(self.n_envs >= 1, "train.n_envs", "must be 1 or more")?;
        require(self.log_every >= 1, "train.log_every", "must be 1 or more env steps")?;
        let least = self.n_envs as u64;
        let problem = format!("must be {least} or more: train.n_envs copies of the environment step together");
        require(self.n_steps >= least, "train.n_steps", &problem)
    }
}

impl EvaluateSpec {
    fn check(&self) -> Result<(), Fault> {
        require(self.n_episodes >= 1, "evaluate.n_episodes", "must be 1 or more")?;
        require(!self.worlds.is_empty(), "evaluate.worlds", "must hold at least one world")?;
        for (index, world) in self.worlds.iter().enumerate() {
            world.check(&self.worlds[..index]).map_err(|fault| in_evaluation(fault, index))?;
        }
        Ok(())
    }
}

impl EvaluateWorld {
    fn check(&self, earlier: &[Self]) -> Result<(), Fault> {
        require(!self.name.trim().is_empty(), "name", "must not be empty")?;
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

/// What the decision process refuses.
fn of_env(error: &EnvError) -> Fault {
    match error {
        EnvError::Field(error) => fault(&error.field, &format!("must be {}", error.allowed)),
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
