//! Policy files and the drivers made from them, as those who use the crate see them.

mod common;
mod drivers;
mod files;
mod hostile_files;
mod saving;
