//! From a spec file to the runs it stands for.

use std::collections::BTreeSet;
use std::path::Path;

use toml::{Table, Value};

use super::head::{Axis, HEAD_KEYS, Head, Seeds};
use super::names::check_folder;
use super::resolved::{Refusal, Resolved};
use super::source::Sources;
use super::{Assignment, Fault, KeyPath, Place, RunSpec, SpecError};

/// A spec file, loaded and validated: cells x seeds.
#[derive(Debug, Clone)]
pub struct Grid {
    /// Its name: the file's `name`, or else the file's own name without its ending.
    pub name: String,
    /// The training seeds of every cell.
    pub seeds: Seeds,
    /// The axes in the file's order; none where the file holds a single run.
    pub axes: Vec<Axis>,
    /// One cell for each combination of levels; the last axis varies fastest.
    pub cells: Vec<Cell>,
}

/// One combination of levels and the run it stands for.
#[derive(Debug, Clone)]
pub struct Cell {
    /// (axis, level) in the order of the axes.
    pub axes: Vec<(String, String)>,
    /// The run with all defaults filled in; only the seed is missing.
    pub spec: RunSpec,
    /// What its world files hold and its worlds do not: [`RunSpec::check`].
    pub left_out: BTreeSet<String>,
}

impl Cell {
    /// The cell in one line: `reward=R agent=DQN`, or `-` where there is no axis.
    pub fn label(&self) -> String {
        let pairs: Vec<String> = self.axes.iter().map(|(axis, level)| format!("{axis}={level}")).collect();
        if pairs.is_empty() { "-".into() } else { pairs.join(" ") }
    }
}

impl Grid {
    /// Loads, expands and validates the spec file at `path`; `sets` are applied to every cell, last.
    ///
    /// # Errors
    /// Names the place, the dotted path, the value, and what is allowed there.
    pub fn load(path: &Path, sets: &[Assignment]) -> Result<Self, SpecError> {
        let sources = Sources::load(path)?;
        let (head, run) = split(sources.merged());
        let mut loader = Loader { sources, head: Head::default(), sets };
        loader.head = loader.resolve_head(head)?;
        let base = Resolved::new(run).map_err(|refusal| loader.locate(refusal, &[]))?;
        let cells = loader.combinations().into_iter().map(|levels| loader.cell(&base, levels));
        let cells = cells.collect::<Result<_, _>>()?;
        let Head { name, seeds, axis: axes, .. } = loader.head;
        let name = name.map_or_else(|| name_of(path), Ok)?;
        Ok(Self { name, seeds, axes, cells })
    }

    /// Every run: cell by cell, seed by seed; a cell in which nothing is trained is one run.
    pub fn runs(&self) -> impl Iterator<Item = (&Cell, u64)> {
        self.cells.iter().flat_map(|cell| self.seeds_of(&cell.spec).map(move |seed| (cell, seed)))
    }

    /// How many runs there are; cells that train alike have each their own here, though `experiments run` makes but one for them.
    pub fn n_runs(&self) -> u64 {
        let n_learned = self.cells.iter().filter(|cell| cell.spec.policy.is_learned()).count() as u64;
        n_learned * self.seeds.count + (self.cells.len() as u64 - n_learned)
    }

    /// The seeds of a run of the grid: where nothing is trained, they make no difference, and there is one.
    pub(crate) fn seeds_of(&self, spec: &RunSpec) -> impl Iterator<Item = u64> + use<> {
        let Seeds { first, count } = self.seeds;
        Seeds { first, count: if spec.policy.is_learned() { count } else { 1 } }.iter()
    }
}

/// What the parts of loading need to know.
struct Loader<'a> {
    sources: Sources,
    head: Head,
    sets: &'a [Assignment],
}

/// A replacement made in a cell, and where it is written.
struct Step<'a> {
    path: KeyPath,
    value: &'a Value,
    origin: Origin,
}

/// Where a replacement is written.
enum Origin {
    /// At this path in the file, in this part of it.
    File(KeyPath, String),
    CommandLine,
}

impl Loader<'_> {
    /// The head after the assignments that concern it.
    fn resolve_head(&self, table: Table) -> Result<Head, SpecError> {
        let mut head: Resolved<Head> = Resolved::new(table).map_err(|refusal| self.locate(refusal, &[]))?;
        let mut steps = Vec::new();
        for set in self.sets.iter().filter(|set| is_head(&set.path)) {
            if !matches!(set.path.first(), "name" | "seeds") {
                let problem = "of the head, only `name` and `seeds` can be set here; edit the file for the others";
                let refusal = Refusal { path: set.path.clone(), value: None, problem: problem.into() };
                return Err(self.locate(refusal, &[Step::of(set)]));
            }
            steps.push(Step::of(set));
            head.set(&set.path, set.value.clone()).map_err(|refusal| self.locate(refusal, &steps))?;
        }
        head.spec.check().map_err(|fault| self.locate(fault.in_tree(&head.tree), &steps))?;
        Ok(head.spec)
    }

    /// All combinations of levels; the last axis varies fastest.
    fn combinations(&self) -> Vec<Vec<(String, String)>> {
        self.head.axis.iter().fold(vec![Vec::new()], |cells, axis| {
            let extend = |cell: Vec<_>| {
                axis.levels.keys().map(move |level| [&cell[..], &[(axis.name.clone(), level.clone())]].concat())
            };
            cells.into_iter().flat_map(extend).collect()
        })
    }

    /// The cell of these levels: `base` after every replacement, validated.
    fn cell(&self, base: &Resolved<RunSpec>, levels: Vec<(String, String)>) -> Result<Cell, SpecError> {
        let steps = self.steps(&levels)?;
        let mut run = base.clone();
        for (index, step) in steps.iter().enumerate() {
            run.set(&step.path, step.value.clone()).map_err(|refusal| self.locate(refusal, &steps[..=index]))?;
        }
        let mut cell = Cell { axes: levels, spec: run.spec, left_out: BTreeSet::new() };
        cell.left_out = cell.spec.check().map_err(|fault| {
            let needed = self.needed(&fault, base, &steps, &cell);
            let error = self.locate(fault.in_tree(&run.tree), &steps);
            if needed.is_empty() { error } else { error.given(&needed) }
        })?;
        Ok(cell)
    }

    /// What it takes to see a fault beside the place that is blamed for it: "in the cell reward=R, after --set a=1".
    fn needed(&self, fault: &Fault, base: &Resolved<RunSpec>, steps: &[Step<'_>], cell: &Cell) -> String {
        let shows = |those: Vec<&Step<'_>>| {
            let mut run = base.clone();
            let applied = those.into_iter().try_for_each(|step| run.set(&step.path, step.value.clone()));
            applied.is_ok() && run.spec.check().as_ref() == Err(fault)
        };
        let is_set = |step: &&Step<'_>| matches!(step.origin, Origin::CommandLine);
        let sets = || {
            format!("after {}", self.sets_of_cells().map(|set| format!("--set {set}")).collect::<Vec<_>>().join(" "))
        };
        let levels = || format!("in the cell {}", cell.label());
        if shows(last_to_touch(&fault.path, steps).into_iter().collect()) {
            String::new()
        } else if steps.iter().any(|step| is_set(&step)) && shows(steps.iter().filter(is_set).collect()) {
            sets()
        } else if shows(steps.iter().filter(|step| !is_set(step)).collect()) {
            levels()
        } else {
            format!("{}, {}", levels(), sets())
        }
    }

    /// The assignments that change cells.
    fn sets_of_cells(&self) -> impl Iterator<Item = &Assignment> {
        self.sets.iter().filter(|set| !is_head(&set.path))
    }

    /// The replacements of a cell in order: its levels, the `when`s it matches, the command line.
    fn steps(&self, levels: &[(String, String)]) -> Result<Vec<Step<'_>>, SpecError> {
        let mut steps = Vec::new();
        for (index, (axis, (_, level))) in self.head.axis.iter().zip(levels).enumerate() {
            let at = KeyPath::new(["axis", &index.to_string(), "levels", level]);
            let part = format!("axis {:?}, level {level:?}", axis.name);
            let table = axis.levels.get(level).and_then(Value::as_table);
            steps.extend(self.steps_of(table, &at, &part)?);
        }
        for (index, when) in self.head.when.iter().enumerate() {
            let holds = |(axis, level): (&String, &String)| levels.contains(&(axis.clone(), level.clone()));
            if when.matches.iter().all(holds) {
                let at = KeyPath::new(["when", &index.to_string(), "set"]);
                steps.extend(self.steps_of(Some(&when.set), &at, &format!("when number {}", index + 1))?);
            }
        }
        steps.extend(self.sets_of_cells().map(Step::of));
        Ok(steps)
    }

    /// The replacements that a table of dotted path -> value stands for.
    fn steps_of<'t>(&self, table: Option<&'t Table>, at: &KeyPath, part: &str) -> Result<Vec<Step<'t>>, SpecError> {
        let entries = table.into_iter().flatten();
        entries
            .map(|(key, value)| {
                let written = at.join(key);
                let refuse = |problem| SpecError {
                    place: Box::new(self.sources.place(&written).in_part(part)),
                    path: None,
                    value: None,
                    problem,
                };
                let path: KeyPath = key.parse().map_err(refuse)?;
                if is_head(&path) {
                    return Err(refuse(format!("`{path}` is shared by all cells: set it at the top of the file")));
                }
                Ok(Step { path, value, origin: Origin::File(written, part.to_owned()) })
            })
            .collect()
    }

    /// The error of `refusal`: where the last of `steps` that touched its path is written, or else the files' own tables.
    fn locate(&self, refusal: Refusal, steps: &[Step<'_>]) -> SpecError {
        let Refusal { path, value, problem } = refusal;
        let place = match last_to_touch(&path, steps).map(|step| (step, &step.origin)) {
            None => self.sources.place(&path),
            Some((_, Origin::CommandLine)) => Place::CommandLine,
            Some((step, Origin::File(written, part))) => {
                self.sources.place(&written.extend(&path.below(&step.path))).in_part(part)
            }
        };
        let path = (!path.segments().is_empty()).then_some(path);
        SpecError { place: Box::new(place), path, value, problem }
    }
}

impl<'a> Step<'a> {
    fn of(set: &'a Assignment) -> Self {
        Self { path: set.path.clone(), value: &set.value, origin: Origin::CommandLine }
    }

    /// What it replaces: a `preset` stands for the table that it is in.
    fn reach(&self) -> KeyPath {
        if self.path.last() == "preset" { self.path.parent() } else { self.path.clone() }
    }
}

/// The last of `steps` that changed the value at `path`, something in it, or what holds it.
fn last_to_touch<'s, 'v>(path: &KeyPath, steps: &'s [Step<'v>]) -> Option<&'s Step<'v>> {
    steps.iter().rev().find(|step| step.reach().is_prefix_of(path) || path.is_prefix_of(&step.path))
}

impl Fault {
    pub(super) fn in_tree(self, tree: &Value) -> Refusal {
        Refusal::new(tree, self.path, self.problem)
    }
}

/// The tables of the head, and those of the run.
fn split(merged: Table) -> (Table, Table) {
    merged.into_iter().partition(|(key, _)| HEAD_KEYS.contains(&key.as_str()))
}

fn is_head(path: &KeyPath) -> bool {
    HEAD_KEYS.contains(&path.first())
}

/// What a spec without a `name` is called: its file's name without the ending.
fn name_of(path: &Path) -> Result<String, SpecError> {
    let stem = path.file_stem().map_or_else(|| "spec".into(), |stem| stem.to_string_lossy().into_owned());
    check_folder(&stem).map(|()| stem.clone()).map_err(|problem| SpecError {
        place: Box::new(Place::File { file: path.to_owned(), line: None, part: None }),
        path: None,
        value: None,
        problem: format!("write a `name`: without one the spec is called after its file, {stem:?}, and that {problem}"),
    })
}
