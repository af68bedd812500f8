//! How fast training is, measured on a slice of it.

use std::time::{Duration, Instant};

use crate::Error;
use crate::spec::{Cell, RunSpec};
use crate::train::Training;

/// Cells that are measured at most, spread over the grid.
const N_CELLS: usize = 6;
/// How long a cell is measured.
const SLICE: Duration = Duration::from_millis(250);

/// Training time on one core, seconds per env step, as the mean over some of the cells.
///
/// # Errors
/// If a training fails.
pub(super) fn seconds_per_step(cells: &[Cell]) -> Result<f64, Error> {
    let stride = cells.len().div_ceil(N_CELLS).max(1);
    let measured = cells.iter().step_by(stride).map(|cell| measure(&cell.spec));
    let measured = measured.collect::<Result<Vec<f64>, _>>()?;
    Ok(measured.iter().sum::<f64>() / measured.len() as f64)
}

/// The same for one run, without its beginning, in which it neither learns nor asks the network.
fn measure(spec: &RunSpec) -> Result<f64, Error> {
    let mut spec = spec.clone();
    spec.agent.epsilon.start = spec.agent.epsilon.end;
    spec.train.n_steps = spec.train.n_steps.max(spec.agent.warm_up * 2);
    let mut training = Training::new(&spec, 0)?;
    while training.n_env_steps() < spec.agent.warm_up {
        training.step()?;
    }
    let (n_before, start) = (training.n_env_steps(), Instant::now());
    loop {
        training.step()?;
        if training.is_over() || start.elapsed() >= SLICE {
            let n_steps = training.n_env_steps() - n_before;
            return Ok(start.elapsed().as_secs_f64() / n_steps as f64);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_training_shorter_than_its_warm_up_is_measured_too() {
        let mut spec = RunSpec::default();
        spec.train.n_steps = 32;
        let seconds = seconds_per_step(&[Cell { axes: Vec::new(), spec }]).unwrap();
        assert!(seconds > 0.0 && seconds < 1.0, "{seconds}");
    }
}
