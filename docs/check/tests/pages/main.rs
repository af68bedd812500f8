//! README.md and docs/, tried: their command lines, their pieces of specs, and what they quote.

mod code;
mod commands;
mod quotes;
mod specs;
