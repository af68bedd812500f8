//! The `experiments` program with the smooth rewards linked in.

use smooth_rewards as _; // names the plugin; unnamed, it would not be linked, and its rewards would be unknown

fn main() -> std::process::ExitCode {
    headway_experiments::main()
}
