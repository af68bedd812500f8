//! The binary `experiments`: all of it is in the library, so that a plugin's binary can have it too.

fn main() -> std::process::ExitCode {
    headway_experiments::main()
}
