//! Seeds, axes, levels, and what is set on the command line.

use crate::check_all;

#[test]
fn axes_and_levels() {
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
            "[[axis]]\nname = \"world\"\nlevels = { x = {} }",
            &[],
            "spec.toml:2: axis.0.name = \"world\": is the name of a column of reports; give the axis another",
        ),
        (
            "[[axis]]\nname = \"policy\"\nlevels = { x = {} }",
            &[],
            "spec.toml:2: axis.0.name = \"policy\": is the name of a column of reports; give the axis another",
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
    ]);
}

#[test]
fn what_levels_set() {
    check_all(&[
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
        ("", &["--set", "agent.gamma=.9"], "--set: agent.gamma = \".9\": must be a number; write 0.9"),
        (
            "",
            &["--set", "world.worlds.1.world.width=.9"],
            "--set: world.worlds.1.world.width = \".9\": expected a number or a range [low, high]; write 0.9",
        ),
        (
            "",
            &["--set", "agent.n_step=1e1"],
            "--set: agent.n_step = 10.0: must be a whole number, 0 or above; write 10",
        ),
        ("", &["--set", "agent.reward_scale=1e-320"], "--set: agent.reward_scale = 1e-320: must be above 0"),
        (
            "",
            &["--set", "seeds.first=18446744073709551615"],
            "--set: seeds.first = \"18446744073709551615\": must be a whole number, 0 or above; the greatest is 2^63 - 1",
        ),
        ("", &["--set", "vehicle.footprint.type=box"], "--set: vehicle.footprint: the key `length` is missing"),
        (
            "",
            &["--set", "seeds={first=18446744073709551615,count=1}"],
            "invalid value 'seeds={first=18446744073709551615,count=1}' for '--set <PATH=VALUE>': seeds.first = \
             18446744073709551615: whole numbers reach from -2^63 to 2^63 - 1\n\nFor more information, try '--help'.",
        ),
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
