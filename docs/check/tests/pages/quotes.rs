//! Rust snippets: pages that have some are doc-tests, and docs/plugins.md quotes the example as it is.

use std::fs;

use super::code::{files, from_root, of_page, pages};

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
