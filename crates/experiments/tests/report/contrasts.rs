//! What `compare` prints, to the letter.

use headway_experiments::episode::Metric;
use headway_experiments::report::Contrasts;
use serde_json::{Value, json};

use super::{Fixture, assert_text, skill};

fn contrasts(n_seeds: u64, over: &str) -> Contrasts {
    Fixture::new(n_seeds, skill).report().contrasts(over, None).unwrap()
}

#[test]
fn the_table_of_contrasts() {
    let table = contrasts(4, "reward").table(&[Metric::Success, Metric::SpeedInSuccesses]);
    assert_text(
        &table,
        "
                                       success                      speed in successes
agent  world       reward           difference    P(more)    seeds          difference    P(more)    seeds
                   less R               points                more                 m/s                more
──────────────────────────────────────────────────────────────────────────────────────────────────────────
DQN    room_10x15  R_couple             +93.75       1.00      4/4                   –          –      0/0
                             +87.50 to +100.00  1.00–1.00  p 0.125
DQN    room_25x25  R_couple             +93.75       1.00      4/4                   –          –      0/0
                             +87.50 to +100.00  1.00–1.00  p 0.125
DDQN   room_10x15  R_couple             +75.00       1.00      4/4               0.000       0.50      0/3
                              +50.00 to +93.75  1.00–1.00  p 0.125      0.000 to 0.000  0.50–0.50  p 1.000
DDQN   room_25x25  R_couple             +75.00       1.00      4/4               0.000       0.50      0/3
                              +50.00 to +93.75  1.00–1.00  p 0.125      0.000 to 0.000  0.50–0.50  p 1.000
Each `reward` less `R`, the other axes alike, paired over 4 seeds; below it its 95 % bootstrap interval over them.
Intervals over 3 to 5 seeds are too narrow: over 3 each is the range of the seeds, which misses the mean 1 time in 4.
P(more): how likely a run is to have more than one of the other's, ties by half; seeds more: in how many of the pairs.
p: how likely differences as large as these are if the two are drawn alike (sign-flip test; 0.05 takes 6 seeds).
Of 4 differences that are all luck, 0.2 at most have p of 0.05 or less, on average.
",
    );
}

#[test]
fn fewer_than_three_seeds_have_no_intervals() {
    let table = contrasts(2, "world").table(&[Metric::Collision, Metric::MeanJerk]);
    assert_text(
        &table,
        "
                                   collision                   mean jerk
reward    agent  world            difference  P(more)  seeds  difference  P(more)  seeds
                 less room_10x15      points            more        m/s³            more
────────────────────────────────────────────────────────────────────────────────────────
R         DQN    room_25x25             0.00        –    0/2       0.000        –    0/2
R         DDQN   room_25x25             0.00        –    0/2       0.000        –    0/2
R_couple  DQN    room_25x25             0.00        –    0/2       0.000        –    0/2
R_couple  DDQN   room_25x25             0.00        –    0/2       0.000        –    0/2
Each `world` less `room_10x15`, the other axes alike, paired over 2 seeds; no intervals below 3.
P(more): how likely a run is to have more than one of the other's, ties by half; seeds more: in how many of the pairs.
",
    );
}

#[test]
fn what_does_not_fit_is_named() {
    let table = contrasts(4, "agent").table(&Metric::ALL);
    let left_out = table.lines().last().unwrap();
    let expected = "left out for want of room: timeout and 9 more (see --metric, or --format json or csv)";
    assert_eq!(left_out, expected);
    assert_text(&table, &format!("\n{table}"));
}

/// They stood beside the table alone, and not in JSON.
#[test]
fn settings_that_differ_are_in_the_table_and_in_json() {
    let fixture = Fixture::new(2, skill);
    let contrasts = fixture.report().contrasts("agent", None).unwrap();
    assert!(!contrasts.table(&[Metric::Success]).contains("differ in"), "not read yet");
    let contrasts = contrasts.with_settings(fixture.path()).unwrap();
    let table = contrasts.table(&[Metric::Success]);
    assert_eq!(table.lines().last(), Some("DDQN and DQN differ in cell"), "{table}");
    let json: Value = serde_json::from_str(&contrasts.json()).unwrap();
    let expected = json!([{ "level": "DDQN", "in_all_cells": ["cell"], "in_some_cells": [] }]);
    assert_eq!(json["settings"], expected, "once, whatever the number of worlds");
    // The same runs in two worlds do not differ in their training.
    let worlds = fixture.report().contrasts("world", None).unwrap().with_settings(fixture.path()).unwrap();
    assert!(worlds.settings.is_empty());
}

#[test]
fn records_hold_what_the_contrasts_do() {
    let contrasts = contrasts(4, "agent");
    let json: Value = serde_json::from_str(&contrasts.json()).unwrap();
    assert_eq!((&json["over"], &json["base"]), (&"agent".into(), &"DQN".into()));
    let csv = contrasts.csv();
    let mut rows = csv::Reader::from_reader(csv.as_bytes());
    assert_eq!(
        rows.headers().unwrap(),
        &csv::StringRecord::from(vec![
            "reward",
            "world",
            "agent",
            "base",
            "metric",
            "seeds",
            "seeds_more",
            "difference",
            "low",
            "high",
            "p",
            "more",
            "more_low",
            "more_high",
            "collapsed",
            "collapsed_base"
        ])
    );
    let rows: Vec<_> = rows.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), contrasts.contrasts.len() * Metric::ALL.len());
    for (k, contrast) in contrasts.contrasts.iter().enumerate() {
        for (metric, row) in Metric::ALL.into_iter().zip(&rows[k * Metric::ALL.len()..]) {
            let (of, in_json) = (contrast.difference(metric), &json["contrasts"][k][metric.name()]);
            let text = |number: Option<f64>| number.map_or_else(String::new, |number| number.to_string());
            assert_eq!(&row[0], contrast.axes[0].level);
            assert_eq!(
                (&row[4], &row[7], &row[11]),
                (metric.name(), &*text(of.paired.mean), &*text(of.more.map(|m| m.point)))
            );
            assert_eq!(in_json["difference"]["high"].as_f64(), of.paired.high);
            assert_eq!(&row[10], &*text(of.p));
            assert_eq!(in_json["seeds_more"].as_u64().unwrap(), of.n_more as u64);
            assert_eq!(in_json["more"]["low"].as_f64(), of.more.map(|more| more.low));
        }
    }
}
