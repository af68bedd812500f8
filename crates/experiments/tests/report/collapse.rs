//! What `report` says of seeds that collapsed.

use headway_experiments::collapse::Collapse;
use headway_experiments::episode::{EpisodeRecord, Outcome};
use headway_experiments::report::{Report, of_policy};
use headway_experiments::store::{RunInfo, Store};
use serde_json::{Value, json};

use super::{Fixture, WORLDS, episodes, run_with, skill};

/// By what the training left, by what the evaluations say, or by both.
#[test]
fn collapsed_seeds_are_named() {
    let fixture = Fixture::new(4, skill);
    let store = Store::open(fixture.path()).unwrap();
    let spins = [Collapse::Spinning { share: 0.75 }, Collapse::OneAction { entropy: 0.0 }];
    run_with(&store, 1, skill(1, 2), &RunInfo::new(2, 1), &spins, |episode| episode);
    let times_out = |episode| EpisodeRecord { outcome: Outcome::Timeout, duration: 4.0, distance: 2.0, ..episode };
    run_with(&store, 1, skill(1, 3), &RunInfo::new(3, 1), &[], times_out);
    let report = fixture.report();
    let line = "R DDQN: 2 of 4 seeds collapsed: spins (seed 2), has one action (seed 2), times out in room_10x15 and room_25x25 (seed 3)";
    let table = report.table();
    assert_eq!(table.lines().filter(|found| found.contains("collapsed")).collect::<Vec<_>>(), [line]);
    let rows: Vec<Value> = serde_json::from_str(&report.json()).unwrap();
    assert_eq!(rows[0]["collapsed"], json!({ "seeds": 0, "of": 4, "verdicts": [] }));
    let how = json!([{ "kind": "spinning", "share": 0.75 }, { "kind": "one_action", "entropy": 0.0 }]);
    for (row, world) in rows[2..4].iter().zip(WORLDS) {
        let times_out = json!([{ "kind": "times_out", "world": world, "timeouts": 1.0, "mean_speed": 0.5 }]);
        let verdicts = json!([{ "seed": 2, "how": how }, { "seed": 3, "how": times_out }]);
        assert_eq!(row["collapsed"], json!({ "seeds": 2, "of": 4, "verdicts": verdicts }));
    }
    assert_eq!(collapsed_column(&report), ["0", "0", "2", "2", "0", "0", "0", "0"]);
}

/// The column of that name in CSV.
fn collapsed_column(report: &Report) -> Vec<String> {
    let csv = report.csv();
    let mut records = csv::Reader::from_reader(csv.as_bytes());
    let column = records.headers().unwrap().iter().position(|name| name == "collapsed").unwrap();
    records.records().map(|record| record.unwrap()[column].to_owned()).collect()
}

/// A run that drives in one world and times out in the other counted in neither, as one that times out in all of them only did.
#[test]
fn a_world_counts_the_seeds_that_time_out_in_it() {
    let fixture = Fixture::new(4, skill);
    let times_out_in_second = |episode: EpisodeRecord| match episode.near_time {
        2.0 => EpisodeRecord { outcome: Outcome::Timeout, duration: 8.0, distance: 2.0, ..episode },
        _ => episode,
    };
    run_with(&Store::open(fixture.path()).unwrap(), 2, skill(2, 3), &RunInfo::new(3, 1), &[], times_out_in_second);
    let report = fixture.report();
    let line = "R_couple DQN: 1 of 4 seeds collapsed: times out in room_25x25 (seed 3)";
    assert_eq!(report.table().lines().filter(|found| found.contains("collapsed")).collect::<Vec<_>>(), [line]);
    assert_eq!(collapsed_column(&report), ["0", "0", "0", "0", "0", "1", "0", "0"]);
    let words = "times out in room_25x25 (100 % of evaluation episodes, at 0.25 m/s)";
    assert_eq!(report.rows[5].collapsed.seeds[0].how[0].describe(), words);
}

#[test]
fn nothing_is_said_of_collapse_where_nothing_was_trained() {
    assert_eq!(collapsed_column(&of_policy(&[("room_10x15", episodes(0, 0))])), [""]);
}
