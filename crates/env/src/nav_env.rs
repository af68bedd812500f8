//! Many vehicles in lock-step.

use std::io::{Read, Write};
use std::num::NonZeroUsize;
use std::sync::Arc;

use headway_planning::Sensed;
use headway_sim::{Command, WorldSpec};
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::{Deserialize, Serialize};

use crate::error::check_len;
use crate::navigator::NavigatorState;
use crate::shard::{Episodes, Shard};
use crate::{Env, EnvError, Mdp, Navigator, Step, StepEnd};

/// Independent navigators of one MDP behind [`Env`].
///
/// Copy `i` of `n` drives in the scenarios `i`, `i + n`, `i + 2 n`, ... of the seed: which scenario comes
/// next does not depend on what the other copies do. On one thread a step allocates memory
/// only for new episodes and new goals, for scans of more than 4096 beams, for crowds, and for planned routes.
#[derive(Debug, Clone)]
pub struct NavEnv {
    mdp: Arc<Mdp>,
    n_envs: usize,
    seed: u64,
    /// Empty before the first reset.
    navigators: Vec<Navigator>,
    /// The scenario that each copy drives in.
    scenarios: Vec<u64>,
    /// The threads that step; none where the caller's own does.
    threads: Option<Arc<ThreadPool>>,
}

/// What [`Env::save`] writes.
#[derive(Serialize, Deserialize)]
struct SavedState {
    seed: u64,
    scenarios: Vec<u64>,
    navigators: Vec<NavigatorState>,
}

impl NavEnv {
    /// `n_envs` copies of an MDP, to be reset before the first step.
    #[must_use]
    pub fn new(mdp: Arc<Mdp>, n_envs: usize) -> Self {
        Self { mdp, n_envs, seed: 0, navigators: Vec::new(), scenarios: Vec::new(), threads: None }
    }

    /// The same environments, stepped by `n_threads` threads. The results are the same for any number of them.
    ///
    /// Pays where there are some hundreds of copies; see `docs/benchmarks.md`. Up to 64 are stepped by the calling thread.
    /// Where many runs go on side by side, they use the cores better.
    ///
    /// # Errors
    /// If the threads cannot be started.
    ///
    /// ```
    /// use headway_env::{Env, NavEnv, NavSpec, Step};
    /// use std::num::NonZeroUsize;
    /// let alone = NavEnv::new(NavSpec::default().build()?, 200);
    /// let sharded = alone.clone().on_threads(NonZeroUsize::new(2).unwrap())?;
    /// let steps = [alone, sharded].map(|mut env| {
    ///     let mut step = Step::new(200, env.obs_dim());
    ///     env.reset(0, &mut step.obs).unwrap();
    ///     env.step(&[4; 200], &mut step).unwrap();
    ///     step
    /// });
    /// assert_eq!(steps[0], steps[1]);
    /// # Ok::<(), headway_env::EnvError>(())
    /// ```
    pub fn on_threads(mut self, n_threads: NonZeroUsize) -> Result<Self, EnvError> {
        self.threads = match n_threads.get() {
            1 => None,
            n => Some(Arc::new(ThreadPoolBuilder::new().num_threads(n).build()?)),
        };
        Ok(self)
    }

    /// The MDP.
    #[must_use]
    pub fn mdp(&self) -> &Arc<Mdp> {
        &self.mdp
    }

    /// Lets all episodes that begin from now on take place in another world.
    ///
    /// # Errors
    /// If the world's numbers are not allowed, or what is in it cannot be placed.
    pub fn set_world(&mut self, world: &WorldSpec) -> Result<(), EnvError> {
        let source = world.build(self.mdp.vehicle().footprint())?;
        self.mdp = Arc::new(Mdp { source, ..Mdp::clone(&self.mdp) });
        for navigator in &mut self.navigators {
            navigator.set_mdp(Arc::clone(&self.mdp));
        }
        Ok(())
    }

    /// The vehicles, one per copy; none before the first reset.
    #[must_use]
    pub fn navigators(&self) -> &[Navigator] {
        &self.navigators
    }

    /// What the vehicle of copy `index` perceives.
    ///
    /// # Panics
    /// If there is no such copy, or before the first reset.
    #[must_use]
    pub fn sensed(&self, index: usize) -> Sensed<'_> {
        self.navigators[index].sensed()
    }

    /// As [`Env::step`], with a continuous command in place of every action.
    ///
    /// # Errors
    /// If a next episode could not be started.
    pub fn step_commands(&mut self, commands: &[Command], out: &mut Step) -> Result<(), EnvError> {
        check_len("commands", commands.len(), self.n_envs)?;
        self.step_all(out, |navigator, index| navigator.drive(commands[index]))
    }

    fn step_all(
        &mut self,
        out: &mut Step,
        advance: impl Fn(&mut Navigator, usize) -> Result<StepEnd, EnvError> + Sync,
    ) -> Result<(), EnvError> {
        check_len("reset environments", self.navigators.len(), self.n_envs)?;
        out.check(self.n_envs, self.mdp.obs_dim())?;
        let episodes = Episodes { seed: self.seed, stride: self.n_envs as u64 };
        let shard = Shard::all(&mut self.navigators, &mut self.scenarios, out);
        match &self.threads {
            Some(threads) if self.n_envs > Shard::GRAIN => {
                threads.install(|| shard.step_on_threads(episodes, &advance))
            }
            _ => shard.step(episodes, &advance),
        }
    }
}

impl Env for NavEnv {
    fn n_envs(&self) -> usize {
        self.n_envs
    }

    fn obs_dim(&self) -> usize {
        self.mdp.obs_dim()
    }

    fn n_actions(&self) -> usize {
        self.mdp.actions().len()
    }

    fn reset(&mut self, seed: u64, obs: &mut [f32]) -> Result<(), EnvError> {
        check_len("obs", obs.len(), self.n_envs * self.obs_dim())?;
        let scenarios: Vec<u64> = (0..self.n_envs as u64).collect();
        let make = |index: &u64| Navigator::new(Arc::clone(&self.mdp), seed, *index);
        let navigators = scenarios.iter().map(make).collect::<Result<_, _>>()?;
        (self.seed, self.scenarios, self.navigators) = (seed, scenarios, navigators);
        let rows = obs.chunks_exact_mut(self.mdp.obs_dim());
        self.navigators.iter().zip(rows).for_each(|(navigator, row)| navigator.observe(row));
        Ok(())
    }

    fn step(&mut self, actions: &[u32], out: &mut Step) -> Result<(), EnvError> {
        check_len("actions", actions.len(), self.n_envs)?;
        let n_actions = self.n_actions();
        if let Some(index) = actions.iter().position(|action| *action as usize >= n_actions) {
            return Err(EnvError::NoSuchAction { action: actions[index], index, n_actions });
        }
        self.step_all(out, |navigator, index| navigator.act(actions[index]))
    }

    fn save(&self, mut to: &mut dyn Write) -> Result<(), EnvError> {
        let saved = SavedState {
            seed: self.seed,
            scenarios: self.scenarios.clone(),
            navigators: self.navigators.iter().map(|navigator| navigator.state.clone()).collect(),
        };
        Ok(rmp_serde::encode::write(&mut to, &saved)?)
    }

    fn load(&mut self, from: &mut dyn Read) -> Result<(), EnvError> {
        let saved: SavedState = rmp_serde::decode::from_read(from)?;
        let (found, expected) = (saved.navigators.len(), self.n_envs);
        if found != expected || saved.scenarios.len() != expected {
            return Err(EnvError::StateMismatch { what: "environments", found, expected });
        }
        let restore = |state| Navigator::with_state(Arc::clone(&self.mdp), state);
        let navigators = saved.navigators.into_iter().map(restore).collect::<Result<_, _>>()?;
        (self.seed, self.scenarios, self.navigators) = (saved.seed, saved.scenarios, navigators);
        Ok(())
    }
}
