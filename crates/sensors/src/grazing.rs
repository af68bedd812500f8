//! How steeply a beam meets a surface.

use headway_sim::{Outline, Point, Surface, World};
use nalgebra::Vector2;

/// How far from a surface the end of a beam may lie, metres: the scan's own error and rounding.
const REACH: f64 = 5e-3;

/// The sine of the angle between a beam and the surface that it ends on: 1 head-on, 0 along it; 1 where it ends on nothing.
pub(crate) fn sine(world: &World, end: &Point, direction: &Vector2<f64>) -> f64 {
    let on_wall =
        world.room().to_walls(end).into_iter().enumerate().map(|(index, room)| (room.abs(), Surface::Wall(index)));
    let on_obstacles = world.obstacles_near(end, REACH).map(|index| {
        let surface = Surface::Obstacle(index);
        (world.distance_to(surface, end).abs(), surface)
    });
    let nearest = on_wall.chain(on_obstacles).min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, surface)) = nearest.filter(|(distance, _)| *distance <= REACH) else { return 1.0 };
    normal(&world.outline(surface), end).map_or(1.0, |normal| normal.dot(direction).abs())
}

/// The unit normal of an outline at the point of it nearest to `end`.
fn normal(outline: &Outline<'_>, end: &Point) -> Option<Vector2<f64>> {
    let across = |a: &Point, b: &Point| (b - a).try_normalize(0.0).map(|along| Vector2::new(along.y, -along.x));
    match outline {
        Outline::Disc { center, .. } => (end - center).try_normalize(0.0),
        Outline::Wall([a, b]) => across(a, b),
        Outline::Polygon(corners) => {
            let edges = corners.iter().zip(corners.iter().cycle().skip(1));
            let distance = |(a, b): &(&Point, &Point)| {
                let along = *b - *a;
                let share = (along.dot(&(end - *a)) / along.norm_squared()).clamp(0.0, 1.0);
                (*a + along * share - end).norm()
            };
            let (a, b) = edges.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
            across(a, b)
        }
    }
}
