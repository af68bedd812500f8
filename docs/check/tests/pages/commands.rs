//! Command lines of `experiments`: the program's own parser takes them, their specs load, their files are there.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use clap::{CommandFactory, Parser};
use headway_experiments::cli::args::{Cli, Command};
use headway_experiments::spec::{Assignment, Grid};
use smooth_rewards as _; // the example's spec names its rewards

use super::code::{Code, Kind, files, from_root, of_pages};

/// A command line: where it stands, and its words from `experiments` on.
struct Line {
    place: String,
    words: Vec<String>,
}

/// The packages whose programs have these command lines.
const PACKAGES: [&str; 2] = ["headway-experiments", "smooth-experiments"];

/// The command lines of a block, as a shell would take them: comments, variables, lines that go on, several commands in one.
///
/// # Panics
/// If a line calls the program more often than commands are found in it, or cannot be read: what is not read would not be tried.
fn lines(block: &Code) -> Vec<Line> {
    let mut variables = BTreeMap::new();
    let mut lines = Vec::new();
    for (number, text) in block.text.replace("\\\n", " ").lines().enumerate() {
        let place = format!("{}, line {} of it", block.place, number + 1);
        let words = shlex::split(text);
        assert!(words.is_some() || !text.contains("cargo run"), "{place}: a quote does not end: {text}");
        let commands = words.map(|words| commands(words, &mut variables)).unwrap_or_default();
        let found: Vec<_> = commands.into_iter().filter_map(from_experiments).collect();
        assert!(found.len() >= n_calls(text), "{place}: this calls `experiments` in a way that is not read: {text}");
        lines.extend(found.into_iter().map(|words| Line { place: place.clone(), words }));
    }
    lines
}

/// How often a line calls the program, as far as its bare words tell.
fn n_calls(text: &str) -> usize {
    let words: Vec<_> = text.split_whitespace().take_while(|word| !word.starts_with('#')).collect();
    let program = |word: &str| word.trim_start_matches(['$', '(', '"', '\'']).rsplit('/').next() == Some("experiments");
    let cli = Cli::command();
    let is_command = |word: &str| cli.find_subcommand(word.trim_end_matches([')', '"', '\'', ';'])).is_some();
    words.windows(2).filter(|pair| program(pair[0]) && is_command(pair[1])).count()
}

/// The commands of a line, variables filled in, without what sets variables or says where the output goes.
fn commands(words: Vec<String>, variables: &mut BTreeMap<String, Vec<String>>) -> Vec<Vec<String>> {
    let ends = |word: &String| ["&&", "||", "|", ";", "&"].contains(&word.as_str());
    // As in `cd there; experiments list`.
    let apart = words.into_iter().flat_map(|word| match word.strip_suffix(';') {
        Some(word) => vec![word.to_owned(), ";".to_owned()],
        None => vec![word],
    });
    let apart: Vec<String> = apart.collect();
    let mut commands = Vec::new();
    for words in apart.split(ends) {
        let n_set = words.iter().take_while(|word| assignment(word).is_some()).count();
        let (set, words) = words.split_at(n_set);
        if words.is_empty() {
            let set = set.iter().filter_map(|word| assignment(word));
            variables.extend(set.map(|(name, value)| (format!("${name}"), shlex::split(value).unwrap())));
        }
        let filled = words.iter().flat_map(|word| variables.get(word).cloned().unwrap_or_else(|| vec![word.clone()]));
        commands.push(filled.take_while(|word| !word.starts_with('>')).collect());
    }
    commands
}

/// The name and the value that a word sets, if it does.
fn assignment(word: &str) -> Option<(&str, &str)> {
    let is_name = |name: &str| !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    word.split_once('=').filter(|(name, _)| is_name(name))
}

/// The words from `experiments` on, which `cargo run --release --` stands for; none of other programs.
fn from_experiments(words: Vec<String>) -> Option<Vec<String>> {
    let (program, rest) = words.split_first()?;
    match &program[..] {
        "cargo" if rest.first()? == "run" => {
            let at = rest.iter().position(|word| word == "--")?;
            let arguments = [&["experiments".to_owned()], &rest[at + 1..]].concat();
            runs_experiments(&rest[..at]).then_some(arguments)
        }
        _ => (program.rsplit('/').next() == Some("experiments")).then_some(words),
    }
}

/// Whether `cargo run` with these options runs a program of these command lines, as it does where it is not told which.
fn runs_experiments(options: &[String]) -> bool {
    let values = |names: &[&str]| -> Vec<String> {
        let of_next = options.windows(2).filter(|pair| names.contains(&&pair[0][..])).map(|pair| pair[1].clone());
        let own = options.iter().filter_map(|option| option.split_once('=')).filter(|(name, _)| names.contains(name));
        of_next.chain(own.map(|(_, value)| value.to_owned())).collect()
    };
    let programs = values(&["--bin", "--example"]);
    values(&["-p", "--package"]).iter().all(|package| PACKAGES.contains(&&package[..]))
        && programs.iter().all(|program| ["experiments", "smooth-experiments"].contains(&&program[..]))
}

/// Whether it is shell: a block that says so, or does not say what it is; or a whole command in a sentence, with its arguments.
fn is_shell(code: &Code) -> bool {
    match &code.kind {
        Kind::Block(None) => true,
        Kind::Block(Some(language)) => language == "sh",
        Kind::Inline => code.text.starts_with("experiments ") && code.text.split(' ').count() > 2,
    }
}

/// What the comments at the head of a spec file say.
fn head_of_spec(path: &Path) -> Code {
    let text = fs::read_to_string(path).unwrap();
    let comments: Vec<_> = text.lines().map_while(|line| line.strip_prefix('#')).collect();
    Code::of_block(path, comments.join("\n"))
}

/// The examples that `--help` shows of a command and those below it, without what it says beside them.
fn examples(command: &clap::Command) -> Vec<Code> {
    let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    let shown = help.lines().filter_map(|line| line.strip_prefix("  ")?.split("   ").next());
    let text = shown.collect::<Vec<_>>().join("\n");
    let own = Code::of_block(format!("{} --help", command.get_name()).as_ref(), text);
    command.get_subcommands().flat_map(examples).chain([own]).collect()
}

/// The spec of a command, with what it sets.
fn spec_of(command: &Command) -> Option<(&Path, &[Assignment])> {
    match command {
        Command::Run(args) => Some((&args.spec, &args.set)),
        Command::Check(args) => Some((&args.spec, &args.set)),
        Command::Audit(args) => Some((&args.spec, &args.set)),
        _ => None,
    }
}

/// What is wrong with a command line.
fn fault(line: &Line) -> Option<String> {
    let cli = match Cli::try_parse_from(&line.words) {
        Ok(cli) => cli,
        Err(error) => return Some(error.to_string()),
    };
    let ours = |word: &&String| ["specs/", "policies/", "examples/"].iter().any(|folder| word.starts_with(folder));
    if let Some(missing) = line.words.iter().filter(ours).find(|word| !from_root(word).exists()) {
        return Some(format!("there is no {missing}"));
    }
    let (spec, set) = spec_of(&cli.command).filter(|(spec, _)| spec.extension().is_some())?;
    Grid::load(&from_root(spec), set).err().map(|error| error.to_string())
}

#[test]
fn every_command_line_is_right() {
    let mut blocks: Vec<Code> = of_pages().into_iter().filter(is_shell).collect();
    blocks.extend(files("specs", "toml").iter().map(|path| head_of_spec(path)));
    blocks.push(head_of_spec(&from_root("examples/reward-plugin/spec.toml")));
    blocks.extend(examples(&Cli::command()));
    let lines: Vec<Line> = blocks.iter().flat_map(lines).collect();
    assert!(lines.len() > 70, "only {} were found", lines.len());
    let faults = lines.iter().filter_map(|line| Some(format!("{}: {:?}\n{}", line.place, line.words, fault(line)?)));
    let faults: Vec<_> = faults.collect();
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
}

#[test]
fn every_option_in_a_sentence_exists() {
    let cli = Cli::command();
    let has = |command: &clap::Command, option: &str| command.get_arguments().any(|arg| arg.get_long() == Some(option));
    for code in of_pages().iter().filter(|code| code.kind == Kind::Inline) {
        let mut words = code.text.split(' ').skip_while(|word| *word == "experiments").peekable();
        let Some(first) = words.peek() else { continue };
        let command = cli.find_subcommand(first);
        if command.is_none() && !first.starts_with("--") && !code.text.starts_with("experiments ") {
            continue;
        }
        for option in words.filter_map(|word| word.strip_prefix("--")) {
            let exists = match command {
                Some(command) => has(command, option),
                None => cli.get_subcommands().any(|command| has(command, option)),
            };
            assert!(exists, "{}: `{}`: there is no --{option}", code.place, code.text);
        }
    }
}

/// The commands found in a text, their words parted by bars.
fn found_in(text: &str) -> Vec<String> {
    let lines = lines(&Code::of_block("here".as_ref(), text.into()));
    lines.iter().map(|line| line.words[1..].join("|")).collect()
}

#[test]
fn shell_is_read_as_a_shell_does() {
    let text = "C=\"--set a.b=1 --set 'c=[2, 3]'\"\nexperiments run x.toml $C \\\n  --jobs 2 # fast\n\
                cargo run --release -- list > names\ncargo test --release\n";
    assert_eq!(found_in(text), ["run|x.toml|--set|a.b=1|--set|c=[2, 3]|--jobs|2", "list"]);
    assert_eq!(found_in("A=b B=c experiments list"), ["list"]);
    assert_eq!(
        found_in("cd x; experiments list && ./target/release/experiments run a.toml | tail"),
        ["list", "run|a.toml"]
    );
    assert!(found_in("It's prose. `experiments run SPEC` trains; experiments take time.").is_empty());
}

/// Another package's `list` was taken for ours.
#[test]
fn other_programs_are_not_ours() {
    for other in ["-p other", "--package=other", "--bin other", "--example=other", "-p headway-experiments --bin other"]
    {
        assert!(found_in(&format!("cargo run --release {other} -- list")).is_empty(), "{other}");
    }
    for own in ["-p smooth-experiments", "--package=headway-experiments", "--bin experiments", "--release"] {
        assert_eq!(found_in(&format!("cargo run {own} -- list")), ["list"], "{own}");
    }
}

/// These were passed over in silence.
#[test]
fn calls_that_cannot_be_read_are_failures() {
    let unread = [
        "experiments run 'x.toml",
        "cargo run -- run 'x.toml",
        "for x in 1 2; do experiments list; done",
        "echo \"$(experiments list)\"",
    ];
    for text in unread {
        let read = std::panic::catch_unwind(|| found_in(text));
        assert!(read.is_err(), "{text}: {read:?}");
    }
}
