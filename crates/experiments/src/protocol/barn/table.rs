//! A report as text.

use std::collections::BTreeMap;
use std::fmt::Write;

use headway_env::RouteSource;
use headway_planning::ShieldSpec;
use headway_sensors::{LidarSpec, OdometrySpec};
use headway_sim::{ActuationSpec, Shape};
use toml::Value;

use super::{Conditions, OverWorlds, Report, Row, Source, Vehicle};
use crate::candidate::Identity;
use crate::difference::{changes, words};

impl Report {
    /// As a text table, with all that it rests on below.
    #[must_use]
    pub fn table(&self) -> String {
        let names = self.worlds.iter().map(|row| row.world.chars().count());
        let width = names.max().unwrap_or(0).max("over worlds".len());
        let [names, units] =
            if self.conditions.shield.is_some() { ["  vetoes   stops", "       %       %"] } else { [""; 2] };
        let mut text = format!(
            "{:width$}  runs    success  collision    timeout  mean time   score   score{names}\n\
             {:width$}                %          %          %          s    2022    2023{units}\n",
            "world", ""
        );
        let rule = "\u{2500}".repeat(text.lines().map(|line| line.chars().count()).max().unwrap_or(0));
        let _ = writeln!(text, "{rule}");
        for row in &self.worlds {
            row.write(&mut text, width);
        }
        let _ = writeln!(text, "{rule}");
        self.overall.write(&mut text, width);
        if let Some(i) = &self.overall.intervals {
            let rates =
                [(i.success_low, i.success_high), (i.collision_low, i.collision_high), (i.timeout_low, i.timeout_high)];
            write_ranges(&mut text, "over runs", width, rates);
        }
        if let Some(OverWorlds { success, collision, timeout, .. }) = &self.over_worlds {
            write_ranges(
                &mut text,
                "over worlds",
                width,
                [success, collision, timeout].map(|rate| (rate.low, rate.high)),
            );
        }
        text + "\n" + &self.legend() + "\n" + &self.conditions.table() + &self.references()
    }

    fn legend(&self) -> String {
        let mut text = "mean time    of the successes\n\
            scores       OT / clip(AT, 4 OT, 8 OT) for 2022, (2 OT, 8 OT) for 2023; 0 for a failure\n"
            .to_owned();
        if self.conditions.shield.is_some() {
            text += "vetoes       commands that the shield did not pass on as they were, in % of all; stops: those it braked instead of\n";
        }
        text += "over runs    95 % Wilson intervals as if all runs were independent\n";
        if let Some(over) = &self.over_worlds {
            let range = |low: Option<f64>, high: Option<f64>| {
                format!("{:.4}\u{2013}{:.4}", low.unwrap_or(f64::NAN), high.unwrap_or(f64::NAN))
            };
            let _ = writeln!(
                text,
                "over worlds  the same for as many runs as tell as much, those of one world being alike: go by these\n\
                 {:13}scores {} and {} (bootstrap over the worlds)",
                "",
                range(over.score_2022.low, over.score_2022.high),
                range(over.score_2023.low, over.score_2023.high)
            );
        } else {
            text += "             those of one world are alike, so these are too narrow; no other for fewer than three worlds\n";
        }
        text
    }

    /// What the optimal times come from.
    fn references(&self) -> String {
        let planned: Vec<&str> =
            self.references.iter().filter(|m| m.source == Source::Planned).map(|m| m.world.as_str()).collect();
        let what = match planned.len() {
            0 => "path files".to_owned(),
            n => {
                let which = if n == self.references.len() { "any world".to_owned() } else { planned.join(", ") };
                format!(
                    "no path file for {which}: our own shortest path, for the largest disc within the footprint, instead"
                )
            }
        };
        line("OT from", &what)
    }
}

impl Row {
    fn write(&self, text: &mut String, width: usize) {
        let percent = |share: f64| format!("{:.1}", 100.0 * share);
        let time = self.mean_time.map_or_else(|| "-".to_owned(), |time| format!("{time:.2}"));
        let of_shield = |share: Option<f64>| share.map_or_else(String::new, |share| format!("{:>8}", percent(share)));
        let (vetoes, stops) = (of_shield(self.vetoes), of_shield(self.stops));
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:width$}  {:>4}{:>11}{:>11}{:>11}{time:>11}  {:.4}  {:.4}{vetoes}{stops}",
            self.world,
            self.runs,
            percent(self.success),
            percent(self.collision),
            percent(self.timeout),
            self.score_2022,
            self.score_2023
        );
    }
}

fn write_ranges(text: &mut String, name: &str, width: usize, rates: [(f64, f64); 3]) {
    let [a, b, c] = rates.map(|(low, high)| format!("{:.1}\u{2013}{:.1}", 100.0 * low, 100.0 * high));
    let _ = writeln!(text, "{name:width$}      {a:>11}{b:>11}{c:>11}");
}

/// A line of the footer.
fn line(name: &str, what: &str) -> String {
    format!("{name:13}{what}\n")
}

impl Conditions {
    fn table(&self) -> String {
        let shield = self.shield.map_or("none".to_owned(), |ShieldSpec { margin, confidence, noise, latency }| {
            format!("margin {margin} m, confidence {confidence}, noise {noise}, latency {latency} s")
        });
        let lines = [
            ("driver", self.driver.words()),
            ("shield", shield),
            ("vehicle", self.vehicle.words()),
            ("actuation", actuation(&self.vehicle.spec.actuation)),
            ("lidar", lidar(&self.lidar)),
            ("odometry", odometry(&self.odometry)),
            ("randomized", if self.randomize.is_empty() { "nothing".to_owned() } else { randomized(self) }),
            ("route", route(&self.route)),
            ("runs", self.runs()),
            ("simulator", "Headway's, not Gazebo".to_owned()),
        ];
        lines.iter().map(|(name, what)| line(name, what)).collect()
    }

    fn runs(&self) -> String {
        if self.deterministic {
            "1 in each world: nothing here is random, so all would be the same".to_owned()
        } else {
            format!("{} in each world, seed {}", self.runs, self.seed)
        }
    }
}

impl Identity {
    fn words(&self) -> String {
        match self {
            Self::Policy { file, .. } => {
                file.as_ref().map_or("a policy".to_owned(), |file| format!("the policy {}", file.display()))
            }
            Self::Driver { name, changed } => format!("{name}{}", unlike(changed)),
        }
    }
}

impl Vehicle {
    fn words(&self) -> String {
        let footprint = match &self.spec.footprint {
            Shape::Disc { radius } => format!("a disc of radius {radius} m"),
            Shape::Box { length, width } => format!("{length} x {width} m"),
            Shape::Polygon { vertices } => format!("a polygon of {} corners", vertices.len()),
        };
        let known =
            self.preset.map_or("of no preset's outline".to_owned(), |name| format!("{name}{}", unlike(&self.changed)));
        format!(
            "{footprint}, up to {} m/s, a command every {} s: {known}",
            self.spec.max_speed, self.spec.control_period
        )
    }
}

fn actuation(ActuationSpec { latency, speed_lag, yaw_rate_lag, noise, yaw_rate_gain }: &ActuationSpec) -> String {
    format!(
        "latency {latency} s, lags {speed_lag} s (speed) and {yaw_rate_lag} s (yaw rate), noise {noise}, yaw rate gain {yaw_rate_gain}"
    )
}

fn lidar(lidar: &LidarSpec) -> String {
    format!(
        "{} beams over {:.0} deg, {} to {} m, noise {} m, dropout {}, grazing angle {} rad",
        lidar.n_beams,
        lidar.field_of_view.to_degrees(),
        lidar.min_range,
        lidar.max_range,
        lidar.noise,
        lidar.dropout,
        lidar.grazing_angle
    )
}

fn odometry(odometry: &OdometrySpec) -> String {
    let tree = |spec: &OdometrySpec| Value::try_from(spec).expect("numbers have a TOML form");
    let changed = changes(&tree(&OdometrySpec::default()), &tree(odometry));
    if changed.is_empty() { "exact".to_owned() } else { list(&changed) }
}

fn randomized(conditions: &Conditions) -> String {
    let drawn = conditions.randomize.iter().map(|(path, distribution)| format!("{path} {distribution}"));
    drawn.collect::<Vec<_>>().join(", ")
}

fn route(route: &RouteSource) -> String {
    let tree = |route: &RouteSource| Value::try_from(route).expect("numbers and names have a TOML form");
    let (what, default) = match route {
        RouteSource::None {} => return "none is shown".to_owned(),
        RouteSource::TrueMap(_) => ("planned over the true map", RouteSource::TrueMap(Default::default())),
        RouteSource::Scans(_) => ("planned over what the scans have shown", RouteSource::Scans(Default::default())),
    };
    format!("{what}{}", unlike(&changes(&tree(&default), &tree(route))))
}

/// The changes of a default, after what it is.
fn unlike(changed: &BTreeMap<String, Option<Value>>) -> String {
    if changed.is_empty() { String::new() } else { format!(", but {}", list(changed)) }
}

fn list(changed: &BTreeMap<String, Option<Value>>) -> String {
    let changes = changed.iter().map(|(path, value)| format!("{path} = {}", words(value.as_ref())));
    changes.collect::<Vec<_>>().join(", ")
}
