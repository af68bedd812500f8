use super::*;
use crate::collapse::Collapse;
use crate::report::{Interval as Intervals, Policy};
use crate::store::TrainKey;

fn summary(success: f64, spl: Option<f64>) -> SeedSummary {
    SeedSummary { success: Some(success), spl, n_episodes: 4, ..SeedSummary::of(&[]) }
}

/// A run of a cell in the worlds `a` and `b`.
fn run(levels: [(&str, &str); 2], seed: u64, a: Option<SeedSummary>, b: Option<SeedSummary>) -> RunRow {
    RunRow {
        axes: levels.map(|(axis, level)| AxisLevel { axis: axis.into(), level: level.into() }).into(),
        seed,
        train_id: TrainKey { spec: &levels, seed, reward_version: 1 }.id().unwrap(),
        summaries: vec![("a".into(), a), ("b".into(), b)],
        policy: Policy::NotTrained,
        collapse: Vec::new(),
    }
}

fn report(runs: Vec<RunRow>) -> Report {
    Report {
        axes: vec!["reward".into(), "agent".into()],
        rows: Vec::new(),
        n_complete: runs.len(),
        n_runs: runs.len(),
        runs,
        interval: Intervals::Seeds,
        warnings: Vec::new(),
    }
}

/// Rewards R and S with DQN, of as many seeds as there are successes in world `a`; the same in world `b` less 0.25.
fn two_rewards(r: &[f64], s: &[f64]) -> Report {
    let cell = |reward, successes: &[f64]| {
        let of = |(seed, success): (usize, &f64)| {
            let there = |success| Some(summary(success, Some(0.5)));
            run([("reward", reward), ("agent", "DQN")], seed as u64, there(*success), there(success - 0.25))
        };
        successes.iter().enumerate().map(of).collect::<Vec<_>>()
    };
    report([cell("R", r), cell("S", s)].concat())
}

#[test]
fn worked_by_hand() {
    let contrasts = two_rewards(&[0.25, 0.75, 0.5], &[0.5, 0.75, 1.0]).contrasts("reward", None).unwrap();
    assert_eq!((&*contrasts.over, &*contrasts.base, contrasts.contrasts.len()), ("reward", "R", 2));
    let in_a = &contrasts.contrasts[0];
    assert_eq!((&*in_a.level, in_a.world.as_deref(), in_a.n_seeds), ("S", Some("a"), 3));
    assert_eq!(in_a.axes, [AxisLevel { axis: "agent".into(), level: "DQN".into() }]);
    let success = in_a.difference(Metric::Success);
    // 0.25, 0 and 0.5, seed by seed; each of them has more than 1 / 27 of the resamples to itself.
    let paired = Estimate { mean: Some(0.25), low: Some(0.0), high: Some(0.5), n: 3 };
    assert_eq!((success.paired, success.n_more), (paired, 2));
    // Of the four ways to turn 0.25 and 0.5, two are as far from 0.
    assert_eq!((success.p, success.is_told_from_luck()), (Some(0.5), false));
    // 0.5 beats one and ties one of three, 0.75 beats two and ties one, 1 beats all: 1.5 + 2.5 + 3 of 9.
    assert!((success.more.unwrap().point - 7.0 / 9.0).abs() < 1e-15);
    // All alike: nothing but ties.
    let spl = in_a.difference(Metric::Spl);
    assert_eq!((spl.paired.mean, spl.n_more, spl.p), (Some(0.0), 0, Some(1.0)));
    assert_eq!(spl.more.unwrap().point, 0.5);
    assert_eq!(in_a.difference(Metric::MeanSpeed).paired.n, 0);
}

#[test]
fn the_base_can_be_chosen_and_turns_the_signs() {
    let report = two_rewards(&[0.25, 0.75, 0.5], &[0.5, 0.75, 1.0]);
    let (forth, back) = (report.contrasts("reward", None).unwrap(), report.contrasts("reward", Some("S")).unwrap());
    let mean = |contrasts: &Contrasts| contrasts.contrasts[1].difference(Metric::Success).paired.mean.unwrap();
    assert_eq!((&*back.base, &*back.contrasts[1].level), ("S", "R"));
    assert_eq!(mean(&forth), -mean(&back));
}

#[test]
fn worlds_are_compared_policy_by_policy() {
    let contrasts = two_rewards(&[0.25, 0.75, 0.5], &[0.5, 0.75, 1.0]).contrasts(WORLD, None).unwrap();
    assert_eq!(contrasts.contrasts.len(), 2); // one for each cell
    for contrast in &contrasts.contrasts {
        let success = contrast.difference(Metric::Success);
        assert_eq!((&*contrast.level, &contrast.world, contrast.axes.len()), ("b", &None, 2));
        assert_eq!(success.paired, Estimate { mean: Some(-0.25), low: Some(-0.25), high: Some(-0.25), n: 3 });
        assert_eq!(success.p, Some(0.25)); // three alike are no proof
    }
}

#[test]
fn only_seeds_that_both_have_are_paired() {
    let r = |seed, success| run([("reward", "R"), ("agent", "DQN")], seed, success, None);
    let s = |seed, success| run([("reward", "S"), ("agent", "DQN")], seed, success, None);
    let there = |success| Some(summary(success, None));
    let runs = vec![r(0, there(0.0)), r(1, None), r(5, there(0.5)), s(0, None), s(5, there(0.75)), s(7, there(1.0))];
    let contrasts = report(runs).contrasts("reward", None).unwrap();
    let [in_a, in_b] = &contrasts.contrasts[..] else { panic!("two worlds") };
    let success = in_a.difference(Metric::Success);
    assert_eq!((in_a.n_seeds, in_b.n_seeds), (1, 0));
    assert_eq!((success.paired.mean, success.paired.low, success.more), (Some(0.25), None, None));
    assert_eq!(in_a.difference(Metric::Spl).paired.n, 0);
    assert_eq!(in_a.difference(Metric::Spl).p, None);
}

#[test]
fn six_seeds_that_agree_are_told_from_luck() {
    let contrasts = two_rewards(&[0.25; 6], &[0.5; 6]).contrasts("reward", None).unwrap();
    let success = contrasts.contrasts[0].difference(Metric::Success);
    assert_eq!((success.p, success.is_told_from_luck()), (Some(2.0 / 64.0), true));
}

#[test]
fn all_else_is_alike() {
    let cell =
        |reward, agent, success| run([("reward", reward), ("agent", agent)], 0, Some(summary(success, None)), None);
    // S was not run with DDQN, R not with a third agent.
    let runs = vec![cell("R", "DQN", 0.1), cell("R", "DDQN", 0.2), cell("S", "DQN", 0.4), cell("S", "third", 0.8)];
    let contrasts = report(runs).contrasts("reward", None).unwrap();
    let in_a: Vec<_> = contrasts.contrasts.iter().filter(|c| c.world.as_deref() == Some("a")).collect();
    assert_eq!(in_a.len(), 1);
    assert_eq!(in_a[0].axes[0].level, "DQN");
    assert_eq!(contrasts.n_alone, 2, "S with the third agent, in both worlds");
    assert!((in_a[0].difference(Metric::Success).paired.mean.unwrap() - 0.3).abs() < 1e-15);
}

#[test]
fn refusals_name_what_there_is() {
    let report = two_rewards(&[0.5], &[0.5]);
    let refusal = |over, base| report.contrasts(over, base).unwrap_err().to_string();
    assert_eq!(refusal("gamma", None), "no axis `gamma` to compare over: must be one of reward, agent, world");
    assert_eq!(refusal("reward", Some("T")), "axis `reward` has no level `T`: must be one of R, S");
    assert_eq!(refusal("agent", None), "axis `agent` has one level only: nothing to compare");
    let apart = ["R", "S"].map(|reward| run([("reward", reward), ("agent", reward)], 0, None, None));
    assert_eq!(
        super::super::Report { runs: apart.into(), ..report }.contrasts("reward", None).unwrap_err().to_string(),
        "nothing to hold against `R`: no other cell has the same world and the same levels of all axes but `reward`"
    );
}

/// Each side counts what concerns the world that it is compared in; sides without a policy count nothing.
#[test]
fn collapsed_seeds_of_both_sides_are_counted() {
    let mut report = two_rewards(&[0.25, 0.75, 0.5], &[0.5, 0.75, 1.0]);
    let counts = |report: &Report, over| -> Vec<_> {
        report.contrasts(over, None).unwrap().contrasts.iter().map(|of| of.n_collapsed).collect()
    };
    assert_eq!(counts(&report, "reward"), [[None; 2]; 2]);
    let times_out = Collapse::TimesOut { world: "b".into(), timeouts: 1.0, mean_speed: 0.5 };
    for run in &mut report.runs {
        run.policy = Policy::At("policy".into());
        run.collapse = match (&*run.axes[0].level, run.seed) {
            ("R", 0) => vec![Collapse::Spinning { share: 0.8 }, times_out.clone()],
            ("S", _) => vec![times_out.clone()],
            _ => Vec::new(),
        };
    }
    // R, the base, spins in both worlds with one seed; S times out in `b` with all three.
    assert_eq!(counts(&report, "reward"), [[Some(0), Some(1)], [Some(3), Some(1)]]);
    assert_eq!(counts(&report, WORLD), [[Some(1), Some(1)], [Some(3), Some(0)]]);
    let contrasts = report.contrasts("reward", None).unwrap();
    let table = contrasts.table(&[Metric::Success]);
    let lines = table.lines().rev().take(2).collect::<Vec<_>>();
    assert_eq!(lines, ["S collapsed in 3 of 3 seeds where world=b", "R collapsed in 1 of 3 seeds"]);
    let json: serde_json::Value = serde_json::from_str(&contrasts.json()).unwrap();
    assert_eq!(json["contrasts"][1]["collapsed"], serde_json::json!({ "level": 3, "base": 1 }));
    let csv = contrasts.csv();
    let ends: Vec<_> = csv.lines().skip(1).step_by(Metric::ALL.len()).map(|line| &line[line.len() - 4..]).collect();
    assert_eq!(ends, [",0,1", ",3,1"]);
}

#[test]
fn no_axis_can_have_the_name_of_a_column() {
    let of_seeds = two_rewards(&[0.25, 0.75, 0.5], &[0.5, 0.75, 1.0]);
    let of_policy = Report { interval: Intervals::Episodes, axes: Vec::new(), ..of_seeds.clone() };
    let contrasts = of_seeds.contrasts("reward", None).unwrap();
    let texts = [of_seeds.csv(), of_policy.csv(), contrasts.csv(), of_seeds.runs_csv()];
    let columns = texts.iter().flat_map(|text| text.lines().next().unwrap().split(','));
    let table = of_seeds.runs_table();
    let of_runs = table.lines().next().unwrap().split_whitespace();
    let free: Vec<_> = columns.chain(of_runs).filter(|column| !crate::spec::is_column(column)).collect();
    // The axes, of the list of runs twice, and there the worlds.
    assert_eq!(free, ["reward", "agent", "agent", "reward", "reward", "agent", "reward", "agent", "a", "b"]);
    assert!(["cell", "run"].into_iter().all(crate::spec::is_column), "of lists of runs elsewhere");
}
