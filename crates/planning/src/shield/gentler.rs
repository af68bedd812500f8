//! What to try instead of a vetoed command.

use headway_sim::{Command, VehicleSpec};

/// Shares of the speed, and turns in shares of the greatest yaw rate added towards the straight, of the commands tried
/// instead of a vetoed one.
const GENTLER: [(f64, f64); 16] = [
    (0.75, 0.0),
    (1.0, 0.25),
    (1.0, -0.25),
    (0.5, 0.0),
    (0.75, 0.25),
    (0.75, -0.25),
    (1.0, 0.5),
    (1.0, -0.5),
    (0.5, 0.25),
    (0.5, -0.25),
    (0.25, 0.0),
    (0.5, 0.5),
    (0.5, -0.5),
    (0.25, 0.5),
    (0.25, -0.5),
    (0.1, 0.0),
];

/// What to try instead of a command, the nearest first.
pub(super) fn gentler(vehicle: &VehicleSpec, asked: Command) -> impl Iterator<Item = Command> + use<> {
    let radius = vehicle.drive.turning_radius();
    let most = if radius > 0.0 { vehicle.max_yaw_rate.min(asked.speed.abs() / radius) } else { vehicle.max_yaw_rate };
    let towards_straight = if asked.yaw_rate > 0.0 { -most } else { most };
    let along = move |(share, turn): (f64, f64)| Command {
        speed: asked.speed * share,
        yaw_rate: asked.yaw_rate * share + turn * towards_straight,
        lateral_speed: asked.lateral_speed * share,
    };
    let turns = [asked.yaw_rate, 0.5 * towards_straight, -0.5 * towards_straight];
    let on_the_spot = turns.into_iter().filter(move |_| radius == 0.0).map(|turn| Command::new(0.0, turn));
    GENTLER.into_iter().map(along).chain(on_the_spot)
}
