//! Bad input: one message that names file, place, value and what is allowed; exit code 2; nothing written.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

/// Runs the binary in `folder`.
fn experiments(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_experiments")).args(args).current_dir(folder).output().unwrap()
}

/// Checks that `check spec.toml ARGS` refuses this file with this message.
fn assert_refused(text: &str, args: &[&str], expected: &str) {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("spec.toml"), text).unwrap();
    let output = experiments(folder.path(), &[&["check", "spec.toml"], args].concat());
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(stderr, format!("error: {expected}\n"), "for\n{text}\n{args:?}");
    assert_eq!(output.status.code(), Some(2), "{expected}");
    assert!(output.stdout.is_empty(), "{expected}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "something was written: {expected}");
}

/// The file, the options, and the message.
type Case = (&'static str, &'static [&'static str], &'static str);

fn check_all(cases: &[Case]) {
    for (text, args, expected) in cases {
        assert_refused(text, args, expected);
    }
}

#[test]
fn rewards() {
    check_all(&[
        (
            "[reward]\ntype = \"r_cuple\"",
            &[],
            "spec.toml:2: reward.type = \"r_cuple\": unknown reward `r_cuple`: this binary knows heading, progress, \
             proximity, r, r_couple, sum, time. A plugin's rewards are known only to a binary that links the plugin and \
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
fn keys_and_types() {
    check_all(&[
        (
            "[lidar]\nn_beans = 36",
            &[],
            "spec.toml:2: lidar.n_beans = 36: unknown key `n_beans`; did you mean `n_beams`? Keys of `lidar`: \
             `n_beams`, `field_of_view`, `min_range`, `max_range`, `noise`, `dropout`",
        ),
        (
            "[agnet]\ngamma = 0.9",
            &[],
            "spec.toml:1: agnet: unknown key `agnet`; did you mean `agent`? Keys of a spec file: `name`, `base`, \
             `seeds`, `axis`, `when`, `world`, `vehicle`, `lidar`, `env`, `reward`, `agent`, `train`, `evaluate`",
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

#[test]
fn seeds_axes_and_levels() {
    check_all(&[
        (
            "seeds = { first = 0, count = 0 }",
            &[],
            "spec.toml:1: seeds.count = 0: must be 1 or more: without a seed there is nothing to run",
        ),
        (
            "[[axis]]\nname = \"a\"\nlevels = { x = {} }\n[[axis]]\nname = \"a\"\nlevels = { y = {} }",
            &[],
            "spec.toml:5: axis.1.name = \"a\": an earlier axis has this name; give each axis its own",
        ),
        (
            "[[axis]]\nname = \"a\"\n[axis.levels]\nx = {}\nx = {}",
            &[],
            "spec.toml:5: not valid TOML: duplicate key `x`; levels, like all keys, need names of their own",
        ),
        (
            "[[axis]]\nname = \"a\"\nlevels = {}",
            &[],
            "spec.toml:3: axis.0.levels: must hold at least one level: NAME = { \"dotted.path\" = value }",
        ),
        ("[[axis]]\nname = \"a\"", &[], "spec.toml:1: axis.0: the key `levels` is missing"),
        (
            "[[axis]]\nname = \"a\"\nlevels = { x = 3 }",
            &[],
            "spec.toml:3: axis.0.levels.x = 3: must be a table: { \"dotted.path\" = value }",
        ),
        (
            "[[axis]]\nname = \"agent\"\n[axis.levels]\nx = {}\ny = {\n  \"agent.gama\" = 0.9 }",
            &[],
            "spec.toml:6 (axis \"agent\", level \"y\"): agent.gama = 0.9: unknown key `gama`; did you mean `gamma`? \
             Keys of `agent`: `target`, `hidden`, `gamma`, `n_step`, `learning_rate`, `adam`, `loss`, `grad_clip`, \
             `batch_size`, `update_every`, `warm_up`, `replay_capacity`, `target_network`, `epsilon`, `average`, \
             `reward_scale`",
        ),
        (
            "[[axis]]\nname = \"gamma\"\n[axis.levels]\nx = {}\ny = { \"agent.gamma\" = 2 }",
            &[],
            "spec.toml:5 (axis \"gamma\", level \"y\"): agent.gamma = 2.0: must be in [0, 1]",
        ),
        (
            "[axis]\nname = \"a\"\nlevels = { x = {} }",
            &[],
            "spec.toml:1: axis: must be an array, not a table; write its tables as [[axis]]",
        ),
        (
            "[[axis]]\nname = \"a\"\nlevels = { x = { \"seeds.count\" = 2 } }",
            &[],
            "spec.toml:3 (axis \"a\", level \"x\"): `seeds.count` is shared by all cells: set it at the top of the file",
        ),
        (
            "[env]\nactions = { type = \"set_points\", speeds = [1.5], yaw_rates = [0.0] }\n[[axis]]\nname = \"v\"\n\
             [axis.levels]\nfast = {}\nslow = { \"vehicle.max_speed\" = 1.0 }",
            &[],
            "spec.toml:2: env.actions.speeds.0 = 1.5: must be from 0 to 1, the vehicle's limits (in the cell v=slow)",
        ),
        (
            "[[axis]]\nname = \"reward\"\nlevels = { R = {} }\n[[when]]\nmatch = { reword = \"R\" }\nset = {}",
            &[],
            "spec.toml:5: when.0.match.reword = \"R\": unknown axis `reword`; did you mean `reward`? Axes: `reward`",
        ),
        (
            "[[axis]]\nname = \"reward\"\nlevels = { R = {} }\n[[when]]\nmatch = { reward = \"Q\" }\nset = {}",
            &[],
            "spec.toml:5: when.0.match.reward = \"Q\": unknown level of axis `reward`. Levels: `R`",
        ),
        (
            "[[axis]]\nname = \"a\"\nlevels = { x = {} }\n[[when]]\nmatch = { a = \"x\" }\nset = { \"env.goal\" = 1 }",
            &[],
            "spec.toml:6 (when number 1): env.goal = 1: unknown choice. Known: `terminate`, `new_goal`",
        ),
    ]);
}

#[test]
fn impossible_scenarios() {
    let giant = "type = \"room\"\nwidth = 10\nheight = 10\nobstacle_radius = 6\nobstacles = { count = 3 }";
    let problem = "cannot place";
    for (table, place) in [
        (format!("[world]\n{giant}"), "spec.toml:1: world: "),
        (
            format!("[[evaluate.worlds]]\nname = \"a\"\ntime_limit = 60\n[evaluate.worlds.world]\n{giant}"),
            "spec.toml:4: evaluate.worlds.0.world: ",
        ),
    ] {
        let folder = TempDir::new().unwrap();
        fs::write(folder.path().join("spec.toml"), table).unwrap();
        let output = experiments(folder.path(), &["check", "spec.toml"]);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(stderr.starts_with(&format!("error: {place}{problem}")), "{stderr}");
        assert_eq!(output.status.code(), Some(2));
    }
}

#[test]
fn files() {
    check_all(&[
        (
            "base = \"missing.toml\"",
            &[],
            "spec.toml:1: base = \"missing.toml\": cannot read the base missing.toml: No such file or directory (os \
             error 2)",
        ),
        ("base = 3", &[], "spec.toml:1: base = 3: must be a string: the path of a spec file, relative to this one"),
        ("base = \"spec.toml\"", &[], "spec.toml:1: base = \"spec.toml\": is a cycle: spec.toml -> spec.toml"),
        (
            "[agent]\ngamma = 0.9\ngamma = 0.8",
            &[],
            "spec.toml:3: not valid TOML: duplicate key `gamma`; levels, like all keys, need names of their own",
        ),
        ("[agent\ngamma = 0.9", &[], "spec.toml:1: not valid TOML: unclosed table, expected `]`"),
    ]);
    let folder = TempDir::new().unwrap();
    let output = experiments(folder.path(), &["check", "missing.toml"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(stderr, "error: missing.toml: cannot read the spec: No such file or directory (os error 2)\n");
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn a_fault_of_a_base_is_placed_in_the_base() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("base.toml"), "\n[agent]\ngamma = 3").unwrap();
    fs::write(folder.path().join("leaf.toml"), "base = \"base.toml\"\n[agent]\nn_step = 1").unwrap();
    let output = experiments(folder.path(), &["check", "leaf.toml"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(stderr, "error: base.toml:3: agent.gamma = 3.0: must be in [0, 1]\n");
}

#[test]
fn a_run_of_a_bad_spec_creates_no_folder() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("spec.toml"), "[agent]\ngamma = 3").unwrap();
    let output = experiments(folder.path(), &["run", "spec.toml", "--out", "out"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(!folder.path().join("out").exists());
}

#[test]
fn assignments() {
    check_all(&[
        (
            "",
            &["--set", "agent.learning_rate.strat=1"],
            "--set: agent.learning_rate.strat = 1: unknown key `strat`; did you mean `start`? Keys of \
             `agent.learning_rate`: `start`, `end`",
        ),
        (
            "",
            &["--set", "reward.terms.9.weight=1"],
            "--set: reward.terms.9.weight = 1: no entry 9: `reward.terms` has entries 0 to 3",
        ),
        ("", &["--set", "agent.gamma.x=1"], "--set: agent.gamma.x = 1: `agent.gamma` is one value and has no keys"),
        ("", &["--set", "agent.gamma=1.5"], "--set: agent.gamma = 1.5: must be in [0, 1]"),
        ("", &["--set", "agent.gamma=nan"], "--set: agent.gamma = nan: must be a finite number"),
        ("", &["--set", "agent.n_step=3x"], "--set: agent.n_step = \"3x\": must be a whole number, 0 or above"),
        (
            "",
            &["--set", "seeds.count=0"],
            "--set: seeds.count = 0: must be 1 or more: without a seed there is nothing to run",
        ),
        (
            "",
            &["--set", "seeds.cuont=2"],
            "--set: seeds.cuont = 2: unknown key `cuont`; did you mean `count`? Keys of `seeds`: `first`, `count`",
        ),
        (
            "",
            &["--set", "axis.0.name=x"],
            "--set: axis.0.name: of the head, only `name` and `seeds` can be set here; edit the file for the others",
        ),
        (
            "",
            &["--set", "gamma"],
            "invalid value 'gamma' for '--set <PATH=VALUE>': write PATH=VALUE, for example agent.gamma=0.9\n\nFor more \
             information, try '--help'.",
        ),
    ]);
}
