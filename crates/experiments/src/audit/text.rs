//! Audits in words.

use headway_env::GoalHandling;
use serde::Serialize;

use super::ride::DISC_RADIUS;
use super::{Audit, Behaviour, Case, End, Paid, Place, SpeedTerm, SpeedVerdict};

/// Columns that lines have.
const WIDTH: usize = 110;
/// Columns that the name of a line takes.
const INDENT: usize = 10;

/// A case with the cells of a spec that share it, and its audit.
#[derive(Debug, Serialize)]
pub struct Entry {
    /// The cells: the levels that tell them from others; empty where there are no others.
    pub cells: String,
    /// The same where there is little room: of several levels only the first is named.
    #[serde(skip)]
    pub short_cells: String,
    /// The reward in a few words.
    pub reward_in_words: String,
    /// What was audited.
    #[serde(flatten)]
    pub case: Case,
    /// What came of it.
    #[serde(flatten)]
    pub audit: Audit,
}

/// The audits of a spec, one after the other, with a summary if there are several.
pub fn table(name: &str, entries: &[Entry]) -> String {
    let mut text = opening(name, entries);
    for entry in entries {
        text += &entry.text();
    }
    if entries.len() > 1 {
        text += &summary(entries);
    }
    text
}

fn opening(name: &str, entries: &[Entry]) -> String {
    let title = match entries {
        [_] => format!("{name}: what its reward pays for"),
        _ => format!("{name}: what its rewards pay for, {} cases", entries.len()),
    };
    let scene = format!(
        "Scripted drivers start at rest, the goal straight ahead, a disc of radius {DISC_RADIUS} m to the left of the way. Their \
         returns are exact: discounted per step, without a time limit, with the spec's vehicle and lidar free of noise."
    );
    format!("{title}\n\n{}", wrapped("", 0, &scene))
}

impl Entry {
    fn text(&self) -> String {
        let mut text = String::from("\n");
        if !self.cells.is_empty() {
            text += &format!("== {} ==\n", self.cells);
        }
        text += &wrapped("reward", INDENT, &self.reward_in_words);
        text += &wrapped("process", INDENT, &self.process());
        text.push('\n');
        text += &drivers(&self.audit.drivers, self.case.goal);
        text.push('\n');
        text += &wrapped(verdict(&self.audit), INDENT, &self.audit.in_words());
        text += &wrapped("gamma", INDENT, &self.gamma());
        text += &wrapped("speed", INDENT, &self.audit.speed_in_words());
        text += &wrapped("pay", INDENT, &self.audit.speed_term.in_words());
        let left_out = self.audit.left_out();
        if !left_out.is_empty() {
            let why = "not driven, since the actions or the vehicle do not allow it";
            text += &wrapped("note", INDENT, &format!("{why}: {}", left_out.join(", ")));
        }
        text
    }

    fn process(&self) -> String {
        let goal = match self.case.goal {
            GoalHandling::Terminate => "a reached goal ends the episode",
            GoalHandling::NewGoal => "a reached goal is followed by a new one",
        };
        let (gamma, dt) = (self.case.gamma, self.case.vehicle.control_period);
        format!("gamma {gamma} per step of {dt} s; {goal}; the goal is {} m away", rounded(self.audit.goal_distance))
    }

    fn gamma(&self) -> String {
        if self.audit.best_not_arriving().is_empty() {
            return "arriving is all that the agent can do, at every gamma".to_owned();
        }
        format!("{} (here it is {})", self.audit.gamma_in_words(), self.case.gamma)
    }
}

impl Audit {
    /// The verdict in a sentence.
    fn in_words(&self) -> String {
        let arriving = self.best_arriving();
        let others = self.best_not_arriving();
        let best = format!("`{}` returns {}", arriving.driver, number(arriving.discounted));
        let Some(other) = others.first() else {
            return format!("whatever the agent does, it arrives; {best}");
        };
        let names: Vec<String> = others.iter().map(|paid| format!("`{}`", paid.driver)).collect();
        let (names, each) = (names.join(", "), if others.len() > 1 { " each" } else { "" });
        let other = number(other.discounted);
        if self.passes {
            return format!("it pays best for arriving: {best}; not arriving returns {other} at most ({names})");
        }
        if !self.pays_more_for_not_arriving() {
            return format!("it does not tell arriving from not arriving: {best}, and so do {names}");
        }
        let verb = if others.len() > 1 { "return" } else { "returns" };
        format!("it pays best for not arriving: {names} {verb} {other}{each}; of those that arrive, {best} at most")
    }

    fn gamma_in_words(&self) -> String {
        match &self.not_arriving_pays_more[..] {
            [] => "arriving pays at least as much at every gamma".to_owned(),
            [[0.0, 1.0]] => "not arriving pays more at every gamma".to_owned(),
            [[from, 1.0]] => format!("from {} on, not arriving pays more", discount(*from)),
            several => {
                let parts: Vec<String> = several.iter().map(interval).collect();
                format!("not arriving pays more {}", parts.join(" and "))
            }
        }
    }

    /// What the speed does to the return of arriving.
    fn speed_in_words(&self) -> String {
        let [lowest, highest] = self.arriving_speeds;
        let best = self.best_arriving_speed;
        let range = format!("{lowest:.2} to {highest:.2} m/s");
        if self.arriving_speed_is_indifferent {
            format!("of those that arrive, all are paid the same: {range}")
        } else if best >= highest {
            format!("of those that arrive, the fastest is paid best: {best:.2} m/s of {range}")
        } else if best <= lowest {
            format!(
                "of those that arrive, the slowest is paid best, {best:.2} m/s of {range}: WARNING, it pays for taking time"
            )
        } else {
            format!("of those that arrive, that at {best:.2} m/s is paid best, of {range}")
        }
    }

    /// The drivers that could not drive.
    fn left_out(&self) -> Vec<&'static str> {
        let all = [
            (Behaviour::Park, "park"),
            (Behaviour::Spin, "spin on the spot"),
            (Behaviour::Orbit, "orbit the disc"),
            (Behaviour::Hover, "stop before the goal"),
            (Behaviour::Crash, "crash into the disc"),
        ];
        let is_there = |behaviour| self.drivers.iter().any(|paid| paid.behaviour == behaviour);
        all.iter().filter(|(behaviour, _)| !is_there(*behaviour)).map(|(_, words)| *words).collect()
    }
}

impl SpeedTerm {
    fn in_words(&self) -> String {
        let range = format!("{:.2} to {:.2} m/s", self.speeds[0], self.speeds[1]);
        if self.verdict == SpeedVerdict::None && self.by_place == 0.0 {
            let pay = self.at_desired_speed.first().map_or(0.0, |(_, pay)| *pay);
            return format!(
                "a step pays {}, whatever the place and the speed ({range}): there is no speed term",
                number(pay)
            );
        }
        let places: Vec<String> = self
            .at_desired_speed
            .iter()
            .map(|(place, pay)| format!("{} {}", number(*pay), Place::in_words(*place)))
            .collect();
        let pays = format!("at {:.2} m/s a step pays {}", self.desired_speed, places.join(", "));
        let (by_speed, by_place) = (number(self.by_speed), number(self.by_place));
        let effects = format!("speed ({range}) changes that by {by_speed} at most, the place by {by_place}");
        match self.verdict {
            SpeedVerdict::None => format!("{pays}; and the same at every speed ({range}): there is no speed term"),
            SpeedVerdict::Flat => format!("{pays}; {effects}: WARNING, the speed term is too flat to learn"),
            SpeedVerdict::Clear => format!("{pays}; {effects}"),
        }
    }
}

fn verdict(audit: &Audit) -> &'static str {
    if audit.passes { "PASSES" } else { "FAILS" }
}

/// A line a driver.
fn drivers(paid: &[Paid], goal: GoalHandling) -> String {
    let end = |paid: &Paid| match (paid.end, paid.seconds) {
        (End::Arrives, Some(s)) if goal == GoalHandling::NewGoal => format!("at the first goal after {s:.1} s"),
        (End::Arrives, Some(s)) => format!("at the goal after {s:.1} s"),
        (End::Collides, Some(s)) => format!("in the disc after {s:.1} s"),
        _ => "never".to_owned(),
    };
    let mut rows = vec![["driver", "return", "per second", "ends"].map(str::to_owned)];
    rows.extend(
        paid.iter().map(|paid| [paid.driver.clone(), number(paid.discounted), number(paid.per_second), end(paid)]),
    );
    columns(&rows, &[1, 2])
}

/// A line a case.
fn summary(entries: &[Entry]) -> String {
    let head = ["cells", "verdict", "pays best for", "not arriving pays more", "speed term"].map(str::to_owned);
    let row = |entry: &Entry| {
        let audit = &entry.audit;
        let speed = match audit.speed_term.verdict {
            SpeedVerdict::None => "none",
            SpeedVerdict::Flat => "too flat",
            SpeedVerdict::Clear => "clear",
        };
        let gammas = match &audit.not_arriving_pays_more[..] {
            [] => "at no gamma".to_owned(),
            [[0.0, 1.0]] => "at every gamma".to_owned(),
            several => several.iter().map(interval).collect::<Vec<_>>().join(" and "),
        };
        [entry.short_cells.clone(), verdict(audit).to_owned(), best_paid(audit), gammas, speed.to_owned()]
    };
    let rows: Vec<[String; 5]> = std::iter::once(head).chain(entries.iter().map(row)).collect();
    format!("\n== summary ==\n{}", columns(&rows, &[]))
}

/// Who is paid best, by name.
fn best_paid(audit: &Audit) -> String {
    if audit.passes {
        return audit.best_arriving().driver.clone();
    }
    match &audit.best_not_arriving()[..] {
        [one] => one.driver.clone(),
        [first, rest @ ..] => format!("{} (and {} more)", first.driver, rest.len()),
        [] => audit.best_arriving().driver.clone(),
    }
}

/// Rows in columns as wide as they need be; those that are named flush right.
fn columns<const N: usize>(rows: &[[String; N]], right: &[usize]) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; N] = std::array::from_fn(width);
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().zip(widths).enumerate().map(|(column, (cell, width))| {
            if right.contains(&column) { format!("{cell:>width$}") } else { format!("{cell:<width$}") }
        });
        let line = cells.collect::<Vec<_>>().join("  ");
        text += &format!("  {}\n", line.trim_end());
    }
    text
}

/// A name and words, in lines of at most [`WIDTH`] columns that begin below each other.
fn wrapped(name: &str, indent: usize, words: &str) -> String {
    let mut text = format!("{name:<indent$}");
    let mut column = indent;
    for word in words.split(' ') {
        let length = word.chars().count();
        if column > indent && column + 1 + length > WIDTH {
            text += &format!("\n{:indent$}", "");
            column = indent;
        } else if column > indent {
            text.push(' ');
            column += 1;
        }
        text += word;
        column += length;
    }
    text + "\n"
}

/// A pay or a return.
fn number(pay: f64) -> String {
    if !pay.is_finite() {
        return if pay > 0.0 { "infinite" } else { "-infinite" }.to_owned();
    }
    let text = format!("{pay:.2}");
    if text == "-0.00" { "0.00".to_owned() } else { text }
}

/// A length with no more digits than it needs.
fn rounded(metres: f64) -> f64 {
    (metres * 100.0).round() / 100.0
}

/// A discount: nearer to 1, more digits tell it from 1.
fn discount(gamma: f64) -> String {
    let n_digits = (1.0 - (1.0 - gamma).log10()).ceil().clamp(3.0, 7.0) as usize;
    format!("{gamma:.n_digits$}")
}

fn interval([from, to]: &[f64; 2]) -> String {
    match (*from, *to) {
        (0.0, to) => format!("up to gamma {}", discount(to)),
        (from, 1.0) => format!("from gamma {} on", discount(from)),
        (from, to) => format!("from gamma {} to {}", discount(from), discount(to)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discounts_have_the_digits_that_tell_them_from_one() {
        assert_eq!(discount(0.9), "0.900");
        assert_eq!(discount(0.25), "0.250");
        assert_eq!(discount(0.9987), "0.9987");
    }

    #[test]
    fn lines_end_before_the_width() {
        let text = wrapped("name", 6, &["word"; 60].join(" "));
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH));
        assert!(text.starts_with("name  word word") && text.contains("\n      word"));
    }

    #[test]
    fn intervals_in_words() {
        assert_eq!(interval(&[0.0, 0.5]), "up to gamma 0.500");
        assert_eq!(interval(&[0.9, 1.0]), "from gamma 0.900 on");
        assert_eq!(interval(&[0.2, 0.4]), "from gamma 0.200 to 0.400");
    }
}
