//! What `audit` finds rewards to pay for: by hand, and to the letter.

use std::path::Path;
use std::process::{Command, Output};
use std::sync::Arc;

use headway_env::{Control, GoalHandling, RouteSource};
use headway_experiments::audit::{Audit, Behaviour, Case, End, Pace, Paid, SpeedVerdict};
use headway_experiments::spec::RunSpec;
use headway_reward::{Event, R, RCouple, Reward, SteadySpeed, Sum, Transition};
use serde::{Deserialize, Serialize};

fn case(reward: impl Reward + 'static) -> Case {
    Case::of(&RunSpec { reward: Arc::new(reward), ..RunSpec::default() })
}

fn paid(audit: &Audit, behaviour: Behaviour) -> &Paid {
    audit.drivers.iter().find(|paid| paid.behaviour == behaviour).unwrap()
}

fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-6, "{found}, not {expected}");
}

#[test]
fn r_by_hand() {
    let audit = Audit::of(&case(R::default())).unwrap();
    let gamma: f64 = 0.95;
    for behaviour in [Behaviour::Park, Behaviour::Spin, Behaviour::Orbit, Behaviour::Hover] {
        assert_near(paid(&audit, behaviour).discounted, 10.0 / (1.0 - gamma));
        assert_near(paid(&audit, behaviour).per_second, 50.0);
    }
    for (pace, n) in [(Pace::FlatOut, 14), (Pace::Desired, 17)] {
        let arriving = paid(&audit, Behaviour::Arrive(pace));
        assert_near(arriving.seconds.unwrap(), f64::from(n) * 0.2);
        let alive = 10.0 * (1.0 - gamma.powi(n - 1)) / (1.0 - gamma);
        assert_near(arriving.discounted, alive + 100.0 * gamma.powi(n - 1));
    }
    let crash = paid(&audit, Behaviour::Crash);
    let n = (crash.seconds.unwrap() / 0.2).round() as i32;
    assert_near(crash.discounted, 10.0 * (1.0 - gamma.powi(n - 1)) / (1.0 - gamma) - 100.0 * gamma.powi(n - 1));

    assert!(!audit.passes && audit.pays_more_for_not_arriving());
    assert_eq!(audit.best_not_arriving().len(), 4);
    // 10 / (1 - gamma) = 100.
    let [[from, to]] = audit.not_arriving_pays_more[..] else { panic!("{:?}", audit.not_arriving_pays_more) };
    assert!((from - 0.9).abs() < 1e-4 && to == 1.0, "{from}");
    assert_eq!(audit.speed_term.verdict, SpeedVerdict::None);
    assert_eq!(audit.best_arriving_speed, audit.arriving_speeds[0]);
}

#[test]
fn r_pays_for_arriving_below_its_gamma_and_with_new_goals() {
    let mut case = case(R::default());
    case.gamma = 0.89;
    assert!(Audit::of(&case).unwrap().passes);
    (case.gamma, case.goal) = (0.99, GoalHandling::NewGoal);
    let audit = Audit::of(&case).unwrap();
    assert!(audit.passes && audit.not_arriving_pays_more.is_empty());
    // 14 steps to the first goal, then one every 12: each pays 90 more than staying alive.
    let n = |k: i32| 0.99_f64.powi(k);
    assert_near(audit.best_arriving().discounted, 1000.0 + 90.0 * n(13) + 90.0 * n(14) * n(11) / (1.0 - n(12)));
}

#[test]
fn r_couple_pays_for_orbiting_and_hardly_for_its_speed() {
    let audit = Audit::of(&case(RCouple::default())).unwrap();
    assert!(!audit.passes);
    let best = audit.best_not_arriving();
    assert_eq!((best.len(), best[0].behaviour), (1, Behaviour::Orbit));
    assert_near(best[0].per_second, 200.0);
    let term = &audit.speed_term;
    assert_eq!(term.verdict, SpeedVerdict::Flat);
    assert_near(term.by_place, 30.0);
    assert_near(term.by_speed, 20.0 * (1.0 - (-0.18_f64).exp())); // g(1.2) - g(0.6), beside an obstacle
    let pays: Vec<f64> = term.at_desired_speed.iter().map(|(_, pay)| *pay).collect();
    assert_eq!(pays, [10.0, 40.0, 20.0]);
}

#[test]
fn the_recommended_rewards_pass() {
    let audit = Audit::of(&Case::of(&RunSpec::default())).unwrap();
    assert!(audit.passes && audit.not_arriving_pays_more.is_empty());
    assert_eq!((audit.best_arriving_speed, audit.speed_term.verdict), (1.5, SpeedVerdict::Clear));

    let audit = Audit::of(&case(SteadySpeed::default())).unwrap();
    assert!(audit.passes && audit.not_arriving_pays_more.is_empty());
    assert_eq!((audit.best_arriving_speed, audit.speed_term.verdict), (1.2, SpeedVerdict::Clear));
    assert_near(paid(&audit, Behaviour::Park).discounted, -2.5 * 0.2 / 0.05);
}

#[test]
fn a_reward_that_pays_nothing_tells_nothing_apart() {
    let audit = Audit::of(&case(Sum::default())).unwrap();
    assert!(!audit.passes && !audit.pays_more_for_not_arriving() && audit.arriving_speed_is_indifferent);
    assert!(audit.not_arriving_pays_more.is_empty());
}

#[test]
fn without_discounting_the_better_of_two_infinite_returns_is_found() {
    let mut case = Case::of(&RunSpec::default());
    (case.gamma, case.goal) = (1.0, GoalHandling::NewGoal);
    let audit = Audit::of(&case).unwrap();
    assert!(audit.passes);
    let best = audit.best_arriving();
    assert_eq!((best.behaviour, best.discounted), (Behaviour::Arrive(Pace::FlatOut), f64::INFINITY));
}

#[test]
fn who_only_picks_the_speed_cannot_but_arrive() {
    let mut spec = RunSpec { reward: Arc::new(R::default()), ..RunSpec::default() };
    spec.env.control = Control::SpeedOnly { pursuit: Default::default() };
    spec.env.route = RouteSource::TrueMap(Default::default());
    let actions = |speeds: &str| toml::from_str(&format!("type = 'set_points'\nspeeds = {speeds}\nyaw_rates = [0.0]"));
    spec.env.actions = actions("[0.3, 1.5]").unwrap();
    let audit = Audit::of(&Case::of(&spec)).unwrap();
    assert!(audit.passes && audit.drivers.iter().all(|paid| paid.end == End::Arrives));
    assert_eq!(audit.best_arriving_speed, 0.3);

    spec.env.actions = actions("[0.0, 1.5]").unwrap();
    let audit = Audit::of(&Case::of(&spec)).unwrap();
    assert!(!audit.passes);
    let others: Vec<_> = audit.best_not_arriving().iter().map(|paid| paid.behaviour).collect();
    assert_eq!(others, [Behaviour::Park, Behaviour::Hover]);
}

/// A plugin's reward with a loophole: it pays for coming nearer and takes nothing for going away again.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Approach {}

#[typetag::serde(name = "audit_test/approach")]
impl Reward for Approach {
    fn reward(&self, t: &Transition<'_>) -> f64 {
        let reached = if t.event == Some(Event::Reach) { 20.0 } else { 0.0 };
        reached + 40.0 * t.progress().max(0.0)
    }
}

#[test]
fn a_loophole_of_a_plugins_reward_is_found() {
    let mut case = case(Approach {});
    assert!(Audit::of(&case).unwrap().passes, "the horizon is too short to go round often");
    case.gamma = 0.99;
    let audit = Audit::of(&case).unwrap();
    assert!(!audit.passes);
    assert_eq!(audit.best_not_arriving()[0].behaviour, Behaviour::Orbit);
    let [[from, 1.0]] = audit.not_arriving_pays_more[..] else { panic!("{:?}", audit.not_arriving_pays_more) };
    assert!(0.95 < from && from < 0.99, "{from}");
}

/// A plugin's reward that fails at rest.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Slowness {}

#[typetag::serde(name = "audit_test/slowness")]
impl Reward for Slowness {
    fn reward(&self, t: &Transition<'_>) -> f64 {
        1.0 / t.after.speed
    }
}

#[test]
fn a_pay_that_is_no_number_is_refused() {
    let error = Audit::of(&case(Slowness {})).unwrap_err();
    let expected = "reward: pays inf for a step to a speed of 0.00 m/s, 4.00 m from the goal; must be finite";
    assert_eq!((error.to_string().as_str(), error.exit_code()), (expected, 2));
}

fn audit(args: &[&str]) -> Output {
    let specs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs");
    let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
    command.arg("audit").args(args).current_dir(specs).output().unwrap()
}

/// Checks the exit code, and all that is printed against a file of `tests/audit`.
fn assert_prints(args: &[&str], code: i32, file: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/audit");
    let expected = std::fs::read_to_string(folder.join(file)).unwrap();
    let output = audit(args);
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
    assert_eq!(String::from_utf8(output.stdout).unwrap(), expected);
    assert_eq!(output.status.code(), Some(code));
}

#[test]
fn the_default_spec_to_the_letter() {
    assert_prints(&["default.toml"], 0, "default.txt");
}

#[test]
fn liu_et_al_s_rewards_as_published_to_the_letter() {
    assert_prints(&["table1.toml", "--cell", "reading=P"], 3, "table1_p.txt");
}

#[test]
fn speed_only_control_to_the_letter() {
    assert_prints(&["table1.toml", "--cell", "reading=H,reward=R"], 0, "table1_h_r.txt");
}

#[test]
fn all_cells_as_json() {
    let output = audit(&["table1.toml", "--format", "json"]);
    assert_eq!(output.status.code(), Some(3));
    let entries: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let entries = entries.as_array().unwrap();
    assert_eq!(entries.len(), 12, "DQN and DDQN are paid alike");
    assert_eq!(entries[0]["cells"], "reading=P reward=R");
    assert_eq!(entries[0]["passes"], false);
    assert!((entries[0]["drivers"][0]["return"].as_f64().unwrap() - 200.0).abs() < 1e-9);
    assert_eq!(entries[11]["passes"], true);
}

#[test]
fn the_summary_of_many_levels_fits() {
    let output = audit(&["sensitivity.toml"]);
    let text = String::from_utf8(output.stdout).unwrap();
    let (cases, summary) = text.split_once("== summary ==").unwrap();
    assert!(cases.contains("== reward=R change=none|6 obstacles|24 obstacles|"), "who shares a case is told there");
    assert!(summary.contains("  reward=R change=none (and 4 more)  "), "{summary}");
    assert!(summary.lines().all(|line| line.chars().count() <= 120), "{summary}");

    let output = audit(&["quick.toml"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("== arm=R ==") && !text.contains("agent="), "all cells have the agent: {text}");
}

#[test]
fn what_cannot_be_audited_is_said() {
    let refused = |args: &[&str], expected: &str| {
        let output = audit(args);
        assert_eq!(String::from_utf8(output.stderr).unwrap(), format!("error: {expected}\n"));
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0));
    };
    refused(
        &["default.toml", "--set", "policy.type=dwa"],
        "policy: no cell trains a policy, so no reward is ever paid",
    );
    refused(&["default.toml", "--distance", "0.4"], "--distance 0.4: must be above env.reach_radius, 0.5 m");
    refused(
        &["default.toml", "--distance", "2"],
        "--distance 2: must be 2.58 m or more: beside the way, this vehicle needs that much room to orbit an obstacle",
    );
    refused(&["table1.toml", "--cell", "reading=Q"], "--cell reading=Q: unknown level; there are: P, T, H, N");
    refused(
        &["default.toml", "--set", "env.actions={ type = \"set_points\", speeds = [0.0], yaw_rates = [0.0] }"],
        "env.actions: no action drives forward, so no driver arrives",
    );
}
