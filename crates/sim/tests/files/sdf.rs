//! What SDF worlds become, by hand and against a slow reading of the solids themselves.

use std::f64::consts::FRAC_PI_2;

use headway_sim::files::{SdfSpec, Unsupported, parse_sdf};
use headway_sim::nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion};
use headway_sim::{Obstacle, Point, Room, Shape};
use proptest::prelude::*;

use crate::common::{cylinder, document, model, read};

fn one(world: &str) -> Obstacle {
    let file = read(world);
    assert_eq!(file.world.obstacles().len(), 1);
    file.world.obstacles()[0].clone()
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

#[test]
fn upright_solids_keep_their_shape_and_pose() {
    let disc = one(&model("a", "1.5 -2.25 0.5 0 0 0.75", &cylinder(0.3, 1.0)));
    assert_eq!(disc, Obstacle { shape: Shape::Disc { radius: 0.3 }, x: 1.5, y: -2.25, yaw: 0.75 });
    let block = one(&model("a", "1.5 -2.25 0.5 0 0 0.75", "<box><size>2 1 3</size></box>"));
    assert_eq!(block, Obstacle { shape: Shape::Box { length: 2.0, width: 1.0 }, x: 1.5, y: -2.25, yaw: 0.75 });
    let ball = one(&model("a", "0 0 0.5 1 2 3", "<sphere><radius>0.5</radius></sphere>"));
    assert!(matches!(ball.shape, Shape::Disc { radius } if close(radius, 0.4))); // 0.3 below the centre
    let capsule = one(&model("a", "0 0 0.9 0 0 0", "<capsule><radius>0.5</radius><length>0.8</length></capsule>"));
    assert!(matches!(capsule.shape, Shape::Disc { radius } if close(radius, 0.4)));
    let cone = one(&model("a", "0 0 0 0 0 0", "<cone><radius>0.5</radius><length>1</length></cone>"));
    assert!((cone.shape.circumradius() - 0.15).abs() < 2e-4); // 0.7 of the way to the tip, facets outside
    let on_its_head = one(&model("a", "0 0 0 3.141592653589793 0 0", "<box><size>2 1 3</size></box>"));
    assert!(matches!(on_its_head.shape, Shape::Box { length, width } if length == 2.0 && width == 1.0));
}

#[test]
fn what_the_cut_does_not_meet_is_left_out() {
    for z in ["0.71", "-0.31"] {
        assert!(read(&model("a", &format!("0 0 {z} 0 0 0"), &cylinder(0.3, 1.0))).world.obstacles().is_empty());
    }
    let above = SdfSpec { slice_height: 1.0, ..SdfSpec::default() };
    let file = parse_sdf(document(&model("a", "0 0 0 0 0 0", &cylinder(0.3, 1.0))).as_bytes(), &above).unwrap();
    assert!(file.world.obstacles().is_empty());
}

#[test]
fn a_lying_cylinder_becomes_a_strip() {
    // Its axis along x and 0.1 m above the cut: a chord of 2 sqrt(0.5^2 - 0.1^2).
    let strip = one(&model("a", "0 0 0.3 0 1.5707963267948966 0", &cylinder(0.5, 2.0)));
    let corners = strip.shape.vertices();
    let extent = |of: fn(&Point) -> f64| corners.iter().map(of).fold(0.0, |most, x| f64::max(most, 2.0 * x.abs()));
    assert!(close(extent(|p| p.x), 2.0));
    let chord = 2.0 * 0.24_f64.sqrt();
    assert!((chord..chord * 1.003).contains(&extent(|p| p.y)));
}

#[test]
fn planes_are_ground_or_walls() {
    let plane = |normal: &str| format!("<plane><normal>{normal}</normal><size>4 6</size></plane>");
    for ground in ["0 0 1", "0 0 -1", "0.5 0 1"] {
        assert!(read(&model("ground", "0 0 0 0 0 0", &plane(ground))).world.obstacles().is_empty());
    }
    let wall = one(&model("wall", "1 2 0 0 0 0", &plane("1 0 0")));
    let corners = wall.shape.vertices();
    assert!(corners.iter().all(|p| close(p.x.abs(), 0.005) && close(p.y.abs(), 3.0)));
    assert_eq!((wall.x, wall.y), (1.0, 2.0));
}

#[test]
fn poses_are_nested_and_relative() {
    let collision = format!(
        "<collision name='c'><pose>0 0 0 0 0 0.5</pose><geometry>{}</geometry></collision>",
        "<box><size>1 2 3</size></box>"
    );
    let nested = one(&format!(
        "<model name='a'><pose>1 0 0 0 0 {FRAC_PI_2}</pose><model name='b'><pose>1 0 0 0 0 0</pose>\
         <link name='l'><pose>0 1 0 0 0 0</pose>{collision}</link></model></model>"
    ));
    assert!(close(nested.x, 0.0) && close(nested.y, 1.0) && close(nested.yaw, FRAC_PI_2 + 0.5));

    let ball = "<sphere><radius>1</radius></sphere>";
    let relative = format!(
        "<frame name='f' attached_to='a'><pose>0 1 0 0 0 0</pose></frame>\
         <model name='a'><pose degrees='true'>1 0 0 0 0 90</pose></model>\
         <model name='b'><pose relative_to='f'>0 0 0 0 0 0</pose><link name='k'><pose>2 0 0 0 0 0</pose></link>\
         <link name='l'><pose relative_to='k' rotation_format='quat_xyzw'>1 0 0 0 0 0 1</pose><collision name='c'>\
         <pose relative_to='__model__'>0 5 0 0 0 0</pose><geometry>{ball}</geometry></collision></link></model>"
    );
    let ball = one(&relative); // a at (1, 0) turned left, f one to its left at (0, 0), and 5 to the left of that
    assert!(close(ball.x, -5.0) && close(ball.y, 0.0));
}

#[test]
fn scoped_names_lead_into_models() {
    // a at (1, 2) turned left; in it b 3 ahead of it, so at (1, 5), and in b the frame f 1 to its left, at (0, 5).
    let a = format!(
        "<model name='a'><pose>1 2 0 0 0 {FRAC_PI_2}</pose><model name='b'><pose>3 0 0 0 0 0</pose>\
         <frame name='f'><pose>0 1 0 0 0 0</pose></frame></model></model>"
    );
    let disc = one(&(a.clone()
        + &model("c", "0.5 0 0 0 0 0", &cylinder(0.3, 1.0)).replace("<pose>", "<pose relative_to='a::b::f'>")));
    assert!(close(disc.x, 0.0) && close(disc.y, 5.5) && close(disc.yaw, FRAC_PI_2));
    let own =
        one(&(a + &model("c", "0.5 0 0 0 0 0", &cylinder(0.3, 1.0))
            .replace("<pose>", "<pose relative_to='a::__model__'>")));
    assert!(close(own.x, 1.0) && close(own.y, 2.5));
}

#[test]
fn joints_lie_in_their_child_links() {
    // The wheel at (1, 2) turned left, its joint 0.5 ahead of it, at (1, 2.5); the other joint is given in the model itself.
    let ball = "<collision name='c'><geometry><sphere><radius>1</radius></sphere></geometry></collision>";
    let joints = |of: &str| {
        one(&format!(
            "<model name='m'><link name='wheel'><pose>1 2 0 0 0 {FRAC_PI_2}</pose></link>\
             <joint name='j' type='fixed'><pose>0.5 0 0 0 0 0</pose><parent>k</parent><child>wheel</child></joint>\
             <joint name='i' type='fixed'><pose relative_to='__model__'>7 0 0 0 0 0</pose><child>wheel</child></joint>\
             <link name='k'><pose relative_to='{of}'>0.25 0 0 0 0 0</pose>{ball}</link></model>"
        ))
    };
    assert!(close(joints("j").x, 1.0) && close(joints("j").y, 2.75));
    assert!(close(joints("i").x, 7.25) && close(joints("i").y, 0.0));
}

#[test]
fn a_model_is_placed_by_its_placement_frame() {
    // The frame f, 2 ahead of the model and turned left, is put to (5, 5) without a turn: the model is turned right, and 2
    // behind along its own x axis, which points down: at (5, 7). Its link, 1 ahead of it, is at (5, 6).
    let ball = "<collision name='c'><geometry><sphere><radius>1</radius></sphere></geometry></collision>";
    for frame in ["f", "n::g"] {
        let placed = one(&format!(
            "<model name='m' placement_frame='{frame}'><pose>5 5 0 0 0 0</pose><link name='l'><pose>1 0 0 0 0 0</pose>{ball}</link>\
             <frame name='f'><pose>2 0 0 0 0 {FRAC_PI_2}</pose></frame>\
             <model name='n'><pose>2 0 0 0 0 0</pose><frame name='g'><pose>0 0 0 0 0 {FRAC_PI_2}</pose></frame></model></model>"
        ));
        assert!(close(placed.x, 5.0) && close(placed.y, 6.0), "{placed:?}");
    }
}

/// Each of these models once more refers to all within: without a memory, two to the power of thirty steps.
#[test]
fn scoped_names_do_not_multiply() {
    let mut inner = "<frame name='f'/>".to_owned();
    for _ in 0..30 {
        inner = format!(
            "<frame name='f'><pose relative_to='m::f'/></frame><model name='m' placement_frame='f'>{inner}</model>"
        );
    }
    assert!(read(&inner).world.obstacles().is_empty());
}

#[test]
fn a_concave_polyline_covers_its_area() {
    let l: String =
        [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]].map(|[x, y]| format!("<point>{x} {y}</point>")).concat();
    let polyline = format!("<polyline>{l}<height>0.5</height></polyline>");
    for (pose, sine) in [("0 0 0 0 0 0", 0.0), ("0 0 0 0.2 0 0", 0.2_f64.sin())] {
        let file = read(&model("l", pose, &polyline));
        let is_in = |x: f64, y: f64| file.world.distance(&Point::new(x, y)) <= 0.0;
        assert_eq!(file.world.obstacles().len(), 2);
        if sine == 0.0 {
            for (x, y, inside) in [(0.5, 1.9, true), (1.9, 0.5, true), (0.99, 0.99, true), (1.1, 1.1, false)] {
                assert_eq!(is_in(x, y), inside, "{x} {y}");
            }
        } else {
            // Tilted up towards y: at y = 2 the bottom is above the cut, at y = 0 it is below.
            assert!(is_in(0.5, 0.5) && !is_in(0.5, 1.5));
        }
    }
}

#[test]
fn the_room_is_around_all_that_stands() {
    let file =
        read(&(model("a", "1 2 0 0 0 0", &cylinder(0.5, 1.0)) + &model("b", "4 8 0 0 0 0", &cylinder(1.0, 1.0))));
    let Room { x, y, width, height } = file.world.room();
    assert!(close(x, -9.5) && close(y, -8.5) && close(width, 24.5) && close(height, 27.5));
    let empty = read("").world.room();
    assert_eq!((empty.x, empty.width), (-10.0, 20.0));
    let tight = SdfSpec { margin: 0.0, ..SdfSpec::default() };
    let box_of = |at: &str| document(&model("a", at, "<box><size>0.7 0.3 1</size></box>"));
    for at in ["0.1 0.2 0 0 0 0.3", "98765.4321 -1234.567 0 0 0 1"] {
        assert_eq!(parse_sdf(box_of(at).as_bytes(), &tight).unwrap().world.obstacles().len(), 1);
    }
}

#[test]
fn states_and_visuals_are_no_obstacles() {
    let a = model("a", "1 2 0 0 0 0", &cylinder(0.5, 1.0));
    let mesh = "<geometry><mesh><uri>a.dae</uri></mesh></geometry>";
    let visual = format!("<model name='v'><link name='l'><visual name='v'>{mesh}</visual></link></model>");
    let file = read(&format!("{a}<light name='sun'/>{visual}<state world_name='w'>{a}<model name='c'/></state>"));
    assert_eq!(file.world.obstacles().len(), 1);
}

#[test]
fn what_cannot_be_represented_is_listed() {
    let world = model("house", "0 0 0 0 0 0", "<mesh><uri>model://house/house.dae</uri></mesh>")
        + &model("hill", "0 0 0 0 0 0", "<heightmap/>")
        + &model("tree", "0 0 0 0 0 0", &cylinder(0.5, 1.0))
        + "<include><name>sun</name><uri>model://sun</uri></include><actor name='walker'/><population name='crowd'/>";
    let ignore = SdfSpec { unsupported: Unsupported::Ignore, ..SdfSpec::default() };
    let file = parse_sdf(document(&world).as_bytes(), &ignore).unwrap();
    assert_eq!(file.world.obstacles().len(), 1);
    let listed = [
        "model 'house', link 'link', collision 'collision': mesh 'model://house/house.dae'",
        "model 'hill', link 'link', collision 'collision': heightmap",
        "include: 'model://sun'",
        "actor 'walker'",
        "population 'crowd'",
    ];
    assert_eq!(file.unsupported, listed);
    let error = parse_sdf(document(&world).as_bytes(), &SdfSpec::default()).unwrap_err().to_string();
    assert!(listed.iter().all(|name| error.contains(name)) && error.contains("unsupported = \"ignore\""), "{error}");
}

/// Solids that are asked in three dimensions whether they hold a point.
fn holds(kind: usize, p: &Point3<f64>) -> bool {
    let aside = p.xy().coords.norm();
    match kind {
        0 => p.x.abs() <= 0.5 && p.y.abs() <= 1.0 && p.z.abs() <= 0.25,
        1 => aside <= 0.5 && p.z.abs() <= 1.0,
        2 => (p - Point3::new(0.0, 0.0, p.z.clamp(-0.5, 0.5))).norm() <= 0.4,
        _ => p.z.abs() <= 0.5 && aside <= 0.8 * (0.5 - p.z),
    }
}

const KINDS: [&str; 4] = [
    "<box><size>1 2 0.5</size></box>",
    "<cylinder><radius>0.5</radius><length>2</length></cylinder>",
    "<capsule><radius>0.4</radius><length>1</length></capsule>",
    "<cone><radius>0.8</radius><length>1</length></cone>",
];

proptest! {
    #[test]
    fn a_cut_holds_just_the_solid_at_its_height(
        kind in 0..4_usize, z in -1.2..1.6_f64,
        roll in -3.2..3.2_f64, pitch in -1.6..1.6_f64, yaw in -3.2..3.2_f64,
        points in prop::collection::vec((-1.5..1.5_f64, -1.5..1.5_f64), 100),
    ) {
        let file = read(&model("a", &format!("0.5 -0.5 {z} {roll} {pitch} {yaw}"), KINDS[kind]));
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        let pose = Isometry3::from_parts(Translation3::new(0.5, -0.5, z), rotation);
        for (x, y) in points {
            let point = Point::new(0.5 + x, -0.5 + y);
            let is_in_solid = holds(kind, &(pose.inverse() * Point3::new(point.x, point.y, 0.2)));
            let apart = file.world.distance(&point);
            if is_in_solid {
                prop_assert!(apart <= 1e-9 || file.world.obstacles().is_empty());
            } else {
                // Facets lie outside by no more than a share of the size, flat cuts magnify it along their length.
                prop_assert!(apart >= -0.05, "{apart} at {x} {y}");
            }
        }
    }
}
