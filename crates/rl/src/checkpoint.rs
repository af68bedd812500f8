//! The whole state of an agent as a stream of MessagePack values.

use std::fmt::Debug;
use std::io::{Read, Write};

use rand_chacha::ChaCha8Rng;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::adam::N_ROWS;
use crate::learner::LearnerState;
use crate::n_step::NStepQueues;
use crate::observations::Observations;
use crate::replay::Replay;
use crate::{Dqn, RlError};

/// Raise it whenever the stream changes.
const VERSION: u32 = 2;

/// What two agents must share to share a state; read first, so that a mismatch is named rather than stumbled over.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Header {
    agent: String,
    version: u32,
    widths: Vec<usize>,
    n_envs: usize,
    n_step: usize,
    gamma: f32,
    replay_capacity: usize,
}

/// Weights and moments, as the learner has them in memory, with the counters.
#[derive(Serialize, Deserialize)]
struct Numbers {
    n_env_steps: u64,
    n_gradient_steps: u64,
    n_adam_steps: u64,
    #[serde(with = "f32_bytes")]
    memory: Vec<f32>,
}

/// Writes header, numbers, random streams, observations, queues and replay, in this order.
pub(crate) fn save(agent: &Dqn, mut w: &mut dyn Write) -> Result<(), RlError> {
    write(&mut w, &Header::of(agent))?;
    write(&mut w, &Numbers::of(agent)?)?;
    write(&mut w, &(&agent.exploration_rng, &agent.replay_rng))?;
    write(&mut w, &(&agent.observations, &agent.queues, &agent.replay))
}

/// Reads everything, checks it, and only then touches the agent.
pub(crate) fn load(agent: &mut Dqn, mut r: &mut dyn Read) -> Result<(), RlError> {
    read::<Header>(&mut r)?.check(&Header::of(agent))?;
    let numbers: Numbers = read(&mut r)?;
    let network = &agent.learner.network;
    sound("the number of weights", numbers.memory.len() == N_ROWS * network.n_weights())?;
    let (exploration_rng, replay_rng): (ChaCha8Rng, ChaCha8Rng) = read(&mut r)?;
    let (mut observations, queues, replay): (Observations, NStepQueues, Replay) = read(&mut r)?;
    sound("the n-step queues", queues.fits(&agent.queues, network.n_actions()))?;
    sound("the replay", replay.fits(&agent.replay, network.n_actions()))?;
    let holds = queues.holds().chain(replay.holds());
    sound("the observations", observations.recount(network.obs_dim(), holds))?;
    agent.n_env_steps = numbers.n_env_steps;
    agent.learner.set_state(&numbers.learner())?;
    (agent.exploration_rng, agent.replay_rng) = (exploration_rng, replay_rng);
    (agent.observations, agent.queues, agent.replay) = (observations, queues, replay);
    Ok(())
}

impl Header {
    fn of(agent: &Dqn) -> Self {
        Self {
            agent: "headway-rl/dqn".to_owned(),
            version: VERSION,
            widths: agent.learner.network.widths.clone(),
            n_envs: agent.n_envs,
            n_step: agent.queues.n_step(),
            gamma: agent.queues.gamma(),
            replay_capacity: agent.replay.capacity(),
        }
    }

    /// Fails with the first field that differs.
    fn check(&self, expected: &Self) -> Result<(), RlError> {
        same("agent", &self.agent, &expected.agent)?;
        same("version", &self.version, &expected.version)?;
        same("widths", &self.widths, &expected.widths)?;
        same("n_envs", &self.n_envs, &expected.n_envs)?;
        same("n_step", &self.n_step, &expected.n_step)?;
        same("gamma", &self.gamma, &expected.gamma)?;
        same("replay_capacity", &self.replay_capacity, &expected.replay_capacity)
    }
}

impl Numbers {
    fn of(agent: &Dqn) -> Result<Self, RlError> {
        let LearnerState { n_gradient_steps, n_adam_steps, memory } = agent.learner.state()?;
        Ok(Self { n_env_steps: agent.n_env_steps, n_gradient_steps, n_adam_steps, memory })
    }

    fn learner(self) -> LearnerState {
        let Self { n_gradient_steps, n_adam_steps, memory, .. } = self;
        LearnerState { n_gradient_steps, n_adam_steps, memory }
    }
}

/// Appends one value to a stream.
pub(crate) fn write<T: Serialize>(w: &mut &mut dyn Write, value: &T) -> Result<(), RlError> {
    Ok(rmp_serde::encode::write(w, value)?)
}

/// Takes one value from a stream, and not a byte more.
pub(crate) fn read<T: DeserializeOwned>(r: &mut &mut dyn Read) -> Result<T, RlError> {
    Ok(rmp_serde::decode::from_read(r)?)
}

/// Fails with the field's name and both values, unless they are equal.
pub(crate) fn same<T: PartialEq + Debug>(field: &'static str, found: &T, expected: &T) -> Result<(), RlError> {
    if found == expected {
        return Ok(());
    }
    Err(RlError::StateMismatch { field, found: format!("{found:?}"), expected: format!("{expected:?}") })
}

pub(crate) fn sound(what: &'static str, ok: bool) -> Result<(), RlError> {
    if ok { Ok(()) } else { Err(RlError::CorruptState { what }) }
}

/// `Vec<f32>` as one run of little-endian bytes: an eighth of the time and four fifths of the size of a list of floats.
pub(crate) mod f32_bytes {
    use std::fmt;

    use serde::de::{Error, Visitor};
    use serde::{Deserializer, Serializer, ser};

    pub(crate) fn serialize<S: Serializer>(values: &[f32], serializer: S) -> Result<S::Ok, S::Error> {
        if 4 * values.len() as u64 > u64::from(u32::MAX) {
            // What MessagePack has room for; rmp itself would cut the length and say nothing.
            return Err(ser::Error::custom("a checkpoint holds up to 4 GiB of observations: lower replay_capacity"));
        }
        let mut bytes = Vec::with_capacity(4 * values.len());
        for value in values {
            bytes.extend_from_slice(&value.to_le_bytes());
        }
        serializer.serialize_bytes(&bytes)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f32>, D::Error> {
        struct Bytes;

        impl Visitor<'_> for Bytes {
            type Value = Vec<f32>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a multiple of four bytes")
            }

            fn visit_bytes<E: Error>(self, bytes: &[u8]) -> Result<Self::Value, E> {
                match bytes.as_chunks::<4>() {
                    (chunks, []) => Ok(chunks.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect()),
                    _ => Err(E::invalid_length(bytes.len(), &self)),
                }
            }
        }

        deserializer.deserialize_bytes(Bytes)
    }
}
