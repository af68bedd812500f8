//! The binary's `evaluate` by a protocol and with classical drivers, on small worlds.

use std::f64::consts::FRAC_PI_2;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

use headway_env::ActionSpec;
use headway_policy::{Header, Layer, Policy};
use headway_sim::files::{WorldFile, write_sdf};
use headway_sim::{GoalRule, Obstacle, Point, Pose, Room, Scenario, Shape, VehicleSpec, World};
use npyz::WriterBuilder;
use serde_json::Value;

/// A folder with `worlds/world_1.world` and `world_2.world`, of which only the first has a path in `paths`.
struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        for name in ["worlds", "paths"] {
            fs::create_dir(folder.path().join(name)).unwrap();
        }
        let bench = Self { folder };
        bench.write_world("world_1", &[]);
        bench.write_world("world_2", &[[-2.0, 8.0], [-1.0, 6.0]]);
        // Straight up: cells (17, 0) to (17, 40) lie at x = -2.025.
        let cells: Vec<i64> = (0..=40).flat_map(|j| [17, j]).collect();
        let mut bytes = Vec::new();
        let options = npyz::WriteOptions::new().default_dtype().shape(&[41, 2]);
        let mut writer = options.writer(&mut bytes).begin_nd().unwrap();
        writer.extend(cells).unwrap();
        writer.finish().unwrap();
        fs::write(bench.path("paths/path_1.npy"), bytes).unwrap();
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// A room around the protocol's start and goal with posts in it.
    fn write_world(&self, name: &str, posts: &[[f64; 2]]) {
        let post = |[x, y]: &[f64; 2]| Obstacle { shape: Shape::Disc { radius: 0.3 }, x: *x, y: *y, yaw: 0.0 };
        let room = Room { x: -6.0, y: 0.0, width: 8.0, height: 16.0 };
        let world = World::new(room, posts.iter().map(post).collect()).unwrap();
        let start = Pose::new([-2.0, 3.0].into(), FRAC_PI_2);
        let rule = GoalRule { distance: 4.0, clearance: 0.2 };
        let scenario = Scenario::new(world, start, Point::new(-2.0, 13.0), rule).unwrap();
        write_sdf(&self.path(&format!("worlds/{name}.world")), &WorldFile::of_scenario(name, &scenario)).unwrap();
    }

    /// A policy that drives straight on at 1.5 m/s, for this vehicle.
    fn write_policy(&self, vehicle: VehicleSpec) -> Policy {
        let header = Header { vehicle, ..Header::default() };
        let ActionSpec::SetPoints { speeds, yaw_rates, .. } = &header.actions else { panic!("set points by default") };
        let n = speeds.len() * yaw_rates.len();
        let mut bias = vec![0.0; n];
        bias[n - yaw_rates.len().div_ceil(2)] = 1.0;
        let layer = Layer { weight: vec![0.0; n * header.obs_dim().unwrap()], bias };
        let policy = Policy::new(header, vec![layer]).unwrap();
        policy.save(&self.path("straight.safetensors")).unwrap();
        policy
    }

    fn evaluate(&self, args: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
        command.current_dir(self.folder.path()).arg("evaluate").args(args).output().unwrap()
    }

    fn succeed(&self, args: &[&str]) -> String {
        let output = self.evaluate(args);
        assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }

    fn fail(&self, args: &[&str]) -> String {
        let output = self.evaluate(args);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{args:?}: {errors}");
        errors
    }
}

const BARN: [&str; 4] = ["--protocol", "barn", "--worlds", "worlds"];

fn with<'a>(policy: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&[policy], &BARN[..], more].concat()
}

#[test]
fn a_classical_driver_by_the_protocol() {
    let bench = Bench::new();
    let noise = ["--set", "vehicle.actuation.noise=0.1", "--runs", "3", "--format", "json"];
    let one = bench.succeed(&with("dwa", &[&noise[..], &["--jobs", "1"]].concat()));
    let two = bench.succeed(&with("dwa", &[&noise[..], &["--jobs", "2"]].concat()));
    assert_eq!(one, two);
    let other_seed = bench.succeed(&with("dwa", &[&noise[..], &["--seed", "3"]].concat()));
    assert_ne!(one, other_seed);
    let report: Value = serde_json::from_str(&one).unwrap();
    let keys = |value: &Value| value.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    assert_eq!(keys(&report), ["conditions", "deterministic", "over_worlds", "overall", "references", "worlds"]);
    assert_eq!((&report["deterministic"], &report["over_worlds"]), (&false.into(), &Value::Null));
    let mut expected =
        ["collision", "mean_time", "runs", "score_2022", "score_2023", "success", "timeout", "world"].to_vec();
    for world in report["worlds"].as_array().unwrap() {
        assert_eq!(keys(world), expected);
        assert_eq!((&world["runs"], &world["success"], &world["timeout"]), (&3.into(), &1.0.into(), &0.0.into()));
    }
    let overall = &report["overall"];
    assert_eq!((&overall["world"], &overall["runs"]), (&"all".into(), &6.into()));
    for rate in ["success", "collision", "timeout"] {
        expected.extend(match rate {
            "success" => ["success_low", "success_high"],
            "collision" => ["collision_low", "collision_high"],
            _ => ["timeout_low", "timeout_high"],
        });
    }
    expected.sort_unstable();
    assert_eq!(keys(overall), expected);
    // 9 m less the first 0.1 m at no more than 0.5 m/s, and the optimal time is some 5 s: by the first rule they score the same.
    let first = &report["worlds"][0];
    let time = first["mean_time"].as_f64().unwrap();
    assert!((17.7..19.0).contains(&time), "{time}");
    assert_eq!(first["score_2022"], 0.25);
    assert!((first["score_2023"].as_f64().unwrap() - 5.0 / time).abs() < 0.01);
}

#[test]
fn a_table_says_what_it_rests_on() {
    let bench = Bench::new();
    let random = [
        "--set",
        "lidar.noise=0.02",
        "--set",
        "policy.desired_linear_vel=0.4",
        "--set",
        "vehicle.actuation.latency=0.1",
    ];
    let table = bench.succeed(&with("pure_pursuit", &[&["--runs", "2", "--seed", "7"], &random[..]].concat()));
    for part in [
        "world_1         2      100.0",
        "driver       pure_pursuit, but desired_linear_vel = 0.4\n",
        "shield       none\n",
        "a command every 0.05 s: jackal, but actuation.latency = 0.1, control_period = 0.05\n",
        "actuation    latency 0.1 s,",
        "lidar        720 beams over 270 deg, 0.1 to 10 m, noise 0.02 m",
        "route        planned over what the scans have shown, but costmap.footprint",
        "runs         2 in each world, seed 7\n",
        "simulator    Headway's, not Gazebo\n",
        "OT from      no path file for world_2:",
    ] {
        assert!(table.contains(part), "{part} is missing in\n{table}");
    }
    let shielded = bench.succeed(&with("pure_pursuit", &["--runs", "1", "--shield", "--world", "world_1"]));
    assert!(shielded.contains("shield       margin 0.05 m"), "{shielded}");
    assert!(shielded.contains("score   score  vetoes   stops\n"), "{shielded}");
    assert!(shielded.contains("vetoes       commands that the shield") && !table.contains("vetoes"), "{shielded}");
    assert!(shielded.contains("OT from      path files\n"), "{shielded}");
}

#[test]
fn where_nothing_is_random_one_run_stands_for_all() {
    let bench = Bench::new();
    let run = |args: &[&str]| {
        let output = bench.evaluate(&with("pure_pursuit", args));
        [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap())
    };
    let [table, errors] = run(&["--runs", "5"]);
    assert!(table.contains("world_1         1      100.0"), "{table}");
    assert!(table.contains("runs         1 in each world: nothing here is random"), "{table}");
    assert!(errors.contains("--runs 5: one run in each world"), "{errors}");
    let [by_default, errors] = run(&[]);
    assert!(by_default == table && !errors.contains("--runs"), "{errors}");
    let report: Value = serde_json::from_str(&run(&["--runs", "5", "--format", "json"])[0]).unwrap();
    assert_eq!((&report["deterministic"], &report["conditions"]["runs"]), (&true.into(), &1.into()));
    assert_eq!((&report["worlds"][0]["runs"], &report["overall"]["runs"]), (&1.into(), &2.into()));
    // The worlds' parent will do, too.
    assert_eq!(table, bench.succeed(&["pure_pursuit", "--protocol", "barn", "--worlds", "."]));
}

#[test]
fn json_holds_conditions_and_references() {
    let bench = Bench::new();
    bench.write_world("world_5", &[]);
    let args = ["--runs", "2", "--set", "vehicle.actuation.noise=0.1", "--shield", "--format", "json"];
    let report: Value = serde_json::from_str(&bench.succeed(&with("dwa", &args))).unwrap();
    let conditions = &report["conditions"];
    assert_eq!((&conditions["driver"]["type"], &conditions["driver"]["name"]), (&"driver".into(), &"dwa".into()));
    assert_eq!(conditions["driver"]["changed"]["escape"], "always");
    assert_eq!(
        (&conditions["vehicle"]["preset"], &conditions["vehicle"]["max_speed"]),
        (&"jackal".into(), &2.0.into())
    );
    assert_eq!(conditions["vehicle"]["changed"]["actuation.noise"], 0.1);
    assert_eq!((&conditions["lidar"]["n_beams"], &conditions["route"]["type"]), (&720.into(), &"scans".into()));
    assert_eq!((&conditions["runs"], &conditions["shield"]["margin"]), (&2.into(), &0.05.into()));
    let [first, second] = [0, 1].map(|index| &report["references"][index]);
    assert_eq!((&first["world"], &first["source"]), (&"world_1".into(), &"file".into()));
    assert!(first["file"].as_str().unwrap().ends_with("paths/path_1.npy"));
    assert_eq!((&second["source"], &second["file"]), (&"planned".into(), &Value::Null));
    // 10 m straight ahead, and a little around a post: at 2 m/s.
    for (reference, most) in [(first, 5.1), (second, 5.4)] {
        let time = reference["optimal_time"].as_f64().unwrap();
        assert!((5.0..most).contains(&time), "{reference}");
        assert_eq!(reference["reference_length"].as_f64().unwrap(), 2.0 * time);
    }
    // Three worlds: an interval with the world as the unit.
    let (over, overall) = (&report["over_worlds"], &report["overall"]);
    assert_eq!((&over["n_worlds"], &over["score_2023"]["n"]), (&3.into(), &3.into()));
    assert!(over["success"]["low"].as_f64() <= overall["success_low"].as_f64());
    assert_eq!(over["success"]["effective_n"], 3.0, "all runs end alike: {over}");
}

#[test]
fn a_policy_file_by_the_protocol() {
    let bench = Bench::new();
    bench.write_policy(VehicleSpec { max_acceleration: 2.0, ..VehicleSpec::default() });
    let args = with("straight.safetensors", &["--runs", "1", "--format", "json"]);
    let report: Value = serde_json::from_str(&bench.succeed(&args)).unwrap();
    let outcomes = |key: &str| [0, 1].map(|world| report["worlds"][world][key].as_f64().unwrap());
    assert_eq!((outcomes("success"), outcomes("collision")), ([1.0, 0.0], [0.0, 1.0]));
    // 1.5 m/s are reached after 0.75 s and 0.5625 m; the clock starts in the second period, after 0.16 m, and the goal's edge is 9 m on.
    let time = report["worlds"][0]["mean_time"].as_f64().unwrap();
    assert!((time - 6.0).abs() < 0.2 + 1e-9, "{time}");
    assert_eq!(report["worlds"][0]["score_2022"], 0.25);
    // A shield stops it in front of the post.
    let shielded = bench.succeed(&[&args[..], &["--shield"]].concat());
    let shielded: Value = serde_json::from_str(&shielded).unwrap();
    assert_eq!(shielded["worlds"][1]["collision"], 0.0);
    // Nothing is in the way in the first world; in the second it may turn before the post, and not drive on, for most of the time.
    let share = |row: &Value, of: &str| row[of].as_f64().unwrap();
    let [free, post] = [0, 1].map(|world| &shielded["worlds"][world]);
    assert_eq!((share(free, "vetoes"), share(free, "stops")), (0.0, 0.0));
    assert!(share(post, "vetoes") > 0.9 && (0.0..1.0).contains(&share(post, "stops")), "{post}");
    let all = share(&shielded["overall"], "vetoes");
    assert!(0.0 < all && all < share(post, "vetoes"), "{all}");
    assert!(report["overall"].get("vetoes").is_none());
}

#[test]
fn one_world_as_a_picture() {
    let bench = Bench::new();
    let table = bench.succeed(&with("dwa", &["--runs", "1", "--world", "world_2", "--plot", "drive.svg"]));
    assert!(table.contains("world_2") && !table.contains("world_1"));
    let svg = fs::read_to_string(bench.path("drive.svg")).unwrap();
    assert!(svg.contains("world_2, run 0") && svg.contains("success after"), "{svg}");
}

#[test]
fn a_classical_driver_in_the_worlds_of_a_spec() {
    let bench = Bench::new();
    fs::write(bench.path("spec.toml"), "[evaluate]\nn_episodes = 5\n").unwrap();
    let args = ["pure_pursuit", "--spec", "spec.toml", "--format", "json", "--set", "env.route.type=true_map"];
    let slow = [&args[..], &["--set", "policy.desired_linear_vel=0.5"]].concat();
    let [fast, slow] = [&args[..], &slow].map(|args| serde_json::from_str::<Value>(&bench.succeed(args)).unwrap());
    assert_eq!(fast[0]["world"], "10x15");
    let speed = |report: &Value| report[0]["speed_in_successes"]["mean"].as_f64().unwrap();
    assert!(speed(&slow) < 0.5 && speed(&fast) > speed(&slow));
}

#[test]
fn what_is_wrong_is_said() {
    let bench = Bench::new();
    let refused = |args: &[&str], part: &str| {
        let errors = bench.fail(args);
        assert!(errors.contains(part), "{args:?} gives\n{errors}which lacks\n{part}");
    };
    refused(
        &with("dva", &[]),
        "`dva` is no policy file, and no driver has that name; there are dwa, pure_pursuit, plain_pursuit, vfh",
    );
    refused(&["dwa", "--protocol", "barn", "--worlds", "nowhere"], "--worlds nowhere: there is no such folder");
    refused(&["dwa", "--protocol", "barn", "--worlds", "paths"], "neither it nor a folder `worlds` in it holds");
    refused(&["dwa", "--protocol", "barn"], "--worlds");
    refused(&["dwa"], "--spec");
    refused(&with("dwa", &["--world", "world_7"]), "--world world_7: no such world; did you mean `world_");
    refused(&with("dwa", &["--world", "world_7"]), "? The worlds in worlds are world_1, world_2\n");
    refused(&with("dwa", &["--cell", "a=b"]), "--cell a=b: cells are those of a spec, which --spec SPEC names");
    refused(
        &with("dwa", &["--set", "env.time_limit=50"]),
        "--set env.time_limit=50: env.time_limit: the protocol fixes it",
    );
    refused(&with("dwa", &["--plot", "a.svg", "--plot-episodes", "0,3"]), "--plot-episodes 3: there is no such run");
    refused(
        &with("dwa", &["--set", "policy.max_sped=1"]),
        "--set: policy.max_sped = 1: unknown key `max_sped`; did you",
    );
    refused(&with("dwa", &["--set", "policy.max_speed=-1"]), "--set: policy.max_speed = -1.0: must be");
    refused(&with("dwa", &["--shield", "--set", "evaluate.shield.margin=0"]), "evaluate.shield.margin = 0.0: must be");
    fs::write(bench.path("paths/path_2.npy"), "nothing").unwrap();
    refused(&with("dwa", &[]), "path_2.npy: not a .npy file");
    fs::remove_file(bench.path("paths/path_2.npy")).unwrap();
    bench.write_world("world_3", &[[-2.0, 3.0]].map(|[x, y]| [x, y + 0.4]));
    refused(&with("dwa", &[]), "world_3.world");
    // Walled off, and no path file: there is nothing to measure by. Nothing has been driven by then.
    let wall: Vec<[f64; 2]> = (0..=18).map(|k| [-6.0 + 0.3 + 0.41 * f64::from(k), 8.0]).collect();
    bench.write_world("world_3", &wall);
    let errors = bench.fail(&with("dwa", &[]));
    assert!(errors.starts_with("error: worlds/world_3.world: no way from (-2, 3) to (-2, 13)"), "{errors}");
}

#[test]
fn a_policy_brings_what_it_was_trained_with() {
    let bench = Bench::new();
    bench.write_policy(VehicleSpec { max_acceleration: 2.0, ..VehicleSpec::default() });
    let of = |more: &[&str]| {
        with("straight.safetensors", &[&["--world", "world_1", "--format", "json"], more].concat()).join(" ")
    };
    let run = |more: &[&str]| bench.evaluate(&of(more).split(' ').collect::<Vec<_>>());
    let report: Value = serde_json::from_slice(&run(&[]).stdout).unwrap();
    let driver = &report["conditions"]["driver"];
    assert_eq!((&driver["type"], &driver["file"]), (&"policy".into(), &"straight.safetensors".into()));
    fs::write(bench.path("spec.toml"), "[evaluate]\nn_episodes = 5\n").unwrap();
    let errors = run(&["--spec", "spec.toml", "--set", "env.route.type=none"]).stderr;
    assert!(String::from_utf8(errors).unwrap().contains("env.route.type: the policy file brings it"));
}

#[test]
fn a_policy_for_another_robot_is_refused() {
    let bench = Bench::new();
    bench.write_policy(VehicleSpec { max_speed: 3.0, ..VehicleSpec::default() });
    fs::write(bench.path("spec.toml"), "[evaluate]\nn_episodes = 5\n").unwrap();
    let errors = bench.fail(&with("straight.safetensors", &["--spec", "spec.toml"]));
    assert!(errors.contains("this policy was made for another robot"), "{errors}");
}
