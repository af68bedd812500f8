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

/// The command lines of a block, as a shell would take them: comments, variables, and lines that go on.
fn lines(block: &Code) -> Vec<Line> {
    let mut variables = BTreeMap::new();
    let mut lines = Vec::new();
    for (number, text) in block.text.replace("\\\n", " ").lines().enumerate() {
        let Some(words) = shlex::split(text) else { continue };
        if let [word] = &words[..]
            && let Some((name, value)) = word.split_once('=')
        {
            variables.insert(format!("${name}"), shlex::split(value).unwrap());
        }
        let filled = words.into_iter().flat_map(|word| variables.get(&word).cloned().unwrap_or_else(|| vec![word]));
        if let Some(words) = from_experiments(filled.take_while(|word| word != ">").collect()) {
            lines.push(Line { place: format!("{}, line {} of it", block.place, number + 1), words });
        }
    }
    lines
}

/// The words from `experiments` on, which `cargo run --release --` stands for; none of other programs.
fn from_experiments(words: Vec<String>) -> Option<Vec<String>> {
    let (program, rest) = words.split_first()?;
    match &program[..] {
        "experiments" => Some(words),
        "cargo" if rest.first()? == "run" => {
            let at = rest.iter().position(|word| word == "--")?;
            Some([&["experiments".to_owned()], &rest[at + 1..]].concat())
        }
        _ => None,
    }
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

#[test]
fn shell_is_read_as_a_shell_does() {
    let text = "C=\"--set a.b=1 --set 'c=[2, 3]'\"\nexperiments run x.toml $C \\\n  --jobs 2 # fast\n\
                cargo run --release -p other -- list > names\ncargo test --release\n";
    let found = lines(&Code::of_block("here".as_ref(), text.into()));
    let words: Vec<_> = found.iter().map(|line| line.words.join("|")).collect();
    assert_eq!(words, ["experiments|run|x.toml|--set|a.b=1|--set|c=[2, 3]|--jobs|2", "experiments|list"]);
}
