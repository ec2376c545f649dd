//! The lumenscope program.

use std::process::ExitCode;

fn main() -> ExitCode {
    match lumenscope::cli::run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("lumenscope: {error:#}");
            ExitCode::FAILURE
        }
    }
}
