//! The Rust snippets of README.md and docs/ are this library's doc-tests. There is nothing else in it.

/// Makes doc-tests of the snippets of a page, under a name for their output.
macro_rules! page {
    ($name:ident, $path:literal) => {
        #[cfg(doctest)]
        #[doc = include_str!($path)]
        struct $name;
    };
}

page!(Readme, "../../../README.md");
page!(Plugins, "../../plugins.md");
