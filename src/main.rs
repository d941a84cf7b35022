//! The command `huygens`. See `huygens --help` and `docs/command-line.md`.

mod cli;

fn main() -> std::process::ExitCode {
    cli::main()
}
