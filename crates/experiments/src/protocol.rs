//! Published ways to measure, step by step as their authors have them.

pub mod barn;
