//! Values that a table cannot have.

use std::fs;
use std::path::Path;

use tempfile::TempDir;

use crate::{assert_refused, check_all, experiments};

#[test]
fn rewards() {
    check_all(&[
        (
            "[reward]\ntype = \"r_cuple\"",
            &[],
            "spec.toml:2: reward.type = \"r_cuple\": unknown reward `r_cuple`: this binary knows heading, progress, \
             proximity, r, r_couple, steady_speed, sum, time. A plugin's rewards are known only to a binary that links the plugin and \
             names it, as in `use my_rewards as _;` in its main.rs: without that line the linker drops the plugin. Did \
             you mean `r_couple`?",
        ),
        (
            "[reward]\ntype = \"sum\"\nterms = [\n  { weight = 1, reward = { type = \"r\" } },\n  \
             { weight = 1, reward = { type = \"r_couple\", desired_sped = 1 } },\n]",
            &[],
            "spec.toml:5: reward.terms.1.reward.desired_sped = 1: unknown key `desired_sped`; did you mean \
             `desired_speed`? Keys of `reward.terms.1.reward`: `desired_speed`, `collision`, `side`, `front`, \
             `otherwise`, `angle_threshold`, `speed_width`",
        ),
        (
            "[reward]\ntype = \"sum\"\nterms = [{ weight = 1, reward = { type = \"proximity\", margin = -1 } }]",
            &[],
            "spec.toml:3: reward.terms.0.reward.margin = -1.0: must be positive and finite",
        ),
        ("[reward]\nside = 3", &[], "spec.toml:1: reward: the key `type` is missing"),
    ]);
}

#[test]
fn the_docs_quote_what_is_said_of_a_plugin_that_is_not_linked() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/plugins.md");
    let docs = fs::read_to_string(docs).unwrap();
    let spec =
        docs.split("```toml\n").find(|block| block.starts_with("[reward]")).unwrap().split("```").next().unwrap();
    let quote: Vec<&str> = docs.lines().filter_map(|line| line.strip_prefix("> ")).collect();
    assert_refused(spec, &[], quote.join(" ").strip_prefix("error: ").unwrap());
}

/// Serde takes a sequence for the fields of a struct, in order: `seeds = [3, 2]` was seeds 3 and 4.
#[test]
fn arrays_are_no_tables() {
    check_all(&[
        (
            "seeds = [3, 2]",
            &[],
            "spec.toml:1: seeds = [3, 2]: must be a table, not an array; seeds 3 and 4 are { first = 3, count = 2 }",
        ),
        (
            "",
            &["--set", "seeds=[]"],
            "--set: seeds = []: must be a table, not an array; seeds 3 and 4 are { first = 3, count = 2 }",
        ),
        ("vehicle = []", &[], "spec.toml:1: vehicle = []: must be a table, not an array"),
        (
            "",
            &["--set", "agent.epsilon=[1.0, 0.5, 0.3]"],
            "--set: agent.epsilon = [1.0, 0.5, 0.3]: must be a table, not an array",
        ),
        ("[agent]\nloss = [\"mse\"]", &[], "spec.toml:2: agent.loss = [\"mse\"]: must be a table, not an array"),
        (
            "[[evaluate.worlds]]\nname = \"a\"\ntime_limit = 9\nworld = [\"room_10x15\"]",
            &[],
            "spec.toml:4: evaluate.worlds.0.world = [\"room_10x15\"]: must be a table, not an array",
        ),
        (
            "axis = [[\"a\", { x = {} }]]",
            &[],
            "spec.toml:1: axis.0 = [\"a\", { x = {} }]: must be a table, not an array",
        ),
    ]);
}

#[test]
fn keys_and_types() {
    check_all(&[
        (
            "[lidar]\nn_beans = 36",
            &[],
            "spec.toml:2: lidar.n_beans = 36: unknown key `n_beans`; did you mean `n_beams`? Keys of `lidar`: \
             `n_beams`, `field_of_view`, `min_range`, `max_range`, `noise`, `dropout`, `grazing_angle`",
        ),
        (
            "[agnet]\ngamma = 0.9",
            &[],
            "spec.toml:1: agnet: unknown key `agnet`; did you mean `agent`? Keys of a spec file: `name`, `base`, \
             `seeds`, `axis`, `when`, `world`, `vehicle`, `lidar`, `odometry`, `randomize`, `env`, `policy`, `reward`, `agent`, `train`, `evaluate`",
        ),
        ("[lidar]\nn_beams = 3.5", &[], "spec.toml:2: lidar.n_beams = 3.5: must be a whole number, 0 or above"),
        ("[agent]\ngamma = \"high\"", &[], "spec.toml:2: agent.gamma = \"high\": must be a number"),
        ("agent = 3", &[], "spec.toml:1: agent = 3: must be a table"),
        (
            "[agent]\ntarget = \"dueling\"",
            &[],
            "spec.toml:2: agent.target = \"dueling\": unknown choice. Known: `dqn`, `double_dqn`",
        ),
        (
            "[world]\ntype = \"room\"\nobstacles = { densty = 0.1 }",
            &[],
            "spec.toml:3: world.obstacles.densty = 0.1: unknown choice; did you mean `density`? Known: `count`, \
             `density`",
        ),
    ]);
}

#[test]
fn numbers() {
    check_all(&[
        (
            "[vehicle.footprint]\ntype = \"disc\"\nradius = -0.25",
            &[],
            "spec.toml:3: vehicle.footprint.radius = -0.25: must be a finite number above 0",
        ),
        ("[vehicle]\nmax_speed = nan", &[], "spec.toml:2: vehicle.max_speed = nan: must be a finite number"),
        (
            "[world]\ntype = \"room\"\nwidth = [6.0, inf]",
            &[],
            "spec.toml:3: world.width.1 = inf: must be a finite number",
        ),
        ("[agent]\ngamma = 1.5", &[], "spec.toml:2: agent.gamma = 1.5: must be in [0, 1]"),
        ("[agent.adam]\neps = 0", &[], "spec.toml:2: agent.adam.eps = 0.0: must be above 0"),
        (
            "[train]\nn_steps = 10",
            &[],
            "spec.toml:2: train.n_steps = 10: must be 32 or more: train.n_envs copies of the environment step together",
        ),
        ("[evaluate]\nn_episodes = 0", &[], "spec.toml:2: evaluate.n_episodes = 0: must be 1 to 10000000"),
        (
            "[[evaluate.worlds]]\nname = \"a\"\ntime_limit = -1\nworld = { type = \"room_10x15\" }",
            &[],
            "spec.toml:3: evaluate.worlds.0.time_limit = -1.0: must be a finite number above 0",
        ),
        (
            "[env.actions]\ntype = \"accelerate\"\nyaw_rates = [0.0, 1.0]",
            &[],
            "spec.toml:3: env.actions.yaw_rates = [0.0, 1.0]: must be symmetric, w and -w alike, because \
             observation.mirror is on",
        ),
    ]);
}

/// Sizes without a bound ended in an abort or never.
#[test]
fn sizes() {
    check_all(&[
        ("[train]\nn_envs = 65537", &[], "spec.toml:2: train.n_envs = 65537: must be 1 to 65536"),
        (
            "[train]\nn_steps = 1_000_000_000_001",
            &[],
            "spec.toml:2: train.n_steps = 1000000000001: must be 10^12 or less",
        ),
        (
            "[evaluate]\nn_episodes = 10_000_001",
            &[],
            "spec.toml:2: evaluate.n_episodes = 10000001: must be 1 to 10000000",
        ),
        (
            "[agent]\nhidden = [64, 65537]",
            &[],
            "spec.toml:2: agent.hidden = [64, 65537]: must be at most 16 widths, each 1..=65_536",
        ),
        ("[agent]\nbatch_size = 1_000_001", &[], "spec.toml:2: agent.batch_size = 1000001: must be 1..=1_000_000"),
        // 42 numbers, before and after, of 4 bytes each: 64 GiB are 204 522 252 transitions.
        (
            "[agent]\nreplay_capacity = 4_000_000_000",
            &[],
            "spec.toml:2: agent.replay_capacity = 4000000000: would need 1252 GiB of memory with 42 numbers in an \
             observation; at most 64 GiB are allowed",
        ),
        (
            "[agent]\nhidden = [65536, 65536]",
            &[],
            "spec.toml:2: agent.hidden = [65536, 65536]: would need 96 GiB of memory with 42 numbers in an observation; \
             at most 64 GiB are allowed",
        ),
        (
            "[agent]\nhidden = [65536]\nbatch_size = 1_000_000\nreplay_capacity = 1_000_000",
            &[],
            "spec.toml:3: agent.batch_size = 1000000: would need 489 GiB of memory with 42 numbers in an observation; \
             at most 64 GiB are allowed",
        ),
        (
            "seeds = { count = 500_001 }\n[[axis]]\nname = \"a\"\nlevels = { x = {}, y = {} }",
            &[],
            "spec.toml:1: seeds.count = 500001: must be 500000 or less: a spec may stand for 1000000 runs at most, cells x \
             seeds",
        ),
        (
            "seeds = { first = 9223372036854775807 }",
            &[],
            "spec.toml:1: seeds.first = 9223372036854775807: must leave every seed below 2^63",
        ),
    ]);
    // Twenty axes of two levels are as many cells as there may be runs, and a few more.
    let axes: String =
        (0..20).map(|i| format!("[[axis]]\nname = \"{i}\"\nlevels = {{ x = {{}}, y = {{}} }}\n")).collect();
    let problem = "make 1048576 cells; a spec may stand for 1000000 runs at most";
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("spec.toml"), axes).unwrap();
    let output = experiments(folder.path(), &["check", "spec.toml"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(
        stderr.starts_with("error: spec.toml:1: axis = [{") && stderr.ends_with(&format!("...: {problem}\n")),
        "{stderr}"
    );
}

#[test]
fn episodes_that_are_over_before_they_begin() {
    check_all(&[
        (
            "[env]\ntime_limit = 0.1",
            &[],
            "spec.toml:2: env.time_limit = 0.1: must be vehicle.control_period, 0.2 s, or more",
        ),
        (
            "[[evaluate.worlds]]\nname = \"a\"\ntime_limit = 0.1\nworld = { type = \"room_10x15\" }",
            &[],
            "spec.toml:3: evaluate.worlds.0.time_limit = 0.1: must be vehicle.control_period, 0.2 s, or more",
        ),
        (
            "[env]\nreach_radius = 4",
            &[],
            "spec.toml:2: env.reach_radius = 4.0: must be below every room's start_goal_distance, which is 4 m in \
             world.worlds.0.world",
        ),
        (
            "[env]\nreach_radius = 4\n[world]\ntype = \"room_25x25\"",
            &[],
            "spec.toml:2: env.reach_radius = 4.0: must be below every room's start_goal_distance, which is 4 m in \
             evaluate.worlds.0.world",
        ),
    ]);
}

/// `name` is a folder under `results/`: `../evil` was written beside it.
#[test]
fn names() {
    let no_path = "must be the name of a folder, not a path: no `/`, no `\\`, not `.` or `..`";
    for name in ["../evil", "/tmp/evil", "a/b", "..", "."] {
        let set = format!("name={name}");
        assert_refused("", &["--set", &set], &format!("--set: name = \"{name}\": {no_path}"));
    }
    check_all(&[
        ("name = \" a\"", &[], "spec.toml:1: name = \" a\": must not begin or end with a blank"),
        ("name = \"\"", &[], "spec.toml:1: name = \"\": must not be empty"),
        (
            "name = \"a\\u001bb\"",
            &[],
            "spec.toml:1: name = \"a\\u001Bb\": must not hold line breaks or other control characters",
        ),
        (
            "",
            &["--set", "evaluate.worlds.1.name=\"10x15 \""],
            "--set: evaluate.worlds.1.name = \"10x15 \": must not begin or end with a blank",
        ),
        (
            "[[axis]]\nname = \"a\"\nlevels = { \"x \" = {} }",
            &[],
            "spec.toml:3: axis.0.levels.x : the name must not begin or end with a blank",
        ),
    ]);
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("...toml"), "").unwrap();
    let output = experiments(folder.path(), &["check", "...toml"]);
    let expected = format!(
        "error: ...toml: write a `name`: without one the spec is called after its file, \"..\", and that {no_path}\n"
    );
    assert_eq!(String::from_utf8_lossy(&output.stderr), expected);
}

/// A value that does not fit another one is often not the one that was changed.
#[test]
fn faults_that_take_two_values() {
    let points = "[env]\nactions = { type = \"set_points\", speeds = [1.5], yaw_rates = [0.0] }\n";
    let grid =
        points.to_owned() + "[[axis]]\nname = \"v\"\nlevels = { fast = {}, slow = { \"vehicle.max_speed\" = 1 } }";
    let problem = "spec.toml:2: env.actions.speeds.0 = 1.5: must be from 0 to 1, the vehicle's limits";
    let set = ["--set", "vehicle.max_speed=1"];
    let harmless = ["--set", "agent.gamma=0.5", "--set", "name=a"];
    assert_refused(points, &set, &format!("{problem} (after --set vehicle.max_speed=1)"));
    assert_refused(&grid, &set, &format!("{problem} (after --set vehicle.max_speed=1)"));
    assert_refused(&grid, &harmless, &format!("{problem} (in the cell v=slow)"));
    // The base's own fault needs neither.
    let fast = points.replace("1.5", "2.5");
    let problem = "spec.toml:2: env.actions.speeds.0 = 2.5: must be from 0 to 1.5, the vehicle's limits";
    assert_refused(&fast, &harmless, problem);
    // A level and an assignment together.
    let grid =
        "[[axis]]\nname = \"l\"\nlevels = { far = { \"lidar.max_range\" = 9 }, near = { \"lidar.max_range\" = 3 } }";
    assert_refused(
        grid,
        &["--set", "lidar.min_range=4"],
        "spec.toml:3 (axis \"l\", level \"near\"): lidar.max_range = 3.0: must be more than min_range = 4 (in the cell \
         l=near, after --set lidar.min_range=4)",
    );
}

/// VFH+ and the dynamic window approach turn on the spot: what refuses them is the drive, wherever that was chosen.
#[test]
fn drivers_that_cannot_drive_a_car() {
    const CAN: &str = "which turns on the spot; of the classical drivers, pure_pursuit and plain_pursuit can drive \
                       Ackermann vehicles";
    let told = |place: &str, driver: &str, after: &str| {
        format!(
            "{place}: vehicle.drive.type = \"ackermann\": must be differential or omnidirectional for {driver}, {CAN}{after}"
        )
    };
    let car = "[policy]\ntype = \"vfh\"\n[vehicle]\npreset = \"f1tenth\"";
    assert_refused(car, &[], &told("spec.toml:3", "vfh", ""));
    let sets = ["--set", "policy.type=dwa", "--set", "vehicle.preset=f1tenth"];
    let after = " (after --set policy.type=\"dwa\" --set vehicle.preset=\"f1tenth\")";
    assert_refused("", &sets, &told("--set", "dwa", after));

    // The base says differential; what counts is the preset.
    let folder = TempDir::new().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("base.toml", "[vehicle]\ndrive = { type = \"differential\" }");
    write("spec.toml", &format!("base = \"base.toml\"\n{car}"));
    let refusal = |args: &[&str]| {
        let output = experiments(folder.path(), args);
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8(output.stderr).unwrap()
    };
    assert_eq!(refusal(&["check", "spec.toml"]), format!("error: {}\n", told("spec.toml:4", "vfh", "")));
    let evaluated = refusal(&["evaluate", "dwa", "--spec", "base.toml", "--set", "vehicle.preset=f1tenth"]);
    assert_eq!(evaluated, format!("error: {}\n", told("--set", "dwa", after)));
}

/// Vehicles, sensors, routes, worlds and curricula of real robots.
#[test]
fn robots() {
    check_all(&[
        (
            "[vehicle]\npreset = \"husky\"",
            &[],
            "spec.toml:2: vehicle.preset = \"husky\": unknown choice. Known: `default`, `turtlebot3_burger`, \
             `turtlebot3_waffle`, `jackal`, `jackal_gazebo`, `f1tenth`, `ridgeback`",
        ),
        (
            "[vehicle]\ndrive = { type = \"ackermann\", wheelbase = 0.3, max_steering_angle = 2.0, max_steering_rate = 1.0 }",
            &[],
            "spec.toml:2: vehicle.drive.max_steering_angle = 2.0: must be from 0 to 1.5607963267948965",
        ),
        (
            "[randomize]\n\"vehicle.max_sped\" = { uniform = [1.0, 2.0] }",
            &[],
            "spec.toml:1: randomize.\"vehicle.max_sped\": must be the path of a number of vehicle, lidar or odometry",
        ),
        (
            "[env.observation]\nlook_ahead = [1.0]",
            &[],
            "spec.toml:2: env.observation.look_ahead = [1.0]: must be used with a route: set `route`, to `true_map` for example",
        ),
        (
            "[env.observation]\nn_sectors = 7",
            &[],
            "spec.toml:2: env.observation.n_sectors = 7: must be 0 or a divisor of the 36 beams",
        ),
        (
            "[world]\ntype = \"files\"\npaths = [\"nowhere.world\"]",
            &[],
            "spec.toml:1: world: nowhere.world: cannot be read: No such file or directory (os error 2)",
        ),
        (
            "[[train.curriculum]]\nuntil = 0.5\nworld = { type = \"barn\" }\n[[train.curriculum]]\nuntil = 0.4\nworld = { type = \"barn\" }",
            &[],
            "spec.toml:5: train.curriculum.1.until = 0.4: must be above 0.5 and at most 1: the stages follow each other",
        ),
        (
            "[[train.curriculum]]\nuntil = 0.5\nworld = { type = \"barn\", fill = 1.5 }",
            &[],
            "spec.toml:3: train.curriculum.0.world.fill = 1.5: must be from 0 to 1",
        ),
    ]);
}
