//! What pages quote from elsewhere: the example, the program's output, each other.

use std::fs;

use clap::Parser;
use headway_experiments::cli::args::{Cli, Command};
use headway_experiments::cli::audit;

use super::code::{Kind, files, from_root, of_page, pages};

#[test]
fn every_page_with_rust_is_a_doc_test() {
    let library = fs::read_to_string(from_root("docs/check/src/lib.rs")).unwrap();
    for page in pages().iter().filter(|page| of_page(page).iter().any(|code| code.is_in("rust"))) {
        let name = page.file_name().unwrap().to_str().unwrap();
        assert!(library.contains(&format!("/{name}\");")), "docs/check/src/lib.rs does not name {name}");
    }
}

#[test]
fn the_plugin_of_the_page_is_the_example() {
    let folders = ["rewards/src", "rewards/tests", "experiments/src"];
    let example = folders.iter().flat_map(|folder| files(&format!("examples/reward-plugin/{folder}"), "rs"));
    let example: Vec<_> = example.map(|path| fs::read_to_string(path).unwrap()).collect();
    let snippets: Vec<_> =
        of_page(&from_root("docs/plugins.md")).into_iter().filter(|code| code.is_in("rust")).collect();
    assert!(snippets.len() >= 3, "a reward, its tests, and a main");
    for snippet in snippets {
        let is_quoted = example.iter().any(|file| file.contains(&snippet.text));
        assert!(is_quoted, "{}: no file of examples/reward-plugin has\n{}", snippet.place, snippet.text);
    }
}

#[test]
fn audits_are_what_the_program_prints() {
    let (mut asked, mut n_audits) = (String::new(), 0);
    for code in of_page(&from_root("docs/audit.md")) {
        if code.kind == Kind::Inline && code.text.starts_with("experiments audit specs/") {
            asked = code.text;
        } else if code.is_in("text") {
            let Command::Audit(mut args) = Cli::parse_from(asked.split(' ')).command else { panic!("{asked}") };
            args.spec = from_root(args.spec);
            let mut printed = Vec::new();
            audit::execute(&args, &mut printed).unwrap();
            assert_eq!(code.text, String::from_utf8(printed).unwrap(), "{}: {asked}", code.place);
            n_audits += 1;
        }
    }
    assert_eq!(n_audits, 2);
}

#[test]
fn the_readme_shows_the_table_of_the_results() {
    let table = of_page(&from_root("README.md")).into_iter().find(|code| code.is_in("text")).unwrap();
    let results = fs::read_to_string(from_root("docs/results.md")).unwrap();
    assert!(results.contains(&table.text), "{}: docs/results.md has another table", table.place);
}
